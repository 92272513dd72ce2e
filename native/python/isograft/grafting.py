# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh files in, mesh file out: what the command line transfers, computed whole before anything is written."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.correspondence import Correspondence
from isograft.errors import InvalidInput
from isograft.formats.layers import FILLED
from isograft.formats.mesh import MeshFile
from isograft.formats.mesh_output import MeshOutput
from isograft.grafting_cut import cut_receiver
from isograft.grafting_layers import LayerOptions, graft_layers, moves_layers, with_seams
from isograft.grafting_moves import Mover
from isograft.grafting_textures import Textures
from isograft.progress import part_of
from isograft.transfer import (
    Baked,
    bake,
    fill_corner,
    fill_point,
    seam_edges,
    transfer_corner_uv,
    transfer_point,
    wrap,
)
from isograft.transfer.arrays import Array, CorrespondenceArrays, Progress
from isograft.transfer.wrapping import Method


@dataclass(eq=False)
class Graft:
    """Everything that is written."""

    mesh: MeshOutput
    #: Per channel of the textures (height, width, components), the first row the lowest.
    images: list[Array] = field(default_factory=list)
    #: (p,) polygons that are shown by the images.
    shown: npt.NDArray[np.bool_] | None = None
    #: What was moved, by name.
    counts: dict[str, int] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    def sentence(self) -> str:
        """What was moved, for people."""
        return ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in self.counts.items())


def at_least(correspondence: Correspondence, confidence: float) -> Correspondence:
    """The same map with vertices of less confidence unmatched."""
    low = correspondence.matched & (correspondence.confidence < confidence)
    if not low.any():
        return correspondence
    changed: dict[str, Any] = {}
    for name, array in correspondence.arrays().items():
        changed[name] = array.copy()
        changed[name][low] = np.nan if array.dtype.kind == "f" else -1
    changed["confidence"][low] = 0.0
    return dataclasses.replace(correspondence, **changed)


