# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of the right correspondence: the true image of every source vertex."""

from __future__ import annotations

import os
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.arguments import to_array, to_points
from isograft.errors import InvalidInput

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Truth:
    """The true image of every source vertex: a target vertex, or a point of a target triangle; n source vertices."""

    #: (n,) target vertex, -1 where there is none or none is known; None where the truth is given by triangles.
    vertex: IntArray | None = None
    #: (n,) target triangle, -1 where there is none; None where the truth is given by vertices.
    face: IntArray | None = None
    #: (n, 3) weights of its corners.
    weights: FloatArray | None = None

    @property
    def known(self) -> BoolArray:
        """(n,): True where a true image is known."""
        index = self.face if self.face is not None else self.vertex
        assert index is not None
        return index >= 0

    def __len__(self) -> int:
        return len(self.known)


def load_truth(path: str | os.PathLike[str]) -> Truth:
    """Read a truth: text with one target vertex index (or -1) a line, or .npz with `tri` (n,) and `w` (n, 3).

    Indices count from 0; -1 means that the vertex has no counterpart, or that none is known.

    Raises:
        InvalidInput: the file cannot be read, or holds something else; the text says where.
    """
    name = os.fspath(path)
    try:
        if name.lower().endswith(".npz"):
            with Path(path).open("rb") as file:
                arrays = np.load(file, allow_pickle=False)
                if not isinstance(arrays, np.lib.npyio.NpzFile):
                    raise InvalidInput(f"{name}: the truth needs the arrays tri and w; the file holds a single array")
                missing = {"tri", "w"} - set(arrays.files)
                if missing:
                    raise InvalidInput(f"{name}: the truth needs the arrays tri and w; it has {sorted(arrays.files)}")
                return as_truth((arrays["tri"], arrays["w"]), where=name)
        lines = Path(path).read_text(encoding="utf-8").split("\n")
    except InvalidInput:
        raise
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise InvalidInput(f"{name}: the truth cannot be read: {error}") from None
    while lines and not lines[-1].strip():
        lines.pop()
    indices = np.empty(len(lines), np.int64)
    for i, line in enumerate(lines):
        try:
            indices[i] = int(line)
        except (ValueError, OverflowError):
            raise InvalidInput(f"{name}, line {i + 1}: {line.strip()!r} is not a vertex index") from None
    return as_truth(indices, where=name)


def as_truth(value: Any, where: str = "truth") -> Truth:
    """A Truth as it is; (n,) target vertices, or a tuple of (n,) triangles and (n, 3) weights, as a checked new one."""
    if isinstance(value, Truth):
        return value
    if isinstance(value, tuple) and len(value) == 2:
        face = _indices(value[0], f"{where}: tri")
        weights = to_points(value[1], f"{where}: w")
        if weights.shape != (len(face), 3):
            raise InvalidInput(f"{where}: w must have shape ({len(face)}, 3) like tri, not {weights.shape}")
        with np.errstate(invalid="ignore"):
            # Weights are often kept in single precision, or rounded to a few digits.
            good = (np.abs(weights.sum(axis=1) - 1.0) < 1e-2) & (weights > -1e-2).all(axis=1)
        bad = np.flatnonzero((face >= 0) & ~good)
        if bad.size:
            raise InvalidInput(
                f"{where}: w row {bad[0]} is {weights[bad[0]].tolist()}: weights must be >= 0 with sum 1"
                f" ({bad.size} such rows)"
            )
        weights = np.where((face >= 0)[:, None], np.maximum(weights, 0.0), 1.0)
        return Truth(face=face, weights=weights / weights.sum(axis=1, keepdims=True))
    return Truth(vertex=_indices(value, where))


def check_range(truth: Truth, vertex_count: int, face_count: int) -> None:
    """Refuse a truth that names a vertex or triangle that the target does not have."""
    indices, size, what = (
        (truth.face, face_count, "triangle") if truth.face is not None else (truth.vertex, vertex_count, "vertex")
    )
    assert indices is not None
    outside = np.flatnonzero(indices >= size)
    if outside.size:
        raise InvalidInput(
            f"truth: row {outside[0]} is {what} {indices[outside[0]]}, but the target has {size}"
            f" ({outside.size} such rows)"
        )


def positions(truth: Truth, rows: IntArray, vertices: FloatArray, faces: npt.NDArray[np.int32]) -> FloatArray:
    """(k, 3) the true images of `rows`."""
    if truth.face is None:
        assert truth.vertex is not None
        return vertices[truth.vertex[rows]]
    assert truth.weights is not None
    return np.asarray(np.einsum("ij,ijk->ik", truth.weights[rows], vertices[faces[truth.face[rows]]]))


def _indices(value: Any, where: str) -> IntArray:
    array = to_array(value, where)
    if array.ndim != 1 or array.dtype.kind not in "iu":
        raise InvalidInput(f"{where} must hold one integer per source vertex, not {array.dtype} of shape {array.shape}")
    if array.dtype.kind == "u" and array.size and int(array.max()) > np.iinfo(np.int64).max:
        raise InvalidInput(f"{where}: {array.max()} is no index")
    low = np.flatnonzero(array < -1)
    if low.size:
        raise InvalidInput(f"{where}: row {low[0]} is {array[low[0]]}; give an index or -1 ({low.size} such rows)")
    return array.astype(np.int64)
