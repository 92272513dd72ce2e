# SPDX-License-Identifier: GPL-3.0-or-later
"""What a mesh file holds: polygons as they stand in the file, and the triangles made of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.layers import Layers
from isograft.surface import Surface

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]


@dataclass(eq=False)
class Polygons:
    """What a reader returns: polygons with any number of corners, checked against the number of vertices.

    `sizes` (p,) counts each polygon's corners, `corners` (c,) holds their vertices one polygon after another.
    `normals` (n, 3) are those of the vertices, of any length. `uvs` (m, 2) is the file's table of texture coordinates,
    `uv_index` (c,) the row of every corner, -1 for none. `colors` (n, 3 or 4) lie in [0, 1]. `layers` is whatever else
    the file holds of vertices, polygons and edges.
    """

    vertices: Floats
    sizes: Ints
    corners: Ints
    colors: Floats | None = None
    normals: Floats | None = None
    uvs: Floats | None = None
    uv_index: Ints | None = None
    layers: Layers = field(default_factory=Layers)
    warnings: list[str] = field(default_factory=list)


@dataclass(eq=False)
class MeshFile:
    """A mesh, or a point cloud without `faces`, as read from a file: row i of `vertices` is vertex i of the file.

    `faces` (k, 3) are triangles. The way back to the file's polygons: `triangle_polygon` (k,) names the polygon of
    every triangle, `triangle_corners` (k, 3) its corners as rows of `polygons.corners`.
    """

    path: str
    vertices: Floats
    faces: Ints
    triangle_polygon: Ints
    triangle_corners: Ints
    polygons: Polygons

    @property
    def colors(self) -> Floats | None:
        """(n, 3 or 4) in [0, 1], or None."""
        return self.polygons.colors

    @property
    def normals(self) -> Floats | None:
        """(n, 3) as they are in the file, of any length, or None."""
        return self.polygons.normals

    @property
    def corner_uvs(self) -> Floats | None:
        """(c, 2) texture coordinates of every corner of the file's polygons, NaN where it has none; or None."""
        uvs, index = self.polygons.uvs, self.polygons.uv_index
        if uvs is None or index is None:
            return None
        padded = np.vstack([uvs, [[np.nan, np.nan]]])
        return padded[index]

    @property
    def triangle_uvs(self) -> Floats | None:
        """(k, 3, 2) texture coordinates of the triangles' corners, NaN where there are none; or None."""
        uvs = self.corner_uvs
        return None if uvs is None else uvs[self.triangle_corners]

    @property
    def layers(self) -> Layers:
        """Attributes, vertex groups, shape keys and custom normals; none in most files."""
        return self.polygons.layers

    @property
    def warnings(self) -> list[str]:
        """What the reader passed over: a sentence each, with counts."""
        return self.polygons.warnings

    @property
    def parts(self) -> tuple[Floats, Ints | None, Floats | None]:
        """What a Surface is made of: vertices, triangles or None for a point cloud, and a cloud's normals."""
        if len(self.polygons.sizes):
            return self.vertices, self.faces, None
        return self.vertices, None, self.normals

    def surface(self) -> Surface:
        """The checked surface, a point cloud if the file has no faces.

        Raises InvalidInput naming the file if it cannot be used as one.
        """
        try:
            return Surface(*self.parts)
        except InvalidInput as error:
            raise InvalidInput(f"{self.path}: {error}") from None
