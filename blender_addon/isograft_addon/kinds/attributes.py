# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of any type, on points, edges, faces and face corners."""

from typing import Any

import numpy as np
from isograft import transfer

from .. import bridge
from ..bridge import Array, AttributeLayer, RefusedError
from ..pairing import Donor, Pair
from ..settings import Names, Settings, choose
from .base import Kind, beside
from .filling import fill_edges, fill_faces, fill_points

_WORDS = {"POINT": "points", "EDGE": "edges", "FACE": "faces", "CORNER": "face corners"}


class Attributes(Kind):
    """All attributes of the user's or the chosen ones; where unmatched 0, false, empty, or what is written over."""

    noun = "attribute"

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        super().__init__(pair, gift, settings, names)
        self._layers: list[AttributeLayer] = gift[0]
        self._edges: Array = gift[1]
        self._targets = [names.claim(layer.name) for layer in self._layers]
        mesh = pair.receiver.data
        self._own = [
            bridge.read_layer(mesh, name, layer.domain, layer.data_type)
            for layer, name in zip(self._layers, self._targets, strict=True)
        ]
        self._moved: list[AttributeLayer] = []

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> tuple[list[AttributeLayer], Array]:
        """The chosen attributes, and the vertices of the donor's edges."""
        with donor.mesh() as mesh:
            layers = bridge.read_attributes(mesh)
        if not settings.attribute_names:
            # Seams come with UV maps, closed and where the receiver's islands part; these only if they are named.
            layers = [layer for layer in layers if layer.name != bridge.SEAMS]
        name = donor.obj.name
        if not layers:
            raise RefusedError(f"{name} has no attribute of yours; make one first, or leave attributes out")
        return choose(layers, settings.attribute_names, name, "attribute", lambda a: a.name), donor.arrays.edges

    def compute(self) -> None:
        """Values per element of each attribute's domain."""
        move = {"POINT": self._points, "EDGE": self._on_edges, "FACE": self._faces, "CORNER": self._corners}
        for layer, name, own in zip(self._layers, self._targets, self._own, strict=True):
            values = beside(*move[layer.domain](_without_objects(layer.values)), own)
            self._moved.append(AttributeLayer(name, layer.domain, layer.data_type, values))

    def write(self) -> None:
        """The attributes."""
        for layer in self._moved:
            bridge.write_attribute(self.pair.receiver, layer.name, layer.domain, layer.data_type, layer.values)

    def received(self) -> list[str]:
        """Names of the attributes."""
        return [f"{layer.name} ({_WORDS[layer.domain]})" for layer in self._moved]

    def _points(self, values: Array) -> tuple[Array, Array]:
        """As the others: values, and which rows have any."""
        progress = self.step(len(self._layers))
        moved = transfer.transfer_point(self.pair.correspondence, self.pair.given.triangles, values, progress=progress)
        result = moved.values
        result[~moved.mask] = np.zeros((), result.dtype)
        return self._completed(fill_points, result, moved.mask)

    def _corners(self, values: Array) -> tuple[Array, Array]:
        pair = self.pair
        moved, mask = self.move_corners(transfer.transfer_corner, values, len(self._layers))
        return pair.to_loops(moved, mask), pair.whole_polygons(mask)[pair.arrays.loop_polygons]

    def _faces(self, values: Array) -> tuple[Array, Array]:
        pair = self.pair
        moved = pair.from_face_centres(values, self.step(len(self._layers)))
        return self._completed(fill_faces, moved.values, moved.mask)

    def _on_edges(self, values: Array) -> tuple[Array, Array]:
        pair = self.pair
        own, triangles, given, donor_triangles = pair.geometry()
        moved = transfer.transfer_edge(
            pair.correspondence,
            own,
            triangles,
            pair.arrays.edges,
            given,
            donor_triangles,
            self._edges,
            values,
            progress=self.step(len(self._layers)),
        )
        # A matched edge without a value has none on the donor either: that is known of it.
        return self._completed(fill_edges, moved.values, pair.matched[pair.arrays.edges].all(axis=1))

    def _completed(self, fill: Any, values: Array, known: Array) -> tuple[Array, Array]:
        """Filled if that is wanted."""
        if not self.settings.fill:
            return values, known
        result, known, filled = fill(self.pair, values, known, self.hold)
        self.filled |= filled
        return result, known


def _without_objects(values: Array) -> Array:
    """Strings as numpy's own, which the engine's functions compare and pick."""
    return values.astype(str) if values.dtype == object else values
