# SPDX-License-Identifier: GPL-3.0-or-later
"""Correspondences in the formats of others: .corr (SHREC'16) and .ply (the source with attributes)."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import numpy.typing as npt

from isograft.correspondence import Correspondence, corners_of
from isograft.errors import InvalidInput
from isograft.formats.atomic import replacing
from isograft.formats.mesh import MeshFile
from isograft.formats.text import Lines
from isograft.surface import Surface

PathLike = str | os.PathLike[str]


def write_corr(path: PathLike, correspondence: Correspondence) -> None:
    """SHREC'16: a line a source vertex with the 1-based target triangle and three weights, `-1 0 0 0` unmatched.

    Raises InvalidInput for a map to a point cloud, which has no triangles to name.
    """
    if (correspondence.matched & (correspondence.face < 0)).any():
        raise InvalidInput(f"{path}: .corr names triangles, and the target is a point cloud: write .npz or .ply")
    weights = np.where(correspondence.matched[:, None], correspondence.barycentric, 0.0).tolist()
    lines = [
        f"{face + 1} {a:.12g} {b:.12g} {c:.12g}\n" if face >= 0 else "-1 0 0 0\n"
        for face, (a, b, c) in zip(correspondence.face.tolist(), weights, strict=True)
    ]
    with replacing(path) as file:
        file.write("".join(lines).encode("ascii"))


def read_corr(path: PathLike, target: Surface) -> Correspondence:
    """Read what write_corr() wrote, for the target it was made for. Matched: confidence 1, stretch 0, region 0."""
    if target.is_cloud:
        raise InvalidInput(f"{path}: .corr names triangles, and the target is a point cloud: use the .npz")
    lines = Lines(os.fspath(path), Path(path).read_bytes())
    table = lines.table(0, len(lines), "a triangle and three weights", 4)
    if table.shape[1] != 4:
        lines.fail(0, f"{table.shape[1]} numbers where a triangle and three weights are needed")
    triangle = table[:, 0]
    bad = np.flatnonzero(
        (triangle != np.floor(triangle))
        | (triangle > len(target.faces))
        | (triangle == 0)
        | ~np.isfinite(table).all(axis=1)
    )
    if bad.size:
        lines.fail(int(bad[0]), f"{triangle[bad[0]]:g} is no triangle of the target, which has {len(target.faces)}")
    face = np.where(triangle > 0, triangle - 1, -1).astype(np.int32)
    matched = face >= 0
    weights = np.where(matched[:, None], table[:, 1:], np.nan)
    off = np.flatnonzero(matched & ((table[:, 1:].min(axis=1) < -1e-6) | (abs(table[:, 1:].sum(axis=1) - 1) > 1e-4)))
    if off.size:
        lines.fail(int(off[0]), "the weights are not >= 0 with sum 1")
    corners = corners_of(face, target.faces)
    points = np.einsum("ij,ijk->ik", weights, target.vertices[corners])
    largest = np.where(matched, np.argmax(table[:, 1:], axis=1), 0)
    return Correspondence(
        face=face,
        barycentric=weights,
        points=points,
        vertex=np.where(matched, corners[np.arange(len(face)), largest], -1).astype(np.int32),
        confidence=matched.astype(np.float64),
        stretch=np.where(matched, 0.0, np.nan),
        region=np.where(matched, 0, -1).astype(np.int32),
        corners=corners,
        target_size=len(target.vertices),
    )


def write_ply(path: PathLike, source: MeshFile, correspondence: Correspondence) -> None:
    """The source's vertices and polygons with the map as vertex properties, zeros where unmatched.

    isograft_face, _weight0 to 2, _x, _y, _z (the point on the target), _vertex, _confidence, _stretch, _region.
    """
    filled = {
        name: np.where(np.isnan(array), 0.0, array)
        for name in ("barycentric", "points", "stretch")
        for array in [getattr(correspondence, name)]
    }
    columns: list[tuple[str, str, npt.NDArray[np.generic]]] = [
        *((axis, "double", source.vertices[:, i]) for i, axis in enumerate("xyz")),
        ("isograft_face", "int", correspondence.face),
        *((f"isograft_weight{i}", "float", filled["barycentric"][:, i]) for i in range(3)),
        *((f"isograft_{axis}", "double", filled["points"][:, i]) for i, axis in enumerate("xyz")),
        ("isograft_vertex", "int", correspondence.vertex),
        ("isograft_confidence", "float", correspondence.confidence),
        ("isograft_stretch", "float", filled["stretch"]),
        ("isograft_region", "int", correspondence.region),
    ]
    codes = {"double": "<f8", "float": "<f4", "int": "<i4"}
    table = np.empty(len(source.vertices), [(name, codes[kind]) for name, kind, _ in columns])
    for name, _, values in columns:
        table[name] = values
    sizes, corners = source.polygons.sizes, source.polygons.corners
    header = [
        "ply", "format binary_little_endian 1.0", f"element vertex {len(table)}",
        *(f"property {kind} {name}" for name, kind, _ in columns),
        f"element face {len(sizes)}", "property list uint int vertex_indices", "end_header", "",
    ]  # fmt: skip
    # Each polygon's length goes right before its corners.
    body = np.insert(corners, np.cumsum(sizes) - sizes, sizes).astype("<i4")
    with replacing(path) as file:
        file.write("\n".join(header).encode("ascii"))
        file.write(table.tobytes())
        file.write(body.tobytes())
