# SPDX-License-Identifier: GPL-3.0-or-later
"""Exit codes, and what the subcommands share."""

from __future__ import annotations

import math
import os
import sys
import time
from pathlib import Path
from typing import TextIO

from isograft.files import MeshFile, read_mesh

OK = 0
FAILED = 1
USAGE = 2
NOTHING_MATCHED = 3
CANCELLED = 130


class BadInput(Exception):
    """An input file cannot be opened, or an output cannot be written where it should be."""


def open_mesh(path: str) -> MeshFile:
    """Read a mesh; a file that cannot be opened is bad input like a corrupt one."""
    try:
        return read_mesh(path)
    except OSError as error:
        raise BadInput(f"{path}: {error.strerror or error}") from None


def check_output(path: str, suffixes: tuple[str, ...]) -> None:
    """Raise BadInput now rather than after a long run if `path` cannot be written."""
    if Path(path).suffix.lower() not in suffixes:
        raise BadInput(f"{path}: the output must end in {', '.join(suffixes)}")
    folder = Path(path).parent
    if not folder.is_dir():
        raise BadInput(f"{path}: there is no folder {folder}")
    if Path(path).is_dir() or not os.access(folder, os.W_OK):
        raise BadInput(f"{path}: cannot be written")


class ProgressLine:
    """One line on a terminal that is written over; elsewhere a line whenever five percent more are done."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._terminal = self._stream.isatty()
        self._shown = -1
        self._stage = ""
        self._last = -math.inf

    def __call__(self, stage: str, fraction: float) -> None:
        percent = int(100 * fraction)
        if self._terminal:
            now = time.monotonic()
            if now - self._last >= 0.1 or stage != self._stage:
                self._stream.write(f"\r\033[K{percent:3d} % {stage}")
                self._last = now
        elif percent >= self._shown + 5 or (percent == 100 and self._shown < 100):
            self._stream.write(f"{percent:3d} % {stage}\n")
            self._shown = percent
        self._stage = stage
        self._stream.flush()

    def close(self) -> None:
        """Leave the terminal's line empty for what is printed next."""
        if self._terminal:
            self._stream.write("\r\033[K")
            self._stream.flush()
