# SPDX-License-Identifier: GPL-3.0-or-later
"""The gate: arrays become a Surface here, or are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.arguments import to_indices, to_points
from isograft.errors import InvalidInput


class Surface:
    """A checked triangle mesh or point cloud; the input is not modified.

    Of a mesh, repeated and zero-area triangles are left out, edges of more than two triangles are split, and the
    winding is made consistent and outward. Of a cloud, outliers are left out, normals are estimated where none are
    given and turned to one side, and a mesh is laid over the smoothed points, with holes where the cloud has holes. All of it is told in `warnings`. Results are always indexed by the vertices and
    triangles given here.

    Args:
        vertices: (n, 3) real numbers in any unit.
        faces: (k, 3) integers, rows of `vertices`; None for a point cloud.
        normals: (n, 3) of any length, for point clouds. A mesh's orientation is found from its triangles; normals
            given with faces are checked for their shape and not used.

    Raises:
        InvalidInput: a wrong shape or dtype, coordinates that are not finite, indices out of range, no triangle
            with an area; of a cloud fewer than 50 different points, normals that are not finite or have no length,
            or points that show no surface.
        ResourceLimit: more vertices or triangles than 32-bit indices can count.
    """

    __slots__ = ("_faces", "_given_normals", "_native", "_vertices", "_warnings")

    def __init__(
        self, vertices: npt.ArrayLike, faces: npt.ArrayLike | None = None, normals: npt.ArrayLike | None = None
    ) -> None:
        points = to_points(vertices, "vertices")
        warnings: list[str] = []
        sides = None if normals is None else to_points(normals, "normals")
        if faces is None:
            self._native = _native.Surface.from_points(points, sides)
            triangles = np.empty((0, 3), np.int32)
        else:
            if sides is not None:
                if sides.shape != points.shape:
                    raise InvalidInput(f"normals must have shape {points.shape} like vertices, not {sides.shape}")
                warnings.append("the normals were not used: the orientation of a mesh is found from its triangles")
            triangles = to_indices(faces, "faces", 3)
            self._native = _native.Surface(points, triangles)
        self._given_normals = None if sides is None else np.array(sides)
        # Arrays of this object's own: the caller may change what was passed.
        self._vertices = np.array(points)
        self._faces = np.array(triangles)
        self._vertices.flags.writeable = False
        self._faces.flags.writeable = False
        self._warnings = [*self._native.warnings, *warnings]

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """(n, 3), as given; read-only."""
        return self._vertices

    @property
    def faces(self) -> npt.NDArray[np.int32]:
        """(k, 3), as given; read-only. Of a point cloud (0, 3)."""
        return self._faces

    @property
    def is_cloud(self) -> bool:
        """True for a point cloud: images on it have no triangle, but the nearest point."""
        return self._native.is_cloud

    @property
    def normals(self) -> npt.NDArray[np.float64] | None:
        """Of a point cloud, (n, 3): unit normals of the smoothed surface, NaN for points left out. Of a mesh None."""
        return self._native.normals if self.is_cloud else None

    @property
    def working_mesh(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
        """Vertices and triangles that matching works on: the repaired mesh, or the one laid over a point cloud."""
        return self._native.working_mesh

    @property
    def warnings(self) -> list[str]:
        """What was repaired or left out: a sentence each, with counts."""
        return list(self._warnings)

    @property
    def orientation_is_ambiguous(self) -> bool:
        """True if a component is open, so that its outer side could not be told from its volume."""
        return self._native.orientation_is_ambiguous

    @property
    def native(self) -> _native.Surface:
        """The compiled part's object, for the other modules of this package."""
        return self._native

    def __repr__(self) -> str:
        if self.is_cloud:
            return f"Surface({len(self._vertices)} points)"
        return f"Surface({len(self._vertices)} vertices, {len(self._faces)} triangles)"

    def __reduce__(self) -> tuple[Any, ...]:
        return Surface, (self._vertices, None if self.is_cloud else self._faces, self._given_normals)


def as_surface(value: Any, name: str) -> Surface:
    """A Surface as it is; a tuple (vertices, faces[, normals]) as a new one. Errors begin with `name`."""
    if isinstance(value, Surface):
        return value
    if not isinstance(value, (tuple, list)) or not 1 <= len(value) <= 3:
        raise InvalidInput(
            f"{name} must be an isograft.Surface or a tuple (vertices, faces[, normals]), not {type(value).__name__}"
            + (f" of {len(value)}" if isinstance(value, (tuple, list)) else "")
        )
    try:
        return Surface(*value)
    except InvalidInput as error:
        raise InvalidInput(f"{name}: {error}") from None
