# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be transferred: one module per kind of data, each a class that reads, computes and writes."""

from .attributes import Attributes
from .base import Kind
from .colors import Colors
from .face_sets import FaceSets
from .groups import Groups
from .keys import Keys
from .materials import Materials
from .normals import Normals
from .uv import UVMaps

KINDS: dict[str, type[Kind]] = {
    "UV": UVMaps,
    "COLOR": Colors,
    "GROUPS": Groups,
    "KEYS": Keys,
    "ATTRIBUTES": Attributes,
    "MATERIALS": Materials,
    "FACE_SETS": FaceSets,
    "NORMALS": Normals,
}
"""By the identifier in the operator's `what`, in the order in which they are written."""

__all__ = ["KINDS", "Kind", "UVMaps"]
