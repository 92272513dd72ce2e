# SPDX-License-Identifier: GPL-3.0-or-later
"""The final result: a surface point of the target, or "unmatched", for every source vertex."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.arguments import to_array
from isograft.errors import InvalidInput
from isograft.formats.npz import ARRAYS, read_npz, write_npz


@dataclass(frozen=True, eq=False, repr=False)
class Correspondence:
    """For every source vertex a point of the target, or "unmatched"; n = number of source vertices.

    For a point-cloud target `face` is -1 everywhere: `points` and `vertex`, the nearest point, carry the answer.
    Unmatched rows: `face`, `vertex`, `region` and `corners` -1, `confidence` 0, NaN in every other array.
    """

    #: (n,) int32: index into the target's input triangles.
    face: npt.NDArray[np.int32]
    #: (n, 3) float64: weights of `corners`, >= 0, sum 1.
    barycentric: npt.NDArray[np.float64]
    #: (n, 3) float64: the point itself, in the target's units.
    points: npt.NDArray[np.float64]
    #: (n,) int32: the target's vertex with the largest weight; of a cloud the nearest point.
    vertex: npt.NDArray[np.int32]
    #: (n,) float64 in [0, 1].
    confidence: npt.NDArray[np.float64]
    #: (n,) float64: mean of abs(d_T / (sigma d_S) - 1) to the mapped neighbours, without dimension.
    stretch: npt.NDArray[np.float64]
    #: (n,) int32: the continuous part the vertex belongs to, 0 the largest.
    region: npt.NDArray[np.int32]
    #: (n, 3) int32: the target vertices that `barycentric` weighs: the corners of `face`; of a cloud the three nearest.
    corners: npt.NDArray[np.int32]
    #: Number of the target's vertices.
    target_size: int

    @classmethod
    def from_native(
        cls, native: _native.Correspondence, faces: npt.NDArray[np.int32], target_size: int
    ) -> Correspondence:
        """`faces` are the target's triangles, none for a point cloud."""
        of_cloud = native.corners
        face = native.face
        return cls(
            face=face,
            barycentric=native.barycentric,
            points=native.points,
            vertex=native.vertex,
            confidence=native.confidence,
            stretch=native.stretch,
            region=native.region,
            corners=of_cloud if len(of_cloud) else corners_of(face, faces),
            target_size=target_size,
        )

    def to_native(self) -> _native.Correspondence:
        """The compiled part's object, for the other modules of this package."""
        return _native.Correspondence(
            self.face, self.barycentric, self.points, self.vertex, self.confidence, self.stretch, self.region
        )

    @property
    def matched(self) -> npt.NDArray[np.bool_]:
        """(n,): True where the vertex has a point."""
        return self.vertex >= 0

    @property
    def coverage(self) -> float:
        """Matched share of the source's vertices."""
        return float(np.mean(self.matched)) if len(self) else 0.0

    def interpolate(self, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Move values from the target's vertices to the source's, weighted by `barycentric`.

        Args:
            values: (m,) or (m, ...) real numbers, one row per target vertex.

        Returns:
            (n,) or (n, ...) float64; NaN where unmatched.

        Raises:
            InvalidInput: another number of rows than the target has vertices, or values that cannot be averaged
                (take `values[correspondence.vertex]` for names and labels).
        """
        array = to_array(values, "values")
        if array.ndim == 0 or array.shape[0] != self.target_size:
            raise InvalidInput(
                f"values must have one row per target vertex ({self.target_size}), not shape {array.shape}"
            )
        result = np.full((len(self), *array.shape[1:]), np.nan)
        matched = self.matched
        weights = self.barycentric[matched]
        result[matched] = np.einsum("ij,ij...->i...", weights, array[self.corners[matched]].astype(np.float64))
        return result

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the arrays to an .npz file of the same names. An old file is replaced whole or not at all."""
        write_npz(path, [self.arrays()], self.target_size, "{}")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Correspondence:
        """Read the best correspondence of an .npz file. Raises InvalidInput if it holds none."""
        correspondences, target_size, _ = read_npz(path)
        return cls(**correspondences[0], target_size=target_size)

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The arrays by name."""
        return {name: getattr(self, name) for name in ARRAYS}

    def __len__(self) -> int:
        return len(self.face)

    def __repr__(self) -> str:
        return f"Correspondence({int(self.matched.sum())} of {len(self)} vertices matched)"


def corners_of(face: npt.NDArray[np.int32], faces: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """(n, 3) int32: vertices of the triangle `face` of every row, -1 where `face` is -1."""
    corners = np.full((len(face), 3), -1, np.int32)
    matched = face >= 0
    corners[matched] = faces[face[matched]]
    return corners
