# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in .npz files; that of a match: the arrays of its correspondences by name, and the report as JSON text."""

from __future__ import annotations

import os
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.atomic import replacing

PathLike = str | os.PathLike[str]
Arrays = dict[str, npt.NDArray[Any]]

#: Type and number of columns of every array of a correspondence.
ARRAYS: Mapping[str, tuple[type[np.generic], int]] = {
    "face": (np.int32, 1), "barycentric": (np.float64, 3), "points": (np.float64, 3), "vertex": (np.int32, 1),
    "confidence": (np.float64, 1), "stretch": (np.float64, 1), "region": (np.int32, 1), "corners": (np.int32, 3),
}  # fmt: skip

_SOURCE = "source_vertices"


def write_npz(
    path: PathLike,
    correspondences: Sequence[Arrays],
    target_size: int,
    report: str,
    source: npt.NDArray[np.float64] | None = None,
) -> None:
    """The first one's arrays by their names, the next ones' as `alternative1_...`, `target_size` and `report`.

    `source` (n, 3) are the source's vertices, by which a map of another shape is known later.
    """
    arrays: Arrays = {"target_size": np.array(target_size, np.int64), "report": np.array(report)}
    for rank, correspondence in enumerate(correspondences):
        prefix = f"alternative{rank}_" if rank else ""
        arrays.update({prefix + name: correspondence[name] for name in ARRAYS})
    if source is not None:
        arrays[_SOURCE] = source.astype(np.float32)
    with replacing(path) as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def read_source(path: PathLike) -> npt.NDArray[np.float32] | None:
    """(n, 3) the source's vertices as write_npz() was given them, None if it was not. Raises as load_arrays() does."""
    found = load_arrays(path).get(_SOURCE)
    return (
        found if found is not None and found.ndim == 2 and found.shape[1] == 3 and found.dtype == np.float32 else None
    )


def load_arrays(path: PathLike) -> Arrays:
    """All arrays of an .npz by name. Raises InvalidInput if it is damaged or has objects, OSError if it is missing."""
    with Path(path).open("rb") as raw:
        if not zipfile.is_zipfile(raw):
            raise InvalidInput(f"{path}: not an .npz file, or a truncated one")
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (ValueError, EOFError, KeyError, zipfile.BadZipFile, zlib.error, NotImplementedError, MemoryError) as error:
        raise InvalidInput(f"{path}: the file is damaged: {error}") from None
    return arrays


def read_npz(path: PathLike) -> tuple[list[Arrays], int, str | None]:
    """What write_npz() was given. Raises InvalidInput naming the file and the array that is missing or malformed."""
    arrays = load_arrays(path)
    size = arrays.get("target_size")
    if size is None or size.shape != () or size.dtype.kind not in "iu":
        raise InvalidInput(f"{path}: not a map of isograft: target_size is missing")
    correspondences = [_take(path, arrays, "", int(size))]
    while f"alternative{len(correspondences)}_face" in arrays:
        correspondences.append(_take(path, arrays, f"alternative{len(correspondences)}_", int(size)))
    return correspondences, int(size), str(arrays["report"]) if "report" in arrays else None


def _take(path: PathLike, arrays: Arrays, prefix: str, target_size: int) -> Arrays:
    face = arrays.get(prefix + "face")
    rows = len(face) if face is not None and face.ndim else 0
    taken: Arrays = {}
    for name, (dtype, columns) in ARRAYS.items():
        array = arrays.get(prefix + name)
        if array is None:
            raise InvalidInput(f"{path}: the array {prefix + name} is missing")
        shape = (rows,) if columns == 1 else (rows, columns)
        if array.dtype != dtype or array.shape != shape:
            raise InvalidInput(
                f"{path}: {prefix + name} should be {np.dtype(dtype)} {shape}, and is {array.dtype} {array.shape}"
            )
        taken[name] = array
    for name in ("corners", "vertex"):
        if rows and not -1 <= taken[name].min() <= taken[name].max() < target_size:
            raise InvalidInput(f"{path}: {prefix}{name} names a vertex that is none of the target's {target_size}")
    matched = taken["vertex"] >= 0
    if rows and (taken["face"].min() < -1 or (taken["corners"][matched | (taken["face"] >= 0)] < 0).any()):
        raise InvalidInput(f"{path}: {prefix}face, {prefix}vertex and {prefix}corners contradict each other")
    return taken
