# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of object.isograft_transfer."""

from typing import Any

import bpy

from .baking import BakeSettings
from .settings import Settings
from .wrapping import WrapSettings

WHAT = (
    ("UV", "UV Maps", "UV maps, islands and seams kept"),
    ("COLOR", "Colours", "Colour attributes of points and of face corners"),
    ("GROUPS", "Vertex Groups", "Vertex groups with their weights"),
    ("KEYS", "Shape Keys", "Shape keys with values, ranges, relative keys, masks and drivers"),
    ("ATTRIBUTES", "Attributes", "Attributes of any type on points, edges, faces and face corners"),
    ("MATERIALS", "Materials", "Material slots and the material of every face"),
    ("FACE_SETS", "Face Sets", "The face sets of Sculpt Mode"),
    ("NORMALS", "Normals", "Custom normals of face corners, turned with the surface"),
)

MIX_MODES = (
    ("REPLACE", "Replace", "The donor's weight"),
    ("ABOVE_THRESHOLD", "Above Threshold", "The donor's weight where the receiver's own is above the factor"),
    ("BELOW_THRESHOLD", "Below Threshold", "The donor's weight where the receiver's own is below the factor"),
    ("MIX", "Mix", "Between the receiver's own weight and the donor's"),
    ("ADD", "Add", "The donor's weight is added to the receiver's own"),
    ("SUBTRACT", "Subtract", "The donor's weight is subtracted from the receiver's own"),
    ("MULTIPLY", "Multiply", "The donor's weight is multiplied with the receiver's own"),
)

KEY_SCALES = (
    ("GLOBAL", "Global", "Displacements grow with the ratio of the two objects' sizes"),
    ("LOCAL", "Local", "Displacements grow with the ratio of sizes around every vertex"),
)

UV_SOURCES = (
    ("EXISTING", "Existing", "A UV map that the receiver has"),
    ("TRANSFERRED", "Donor's", "The donor's UV map, transferred to the receiver"),
    ("UNWRAP", "New Unwrap", "A new map by Blender's Smart UV Project"),
)

METHODS = (
    ("RIGID", "As Rigid as Possible", "Keep the donor's shape there, turned to fit"),
    ("SMOOTH", "Smooth", "Continue the displacements smoothly"),
)

_NAMES = "Names of the {kind} that are transferred, separated by commas, * and ? allowed; empty means all"


def transfer_settings() -> dict[str, Any]:
    """Annotations for a class with the settings of a transfer, by the names and with the defaults of Settings."""
    default = Settings()
    return {
        "what": bpy.props.EnumProperty(
            name="What",
            description="What the receivers get",
            items=WHAT,
            options={"ENUM_FLAG"},
            default=default.what,
        ),
        "min_confidence": _confidence(default.min_confidence),
        "overwrite": _switch(
            "Overwrite", "Write over what has the same name, instead of adding new", default.overwrite
        ),
        "fill": _switch(
            "Fill Unmatched",
            "Complete smoothly what is unmatched, and mark it in the attribute isograft_filled",
            default.fill,
        ),
        "link_materials": _switch(
            "Link Materials",
            "With UV maps, give receiver faces the donor's materials; faces without a match keep theirs",
            default.link_materials,
        ),
        "uv_names": _names("UV Maps", "UV maps", default.uv_names),
        "mark_seams": _switch(
            "Mark Seams", "Mark receiver edges along the seams of the donor's rendered UV map", default.mark_seams
        ),
        "cut_seams": _switch(
            "Cut Seams",
            "Cut receiver faces where the donor's seams run through them, so that UVs are exact on both sides",
            default.cut_seams,
        ),
        "color_names": _names("Colours", "colour attributes", default.color_names),
        "attribute_names": _names("Attributes", "attributes", default.attribute_names),
        **_group_settings(default),
        **_key_settings(default),
    }


