# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of UDIM images: skin.<UDIM>.png stands for skin.1001.png, skin.1002.png and so on, one per unit of UVs."""

from __future__ import annotations

import re
from pathlib import Path

FIRST = 1001
"""Number of the tile at the origin; u counts by ones up to 9, v by tens."""
_PLACES = re.compile("<(udim|uvtile)>", re.IGNORECASE)


def is_tiled(path: str | Path) -> bool:
    """Whether a name has a place for the number of a tile: <UDIM>, or <UVTILE> (u1_v1)."""
    return _PLACES.search(Path(path).name) is not None


def tile_path(path: Path, number: int) -> Path:
    """The file of one tile."""
    v, u = divmod(number - FIRST, 10)
    words = {"udim": str(number), "uvtile": f"u{u + 1}_v{v + 1}"}
    return path.with_name(_PLACES.sub(lambda found: words[found[1].lower()], path.name))


def has_tiles(path: Path) -> bool:
    """Whether there is a file of any tile."""
    parts = _PLACES.split(path.name)
    # Between the parts of the name stand the words of its places.
    kinds = {"udim": r"\d{4}", "uvtile": r"u\d+_v\d+"}
    pattern = re.compile("".join(kinds[part.lower()] if k % 2 else re.escape(part) for k, part in enumerate(parts)))
    return path.parent.is_dir() and any(pattern.fullmatch(file.name) for file in path.parent.iterdir())
