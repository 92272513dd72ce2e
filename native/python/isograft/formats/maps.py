# SPDX-License-Identifier: GPL-3.0-or-later
"""Correspondences in files: .npz (whole), .corr (SHREC'16), .ply (the source with attributes)."""

from __future__ import annotations

import os
import zipfile
import zlib
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from isograft.correspondence import Correspondence, corners_of
from isograft.errors import InvalidInput
from isograft.formats.atomic import replacing
from isograft.formats.mesh import MeshFile
from isograft.formats.text import Lines
from isograft.report import Report
from isograft.surface import Surface

PathLike = str | os.PathLike[str]

_SHAPES: Mapping[str, tuple[type[np.generic], int]] = {
    "face": (np.int32, 1), "barycentric": (np.float64, 3), "points": (np.float64, 3), "vertex": (np.int32, 1),
    "confidence": (np.float64, 1), "stretch": (np.float64, 1), "region": (np.int32, 1), "corners": (np.int32, 3),
}  # fmt: skip


def write_npz(path: PathLike, correspondences: Sequence[Correspondence], report: Report | None = None) -> None:
    """The first one's arrays by their names, the next ones' as `alternative1_...`, and `report` as JSON text.

    `target_size` is the number of the target's vertices.
    """
    arrays: dict[str, npt.NDArray[np.generic]] = {}
    for rank, correspondence in enumerate(correspondences):
        prefix = f"alternative{rank}_" if rank else ""
        for name in _SHAPES:
            arrays[prefix + name] = getattr(correspondence, name)
    arrays["target_size"] = np.int64(correspondences[0].target_size)  # type: ignore[assignment]
    arrays["report"] = np.array((report or Report()).to_json())
    with replacing(path) as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]


def read_npz(path: PathLike) -> tuple[list[Correspondence], Report | None]:
    """Best first. Raises InvalidInput naming the file and the array that is missing or malformed."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except OSError:
        raise
    except (
        ValueError,
        EOFError,
        KeyError,
        AttributeError,
        zipfile.BadZipFile,
        zlib.error,
        NotImplementedError,
    ) as error:
        raise InvalidInput(f"{path}: not a map written by isograft ({error})") from None
    size = arrays.get("target_size")
    if size is None or size.shape != () or size.dtype.kind not in "iu":
        raise InvalidInput(f"{path}: not a map written by isograft (target_size is missing)")
    correspondences = [_take(path, arrays, "", int(size))]
    while f"alternative{len(correspondences)}_face" in arrays:
        correspondences.append(_take(path, arrays, f"alternative{len(correspondences)}_", int(size)))
    report = None
    if "report" in arrays:
        try:
            report = Report.from_json(str(arrays["report"]))
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {error}") from None
    return correspondences, report


def _take(path: PathLike, arrays: Mapping[str, npt.NDArray[np.generic]], prefix: str, size: int) -> Correspondence:
    taken = {}
    rows = None
    for name, (dtype, columns) in _SHAPES.items():
        array = arrays.get(prefix + name)
        if array is None:
            raise InvalidInput(f"{path}: the array {prefix + name} is missing")
        rows = len(array) if rows is None and array.ndim else rows
        shape = (rows,) if columns == 1 else (rows, columns)
        if array.dtype != dtype or array.shape != shape:
            raise InvalidInput(
                f"{path}: {prefix + name} should be {np.dtype(dtype)} {shape}, and is {array.dtype} {array.shape}"
            )
        taken[name] = array
    corners = taken["corners"]
    if len(corners) and int(corners.max()) >= size:
        raise InvalidInput(f"{path}: {prefix}corners names vertex {corners.max()}, the target has {size}")
    return Correspondence(**taken, target_size=size)  # type: ignore[arg-type]


def write_corr(path: PathLike, correspondence: Correspondence) -> None:
    """SHREC'16: a line a source vertex with the 1-based target triangle and three weights, `-1 0 0 0` unmatched."""
    weights = np.where(correspondence.matched[:, None], correspondence.barycentric, 0.0).tolist()
    lines = [
        f"{face + 1} {a:.12g} {b:.12g} {c:.12g}\n" if face >= 0 else "-1 0 0 0\n"
        for face, (a, b, c) in zip(correspondence.face.tolist(), weights, strict=True)
    ]
    with replacing(path) as file:
        file.write("".join(lines).encode("ascii"))


def read_corr(path: PathLike, target: Surface) -> Correspondence:
    """Read what write_corr() wrote, for the target it was made for. Confidence is 1, stretch 0, region 0 if matched."""
    with open(path, "rb") as file:
        lines = Lines(os.fspath(path), file.read())
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
