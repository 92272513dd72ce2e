# SPDX-License-Identifier: GPL-3.0-or-later
"""A donor, a receiver and the match between them, whichever of the two was matched to the other."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import bpy
import isograft
import numpy as np
from isograft import transfer

from . import bridge, matching
from .bridge import Array, MeshArrays, RefusedError
from .job import Progress


@dataclass(frozen=True)
class Donor:
    """The object that gives, and the mesh that a match knows it by."""

    obj: Any
    arrays: MeshArrays
    depsgraph: Any
    is_own: bool
    """True if the match counts the faces of the object's own mesh, False if those of the evaluated one."""

    @contextmanager
    def mesh(self) -> Iterator[bpy.types.Mesh]:
        """The mesh with its layers, to be read."""
        if self.is_own:
            yield self.obj.data
        else:
            with bridge.Evaluated(self.obj, self.depsgraph) as mesh:
                yield mesh


@dataclass(frozen=True)
class Side:
    """A mesh as it is seen in the scene: scaled, and wound outward where its object is mirrored."""

    vertices: Array
    """(n, 3) float64."""
    triangles: Array
    """(k, 3) int32."""
    loops: Array
    """(k, 3) int32, loops of the triangles' corners."""
    polygons: Array
    """(k,) int32, polygon of every triangle."""

    @property
    def corners(self) -> Array:
        """(3 k,) loop of every triangle corner."""
        return self.loops.ravel()


@dataclass(frozen=True)
class Pair:
    """What the transfer of any kind works on. `correspondence` leads from `own` to `given`."""

    receiver: Any
    name: str
    arrays: MeshArrays
    donor: Donor
    correspondence: Any
    own: Side
    given: Side

    @property
    def matched(self) -> Array:
        """(n,) True for receiver vertices that have a point on the donor."""
        return np.asarray(self.correspondence.face) >= 0

    def geometry(self) -> tuple[Array, Array, Array, Array]:
        """Receiver's and donor's vertices and triangles."""
        return self.own.vertices, self.own.triangles, self.given.vertices, self.given.triangles

    def from_face_centres(self, values: Array, progress: Progress) -> transfer.TransferredValues:
        """What the donor's polygons carry, `values` (p', ...), for those of the receiver whose centre lies on them."""
        return transfer.transfer_face(
            self.correspondence,
            *self.geometry(),
            values,
            receiver_polygons=self.own.polygons,
            donor_polygons=self.given.polygons,
            progress=progress,
        )

    def whole_polygons(self, triangle_mask: Array) -> Array:
        """(p,) True for polygons all of whose triangles are."""
        whole = np.ones(self.arrays.polygon_count, dtype=bool)
        whole[self.own.polygons[~triangle_mask]] = False
        return whole

    def to_loops(self, triangle_corners: Array, triangle_mask: Array) -> Array:
        """Rows per triangle corner as rows per loop; zeros in polygons that are not wholly matched."""
        loops = np.zeros((len(self.arrays.loop_polygons), *triangle_corners.shape[1:]), dtype=triangle_corners.dtype)
        loops[self.own.corners] = triangle_corners
        loops[~self.whole_polygons(triangle_mask)[self.arrays.loop_polygons]] = np.zeros((), loops.dtype)
        return loops


def make(donor: Any, receivers: list[Any], context: bpy.types.Context, min_confidence: float) -> list[Pair]:
    """One pair per receiver. All are looked at before anything is computed.

    Raises:
        RefusedError: a match is missing or no longer fits.
    """
    depsgraph = context.evaluated_depsgraph_get()
    giving = Donor(donor, bridge.read_donor(donor, depsgraph), depsgraph, is_own=False)
    return [_pair(obj, giving, min_confidence) for obj in receivers]


def unchanged(pair: Pair, depsgraph: Any, content_hash: str | None = None) -> Any:
    """The receiver of a pair, found again by name after a job.

    Args:
        content_hash: what its mesh must be, if not what the pair knows.

    Raises:
        RefusedError: it is gone, or its mesh is another.
    """
    return again(pair.name, depsgraph, content_hash or pair.arrays.content_hash)


