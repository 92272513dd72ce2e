# SPDX-License-Identifier: GPL-3.0-or-later
"""What object.isograft_transfer computes, whole, before it writes."""

from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from isograft import transfer

from . import bridge, matching
from .bridge import Array, CornerLayer, MeshArrays, RefusedError
from .matching import Messages

MAX_UV_LAYERS = 8


@dataclass(frozen=True)
class Settings:
    """The operator's settings."""

    what: set[str]
    min_confidence: float
    overwrite: bool
    link_materials: bool


@dataclass
class Graft:
    """Everything one receiver gets."""

    receiver: Any
    uv_layers: list[CornerLayer] = field(default_factory=list)
    colors: list[CornerLayer] = field(default_factory=list)
    slots: list[Any] = field(default_factory=list)
    polygon_slots: Array | None = None
    messages: Messages = field(default_factory=list)

    def write(self) -> Messages:
        """Write it all; returns what to report."""
        mesh = self.receiver.data
        # What the donor shows is shown, unless the receiver has something of its own to show.
        show_uv = self.polygon_slots is not None or not len(mesh.uv_layers)
        show_color = not len(mesh.color_attributes)
        for layer in self.uv_layers:
            bridge.write_uv_layer(self.receiver, layer.name, layer.values, show_uv and layer.is_render)
        for layer in self.colors:
            bridge.write_attribute(self.receiver, layer.name, layer.domain, layer.data_type, layer.values)
        for layer in self.colors:
            if show_color and layer.is_render:
                bridge.activate_color(self.receiver, layer.name)
        if self.polygon_slots is not None:
            bridge.write_polygon_materials(self.receiver, self.slots, self.polygon_slots)
        mesh.update()
        return self.messages


@dataclass(frozen=True)
class _Pair:
    receiver: Any
    name: str
    arrays: MeshArrays
    donor: MeshArrays
    correspondence: Any

    def corner_geometry(self) -> tuple[Array, Array, Array, Array]:
        return self.arrays.vertices, self.arrays.triangles, self.donor.vertices, self.donor.triangles

    def whole_polygons(self, triangle_mask: Array) -> Array:
        """(p,) True for polygons all of whose triangles are."""
        whole = np.ones(int(self.arrays.loop_polygons.max()) + 1, dtype=bool)
        whole[self.arrays.triangle_polygons[~triangle_mask]] = False
        return whole

    def to_loops(self, triangle_corners: Array, triangle_mask: Array) -> Array:
        """Rows per triangle corner as rows per loop; zeros in polygons that are not wholly matched."""
        loops = np.zeros((len(self.arrays.loop_polygons), triangle_corners.shape[1]))
        loops[self.arrays.triangle_loops.ravel()] = triangle_corners
        loops[~self.whole_polygons(triangle_mask)[self.arrays.loop_polygons]] = 0.0
        return loops


def prepare(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: Settings) -> list[Graft]:
    """Compute what every receiver gets; changes nothing.

    Raises:
        RefusedError: the donor lacks what is asked for, or a receiver's match is missing or no longer fits.
    """
    if not settings.what:
        raise RefusedError("Nothing to transfer; choose UV maps, colours or both")
    depsgraph = context.evaluated_depsgraph_get()
    donor_arrays = bridge.read_donor(donor, depsgraph)
    uv_layers = bridge.read_uv_layers(donor, depsgraph) if "UV" in settings.what else []
    colors = bridge.read_colors(donor, depsgraph) if "COLOR" in settings.what else []
    if "UV" in settings.what and not uv_layers:
        raise RefusedError(f"{donor.name} has no UV map; unwrap it first, or choose colours only")
    if "COLOR" in settings.what and not colors:
        raise RefusedError(f"{donor.name} has no colour attribute; paint one first, or choose UV maps only")
    materials = [slot.material for slot in donor.material_slots]
    link = bool(uv_layers) and settings.link_materials and any(materials)
    polygon_materials = bridge.read_polygon_materials(donor, depsgraph) if link else None
    # A receiver that is refused is refused before the others are computed.
    pairs = [_pair(obj, donor, donor_arrays, depsgraph, settings) for obj in receivers]
    return [_graft(pair, uv_layers, colors, materials, polygon_materials, settings) for pair in pairs]


def _pair(obj: Any, donor: Any, donor_arrays: MeshArrays, depsgraph: Any, settings: Settings) -> _Pair:
    content = bridge.read_property(obj)
    if content is None:
        raise RefusedError(f"{obj.name} has no match; run Match with {donor.name} as the active object first")
    arrays = bridge.read_receiver(obj, depsgraph)
    if content.get("donor_hash") != donor_arrays.content_hash:
        if content.get("donor") != donor.name:
            raise RefusedError(
                f"{obj.name} was matched to {content.get('donor')}, not to {donor.name}; run Match again"
            )
        raise RefusedError(f"{donor.name} was edited after {obj.name} was matched to it; run Match again")
    if content.get("receiver_hash") != arrays.content_hash:
        raise RefusedError(f"{obj.name} was edited after it was matched; run Match again")
    correspondence = matching.read_correspondence(obj, donor_arrays, settings.min_confidence)
    return _Pair(obj, obj.name, arrays, donor_arrays, correspondence)


