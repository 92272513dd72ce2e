# SPDX-License-Identifier: GPL-3.0-or-later
"""The gate: arrays become a Surface here, or are refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.arguments import to_indices, to_points
from isograft.errors import InvalidInput

#: Called with the stage's name and the fraction done; returning False cancels.
ProgressCallback = Callable[[str, float], Any]

_Parts = tuple[str, npt.NDArray[np.float64], npt.NDArray[np.int32] | None, npt.NDArray[np.float64] | None]
_NORMALS_IGNORED = "the normals were not used: the orientation of a mesh is found from its triangles"


class SurfaceArrays:
    """What a surface is made from, of the right shape and type, but not looked into."""

    def __init__(
        self, vertices: npt.ArrayLike, faces: npt.ArrayLike | None = None, normals: npt.ArrayLike | None = None
    ) -> None:
        self.vertices = to_points(vertices, "vertices")
        self.normals = None if normals is None else to_points(normals, "normals")
        self.faces = None if faces is None else to_indices(faces, "faces", 3)
        if self.faces is not None and self.normals is not None and self.normals.shape != self.vertices.shape:
            raise InvalidInput(f"normals must have shape {self.vertices.shape} like vertices, not {self.normals.shape}")


def check_progress(progress: ProgressCallback | None) -> ProgressCallback | None:
    """`progress` itself. Raises InvalidInput if it cannot be called."""
    if not (progress is None or callable(progress)):
        raise InvalidInput(f"progress must be callable, not {type(progress).__name__}")
    return progress


class Surface:
    """A checked triangle mesh or point cloud; the input is not modified.

    Of a mesh, repeated and zero-area triangles are left out, edges of more than two triangles are split, and the
    winding is made consistent and outward. Of a cloud, outliers are left out, normals are estimated where none are
    given and turned to one side, and a mesh is laid over the smoothed points, with holes where the cloud has holes.
    All of it is told in `warnings`. Results are always indexed by the vertices and
    triangles given here.

    Args:
        vertices: (n, 3) real numbers in any unit.
        faces: (k, 3) integers, rows of `vertices`; None for a point cloud.
        normals: (n, 3) of any length, for point clouds. A mesh's orientation is found from its triangles; normals
            given with faces are checked for their shape and not used.
        progress: called as progress(stage, fraction) on the calling thread; returning False cancels.

    Raises:
        InvalidInput: a wrong shape or dtype, coordinates that are not finite, indices out of range, no triangle
            with an area; of a cloud fewer than 50 different points, normals that are not finite or have no length,
            or points that show no surface.
        ResourceLimit: more vertices or triangles than 32-bit indices can count.
        Cancelled: `progress` returned False. What it raises is passed on; so is KeyboardInterrupt.
    """

    __slots__ = ("_faces", "_given_normals", "_is_cloud", "_native", "_vertices")

    def __init__(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike | None = None,
        normals: npt.ArrayLike | None = None,
        *,
        progress: ProgressCallback | None = None,
    ) -> None:
        self._take(SurfaceArrays(vertices, faces, normals))
        (self._native,) = _native.make_surfaces([self._parts("")], 1, check_progress(progress))

    def _take(self, arrays: SurfaceArrays) -> None:
        # Arrays of this object's own: the caller may change what was passed.
        self._vertices = np.array(arrays.vertices)
        self._faces = np.array(np.empty((0, 3), np.int32) if arrays.faces is None else arrays.faces)
        self._given_normals = None if arrays.normals is None else np.array(arrays.normals)
        self._vertices.flags.writeable = False
        self._faces.flags.writeable = False
        self._is_cloud = arrays.faces is None

    def _parts(self, name: str) -> _Parts:
        if self._is_cloud:
            return name, self._vertices, None, self._given_normals
        return name, self._vertices, self._faces, None

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
        return self._is_cloud

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
        ignored = not self._is_cloud and self._given_normals is not None
        return [*self._native.warnings, *([_NORMALS_IGNORED] if ignored else [])]

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
    return as_surfaces([(name, value)], 1, None)[0]


def as_surfaces(named: Sequence[tuple[str, Any]], threads: int, progress: ProgressCallback | None) -> list[Surface]:
    """The same for several at once, side by side."""
    surfaces = [value if isinstance(value, Surface) else _unmade(value, name) for name, value in named]
    missing = [(s, name) for s, (name, value) in zip(surfaces, named, strict=True) if s is not value]
    if missing:
        made = _native.make_surfaces([s._parts(name) for s, name in missing], threads, progress)
        for (surface, _), native in zip(missing, made, strict=True):
            surface._native = native
    return surfaces


def _unmade(value: Any, name: str) -> Surface:
    if not isinstance(value, (tuple, list)) or not 1 <= len(value) <= 3:
        raise InvalidInput(
            f"{name} must be an isograft.Surface or a tuple (vertices, faces[, normals]), not {type(value).__name__}"
            + (f" of {len(value)}" if isinstance(value, (tuple, list)) else "")
        )
    surface = Surface.__new__(Surface)
    try:
        surface._take(SurfaceArrays(*value))
    except InvalidInput as error:
        raise InvalidInput(f"{name}: {error}") from None
    return surface
