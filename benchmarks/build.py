# SPDX-License-Identifier: GPL-3.0-or-later
"""Which build a row was measured with, so that a later run measures again only what may have changed."""

from __future__ import annotations

import hashlib
import importlib.metadata
from pathlib import Path

import isograft
from isograft import _native


def build_of(method: str) -> str:
    """Of isograft: the compiled module and the package's own files. Of a peer: its version."""
    if method == "isograft":
        return _isograft()
    if method == "pyfm-zoomout":
        try:
            return f"pyfmaps {importlib.metadata.version('pyfmaps')}"
        except importlib.metadata.PackageNotFoundError:
            return "pyfmaps, not installed"
    return "1"


def _isograft() -> str:
    digest = hashlib.sha256()
    package = Path(isograft.__file__).parent
    for path in [Path(_native.__file__), *sorted(package.rglob("*.py"))]:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]
