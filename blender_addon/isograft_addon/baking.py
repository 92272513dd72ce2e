# SPDX-License-Identifier: GPL-3.0-or-later
"""What object.isograft_bake computes, whole, before it writes: the donor's images in the receiver's own UVs."""

from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np
from isograft import transfer

from . import bridge, channels, pairing
from .bridge import Array, RefusedError
from .channels import BakedInput
from .grafting import filled_text, mark_filled
from .job import Progress, in_turn
from .kinds.base import beside
from .kinds.filling import fill_corners, marks
from .matching import Messages
from .pairing import Pair
from .settings import Names, OfProperties

_EDGE = 1e-4
"""UVs this far out of the unit square lie on its edge."""


@dataclass(frozen=True)
class BakeSettings(OfProperties):
    """The properties of object.isograft_bake."""

    size: int = 1024
    margin: int = 16
    uv_source: str = "EXISTING"
    uv_map: str = ""
    float_images: bool = False
    fill: bool = False
    overwrite: bool = False
    min_confidence: float = 0.0
    threads: int = 0


@dataclass
class Bake:
    """Everything one receiver gets."""

    pair: Pair
    settings: BakeSettings
    inputs: list[BakedInput]
    triangle_materials: Array
    """(G,) index into the images of every input."""
    uv_name: str
    uv: Array | None
    """(l, 2); None until the donor's UV map is transferred."""
    donor_uv: Array
    """(3 G, 2)."""
    ways: dict[str, str]
    """Of the new material, as bridge.read_ways()."""
    is_new_map: bool
    own_uv: Array | None = None
    """(l, 2) of the map that is written over, kept where nothing comes."""
    warnings: list[str] = field(default_factory=list)
    background: list[Array] | None = None
    """Images that are written over, kept where nothing is baked."""
    polygons: Array = field(default_factory=lambda: np.zeros(0, dtype=bool))
    images: list[Array] = field(default_factory=list)
    filled: Array = field(default_factory=lambda: np.zeros(0, dtype=bool))
    """(n,) vertices around which the images are filled."""

    def compute(self, progress: Progress) -> None:
        """Bake; touches no object of Blender's."""
        pair = self.pair
        whole = pair.whole_polygons(pair.matched[pair.own.triangles].all(axis=1))
        if self.uv is None:
            moved = transfer.transfer_corner_uv(
                pair.correspondence, *pair.geometry(), self.donor_uv, receiver_polygons=pair.own.polygons
            )
            uv, mask = moved.uv, moved.mask
            whole &= pair.whole_polygons(mask)
            if self.settings.fill:
                uv, mask, _ = fill_corners(pair, uv, mask, lambda stage, _: progress(f"{pair.name}: {stage}", 0.0))
            whole_loops = pair.whole_polygons(mask)[pair.arrays.loop_polygons]
            self.uv = beside(pair.to_loops(uv, mask), whole_loops, self.own_uv)
        self._warn_of_outside(self.uv, whole)
        self.polygons = whole
        own, triangles, given, donor_triangles = pair.geometry()
        baked = transfer.bake(
            pair.correspondence,
            own,
            triangles,
            self.uv[pair.own.corners],
            given,
            donor_triangles,
            self.donor_uv,
            [item.channel() for item in self.inputs],
            self.settings.size,
            donor_materials=self.triangle_materials,
            receiver_mask=whole[pair.own.polygons],
            margin=self.settings.margin,
            fill=self.settings.fill,
            background=self.background,
            threads=self.settings.threads or None,
            progress=lambda stage, fraction: progress(f"{pair.name}: {stage}", fraction),
        )
        self.images = list(baked.images)
        self.filled = marks(pair, whole[pair.own.polygons], baked.filled)
        self.polygons = whole | pair.whole_polygons(whole[pair.own.polygons] | baked.filled)
        if not np.any(np.asarray(baked.mask) == 1):
            raise RefusedError(
                f"{pair.name}: no texel of its UV map lies on a matched face; choose another UV map, or a new unwrap"
            )

    def _warn_of_outside(self, uv: Array, whole: Array) -> None:
        """An image has the unit square only."""
        beyond = ((uv < -_EDGE) | (uv > 1.0 + _EDGE)).any(axis=1)
        outside = np.zeros_like(whole)
        outside[self.pair.arrays.loop_polygons[beyond]] = True
        count = int(np.count_nonzero(outside & whole))
        if count:
            self.warnings.append(
                f"{self.pair.name}: {count:,} faces reach out of the unit square of {self.uv_name}, where nothing is "
                "baked; bake into a new unwrap to have all of them"
            )

    def write(self) -> Messages:
        """The UV map, the images, the material; returns what to report."""
        obj = self.pair.receiver
        assert self.uv is not None
        if self.is_new_map:
            bridge.write_uv_layer(obj, self.uv_name, self.uv, True)
        shown = []
        for item, pixels in zip(self.inputs, self.images, strict=True):
            name = _image_name(obj, item)
            shown.append((item.shown, bridge.write_image(name, pixels, item.space, self.settings.overwrite)))
        constants = [(item, None) for item in self._constants]
        material = bridge.write_material(
            f"{obj.name} baked", constants + shown, self.ways, self.uv_name, self.settings.overwrite
        )
        slots = list(obj.data.materials)
        if not slots and not self.polygons.all():
            slots.append(None)
        if material not in slots:
            slots.append(material)
        index = bridge.polygon_materials(obj.data)
        index[self.polygons] = slots.index(material)
        bridge.write_polygon_materials(obj, slots, index)
        mark_filled(obj, self.filled)
        obj.data.update()
        return self._messages(material.name)

    @property
    def _constants(self) -> list[Any]:
        baked = {item.shown.name for item in self.inputs}
        return [item for item in self.inputs[0].constants if item.name not in baked]

    def _messages(self, material: str) -> Messages:
        messages: Messages = [("WARNING", text) for text in self.warnings]
        if not self.polygons.all():
            count = int(np.count_nonzero(~self.polygons))
            text = f"{count:,} of {len(self.polygons):,} faces are unmatched; they keep their material"
            messages.append(("WARNING", f"{self.pair.name}: {text}"))
        if self.filled.any():
            messages.append(("WARNING", filled_text(self.pair.name, self.filled)))
        names = ", ".join(item.shown.name for item in self.inputs)
        size = f"{self.settings.size} x {self.settings.size}"
        messages.append(("INFO", f"{self.pair.name}: baked {names} at {size} into the material {material}"))
        return messages


