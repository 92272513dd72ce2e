# SPDX-License-Identifier: GPL-3.0-or-later
"""Isograft in Blender: match surfaces, and graft what the active object carries onto the selected ones."""

bl_info = {
    "name": "Isograft",
    "author": "The Isograft authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D Viewport > Sidebar > Isograft",
    "description": "Match surfaces in different poses, in whole or in part, and graft what one carries",
    "category": "Object",
}


def register() -> None:
    """Load the native package, then register the classes: the settings take their defaults from it."""
    from . import native_loader

    native_loader.load()
    from . import operators, panels, properties

    properties.register()
    operators.register()
    panels.register()


def unregister() -> None:
    """Undo register(), in reverse."""
    from . import native_loader, operators, panels, properties

    panels.unregister()
    operators.unregister()
    properties.unregister()
    native_loader.unload()
