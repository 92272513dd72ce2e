# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances along a surface."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.arguments import to_float, to_int
from isograft.errors import InvalidInput
from isograft.surface import as_surface


def geodesic_distances(
    surface: Any, face: int, barycentric: npt.ArrayLike, *, radius: float = math.inf
) -> npt.NDArray[np.float64]:
    """Geodesic distance from one point of a surface to every vertex, by polar marching over the repaired mesh.

    Args:
        surface: a Surface, or a tuple (vertices, faces).
        face: index of the triangle that holds the point.
        barycentric: (3,) weights of the triangle's corners, >= 0, sum 1.
        radius: how far to go, in the surface's own units; the nearer part costs less. Within the outermost tenth a
            distance may be up to a per cent too long.

    Returns:
        (n,) in the surface's own units; infinite where no path leads (another component, an unused vertex) and
        beyond `radius`.

    Raises:
        InvalidInput: no such triangle, one that was left out for having no area, or weights that are no such weights,
            or a radius that is not positive.
    """
    checked = as_surface(surface, "surface")
    if checked.is_cloud:
        raise InvalidInput("a point cloud has no triangles of its own: pass Surface(*surface.working_mesh)")
    index = to_int(face, "face", 0, len(checked.faces) - 1)
    weights = [to_float(weight, "barycentric") for weight in np.asarray(barycentric).ravel().tolist()]
    if len(weights) != 3:
        raise InvalidInput(f"barycentric must have shape (3,), not {np.shape(barycentric)}")
    if min(weights) < -1e-9 or abs(sum(weights) - 1.0) > 1e-6:
        raise InvalidInput(f"barycentric weights must be >= 0 with sum 1, not {weights}")
    try:
        limit = float(radius)
    except (TypeError, ValueError):
        limit = math.nan
    if not limit > 0.0:
        raise InvalidInput(f"radius must be a positive number, not {radius!r}")
    return _native.geodesic_distances(checked.native, index, weights, limit)
