# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar's panel: draws, and nothing else."""

import textwrap

import bpy

from . import bridge, operators, properties

CHARACTER_WIDTH = 8
"""Pixels a letter takes, icon and margins counted in."""


class VIEW3D_PT_isograft(bpy.types.Panel):
    """Match and transfer in the 3D viewport's sidebar."""

    bl_label = "Isograft"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Isograft"

    def draw(self, context: bpy.types.Context) -> None:
        """Who gives and who receives, then the two operators with their settings."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        problem = operators.selection_problem(context)
        if problem:
            _wrapped(layout, problem, context.region.width)
        else:
            self._participants(context)
        self._match(context)
        self._transfer(context)

    def _participants(self, context: bpy.types.Context) -> None:
        donor, receivers = operators.participants(context)
        column = self.layout.column(align=True)
        column.label(text=f"Donor: {donor.name}", icon="EXPORT")
        for obj in receivers:
            content = bridge.read_property(obj)
            matched = f" (matched to {content.get('donor')})" if content else ""
            column.label(text=f"Receiver: {obj.name}{matched}", icon="IMPORT")

    def _match(self, context: bpy.types.Context) -> None:
        settings = context.window_manager.isograft_match
        column = self.layout.column()
        column.prop(settings, "preset")
        column.prop(settings, "scale")
        if settings.scale == "VALUE":
            column.prop(settings, "scale_value")
        column.prop(settings, "threads")
        column.prop(settings, "seed")
        row = self.layout.row()
        row.scale_y = 1.4
        properties.copy_settings(settings, row.operator("object.isograft_match", icon="VIEWZOOM"))

    def _transfer(self, context: bpy.types.Context) -> None:
        settings = context.window_manager.isograft_transfer
        self.layout.separator()
        row = self.layout.row(align=True)
        row.use_property_split = False
        row.prop(settings, "what", expand=True)
        column = self.layout.column()
        column.prop(settings, "min_confidence")
        column.prop(settings, "overwrite")
        if "UV" in settings.what:
            column.prop(settings, "link_materials")
        row = self.layout.row()
        row.scale_y = 1.4
        properties.copy_settings(settings, row.operator("object.isograft_transfer", icon="PASTEDOWN"))


def _wrapped(layout: bpy.types.UILayout, text: str, width: int) -> None:
    """`text` in as many lines as the sidebar's width asks for."""
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, max(16, width // CHARACTER_WIDTH))):
        column.label(text=line, icon="BLANK1" if number else "INFO")


def register() -> None:
    """Register the panel."""
    bpy.utils.register_class(VIEW3D_PT_isograft)


def unregister() -> None:
    """Undo register()."""
    bpy.utils.unregister_class(VIEW3D_PT_isograft)
