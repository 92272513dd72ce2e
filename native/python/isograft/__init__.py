# SPDX-License-Identifier: GPL-3.0-or-later
"""Dense partial near-isometric correspondences between two surfaces.

>>> import isograft
>>> result = isograft.match((vertices_s, faces_s), (vertices_t, faces_t))
>>> colours_on_source = result.best.interpolate(colours_on_target)
"""

from importlib import metadata as _metadata

from isograft.correspondence import Correspondence
from isograft.errors import Cancelled, InvalidInput, ResourceLimit
from isograft.geodesics import geodesic_distances
from isograft.matching import Match, match
from isograft.presets import preset_options, presets
from isograft.report import Report, StageReport
from isograft.surface import Surface

try:
    __version__ = _metadata.version("isograft")
except _metadata.PackageNotFoundError:  # run from a source tree that was never installed
    __version__ = "0+source"

__all__ = [
    "Cancelled",
    "Correspondence",
    "InvalidInput",
    "Match",
    "Report",
    "ResourceLimit",
    "StageReport",
    "Surface",
    "__version__",
    "geodesic_distances",
    "match",
    "preset_options",
    "presets",
]
