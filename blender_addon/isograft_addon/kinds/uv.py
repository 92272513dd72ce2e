# SPDX-License-Identifier: GPL-3.0-or-later
"""UV maps: islands and seams kept."""

from typing import Any

import numpy as np
from isograft import transfer

from .. import bridge
from ..bridge import Array, CornerLayer, RefusedError
from ..pairing import Donor, Pair
from ..settings import Names, Settings, choose
from .base import Kind
from .materials import Slots


class UVMaps(Kind):
    """All UV maps or the chosen ones, with the seams between their islands and, if wanted, the materials."""

    noun = "UV map"

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        super().__init__(pair, gift, settings, names)
        mesh = pair.receiver.data
        self._layers: list[CornerLayer] = gift
        self._moved: list[CornerLayer] = []
        self._has_uv = np.zeros(pair.arrays.polygon_count, dtype=bool)
        self._seams = np.zeros(len(pair.arrays.edges), dtype=bool)
        self._mark = settings.mark_seams
        self._targets = [names.claim(layer.name) for layer in self._layers]
        count = len(mesh.uv_layers) + sum(name not in mesh.uv_layers for name in self._targets)
        if count > bridge.MAX_UV_LAYERS:
            raise RefusedError(
                f"{pair.name} would get more than {bridge.MAX_UV_LAYERS} UV maps; remove some, or choose Overwrite"
            )
        own = {layer.name: layer.values for layer in bridge.read_uv_layers(mesh)}
        self._own = [own.get(name) for name in self._targets]
        # With materials of its own kind, these are not needed here.
        linked = settings.link_materials and "MATERIALS" not in settings.what
        self._slots = Slots.read(pair) if linked else None

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> list[CornerLayer]:
        """The chosen UV maps."""
        with donor.mesh() as mesh:
            layers = bridge.read_uv_layers(mesh)
        if not layers:
            raise RefusedError(f"{donor.obj.name} has no UV map; unwrap it first, or leave UV maps out")
        return choose(layers, settings.uv_names, donor.obj.name, "UV map", lambda layer: layer.name)

    def compute(self) -> None:
        """UVs per loop; where unmatched those that are written over, or 0."""
        pair = self.pair
        for layer, name, own in zip(self._layers, self._targets, self._own, strict=True):
            uv, mask = self.move_corners(transfer.transfer_corner_uv, layer.values, len(self._layers))
            self._has_uv = pair.whole_polygons(mask)
            if self._mark and layer is self._seam_layer():
                self._seams = self._edges(uv, mask)
            self._moved.append(CornerLayer(name, "CORNER", "UV", self.to_loops(uv, mask, own), layer.is_render))
        if self._slots is not None:
            self._slots.assign(self._has_uv, self.settings.fill, self.hold)
        if not self._has_uv.all():
            count = int(np.count_nonzero(~self._has_uv))
            kept = [own is not None for own in self._own]
            stay = "as they were" if all(kept) else "0, or as they were" if any(kept) else "0"
            text = f"{pair.name}: {count:,} of {len(self._has_uv):,} faces are unmatched; their UVs are {stay}"
            self.warnings.append(text)

    def write(self) -> None:
        """The maps, their seams, the materials."""
        obj = self.pair.receiver
        # What the donor shows is shown, unless the receiver has something of its own to show.
        show = (self._slots is not None and self._slots.has_any) or not len(obj.data.uv_layers)
        for layer in self._moved:
            bridge.write_uv_layer(obj, layer.name, layer.values, show and layer.is_render)
        if self._seams.any():
            bridge.write_seams(obj, self._seams)
        if self._slots is not None:
            self._slots.write(obj)

    def received(self) -> list[str]:
        """Names of the maps."""
        return [layer.name for layer in self._moved]

    def seam_maps(self) -> list[Array]:
        """(3 G, 2) of every chosen map, along whose seams the receiver may be cut."""
        return [layer.values[self.pair.given.corners] for layer in self._layers]

    def _seam_layer(self) -> CornerLayer:
        """The chosen map of the donor whose seams count: the rendered one, else the last."""
        return next((layer for layer in self._layers if layer.is_render), self._layers[-1])

    def _edges(self, uv: Array, mask: Array) -> Array:
        """(e,) True for receiver edges along which the islands part."""
        pair = self.pair
        found = transfer.seam_edges(pair.own.triangles, uv, mask=mask, polygons=pair.own.polygons)
        edges = np.sort(pair.arrays.edges, axis=1).astype(np.int64)
        count = len(pair.own.vertices)
        seams: Array = np.isin(edges[:, 0] * count + edges[:, 1], found[:, 0].astype(np.int64) * count + found[:, 1])
        return seams
