# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and maps in files.

One rule for every mesh and point cloud: row i of the result is vertex i of the file. Texture coordinates of corners are
kept apart from the vertices (seams split nothing), and n-gons are triangulated with the way back kept. STL repeats
every vertex in each of its triangles and is the exception: equal positions are one vertex, in the order of first use.
"""

from __future__ import annotations

import os
from pathlib import Path

from isograft.correspondence import Correspondence
from isograft.errors import InvalidInput
from isograft.formats.maps import read_corr, write_corr, write_ply
from isograft.formats.mesh import MeshFile
from isograft.formats.obj import read_obj
from isograft.formats.off import read_off
from isograft.formats.ply import read_ply
from isograft.formats.polygons import triangulate
from isograft.formats.stl import read_stl
from isograft.matching import Match
from isograft.surface import Surface

__all__ = ["MAP_SUFFIXES", "MESH_SUFFIXES", "MeshFile", "read_map", "read_mesh", "write_map"]

_READERS = {".ply": read_ply, ".obj": read_obj, ".off": read_off, ".stl": read_stl}
#: Suffixes of the meshes that can be read, and of the maps that can be written.
MESH_SUFFIXES = tuple(_READERS)
MAP_SUFFIXES = (".npz", ".corr", ".ply")


def read_mesh(path: str | os.PathLike[str]) -> MeshFile:
    """Read a PLY, OBJ, OFF or STL file, whichever its suffix says.

    Raises:
        InvalidInput: the file is corrupt or truncated (the text names the file and the line or byte), or has another
            suffix.
        OSError: it cannot be opened.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in _READERS:
        raise InvalidInput(f"{path}: cannot read {suffix or 'files without a suffix'}, only {', '.join(MESH_SUFFIXES)}")
    name = os.fspath(path)
    return triangulate(name, _READERS[suffix](name, Path(path).read_bytes()))


def write_map(path: str | os.PathLike[str], match: Match, source: MeshFile) -> None:
    """Write .npz (everything), .corr or .ply (the best map), whichever the suffix says; whole or not at all.

    Raises InvalidInput for another suffix, OSError if the file cannot be written.
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".npz":
        match.save(path, source.vertices)
    elif suffix == ".corr":
        write_corr(path, match.best)
    elif suffix == ".ply":
        write_ply(path, source, match.best)
    else:
        raise InvalidInput(f"{path}: cannot write {suffix or 'files without a suffix'}, only {', '.join(MAP_SUFFIXES)}")


def read_map(path: str | os.PathLike[str], target: Surface) -> Correspondence:
    """The best map of an .npz, or a .corr, for the target it was made for.

    Raises InvalidInput if the file is corrupt or was made for another target.
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".corr":
        return read_corr(path, target)
    if suffix != ".npz":
        raise InvalidInput(f"{path}: maps are read from .npz and .corr files")
    best = Correspondence.load(path)
    if best.target_size != len(target.vertices):
        raise InvalidInput(
            f"{path}: the map leads to a target of {best.target_size} vertices, this one has {len(target.vertices)}"
        )
    if len(best) and int(best.face.max()) >= len(target.faces):
        raise InvalidInput(f"{path}: the map names triangle {best.face.max()}, the target has {len(target.faces)}")
    return best
