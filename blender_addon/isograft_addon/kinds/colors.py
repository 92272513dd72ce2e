# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour attributes of points and of face corners, byte and float."""

from typing import Any

import numpy as np
from isograft import transfer

from .. import bridge
from ..bridge import Array, CornerLayer, RefusedError
from ..pairing import Donor, Pair
from ..settings import Names, Settings, choose
from .base import Kind, beside
from .filling import fill_points


class Colors(Kind):
    """All colour attributes or the chosen ones; where unmatched transparent black, or what is written over."""

    noun = "colour attribute"

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        super().__init__(pair, gift, settings, names)
        self._layers: list[CornerLayer] = gift
        self._moved: list[CornerLayer] = []
        self._targets = [names.claim(layer.name) for layer in self._layers]
        mesh = pair.receiver.data
        self._own = [
            bridge.read_layer(mesh, name, layer.domain, layer.data_type)
            for layer, name in zip(self._layers, self._targets, strict=True)
        ]

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> list[CornerLayer]:
        """The chosen colour attributes."""
        with donor.mesh() as mesh:
            layers = bridge.read_colors(donor.obj, mesh)
        if not layers:
            raise RefusedError(f"{donor.obj.name} has no colour attribute; paint one first, or leave colours out")
        return choose(layers, settings.color_names, donor.obj.name, "colour attribute", lambda layer: layer.name)

    def compute(self) -> None:
        """Colours per point or loop."""
        for layer, name, own in zip(self._layers, self._targets, self._own, strict=True):
            values = self._points(layer, own) if layer.domain == "POINT" else self._corners(layer, own)
            self._moved.append(CornerLayer(name, layer.domain, layer.data_type, values, layer.is_render))

    def write(self) -> None:
        """The attributes; the donor's rendered one is shown unless the receiver has colours of its own."""
        obj = self.pair.receiver
        show = not len(obj.data.color_attributes)
        for layer in self._moved:
            bridge.write_attribute(obj, layer.name, layer.domain, layer.data_type, layer.values)
        for layer in self._moved:
            if show and layer.is_render:
                bridge.activate_color(obj, layer.name)

    def received(self) -> list[str]:
        """Names of the attributes."""
        return [layer.name for layer in self._moved]

    def _points(self, layer: CornerLayer, own: Array | None) -> Array:
        progress = self.step(len(self._layers))
        moved = transfer.transfer_point(
            self.pair.correspondence, self.pair.given.triangles, layer.values, progress=progress
        )
        values, known = np.where(moved.mask[:, None], moved.values, 0.0), np.asarray(moved.mask)
        if self.settings.fill:
            limits = {"low": float(layer.values.min()), "high": float(layer.values.max())}
            values, known, filled = fill_points(self.pair, values, known, self.hold, **limits)
            self.filled |= filled
        return beside(values, known, own)

    def _corners(self, layer: CornerLayer, own: Array | None) -> Array:
        return self.to_loops(*self.move_corners(transfer.transfer_corner, layer.values, len(self._layers)), own)
