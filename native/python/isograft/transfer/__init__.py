# SPDX-License-Identifier: GPL-3.0-or-later
"""Move what a donor carries along a correspondence.

The receiver is the source S of the correspondence, the donor its target T. Corner arrays have one row per corner of the
triangles: row 3 f + c belongs to corner c of triangle f; (F, 3, ...) arrays are taken as well.
"""

from isograft.transfer.arrays import TransferredValues
from isograft.transfer.attributes import Located, locate, transfer_face
from isograft.transfer.baking import Baked, Channel, bake
from isograft.transfer.corners import TransferredUV, transfer_corner, transfer_corner_uv, transfer_point, uv_islands
from isograft.transfer.cutting import CutMesh, cut_along_seams
from isograft.transfer.edge_filling import fill_edge
from isograft.transfer.edges import transfer_edge
from isograft.transfer.filling import Filled, fill_corner, fill_face, fill_point
from isograft.transfer.inverse import invert
from isograft.transfer.normals import fill_normals, transfer_normals
from isograft.transfer.seams import seam_edges
from isograft.transfer.shape_keys import LocalFrames, local_frames, transfer_shape_keys
from isograft.transfer.weights import MIX_MODES, mix_weights, tidy_weights, transfer_weights
from isograft.transfer.wrapping import Wrapped, wrap

__all__ = [
    "MIX_MODES",
    "Baked",
    "Channel",
    "CutMesh",
    "Filled",
    "LocalFrames",
    "Located",
    "TransferredUV",
    "TransferredValues",
    "Wrapped",
    "bake",
    "cut_along_seams",
    "fill_corner",
    "fill_edge",
    "fill_face",
    "fill_normals",
    "fill_point",
    "invert",
    "local_frames",
    "locate",
    "mix_weights",
    "seam_edges",
    "tidy_weights",
    "transfer_corner",
    "transfer_corner_uv",
    "transfer_edge",
    "transfer_face",
    "transfer_normals",
    "transfer_point",
    "transfer_shape_keys",
    "transfer_weights",
    "uv_islands",
    "wrap",
]
