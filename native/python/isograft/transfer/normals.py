# SPDX-License-Identifier: GPL-3.0-or-later
"""Custom normals, turned as the receiver's surface lies."""

from __future__ import annotations

from typing import Any

import numpy as np

from isograft import _native
from isograft.progress import part_of
from isograft.transfer.arrays import (
    Array,
    CorrespondenceArrays,
    Progress,
    TransferredValues,
    check_indices,
    corner_rows,
    correspondence_arrays,
    point_rows,
    polygon_ids,
    triangle_rows,
)
from isograft.transfer.filling import Filled, fill_corner
from isograft.transfer.shape_keys import local_frames


def transfer_normals(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    donor_normals: Any,
    *,
    receiver_polygons: Any = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TransferredValues:
    """Move custom normals of corners, turned as the receiver's surface lies; sharp edges stay sharp.

    What is carried is how a custom normal leans against the donor's smooth surface.

    Args:
        correspondence: receiver to donor.
        receiver_vertices: (n, 3).
        receiver_faces: (F, 3).
        donor_vertices: (m, 3).
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        donor_normals: (3 G, 3) or (G, 3, 3), one per corner.
        receiver_polygons: (F,) polygon of every receiver triangle: never parted by a sharp edge.
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        (3 F, 3) unit vectors, 0 where unmatched, and a mask per receiver triangle.

    Raises:
        InvalidInput: arrays that do not fit each other; normals that are not finite.
    """
    vertices = point_rows(receiver_vertices, "receiver_vertices")
    faces = triangle_rows(receiver_faces, "receiver_faces")
    donor, other_faces = point_rows(donor_vertices, "donor_vertices"), triangle_rows(donor_faces, "donor_faces")
    normals = np.ascontiguousarray(corner_rows(donor_normals, len(other_faces), "donor_normals"), np.float64)
    if normals.shape != (3 * len(other_faces), 3):
        raise _native.InvalidInput(f"donor_normals: expected 3 columns, got shape {np.shape(donor_normals)}")
    triangle, weights, _, mask = _native.place_corners(
        *correspondence_arrays(correspondence),
        vertices,
        faces,
        polygon_ids(receiver_polygons),
        donor,
        other_faces,
        normals,
        1e-3,
        0.0,
        threads or 0,
        part_of(progress, 0.0, 0.5),
    )
    frames = local_frames(
        correspondence,
        vertices,
        faces,
        donor,
        other_faces,
        smoothing=2,
        threads=threads,
        progress=part_of(progress, 0.5, 1.0),
    )
    mask = mask & frames.mask[faces].all(axis=1)
    corners = np.flatnonzero(np.repeat(mask, 3))
    vertex = faces.ravel()[corners]
    share, at = weights[corners][:, :, None], triangle[corners]
    custom = (share * normals.reshape(-1, 3, 3)[at]).sum(axis=1)
    smooth = (share * _smooth_normals(donor, other_faces)[other_faces[at]]).sum(axis=1)
    turn = frames.rotation[vertex]
    custom, smooth = (np.einsum("ijk,ik->ij", turn, _unit(v)) for v in (custom, smooth))
    own = _smooth_normals(vertices, faces)[vertex]
    # Meshes of opposite winding have opposite normals; the donor's way of facing is kept.
    own *= np.where(np.einsum("ij,ij->i", own, smooth) < 0.0, -1.0, 1.0)[:, None]
    moved = np.zeros((3 * len(faces), 3))
    moved[corners] = _unit(_turn_between(smooth, own, custom))
    return TransferredValues(moved, mask)


def fill_normals(vertices: Any, faces: Any, normals: Any, known: Any, *, progress: Progress | None = None) -> Filled:
    """Fill custom normals of corners in triangles where they are not known.

    How they lean against the smooth surface is continued smoothly: the hole keeps its own shape in them.

    Args:
        vertices: (n, 3) of the mesh that has the normals.
        faces: (F, 3).
        normals: (3 F, 3) or (F, 3, 3).
        known: (F,) True where all three corners of a triangle are known. Give all triangles of a polygon the same.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        (3 F, 3) unit vectors, and which triangles were filled, as of fill_corner().

    Raises:
        InvalidInput: arrays that do not fit each other; known normals that are not finite.
    """
    points, triangles = point_rows(vertices, "vertices"), triangle_rows(faces, "faces")
    given = np.asarray(corner_rows(normals, len(triangles), "normals"), np.float64)
    if given.shape != (3 * len(triangles), 3):
        raise _native.InvalidInput(f"normals: expected 3 columns, got shape {np.shape(normals)}")
    check_indices(triangles, len(points), "faces")
    smooth = _smooth_normals(points, triangles)[triangles.ravel()]
    lean = np.where(np.repeat(np.asarray(known, bool), 3)[:, None], given - smooth, 0.0)
    moved, filled = fill_corner(points, triangles, lean, known, progress=progress)
    corners = np.repeat(filled, 3)
    result = given.copy()
    result[corners] = _unit(smooth[corners] + moved[corners])
    return Filled(result, filled)


def _turn_between(start: Array, end: Array, vectors: Array) -> Array:
    """`vectors` turned by the smallest rotations that take unit vectors `start` to `end`."""
    axis = np.cross(start, end)
    cosine = np.einsum("ij,ij->i", start, end)[:, None]
    along = np.einsum("ij,ij->i", axis, vectors)[:, None]
    turned = vectors * cosine + np.cross(axis, vectors) + axis * along / np.maximum(1.0 + cosine, 1e-6)
    # Opposite or missing normals say nothing about how to turn.
    result: Array = np.where(cosine > -0.9, turned, vectors)
    return result


def _unit(vectors: Array) -> Array:
    result: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)
    return result


def _smooth_normals(vertices: Array, faces: Array) -> Array:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    summed = np.stack(
        [np.bincount(faces.ravel(), weights=np.repeat(normal[:, k], 3), minlength=len(vertices)) for k in range(3)],
        axis=1,
    )
    return _unit(summed)
