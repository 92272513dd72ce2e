# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """A new file beside `path` that takes its place when the block ends, and is removed if the block raises."""
    target = Path(path)
    handle, name = tempfile.mkstemp(prefix=f".{target.name}.", suffix=".part", dir=target.parent)
    part = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        # mkstemp's mode is for the owner alone; a result gets what any new file would.
        mask = os.umask(0)
        os.umask(mask)
        part.chmod(0o666 & ~mask)
        part.replace(target)
    except BaseException:
        with suppress(FileNotFoundError):
            part.unlink()
        raise


@contextmanager
def together() -> Iterator[Callable[[str | os.PathLike[str]], Path]]:
    """A function that names, for a path, a file beside it to write instead: all of them take their places when the
    block ends, and are removed if it raises."""
    parts: dict[Path, Path] = {}

    def beside(path: str | os.PathLike[str]) -> Path:
        target = Path(path)
        # The suffix stays: it says what is written.
        parts[target] = target.with_name(f".{os.getpid()}.{len(parts)}.{target.name}")
        return parts[target]

    try:
        yield beside
        for target, part in parts.items():
            part.replace(target)
    except BaseException:
        for part in parts.values():
            part.unlink(missing_ok=True)
        raise
