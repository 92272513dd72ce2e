# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's data <-> numpy arrays: the only user of foreach_get and foreach_set.

Reading never changes an object. Writing only happens in the write_... functions, which expect arrays that are ready.
"""

from .attributes import (
    SEAMS,
    AttributeLayer,
    attribute_names,
    read_attribute,
    read_attributes,
    read_layer,
    write_attribute,
)
from .cut import cut_faces, trial
from .groups import Group, armature_modifiers, read_groups, read_weights, write_armatures, write_weights
from .images import color_space, is_data, read_image, read_old_image, write_image, write_material
from .keys import Key, are_relative, copy_drivers, key_drivers, read_keys, through_modifiers, write_keys
from .layers import (
    MAX_UV_LAYERS,
    CornerLayer,
    activate_color,
    copy_object_materials,
    polygon_materials,
    read_colors,
    read_corner_normals,
    read_uv_layers,
    write_corner_normals,
    write_polygon_materials,
    write_seams,
    write_uv_layer,
)
from .meshes import (
    PROPERTY,
    Array,
    Evaluated,
    MeshArrays,
    RefusedError,
    copy_mesh,
    own_arrays,
    read_donor,
    read_property,
    read_receiver,
    refuse_unwritable,
    write_property,
    write_vertices,
)
from .shading import Input, Texture, read_inputs, read_ways
from .tiles import FIRST, read_tiles
from .unwrap import smart_unwrap

__all__ = [
    "FIRST",
    "MAX_UV_LAYERS",
    "PROPERTY",
    "SEAMS",
    "Array",
    "AttributeLayer",
    "CornerLayer",
    "Evaluated",
    "Group",
    "Input",
    "Key",
    "MeshArrays",
    "RefusedError",
    "Texture",
    "activate_color",
    "are_relative",
    "armature_modifiers",
    "attribute_names",
    "color_space",
    "copy_drivers",
    "copy_mesh",
    "copy_object_materials",
    "cut_faces",
    "is_data",
    "key_drivers",
    "own_arrays",
    "polygon_materials",
    "read_attribute",
    "read_attributes",
    "read_colors",
    "read_corner_normals",
    "read_donor",
    "read_groups",
    "read_image",
    "read_inputs",
    "read_keys",
    "read_layer",
    "read_old_image",
    "read_property",
    "read_receiver",
    "read_tiles",
    "read_uv_layers",
    "read_ways",
    "read_weights",
    "refuse_unwritable",
    "smart_unwrap",
    "through_modifiers",
    "trial",
    "write_armatures",
    "write_attribute",
    "write_corner_normals",
    "write_image",
    "write_keys",
    "write_material",
    "write_polygon_materials",
    "write_property",
    "write_seams",
    "write_uv_layer",
    "write_vertices",
    "write_weights",
]