def graft(
    correspondence: Correspondence,
    receiver: MeshFile,
    donor: MeshFile,
    *,
    what: set[str],
    cut_seams: bool = False,
    mark_seams: bool = False,
    fill: bool = False,
    textures: Textures | None = None,
    size: int = 1024,
    margin: int = 16,
    layers: LayerOptions | None = None,
    unmatched: Method = "rigid",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Graft:
    """Move uv, color, texture, attributes, weights, keys, normals, or the shape (alone).

    `textures` are the donor's, for texture; `layers` says which attributes, weights and keys, and how. With `cut_seams`
    polygons of the receiver that the donor's seams cross are cut along them, into triangles, with all that the receiver
    carries; with `mark_seams` edges along which the islands part are marked. `unmatched` is wrap()'s method, for the
    shape.

    Raises:
        InvalidInput: the map does not fit, or the donor's data cannot be used.
    """
    if "shape" in what:
        return _shape(correspondence, receiver, donor, unmatched, threads, progress)
    counts: dict[str, int] = {}
    warnings: list[str] = []
    placed: CorrespondenceArrays = correspondence
    if cut_seams:
        placed, receiver, counts["polygons_cut"] = cut_receiver(
            correspondence,
            receiver,
            donor,
            _whole(donor, "cut along"),
            threads=threads,
            progress=part_of(progress, 0.0, 0.1),
        )
    progress = part_of(progress, 0.1, 1.0) if cut_seams else progress
    has_layers = moves_layers(what, donor)
    last = part_of(progress, 0.6, 1.0)
    progress = part_of(progress, 0.0, 0.6) if has_layers else progress
    polygons = receiver.polygons
    mesh = MeshOutput(
        receiver.vertices, polygons.sizes, polygons.corners, colors=receiver.colors, corner_uvs=receiver.corner_uvs
    )
    mesh.layers = receiver.layers
    result = Graft(mesh, counts=counts, warnings=warnings)
    filled = np.zeros(len(receiver.vertices), bool)
    triangle_uvs = receiver.triangle_uvs
    has_uvs: Array | None = None
    if "uv" in what and donor.corner_uvs is not None:
        triangle_uvs, has_uvs, made_up = _uvs(placed, receiver, donor, fill, threads, part_of(progress, 0.0, 0.2))
        filled[receiver.faces[made_up]] = True
        own = receiver.corner_uvs
        corner_uvs: Array = np.full((len(polygons.corners), 2), np.nan) if own is None else own
        corner_uvs[receiver.triangle_corners[has_uvs]] = triangle_uvs[has_uvs]
        mesh.corner_uvs = corner_uvs
        result.counts["polygons_with_uv"] = len(np.unique(receiver.triangle_polygon[has_uvs]))
    if "color" in what:
        mesh.colors, made_up = _colors(placed, receiver, donor, fill, part_of(progress, 0.2, 0.3))
        filled |= made_up
        result.counts["vertices_coloured"] = int(((placed.face >= 0) | made_up).sum())
    if textures is not None and triangle_uvs is not None:
        usable: Array = np.asarray(np.isfinite(triangle_uvs).all(axis=(1, 2))) if has_uvs is None else has_uvs
        bench = partial(
            bake, size=size, margin=margin, fill=fill, threads=threads, progress=part_of(progress, 0.3, 1.0)
        )
        filled |= _bake(bench, placed, receiver, donor, textures, triangle_uvs, usable, result)
    if has_layers:
        moved = graft_layers(
            placed, receiver, donor, what, layers or LayerOptions(), fill=fill, threads=threads, progress=last
        )
        mesh.layers = moved.layers
        filled |= moved.filled
        result.counts.update(moved.counts)
        result.warnings += moved.warnings
    if mark_seams and has_uvs is not None:
        seams = seam_edges(receiver.faces, triangle_uvs, mask=has_uvs, polygons=receiver.triangle_polygon)
        mesh.layers = with_seams(mesh.layers, receiver, seams)
        result.counts["seam_edges"] = len(seams)
    if fill:
        before = mesh.layers.point.get(FILLED)
        mesh.filled = filled if before is None else filled | before.astype(bool)
        mesh.layers = dataclasses.replace(mesh.layers, point={**mesh.layers.point, FILLED: mesh.filled})
    return result


def _whole(mesh: MeshFile, purpose: str) -> Array:
    uvs = mesh.triangle_uvs
    if uvs is None:
        raise InvalidInput(f"{mesh.path}: there are no texture coordinates to {purpose}")
    lacking = np.isnan(uvs).any(axis=(1, 2))
    if lacking.any():
        raise InvalidInput(
            f"{mesh.path}: {int(lacking.sum())} of {len(uvs)} triangles have no texture coordinates, the first is "
            f"triangle {int(lacking.argmax())}; unwrap all of the mesh"
        )
    return uvs


def _uvs(
    correspondence: CorrespondenceArrays,
    receiver: MeshFile,
    donor: MeshFile,
    fill: bool,
    threads: int | None,
    progress: Progress | None,
) -> tuple[Array, Array, Array]:
    """(F, 3, 2), which triangles have UVs, and which of them were made up."""
    moved = transfer_corner_uv(
        correspondence,
        receiver.vertices,
        receiver.faces,
        donor.vertices,
        donor.faces,
        _whole(donor, "transfer"),
        receiver_polygons=receiver.triangle_polygon,
        threads=threads,
        progress=part_of(progress, 0.0, 0.8),
    )
    uvs, mask, made_up = moved.uv, moved.mask, np.zeros(len(receiver.faces), bool)
    if fill and not mask.all():
        uvs, made_up = fill_corner(receiver.vertices, receiver.faces, uvs, mask, progress=part_of(progress, 0.8, 1.0))
    return uvs.reshape(-1, 3, 2), mask | made_up, made_up


def _bake(
    run: Callable[..., Baked],
    correspondence: CorrespondenceArrays,
    receiver: MeshFile,
    donor: MeshFile,
    textures: Textures,
    triangle_uvs: Array,
    usable: Array,
    result: Graft,
) -> npt.NDArray[np.bool_]:
    """Put the images into `result`; returns the vertices (n,) around which they were made up."""
    baked = run(
        correspondence,
        receiver.vertices,
        receiver.faces,
        np.where(usable[:, None, None], triangle_uvs, 0.0),
        donor.vertices,
        donor.faces,
        _whole(donor, "read an image with"),
        [item.channel for item in textures.channels],
        donor_materials=textures.triangle_materials,
        receiver_mask=usable,
    )
    made_up = baked.filled & usable
    has_image = usable & ((np.asarray(correspondence.face)[receiver.faces] >= 0).all(axis=1) | made_up)
    result.images = list(baked.images)
    result.shown = np.zeros(len(receiver.polygons.sizes), bool)
    result.shown[receiver.triangle_polygon[has_image]] = True
    result.shown[receiver.triangle_polygon[~has_image]] = False
    result.counts["images"] = len(result.images)
    result.counts["texels_baked"] = int((baked.mask == 1).sum())
    result.warnings += [*textures.warnings, *_beyond_the_square(triangle_uvs, usable)]
    filled = np.zeros(len(receiver.vertices), bool)
    filled[receiver.faces[made_up]] = True
    return filled


def _beyond_the_square(triangle_uvs: Array, usable: Array) -> list[str]:
    outside = int((usable & ((triangle_uvs < 0.0) | (triangle_uvs > 1.0)).any(axis=(1, 2))).sum())
    if not outside:
        return []
    return [f"{outside} triangles of the receiver lie partly outside of the unit square: no texels there"]


def _colors(
    correspondence: CorrespondenceArrays, receiver: MeshFile, donor: MeshFile, fill: bool, progress: Progress | None
) -> tuple[Array, npt.NDArray[np.bool_]]:
    moved = transfer_point(correspondence, donor.faces, donor.colors, progress=part_of(progress, 0.0, 0.3))
    colors: Array = np.where(moved.mask[:, None], moved.values, 0.0)
    made_up = np.zeros(len(colors), bool)
    if fill:
        colors, made_up = fill_point(
            receiver.vertices,
            receiver.faces,
            colors,
            moved.mask,
            low=0.0,
            high=1.0,
            progress=part_of(progress, 0.3, 1.0),
        )
    own = receiver.colors
    if own is not None and own.shape[1] == colors.shape[1]:
        left = ~(moved.mask | made_up)
        colors[left] = own[left]
    return colors, made_up


def _shape(
    correspondence: Correspondence,
    receiver: MeshFile,
    donor: MeshFile,
    method: Method,
    threads: int | None,
    progress: Progress | None,
) -> Graft:
    wrapped = wrap(
        correspondence,
        receiver.vertices,
        receiver.faces,
        donor.vertices,
        donor.faces,
        method=method,
        threads=threads,
        progress=progress,
    )
    polygons, layers = donor.polygons, donor.layers
    if layers.normals is not None:
        itself = _identity(donor)
        placed = dataclasses.replace(donor, vertices=wrapped.vertices)
        moved = Mover(itself, placed, donor, None, False, threads, None).normals(layers.normals)
        layers = dataclasses.replace(layers, normals=moved.values)
    mesh = MeshOutput(
        wrapped.vertices,
        polygons.sizes,
        polygons.corners,
        donor.colors,
        donor.corner_uvs,
        filled=wrapped.filled,
        layers=layers,
    )
    return Graft(mesh, counts={"vertices_placed": int((~wrapped.filled).sum()), "completed": int(wrapped.filled.sum())})


def _identity(mesh: MeshFile) -> CorrespondenceArrays:
    """The map of a mesh to itself."""
    count = len(mesh.vertices)
    face, barycentric = np.full(count, -1, np.int32), np.zeros((count, 3))
    corner = np.zeros(count, np.int64)
    face[mesh.faces.ravel()] = np.repeat(np.arange(len(mesh.faces)), 3)
    corner[mesh.faces.ravel()] = np.tile(np.arange(3), len(mesh.faces))
    barycentric[np.arange(count), corner] = 1.0
    vertex = np.where(face >= 0, np.arange(count), -1).astype(np.int32)
    return SimpleNamespace(face=face, barycentric=barycentric, vertex=vertex)
