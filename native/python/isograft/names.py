# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers by name: which are meant, and what a new one is called."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase

from isograft.errors import InvalidInput


def choose(names: Sequence[str], patterns: str, owner: str) -> list[str]:
    """Those of `names` that the comma-separated `patterns`, which may hold * and ?, stand for; all if it is empty.

    Raises:
        InvalidInput: a pattern stands for none; the text begins with `owner`, such as "Body has no UV map".
    """
    wanted = [pattern.strip() for pattern in patterns.split(",") if pattern.strip()]
    if not wanted:
        return list(names)
    for pattern in wanted:
        if not any(_fits(name, pattern) for name in names):
            raise InvalidInput(f"{owner} called {pattern}; it has: {', '.join(names) or 'none'}")
    return [name for name in names if any(_fits(name, pattern) for pattern in wanted)]


def _fits(name: str, pattern: str) -> bool:
    return name == pattern or fnmatchcase(name, pattern)


class Names:
    """Names in use on a receiver."""

    longest: int | None = None
    """Bytes that a name with a number may have."""

    def __init__(self, taken: Iterable[str], overwrite: bool) -> None:
        self._taken = set(taken)
        self._overwrite = overwrite

    def claim(self, name: str) -> str:
        """A free name in Blender's manner, or `name` itself if it may be overwritten; it is then taken."""
        free, number = name, 0
        while free in self._taken and not self._overwrite:
            number += 1
            end = f".{number:03d}"
            free = name if self.longest is None else _cut(name, self.longest - len(end))
            free += end
        self._taken.add(free)
        return free


def _cut(name: str, longest: int) -> str:
    """At most so many bytes of UTF-8, whole letters."""
    return name.encode()[:longest].decode(errors="ignore")
