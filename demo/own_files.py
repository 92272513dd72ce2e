# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender script: read the user's donor and receiver and make the scene that graft.py expects.

    blender -b --factory-startup --python-exit-code 1 -P demo/own_files.py -- FOLDER ZIP DONOR RECEIVER

Reads .ply, .obj, .off and .stl. A donor without UV map and colours gets both, so that there is something to see.
Exits with code 2 if a file does not hold a usable mesh.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import bpy
import numpy as np

from demo import addon, scene
from demo.implicit import Array

CELLS = 14


def refuse(text: str) -> None:
    print(f"demo: {text}", flush=True)
    sys.exit(2)


def read(path: Path, name: str) -> bpy.types.Object:
    """The file as one mesh object: OBJ by Blender, for its materials; the rest by the package's readers."""
    from isograft import Surface
    from isograft.errors import InvalidInput
    from isograft.files import read_mesh

    try:
        file = read_mesh(path)  # also for OBJ: its words about a broken file are better than the importer's
    except (InvalidInput, OSError) as error:
        refuse(str(error))
    if not len(file.faces):
        refuse(f"{path}: holds no faces; the demo needs surfaces")
    try:
        Surface(file.vertices, file.faces)  # the add-on would refuse it too, but after the scene is made
    except InvalidInput as error:
        refuse(f"{path}: {error}")
    item = import_obj(path) if path.suffix.lower() == ".obj" else from_file(file)
    item.name = item.data.name = name
    item.data.polygons.foreach_set("use_smooth", np.ones(len(item.data.polygons), bool))
    return item


def import_obj(path: Path) -> bpy.types.Object:
    """The objects of an OBJ file joined to one, with its materials and images."""
    known = set(bpy.data.objects)
    bpy.ops.wm.obj_import(filepath=str(path))
    added = [item for item in bpy.data.objects if item not in known and item.type == "MESH"]
    if not added:
        refuse(f"{path}: Blender found no mesh in it")
    for item in bpy.context.view_layer.objects:
        item.select_set(item in added)
    bpy.context.view_layer.objects.active = added[0]
    if len(added) > 1:
        bpy.ops.object.join()
    bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
    return added[0]


def from_file(file: object) -> bpy.types.Object:
    """Polygons and point colours of an isograft.files.MeshFile as a mesh object."""
    polygons = file.polygons
    ends = np.cumsum(polygons.sizes)
    faces = [polygons.corners[end - size : end].tolist() for size, end in zip(polygons.sizes, ends, strict=True)]
    item = scene.add_mesh("Mesh", polygons.vertices, faces)
    if polygons.colors is not None:
        colours = np.ones((len(polygons.vertices), 4), np.float32)
        colours[:, : polygons.colors.shape[1]] = polygons.colors
        layer = item.data.color_attributes.new("Color", "BYTE_COLOR", "POINT")
        write_srgb(layer, colours)
    return item


def write_srgb(layer: bpy.types.Attribute, colours: Array) -> None:
    """Colours of a file are sRGB; attributes hold linear light."""
    rgb = colours[:, :3]
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    layer.data.foreach_set("color", np.column_stack([linear, colours[:, 3]]).astype(np.float32).ravel())


def has_texture(item: bpy.types.Object) -> bool:
    """Whether a material shows an image."""
    trees = [m.node_tree for m in item.data.materials if m and m.use_nodes]
    return any(node.type == "TEX_IMAGE" and node.image for tree in trees for node in tree.nodes)


def dress(donor: bpy.types.Object) -> str:
    """Make sure that the donor has something to give; returns in words what it is."""
    if donor.data.uv_layers and has_texture(donor):
        return "its own UV map and texture"
    if donor.data.uv_layers:
        donor.data.materials.clear()
        donor.data.materials.append(scene.checker_material("Checker", CELLS * 3.0))
        return "its own UV map, shown with a checker"
    given = donor.data.color_attributes
    layer = given[0].name if given else position_colours(donor)
    donor.data.materials.clear()
    donor.data.materials.append(scene.attribute_material("Colours", layer))
    unwrap(donor)
    return f"the colours “{layer}” and a generated UV map"


def position_colours(donor: bpy.types.Object) -> str:
    """A point colour attribute: a spatial checker whose hue follows the place in the bounding box."""
    mesh = donor.data
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    points = flat.reshape(-1, 3).astype(float)
    size = np.ptp(points, axis=0)
    place = (points - points.min(axis=0)) / np.maximum(size, 1e-12)
    cell = np.floor(CELLS * (points - points.min(axis=0)) / size.max()).astype(int)
    dark = np.where(cell.sum(axis=1) % 2 == 0, 1.0, 0.35)
    colours = np.column_stack([(0.08 + 0.85 * place) * dark[:, None], np.ones(len(points))])
    layer = mesh.color_attributes.new("Place", "FLOAT_COLOR", "POINT")
    layer.data.foreach_set("color", colours.astype(np.float32).ravel())
    return str(layer.name)


def unwrap(donor: bpy.types.Object) -> None:
    for item in bpy.context.view_layer.objects:
        item.select_set(item is donor)
    bpy.context.view_layer.objects.active = donor
    donor.data.uv_layers.new(name="UVMap")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=1.15, island_margin=0.004)
    bpy.ops.object.mode_set(mode="OBJECT")


def main(folder: Path, zip_path: Path, donor_path: Path, receiver_path: Path) -> None:
    scene.clear()
    addon.install(zip_path)
    donor, receiver = read(donor_path, "Donor"), read(receiver_path, "Receiver")
    given = dress(donor)
    receiver.data.materials.clear()
    receiver.data.materials.append(scene.plain_material("Bare receiver", scene.BARE))
    while receiver.data.uv_layers:
        receiver.data.uv_layers.remove(receiver.data.uv_layers[0])
    for item in (donor, receiver):
        print(f"demo: {item.name.lower()}: {len(item.data.vertices)} vertices, {len(item.data.polygons)} faces")
    print(f"demo: the donor gives {given}")
    bpy.context.scene["donor"], bpy.context.scene["receiver"] = donor.name, receiver.name
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "pair.blend"), check_existing=False)


if __name__ == "__main__":
    main(*(Path(text) for text in sys.argv[sys.argv.index("--") + 1 :]))
