# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar's panel: draws, and nothing else."""

import textwrap

import bpy

from . import bridge, operators, properties, transfer_properties

CHARACTER_WIDTH = 8
"""Pixels a letter takes, icon and margins counted in."""


class VIEW3D_PT_isograft(bpy.types.Panel):
    """Who takes part, and the match, in the 3D viewport's sidebar."""

    bl_label = "Isograft"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Isograft"

    def draw(self, context: bpy.types.Context) -> None:
        """Who gives and who receives, then the match with its settings."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        problem = operators.selection_problem(context)
        if problem:
            _wrapped(layout, problem, context.region.width)
        else:
            self._participants(context)
        self._match(context)

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


class VIEW3D_PT_isograft_transfer(bpy.types.Panel):
    """What the receivers get, with the settings of each kind."""

    bl_label = "Transfer"
    bl_parent_id = "VIEW3D_PT_isograft"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Isograft"

    def draw(self, context: bpy.types.Context) -> None:
        """The kinds as buttons, the settings of the chosen ones, the operator."""
        layout = self.layout
        settings = context.window_manager.isograft_transfer
        grid = layout.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
        for identifier, label, _ in transfer_properties.WHAT:
            grid.prop_enum(settings, "what", identifier, text=label)
        layout.use_property_split = True
        layout.use_property_decorate = False
        for identifier, label, names in _KIND_SETTINGS:
            if identifier in settings.what:
                box = layout.box().column()
                box.label(text=label)
                for name in names:
                    if name != "mix_factor" or settings.mix_mode != "REPLACE" or settings.mix_factor != 1.0:
                        _setting(box, settings, name)
        _finish(layout, settings, ("min_confidence", "overwrite", "fill"), "object.isograft_transfer", "PASTEDOWN")


class VIEW3D_PT_isograft_bake(bpy.types.Panel):
    """Textures, baked into the receivers' own UV maps."""

    bl_label = "Textures"
    bl_parent_id = "VIEW3D_PT_isograft"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Isograft"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """The settings and the operator."""
        names = ("uv_source", "uv_map", "size", "margin", "float_images", "fill", "min_confidence", "overwrite")
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        _finish(self.layout, context.window_manager.isograft_bake, names, "object.isograft_bake", "TEXTURE")


class VIEW3D_PT_isograft_wrap(bpy.types.Panel):
    """The donor's mesh on the receiver's surface."""

    bl_label = "Wrap"
    bl_parent_id = "VIEW3D_PT_isograft"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Isograft"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """The settings and the operator."""
        names = ("method", "min_confidence")
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        _finish(self.layout, context.window_manager.isograft_wrap, names, "object.isograft_wrap", "MOD_SHRINKWRAP")


_KIND_SETTINGS = (
    ("UV", "UV Maps", ("uv_names", "mark_seams", "cut_seams", "link_materials")),
    ("COLOR", "Colours", ("color_names",)),
    (
        "GROUPS",
        "Vertex Groups",
        ("group_names", "mix_mode", "mix_factor", "normalise", "limit_total", "hook_armature"),
    ),
    ("KEYS", "Shape Keys", ("key_names", "key_scale", "key_smoothing", "copy_drivers")),
    ("ATTRIBUTES", "Attributes", ("attribute_names",)),
)
"""Settings shown while a kind is chosen."""


def _finish(
    layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, names: tuple[str, ...], operator: str, icon: str
) -> None:
    """The settings of these names, and below them the operator that is run with all of `settings`."""
    column = layout.column()
    for name in names:
        _setting(column, settings, name)
    row = layout.row()
    row.scale_y = 1.4
    properties.copy_settings(settings, row.operator(operator, icon=icon))


def _setting(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, name: str) -> None:
    """A property; a switch over the whole width, so that its name is not cut off."""
    row = layout.row()
    if settings.bl_rna.properties[name].type == "BOOLEAN":
        row.use_property_split = False
    row.prop(settings, name)


def _wrapped(layout: bpy.types.UILayout, text: str, width: int) -> None:
    """`text` in as many lines as the sidebar's width asks for."""
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, max(16, width // CHARACTER_WIDTH))):
        column.label(text=line, icon="BLANK1" if number else "INFO")


_CLASSES = (VIEW3D_PT_isograft, VIEW3D_PT_isograft_transfer, VIEW3D_PT_isograft_bake, VIEW3D_PT_isograft_wrap)


def register() -> None:
    """Register the panels."""
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    """Undo register()."""
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
