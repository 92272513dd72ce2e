# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the operators; their defaults are those of the native options."""

import inspect
from typing import Any

import bpy
import isograft

from . import transfer_properties

PRESETS = {
    "fast": ("Fast", "Coarser and quicker"),
    "default": ("Default", "Accuracy and time in balance"),
    "thorough": ("Thorough", "Finer and slower"),
    "noisy": ("Noisy", "For noisy scans"),
    "paper": ("Paper", "The published method, parameter by parameter"),
}

SCALE_MODES = (
    ("AUTO", "Auto", "Find the ratio of the two sizes"),
    ("FIXED", "Fixed", "Both objects are in the same unit"),
    ("VALUE", "Value", "The donor is this many times the size of the receiver"),
)

_OVERRIDES: dict[str, tuple[str, str, dict[str, float]]] = {
    "hierarchy_samples": (
        "Samples",
        "Points per unit area on which the map is found; unless set, the preset decides",
        {"min": 50, "soft_max": 5000},
    ),
    "growth_stretch_limit": (
        "Stretch Limit",
        "Largest stretch while a map grows, in sample spacings; unless set, the preset decides",
        {"min": 0.01, "soft_max": 2.0},
    ),
}


def native_defaults() -> dict[str, Any]:
    """Defaults of isograft.match() and of the options of its default preset, by name."""
    parameters = inspect.signature(isograft.match).parameters
    defaults = {name: parameters[name].default for name in ("preset", "scale", "threads", "seed")}
    options = isograft.preset_options(defaults["preset"])
    return defaults | {name: options[name] for name in _OVERRIDES}


def match_settings(defaults: dict[str, Any]) -> dict[str, Any]:
    """Annotations for a class with the settings of a match."""
    scale = defaults["scale"]
    settings: dict[str, Any] = {
        "preset": bpy.props.EnumProperty(
            name="Preset",
            description="What the engine is set up for",
            items=[(name, *texts) for name, texts in available_presets().items()],
            default=defaults["preset"],
        ),
        "scale": bpy.props.EnumProperty(
            name="Scale",
            description="Size of the donor relative to the receiver",
            items=SCALE_MODES,
            default={"auto": "AUTO", "fixed": "FIXED"}.get(scale, "VALUE"),
        ),
        "scale_value": bpy.props.FloatProperty(
            name="Scale Value",
            description="Size of the donor over that of the receiver, both as they stand in the scene",
            default=1.0 if isinstance(scale, str) else scale,
            min=1e-6,
            soft_min=0.01,
            soft_max=100.0,
            precision=4,
        ),
        "threads": bpy.props.IntProperty(
            name="Threads",
            description="Worker threads, 0 takes all cores; the result does not depend on it",
            default=defaults["threads"] or 0,
            min=0,
            soft_max=64,
        ),
        "seed": bpy.props.IntProperty(
            name="Seed", description="Seed of every random choice", default=defaults["seed"], min=0
        ),
    }
    for name, (label, description, limits) in _OVERRIDES.items():
        make = bpy.props.IntProperty if isinstance(defaults[name], int) else bpy.props.FloatProperty
        settings[name] = make(
            name=label, description=description, default=defaults[name], options={"SKIP_SAVE"}, **limits
        )
    return settings


def available_presets() -> dict[str, tuple[str, str]]:
    """The presets that this build of the engine has, with label and description."""
    return {name: PRESETS.get(name, (name.title(), "")) for name in isograft.presets()}


def match_options(settings: Any) -> dict[str, Any]:
    """Keyword arguments of isograft.match() for the properties of an operator."""
    scale = {"AUTO": "auto", "FIXED": "fixed", "VALUE": settings.scale_value}[settings.scale]
    options: dict[str, Any] = {
        "preset": settings.preset,
        "scale": scale,
        "threads": settings.threads or None,
        "seed": settings.seed,
    }
    for name in _OVERRIDES:
        if settings.is_property_set(name):
            options[name] = getattr(settings, name)
    return options


def copy_settings(source: Any, target: Any) -> None:
    """Give `target`, an operator's properties, those settings of `source` that are set."""
    for name in type(source).__annotations__:
        if source.is_property_set(name):
            setattr(target, name, getattr(source, name))


class IsograftMatchSettings(bpy.types.PropertyGroup):
    """Settings of the next match, as the panel shows them."""


class IsograftTransferSettings(bpy.types.PropertyGroup):
    """Settings of the next transfer, as the panel shows them."""


class IsograftBakeSettings(bpy.types.PropertyGroup):
    """Settings of the next bake, as the panel shows them."""


class IsograftWrapSettings(bpy.types.PropertyGroup):
    """Settings of the next wrap, as the panel shows them."""


_CLASSES = (IsograftMatchSettings, IsograftTransferSettings, IsograftBakeSettings, IsograftWrapSettings)


def register() -> None:
    """Register the panel's settings.

    They belong to the window manager: a scene's would come back with every undo.
    """
    IsograftMatchSettings.__annotations__ = match_settings(native_defaults())
    IsograftTransferSettings.__annotations__ = transfer_properties.transfer_settings()
    IsograftBakeSettings.__annotations__ = transfer_properties.bake_settings()
    IsograftWrapSettings.__annotations__ = transfer_properties.wrap_settings()
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.WindowManager.isograft_match = bpy.props.PointerProperty(type=IsograftMatchSettings)
    bpy.types.WindowManager.isograft_transfer = bpy.props.PointerProperty(type=IsograftTransferSettings)
    bpy.types.WindowManager.isograft_bake = bpy.props.PointerProperty(type=IsograftBakeSettings)
    bpy.types.WindowManager.isograft_wrap = bpy.props.PointerProperty(type=IsograftWrapSettings)


def unregister() -> None:
    """Undo register()."""
    del bpy.types.WindowManager.isograft_wrap
    del bpy.types.WindowManager.isograft_bake
    del bpy.types.WindowManager.isograft_transfer
    del bpy.types.WindowManager.isograft_match
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
