# SPDX-License-Identifier: GPL-3.0-or-later
"""What object.isograft_match reads before the job and writes after it."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np

from . import bridge
from .bridge import Array, MeshArrays, RefusedError
from .job import Task
from .native_loader import add_on_version

Messages = list[tuple[str, str]]

ATTRIBUTES = {
    "isograft_face": "INT",
    "isograft_weights": "FLOAT_VECTOR",
    "isograft_position": "FLOAT_VECTOR",
    "isograft_vertex": "INT",
    "isograft_confidence": "FLOAT",
    "isograft_stretch": "FLOAT",
    "isograft_region": "INT",
}
"""Point attributes on the receiver, with their types."""


@dataclass(frozen=True)
class Plan:
    """A match to be made. Holds names and arrays, no objects: those may move in memory while it runs."""

    donor_name: str
    donor: MeshArrays
    receivers: list[tuple[str, MeshArrays]]
    options: dict[str, Any]

    def task(self) -> Task:
        """The part that needs no Blender."""
        return Task(
            self.donor_name,
            self.donor.surface(),
            [(name, arrays.surface()) for name, arrays in self.receivers],
            self.options,
        )

    def write(self, matches: list[Any]) -> Messages:
        """Write one match per receiver and say what was found.

        Raises:
            RefusedError: an object was removed or changed while the match ran; nothing is written.
        """
        depsgraph = bpy.context.evaluated_depsgraph_get()
        _unchanged(self.donor_name, self.donor, bridge.read_donor, depsgraph)
        prepared = [
            (
                _unchanged(name, arrays, bridge.read_receiver, depsgraph),
                attributes(self.donor, match.best),
                self._property(arrays, match.report),
                self._messages(name, arrays, match),
            )
            for (name, arrays), match in zip(self.receivers, matches, strict=True)
        ]
        for obj, values, content, _ in prepared:
            for name, data_type in ATTRIBUTES.items():
                bridge.write_attribute(obj, name, "POINT", data_type, values[name])
            bridge.write_property(obj, content)
        return [message for *_, messages in prepared for message in messages]

    def _property(self, receiver: MeshArrays, report: Any) -> dict[str, Any]:
        return {
            "donor": self.donor_name,
            "donor_hash": self.donor.content_hash,
            "receiver_hash": receiver.content_hash,
            "version": add_on_version(),
            "options": {name: value for name, value in self.options.items() if value is not None},
            "scale": float(report.scale),
        }

    def _messages(self, name: str, receiver: MeshArrays, match: Any) -> Messages:
        count = len(receiver.vertices)
        matched = int(np.count_nonzero(match.best.face >= 0))
        messages = [("WARNING", text) for text in receiver.warnings]
        messages += [("WARNING", f"{name}: {text}") for text in match.report.warnings]
        if not matched:
            return [*messages, ("WARNING", f"{name}: nothing matches {self.donor_name}; all of it is left unmatched")]
        share = f"matched {matched:,} of {count:,} vertices ({matched / count:.1%})"
        return [*messages, ("INFO", f"{name}: {share} to {self.donor_name} in {match.report.seconds:.1f} s")]


def plan(donor: Any, receivers: list[Any], context: bpy.types.Context, options: dict[str, Any]) -> Plan:
    """Read everything a match needs.

    Raises:
        RefusedError: an object cannot take part.
    """
    depsgraph = context.evaluated_depsgraph_get()
    return Plan(
        donor.name,
        bridge.read_donor(donor, depsgraph),
        [(obj.name, bridge.read_receiver(obj, depsgraph)) for obj in receivers],
        options,
    )


def attributes(donor: MeshArrays, correspondence: Any) -> dict[str, Array]:
    """The values of ATTRIBUTES for a correspondence: zeros, not NaN, where unmatched; the face is -1 there."""
    face = np.asarray(correspondence.face)
    matched = face >= 0
    weights = np.where(matched[:, None], donor.in_loop_order(np.asarray(correspondence.barycentric)), 0.0)
    corners = donor.vertices[donor.triangles[np.where(matched, face, 0)]]
    return {
        "isograft_face": face,
        "isograft_weights": weights,
        "isograft_position": np.einsum("nc,ncd->nd", weights, corners),
        "isograft_vertex": np.where(matched, correspondence.vertex, 0),
        "isograft_confidence": np.where(matched, correspondence.confidence, 0.0),
        "isograft_stretch": np.nan_to_num(np.where(matched, correspondence.stretch, 0.0)),
        "isograft_region": np.where(matched, correspondence.region, 0),
    }


def read_correspondence(obj: Any, donor: MeshArrays, min_confidence: float) -> SimpleNamespace:
    """Face, barycentric, vertex and confidence that a match has left on `obj`, in the donor's loop triangles.

    Raises:
        RefusedError: there are none, or they do not fit.
    """
    read = {name: bridge.read_attribute(obj, name, data_type) for name, data_type in ATTRIBUTES.items()}
    face, weights, vertex, confidence = (
        read[name] for name in ("isograft_face", "isograft_weights", "isograft_vertex", "isograft_confidence")
    )
    if face is None or weights is None or vertex is None or confidence is None:
        raise RefusedError(f"{obj.name}: attributes of its match are missing or were replaced; run Match again")
    matched = (face >= 0) & (confidence >= min_confidence)
    total = weights.sum(axis=1, dtype=np.float64)
    if face.max(initial=-1) >= len(donor.triangles) or np.any(np.abs(total[matched] - 1.0) > 1e-3):
        raise RefusedError(f"{obj.name}: the attributes of its match were edited; run Match again")
    return SimpleNamespace(
        face=np.where(matched, face, -1).astype(np.int32),
        barycentric=weights.astype(np.float64) / np.where(matched, total, 1.0)[:, None],
        vertex=np.where(matched, vertex, -1).astype(np.int32),
        confidence=np.where(matched, confidence, 0.0),
    )


def _unchanged(name: str, before: MeshArrays, read: Any, depsgraph: bpy.types.Depsgraph) -> Any:
    """The object called `name`, if it still is what was read before."""
    obj = bpy.data.objects.get(name)
    if obj is None or obj.type != "MESH":
        raise RefusedError(f"{name} was removed or renamed while the match ran; nothing was written")
    if read(obj, depsgraph).content_hash != before.content_hash:
        raise RefusedError(f"{name} was edited while the match ran; nothing was written, run Match again")
    return obj