@dataclass(frozen=True)
class BakeTask:
    """All bakes of a run, one after the other."""

    bakes: list[Bake]

    def task(self) -> "BakeTask":
        """The part that needs no Blender: run()."""
        return self

    def write(self, bakes: list[Bake]) -> Messages:
        """Write what run() returned.

        Raises:
            RefusedError: a receiver was removed or changed meanwhile; nothing is written.
        """
        depsgraph = bpy.context.evaluated_depsgraph_get()
        for bake in bakes:
            obj = pairing.unchanged(bake.pair, depsgraph)
            bake.pair = replace(bake.pair, receiver=obj)
        return [message for bake in bakes for message in bake.write()]

    def run(self, progress: Progress) -> list[Bake]:
        """Compute all of them."""
        for item, part in in_turn(self.bakes, progress):
            with pairing.named(item.pair.name):
                item.compute(part)
        return self.bakes


def prepare(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: BakeSettings) -> BakeTask:
    """Read everything a bake needs.

    Raises:
        RefusedError: a match no longer fits, the donor has no image to give, or the receiver no UV map.
    """
    pairs = pairing.make(donor, receivers, context, settings.min_confidence)
    gifts: dict[bool, channels.Gift] = {}
    for pair in pairs:
        if pair.donor.is_own not in gifts:
            gifts[pair.donor.is_own] = channels.read(pair.donor, settings.float_images)
    # The receivers' maps last: a new unwrap takes time.
    return BakeTask([_bake(pair, gifts[pair.donor.is_own], settings) for pair in pairs])


def _bake(pair: Pair, gift: channels.Gift, settings: BakeSettings) -> Bake:
    mesh = pair.receiver.data
    names = Names.of_layers(mesh, settings.overwrite)
    if settings.uv_source == "EXISTING":
        layers = bridge.read_uv_layers(mesh)
        if not layers:
            raise RefusedError(f"{pair.name} has no UV map to bake into; choose the donor's, or a new unwrap")
        fitting = [layer for layer in layers if (layer.name == settings.uv_map if settings.uv_map else layer.is_render)]
        if not fitting:
            have = ", ".join(layer.name for layer in layers)
            raise RefusedError(f"{pair.name} has no UV map called {settings.uv_map}; it has: {have}")
        name, uv = fitting[0].name, fitting[0].values
    elif settings.uv_source == "UNWRAP":
        # As much room between islands as the margins of two of them need.
        uv = bridge.smart_unwrap(pair.receiver, min(0.2, 2.0 * settings.margin / settings.size))
        name = names.claim(settings.uv_map or "Baked")
    else:
        name, uv = names.claim(settings.uv_map or gift.uv_name), None
    is_new = settings.uv_source != "EXISTING"
    if is_new and name not in mesh.uv_layers and len(mesh.uv_layers) >= bridge.MAX_UV_LAYERS:
        raise RefusedError(f"{pair.name} has {bridge.MAX_UV_LAYERS} UV maps already; remove one, or bake into one")
    return Bake(
        pair,
        settings,
        gift.inputs_for(pair.given.loops),
        gift.polygon_slots[pair.given.polygons],
        name,
        uv,
        gift.uv[pair.given.corners],
        gift.ways,
        is_new,
        next((layer.values for layer in bridge.read_uv_layers(mesh) if layer.name == name), None),
        list(gift.warnings),
        _written_over(pair.receiver, gift.inputs, settings.size) if settings.overwrite else None,
    )


def _image_name(obj: Any, item: BakedInput) -> str:
    return f"{obj.name} {item.shown.name}"


def _written_over(obj: Any, inputs: list[BakedInput], size: int) -> list[Array]:
    """The images that the new ones take the place of, black where there is none of the same kind and size."""
    found = []
    for item in inputs:
        kind, width = item.kind_of_pixels()
        old = bridge.read_old_image(_image_name(obj, item), item.space)
        fits = old is not None and old.dtype == kind and old.shape[:2] == (size, size)
        found.append(np.ascontiguousarray(old[..., :width]) if fits else np.zeros((size, size, width), kind))
    return found
