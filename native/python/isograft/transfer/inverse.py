# SPDX-License-Identifier: GPL-3.0-or-later
"""The map the other way round, so that one match serves both directions."""

from __future__ import annotations

from typing import Any

import numpy as np

from isograft import _native
from isograft.correspondence import Correspondence
from isograft.transfer.arrays import (
    Array,
    CorrespondenceArrays,
    Progress,
    correspondence_arrays,
    point_rows,
    triangle_rows,
)


def invert(
    correspondence: CorrespondenceArrays,
    source_vertices: Any,
    source_faces: Any,
    target_vertices: Any,
    target_faces: Any,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Correspondence:
    """For every vertex of the target its point on the source.

    A target vertex takes the nearest point of the images of the source's triangles that lie there; where the image of
    the source ends before it, it is unmatched.

    Args:
        correspondence: source to target. Its `confidence`, `stretch` and `region` are carried along if it has them.
        source_vertices: (n, 3), n the length of the correspondence.
        source_faces: (F, 3).
        target_vertices: (m, 3).
        target_faces: (G, 3), the triangles that `correspondence.face` counts.
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        The map from target to source, one row per target vertex. Confidence is the least of the source triangle's
        corners, stretch their weighted mean, region that of the corner with the largest weight; without those arrays
        they are 1, 0 and 0.

    Raises:
        InvalidInput: arrays that do not fit each other; a map to a point cloud.
    """
    faces = triangle_rows(source_faces, "source_faces")
    vertices = point_rows(source_vertices, "source_vertices")
    count = len(np.asarray(correspondence.face))
    native = _native.invert(
        *correspondence_arrays(correspondence),
        _optional(correspondence, "confidence", count, np.float64),
        _optional(correspondence, "stretch", count, np.float64),
        _optional(correspondence, "region", count, np.int32),
        vertices,
        faces,
        point_rows(target_vertices, "target_vertices"),
        triangle_rows(target_faces, "target_faces"),
        threads or 0,
        progress,
    )
    return Correspondence.from_native(native, faces, len(vertices))


def _optional(correspondence: Any, name: str, count: int, dtype: Any) -> Array:
    array = getattr(correspondence, name, None)
    if array is None:
        return np.zeros(0, dtype)
    array = np.ascontiguousarray(array, dtype)
    if array.shape != (count,):
        raise _native.InvalidInput(f"correspondence: {name} should have shape ({count},), and has {array.shape}")
    return array
