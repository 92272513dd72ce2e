# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures: the donor's images baked into the receiver's own UVs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.arguments import to_int
from isograft.progress import part_of
from isograft.transfer.arrays import (
    Array,
    CorrespondenceArrays,
    Progress,
    corner_rows,
    correspondence_arrays,
    point_rows,
    triangle_rows,
    value_columns,
)
from isograft.transfer.image_filling import fill_images

_EXTENSIONS = ("repeat", "extend", "clip")
_LARGEST = 1 << 16


@dataclass(frozen=True, eq=False)
class Channel:
    """One image-textured property of the donor's materials: base colour, roughness, a normal map."""

    #: One per material: an image (height, width) or (height, width, components) of uint8 or float32 whose first row is
    #: the lowest (v = 0); a constant (components,) of that type, or None where the material has nothing (such texels
    #: stay as they are). A single array stands for a donor of one material. All of a channel have one type and as many
    #: components, 1 to 4.
    images: Any
    #: "normal": the first three components are a normal in the tangent frame of the UVs, 0.5 standing for 0.
    kind: Literal["color", "normal"] = "color"
    #: (3 G, 2) or (G, 3, 2): the UV map that the images are read with, None for the bake's own.
    uv: Any = None
    #: Beyond the borders: "repeat", "extend" (the border's pixels) or "clip" (zeros).
    extension: Literal["repeat", "extend", "clip"] = "repeat"
    #: "linear" between four pixels, or "closest".
    interpolation: Literal["linear", "closest"] = "linear"


class Baked(NamedTuple):
    """Images in the receiver's UVs."""

    images: list[Array]
    """One per channel, (height, width, components), of the channel's type; the first row is the lowest."""
    mask: npt.NDArray[np.uint8]
    """(height, width): 0 nothing, 1 baked, 2 margin, 3 filled."""
    filled: npt.NDArray[np.bool_]
    """(F,) receiver triangles that were filled."""