def _graft(
    pair: _Pair,
    uv_layers: list[CornerLayer],
    colors: list[CornerLayer],
    materials: list[Any],
    polygon_materials: Array | None,
    settings: Settings,
) -> Graft:
    graft = Graft(pair.receiver)
    has_uv = np.zeros(0, dtype=bool)
    mesh = pair.receiver.data
    count = len(mesh.uv_layers)
    taken = {layer.name for layer in (*mesh.uv_layers, *mesh.attributes)}
    for layer in uv_layers:
        moved = transfer.transfer_corner_uv(
            pair.correspondence,
            *pair.corner_geometry(),
            layer.values[pair.donor.triangle_loops.ravel()],
            receiver_polygons=pair.arrays.triangle_polygons,
        )
        has_uv = pair.whole_polygons(moved.mask)
        name = _name(layer.name, taken, settings.overwrite)
        graft.uv_layers.append(CornerLayer(name, "CORNER", "UV", pair.to_loops(moved.uv, moved.mask), layer.is_render))
    count += sum(layer.name not in mesh.uv_layers for layer in graft.uv_layers)
    if count > MAX_UV_LAYERS:
        raise RefusedError(f"{pair.name} would get more than {MAX_UV_LAYERS} UV maps; remove some, or choose Overwrite")
    taken |= {layer.name for layer in graft.uv_layers}
    for layer in colors:
        name = _name(layer.name, taken, settings.overwrite)
        graft.colors.append(CornerLayer(name, layer.domain, layer.data_type, _color(pair, layer), layer.is_render))
    if polygon_materials is not None:
        graft.slots, graft.polygon_slots = _materials(pair, has_uv, materials, polygon_materials)
    graft.messages = _messages(pair, graft, has_uv if uv_layers else None)
    return graft


def _color(pair: _Pair, layer: CornerLayer) -> Array:
    """Colours per point or loop of the receiver, 0 (transparent) where unmatched."""
    if layer.domain == "POINT":
        moved = transfer.transfer_point(pair.correspondence, pair.donor.triangles, layer.values)
        return np.where(moved.mask[:, None], moved.values, 0.0)
    moved = transfer.transfer_corner(
        pair.correspondence,
        *pair.corner_geometry(),
        layer.values[pair.donor.triangle_loops.ravel()],
        receiver_polygons=pair.arrays.triangle_polygons,
    )
    return pair.to_loops(moved.values, moved.mask)


def _materials(pair: _Pair, has_uv: Array, materials: list[Any], polygon_materials: Array) -> tuple[list[Any], Array]:
    """The receiver's slots with the donor's materials appended, and the slot of every polygon.

    A face takes the material of the donor's face under its first corner. Faces without UVs keep their material; where
    the receiver had no slot, an empty one is made for them.
    """
    slots = list(pair.receiver.data.materials)
    if not slots and not has_uv.all():
        slots.append(None)
    slot_of = np.zeros(len(materials), dtype=np.int32)
    for donor_slot, material in enumerate(materials):
        if material not in slots:
            slots.append(material)
        slot_of[donor_slot] = slots.index(material)
    index = bridge.read_own_polygon_materials(pair.receiver)
    first = np.unique(pair.arrays.triangle_polygons, return_index=True)[1]
    face = pair.correspondence.face[pair.arrays.triangles[first, 0]][has_uv]
    donor_polygon = pair.donor.triangle_polygons[face]
    index[has_uv] = slot_of[np.clip(polygon_materials[donor_polygon], 0, len(materials) - 1)]
    return slots, index


def _name(name: str, taken: set[str], overwrite: bool) -> str:
    """A free name in Blender's manner, or `name` itself if it may be overwritten; it is then taken."""
    free, number = name, 0
    while free in taken and not overwrite:
        number += 1
        free = f"{name}.{number:03d}"
    taken.add(free)
    return free


def _messages(pair: _Pair, graft: Graft, has_uv: Array | None) -> Messages:
    messages: Messages = [("WARNING", text) for text in pair.arrays.warnings]
    if has_uv is not None and not has_uv.all():
        count = int(np.count_nonzero(~has_uv))
        messages.append(("WARNING", f"{pair.name}: {count:,} of {len(has_uv):,} faces are unmatched; their UVs are 0"))
    kinds = (("UV map", graft.uv_layers), ("colour attribute", graft.colors))
    parts = [f"{kind} {', '.join(layer.name for layer in layers)}" for kind, layers in kinds if layers]
    messages.append(("INFO", f"{pair.name}: received {' and '.join(parts)}"))
    return messages