def again(name: str, depsgraph: Any, content_hash: str) -> Any:
    """A receiver found again by name, with the mesh that has this hash.

    Raises:
        RefusedError: it is gone, or its mesh is another.
    """
    obj = bpy.data.objects.get(name)
    if obj is None or obj.type != "MESH":
        raise RefusedError(f"{name} was removed or renamed meanwhile; nothing was written")
    if bridge.read_receiver(obj, depsgraph).content_hash != content_hash:
        raise RefusedError(f"{name} was edited meanwhile; nothing was written")
    return obj


def donor_again(name: str) -> Any:
    """The donor found again by name.

    Raises:
        RefusedError: it is gone.
    """
    donor = bpy.data.objects.get(name)
    if donor is None:
        raise RefusedError(f"{name} was removed or renamed meanwhile; nothing was written")
    return donor


@contextmanager
def named(name: str) -> Iterator[None]:
    """What the engine refuses in the block is refused with the receiver's name."""
    try:
        yield
    except (isograft.InvalidInput, isograft.ResourceLimit) as error:
        raise RefusedError(f"{name}: {error}") from error


def _pair(obj: Any, donor: Donor, min_confidence: float) -> Pair:
    """The match that `obj` has to the donor, else the inverse of the one the donor has to it."""
    content = bridge.read_property(obj)
    arrays = bridge.read_receiver(obj, donor.depsgraph)
    reverse = bridge.read_property(donor.obj)
    if content is not None and content.get("donor_hash") == donor.arrays.content_hash:
        if content.get("receiver_hash") != arrays.content_hash:
            raise RefusedError(f"{obj.name} was edited after it was matched; run Match again")
        correspondence = _seen(matching.read_correspondence(obj, donor.arrays, min_confidence), donor.arrays)
        return _assemble(obj, arrays, donor, correspondence)
    target = bridge.read_donor(obj, donor.depsgraph)
    if reverse is not None and reverse.get("donor_hash") == target.content_hash:
        return _inverse(obj, arrays, target, donor, reverse, min_confidence)
    raise RefusedError(_why_not(obj, donor.obj, content, reverse))


def _inverse(
    obj: Any, arrays: MeshArrays, target: MeshArrays, donor: Donor, content: dict[str, Any], min_confidence: float
) -> Pair:
    source = bridge.own_arrays(donor.obj, donor.depsgraph)
    if content.get("receiver_hash") != source.content_hash:
        raise RefusedError(f"{donor.obj.name} was edited after it was matched to {obj.name}; run Match again")
    if len(target.vertices) != len(arrays.vertices):
        raise RefusedError(
            f"{obj.name}: its modifiers change the number of vertices, so the match of {donor.obj.name} does not lead "
            f"back; apply them, or run Match with {donor.obj.name} as the active object"
        )
    forward = _seen(matching.read_correspondence(donor.obj, target, min_confidence), target)
    turned = Donor(donor.obj, source, donor.depsgraph, is_own=True)
    given, met = _side(source), _side(target)
    back = transfer.invert(forward, given.vertices, given.triangles, met.vertices, met.triangles)
    return _assemble(obj, arrays, turned, back)


def _assemble(obj: Any, arrays: MeshArrays, donor: Donor, correspondence: Any) -> Pair:
    return Pair(obj, obj.name, arrays, donor, correspondence, _side(arrays), _side(donor.arrays))


def _side(arrays: MeshArrays) -> Side:
    vertices, triangles = arrays.surface()
    return Side(vertices, triangles, arrays.in_surface_order(arrays.triangle_loops), arrays.triangle_polygons)


def _seen(correspondence: SimpleNamespace, donor: MeshArrays) -> SimpleNamespace:
    """In the triangles of surface(): the attributes count corners as the loop triangles do."""
    correspondence.barycentric = donor.in_surface_order(correspondence.barycentric)
    return correspondence


def _why_not(obj: Any, donor: Any, content: dict[str, Any] | None, reverse: dict[str, Any] | None) -> str:
    """Why neither of the two matches can be used, and what to do."""
    if content is not None and content.get("donor") == donor.name:
        return f"{donor.name} was edited after {obj.name} was matched to it; run Match again"
    if reverse is not None and reverse.get("donor") == obj.name:
        return f"{obj.name} was edited after {donor.name} was matched to it; run Match again"
    if content is not None:
        return f"{obj.name} was matched to {content.get('donor')}, not to {donor.name}; run Match again"
    return f"{obj.name} has no match; run Match with {donor.name} as the active object first"