def bake(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    receiver_uv: Any,
    donor_vertices: Any,
    donor_faces: Any,
    donor_uv: Any,
    channels: Channel | Sequence[Channel],
    size: int | tuple[int, int],
    *,
    donor_materials: Any = None,
    receiver_mask: Any = None,
    margin: int = 16,
    fill: bool = False,
    background: Sequence[npt.ArrayLike] | None = None,
    out: Sequence[Array] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Baked:
    """Bake the donor's images into the receiver's UVs, all channels at once.

    Every texel of the receiver's layout is a point of the receiver, that a point of the donor, exactly and across the
    donor's edges and seams, and that is read in the donor's image, between four pixels. Normals are turned from the
    donor's tangent frames to the receiver's; UVs of both may be mirrored. Numbers are taken as they stand: colours
    of an 8-bit image stay in its colour space.

    Args:
        correspondence: receiver to donor.
        receiver_vertices: (n, 3).
        receiver_faces: (F, 3).
        receiver_uv: (3 F, 2) or (F, 3, 2): the layout to bake into. What lies outside of the unit square is not baked;
            where triangles overlap, the first has the texel.
        donor_vertices: (m, 3).
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        donor_uv: (3 G, 2) or (G, 3, 2), for channels without UVs of their own.
        channels: one or several.
        size: width and height, or one number for both.
        donor_materials: (G,) index into every channel's `images`; None: all 0.
        receiver_mask: (F,) True for the triangles to bake; None: all. Unmatched and torn ones are never baked.
        margin: texels around what is baked that take the nearest baked one's value.
        fill: continue the images smoothly into the triangles that are not baked; normal maps are flat there. Parts of
            the mesh without a baked triangle stay as they are.
        background: per channel an image of the result's shape and type that is kept where nothing is baked;
            None: zeros.
        out: per channel an array to write into, such as a numpy.memmap, contiguous, of the result's shape and type.
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Raises:
        InvalidInput: arrays that do not fit each other, images of another type.
        Cancelled: `out` may then be partly written.
    """
    width, height = _size(size)
    faces = triangle_rows(donor_faces, "donor_faces")
    own_faces = triangle_rows(receiver_faces, "receiver_faces")
    chosen = [channels] if isinstance(channels, Channel) else list(channels)
    if not chosen:
        raise _native.InvalidInput("channels: give at least one")
    results: list[Array] = []
    given: list[tuple[Any, ...]] = []
    for i, channel in enumerate(chosen):
        images, components, dtype = _images(channel, f"channel {i}")
        uv = donor_uv if channel.uv is None else channel.uv
        shape = (height, width, components)
        result = _result(out, i, shape, dtype)
        result[...] = 0 if background is None else _background(background, i, shape, dtype)
        results.append(result)
        given.append(
            (
                images,
                components,
                value_columns(corner_rows(uv, len(faces), f"channel {i}: uv")),
                _EXTENSIONS.index(channel.extension),
                channel.interpolation == "closest",
                channel.kind == "normal",
                result,
            )
        )
    mask = np.zeros((height, width), np.uint8)
    texels = to_int(margin, "margin", 0, 1024)
    vertices, donor = point_rows(receiver_vertices, "receiver_vertices"), point_rows(donor_vertices, "donor_vertices")
    layout = value_columns(corner_rows(receiver_uv, len(own_faces), "receiver_uv"))
    wanted = np.zeros(0, bool) if receiver_mask is None else np.ascontiguousarray(receiver_mask, bool)
    known = _native.bake(
        *correspondence_arrays(correspondence),
        vertices,
        own_faces,
        layout,
        wanted,
        donor,
        faces,
        _materials(donor_materials, len(faces)),
        given,
        width,
        height,
        0 if fill else texels,
        mask,
        threads or 0,
        part_of(progress, 0.0, 0.7) if fill else progress,
    )
    filled = np.zeros(len(own_faces), bool)
    if fill:
        filled = fill_images(
            vertices, own_faces, layout, known, results, mask,
            [channel.kind == "normal" for channel in chosen], texels, threads or 0, part_of(progress, 0.7, 1.0),
        )  # fmt: skip
    return Baked(results, mask, filled)


def _size(size: int | tuple[int, int]) -> tuple[int, int]:
    if isinstance(size, (tuple, list)):
        if len(size) != 2:
            raise _native.InvalidInput(f"size must be a number or (width, height), not {size!r}")
        return to_int(size[0], "width", 1, _LARGEST), to_int(size[1], "height", 1, _LARGEST)
    both = to_int(size, "size", 1, _LARGEST)
    return both, both


def _materials(materials: Any, count: int) -> Array:
    array = np.zeros(count, np.int32) if materials is None else np.asarray(materials)
    if array.shape != (count,) or array.dtype.kind not in "iu":
        raise _native.InvalidInput(
            f"donor_materials: expected integers of shape ({count},), one per donor triangle, got {array.dtype} "
            f"{array.shape}"
        )
    return np.ascontiguousarray(array, dtype=np.int32)


def _images(channel: Channel, name: str) -> tuple[list[Array | None], int, Any]:
    """Images as (height, width, components), the number of components, and the type."""
    for field, value, known in (
        ("kind", channel.kind, ("color", "normal")),
        ("extension", channel.extension, _EXTENSIONS),
        ("interpolation", channel.interpolation, ("linear", "closest")),
    ):
        if value not in known:
            raise _native.InvalidInput(f"{name}: {field} must be one of {', '.join(known)}, not {value!r}")
    given = [channel.images] if isinstance(channel.images, np.ndarray) else list(channel.images)
    images: list[Array | None] = []
    for i, entry in enumerate(given):
        if entry is None:
            images.append(None)
            continue
        image = np.asarray(entry)
        if image.dtype not in (np.uint8, np.float32):
            raise _native.InvalidInput(f"{name}: image {i} must be uint8 or float32, not {image.dtype}")
        if image.ndim == 1:
            image = image[None, None]
        elif image.ndim == 2:
            image = image[:, :, None]
        if image.ndim != 3 or image.size == 0 or not 1 <= image.shape[2] <= 4:
            raise _native.InvalidInput(
                f"{name}: image {i} must have shape (height, width), (height, width, 1 to 4) or (1 to 4), not "
                f"{np.shape(entry)}"
            )
        images.append(np.ascontiguousarray(image))
    kinds = {(image.dtype, image.shape[2]) for image in images if image is not None}
    if len(kinds) != 1:
        found = ", ".join(sorted(f"{dtype} of {components}" for dtype, components in kinds)) or "no image at all"
        raise _native.InvalidInput(f"{name}: images must have one type and as many components, and there is {found}")
    dtype, components = kinds.pop()
    return images, components, dtype


def _result(out: Sequence[Array] | None, index: int, shape: tuple[int, ...], dtype: Any) -> Array:
    if out is None:
        return np.empty(shape, dtype)
    if index >= len(out):
        raise _native.InvalidInput(f"out: {len(out)} arrays are given, channel {index} has none")
    array = out[index]
    if not isinstance(array, np.ndarray) or array.shape != shape or array.dtype != dtype or not array.flags.carray:
        raise _native.InvalidInput(f"out: array {index} must be a writable contiguous {np.dtype(dtype)} {shape}")
    return array


def _background(background: Sequence[npt.ArrayLike], index: int, shape: tuple[int, ...], dtype: Any) -> Array:
    if index >= len(background):
        raise _native.InvalidInput(f"background: {len(background)} images are given, channel {index} has none")
    array = np.asarray(background[index])
    if array.ndim == 2:
        array = array[:, :, None]
    if array.shape != shape or array.dtype != dtype:
        raise _native.InvalidInput(
            f"background: image {index} must be {np.dtype(dtype)} {shape}, and is {array.dtype} {array.shape}"
        )
    return array
