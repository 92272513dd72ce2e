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
    """A checked triangle mesh. What can be repaired is repaired and told in `warnings`; the input is not modified.

    Repeated and zero-area triangles are left out, edges of more than two triangles are split, and the winding is
    made consistent and outward. Results are always indexed by the vertices and triangles given here.

    Args:
        vertices: (n, 3) real numbers in any unit.
        faces: (k, 3) integers, rows of `vertices`.
        normals: (n, 3), for point clouds. A mesh's orientation is found from its triangles; normals given with
            faces are checked for their shape and not used.

    Raises:
        InvalidInput: a wrong shape or dtype, coordinates that are not finite, indices out of range, no triangle
            with an area, or no faces at all (point clouds are not supported yet).
        ResourceLimit: more vertices or triangles than 32-bit indices can count.
    """

    __slots__ = ("_faces", "_native", "_vertices", "_warnings")

    def __init__(
        self, vertices: npt.ArrayLike, faces: npt.ArrayLike | None = None, normals: npt.ArrayLike | None = None
    ) -> None:
        points = to_points(vertices, "vertices")
        warnings: list[str] = []
        if normals is not None:
            if to_points(normals, "normals").shape != points.shape:
                raise InvalidInput(f"normals must have shape {points.shape} like vertices, not {np.shape(normals)}")
            warnings.append("the normals were not used: the orientation of a mesh is found from its triangles")
        if faces is None:
            raise InvalidInput("point clouds (faces=None) are not supported yet: give the triangles as faces")
        triangles = to_indices(faces, "faces", 3)
        self._native = _native.Surface(points, triangles)
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
        """(k, 3), as given; read-only."""
        return self._faces

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
        return f"Surface({len(self._vertices)} vertices, {len(self._faces)} triangles)"

    def __reduce__(self) -> tuple[Any, ...]:
        return Surface, (self._vertices, self._faces)


def as_surface(value: Any, name: str) -> Surface:
    """A Surface as it is; a tuple (vertices, faces[, normals]) as a new one. Errors begin with `name`."""
    if isinstance(value, Surface):
        return value
    if not isinstance(value, (tuple, list)) or not 1 <= len(value) <= 3:
        raise InvalidInput(
            f"{name} must be an isograft.Surface or a tuple (vertices, faces), not {type(value).__name__}"
            + (f" of {len(value)}" if isinstance(value, (tuple, list)) else "")
        )
    try:
        return Surface(*value)
    except InvalidInput as error:
        raise InvalidInput(f"{name}: {error}") from None