def bake_settings() -> dict[str, Any]:
    """Annotations for a class with the settings of a bake, by the names and with the defaults of BakeSettings."""
    default = BakeSettings()
    return {
        "size": bpy.props.IntProperty(
            name="Size",
            description="Width and height of the images in pixels",
            default=default.size,
            min=16,
            max=16384,
            soft_min=256,
        ),
        "margin": bpy.props.IntProperty(
            name="Margin",
            description="Pixels that the baked islands are extended by",
            default=default.margin,
            min=0,
            soft_max=64,
        ),
        "uv_source": bpy.props.EnumProperty(
            name="Bake Into", description="UV map of the receivers", items=UV_SOURCES, default=default.uv_source
        ),
        "uv_map": bpy.props.StringProperty(
            name="UV Map",
            description="Name of the UV map; empty means the rendered one, or the donor's name for a new one",
            default=default.uv_map,
        ),
        "float_images": _switch("Float Images", "Make 32-bit float images even of 8-bit ones", default.float_images),
        "fill": _switch(
            "Fill Unmatched",
            "Continue the images smoothly where nothing is matched, and mark it in the attribute isograft_filled",
            default.fill,
        ),
        "overwrite": _switch(
            "Overwrite", "Write over UV maps, images and materials of the same name", default.overwrite
        ),
        "min_confidence": _confidence(default.min_confidence),
        "threads": _threads(default.threads),
    }


def wrap_settings() -> dict[str, Any]:
    """Annotations for a class with the settings of a wrap, by the names and with the defaults of WrapSettings."""
    default = WrapSettings()
    return {
        "method": bpy.props.EnumProperty(
            name="Unmatched", description="How the unmatched part is completed", items=METHODS, default=default.method
        ),
        "min_confidence": _confidence(default.min_confidence),
        "threads": _threads(default.threads),
    }


def _group_settings(default: Settings) -> dict[str, Any]:
    return {
        "group_names": _names("Groups", "vertex groups", default.group_names),
        "mix_mode": bpy.props.EnumProperty(
            name="Mix Mode",
            description="How the donor's weights meet those that the receiver has in a group of that name",
            items=MIX_MODES,
            default=default.mix_mode,
        ),
        "mix_factor": bpy.props.FloatProperty(
            name="Mix Factor",
            description="How much of the result is taken; for the two threshold modes, the threshold",
            default=default.mix_factor,
            min=0.0,
            max=1.0,
            subtype="FACTOR",
        ),
        "normalise": _switch(
            "Normalise",
            "Scale the received weights of every vertex to a sum of 1, locked groups apart",
            default.normalise,
        ),
        "limit_total": bpy.props.IntProperty(
            name="Limit Total",
            description="Most received groups that a vertex is in, the heaviest; 0 means no limit",
            default=default.limit_total,
            min=0,
            soft_max=8,
        ),
        "hook_armature": _switch(
            "Hook Up Armature", "Give the receiver the donor's armature modifiers", default.hook_armature
        ),
    }


def _key_settings(default: Settings) -> dict[str, Any]:
    return {
        "key_names": _names("Keys", "shape keys", default.key_names),
        "key_scale": bpy.props.EnumProperty(
            name="Key Scale",
            description="How long the displacements of shape keys become",
            items=KEY_SCALES,
            default=default.key_scale,
        ),
        "key_smoothing": bpy.props.IntProperty(
            name="Key Smoothing",
            description=(
                "Edges around a vertex over which the turning of its displacements is measured; -1 chooses: a wide "
                "surrounding for two shapes in one pose, such as two faces, else 2"
            ),
            default=default.key_smoothing,
            min=-1,
            max=100,
            soft_max=32,
        ),
        "copy_drivers": _switch("Copy Drivers", "Copy the drivers of shape keys", default.copy_drivers),
    }


def _threads(default: int) -> Any:
    return bpy.props.IntProperty(
        name="Threads",
        description="Worker threads, 0 takes all cores; the result does not depend on it",
        default=default,
        min=0,
        soft_max=64,
    )


def _confidence(default: float) -> Any:
    return bpy.props.FloatProperty(
        name="Confidence",
        description="Vertices matched with less confidence than this count as unmatched",
        default=default,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )


def _switch(name: str, description: str, default: bool) -> Any:
    return bpy.props.BoolProperty(name=name, description=description, default=default)


def _names(name: str, kind: str, default: str) -> Any:
    return bpy.props.StringProperty(name=name, description=_NAMES.format(kind=kind), default=default)
