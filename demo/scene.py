# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: meshes, materials, light, ground and camera of the demo's pictures."""

from __future__ import annotations

import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from demo.implicit import Array

BACKDROP = (0.55, 0.57, 0.60)
BARE = (0.33, 0.34, 0.36)


def clear() -> None:
    """Remove every object of the start-up scene."""
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)


def add_mesh(name: str, vertices: Array, triangles: Array) -> bpy.types.Object:
    """A smooth-shaded mesh object in the scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], np.asarray(triangles).tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    mesh.update()
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    return item


def plain_material(name: str, colour: tuple[float, float, float], roughness: float = 0.6) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    material.diffuse_color = (*colour, 1.0)
    return material


def attribute_material(name: str, attribute: str, roughness: float = 0.55) -> bpy.types.Material:
    """Material that shows a colour attribute."""
    material = plain_material(name, (0.5, 0.5, 0.5), roughness)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    source = nodes.new("ShaderNodeAttribute")
    source.attribute_name = attribute
    links.new(source.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return material


def checker_material(name: str, cells: float) -> bpy.types.Material:
    """Checker of `cells` squares along each side of the UV square, in two hues that drift over the map."""
    material = plain_material(name, (0.5, 0.5, 0.5))
    nodes, links = material.node_tree.nodes, material.node_tree.links
    uv = nodes.new("ShaderNodeUVMap")
    drift = nodes.new("ShaderNodeTexGradient")
    hue = nodes.new("ShaderNodeHueSaturation")
    hue.inputs["Color"].default_value = (0.8, 0.12, 0.08, 1.0)
    shift = nodes.new("ShaderNodeMath")
    shift.operation = "ADD"
    shift.inputs[1].default_value = 0.5
    checker = nodes.new("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = cells
    checker.inputs["Color2"].default_value = (0.9, 0.9, 0.87, 1.0)
    links.new(uv.outputs["UV"], checker.inputs["Vector"])
    links.new(uv.outputs["UV"], drift.inputs["Vector"])
    links.new(drift.outputs["Fac"], shift.inputs[0])
    links.new(shift.outputs["Value"], hue.inputs["Hue"])
    links.new(hue.outputs["Color"], checker.inputs["Color1"])
    links.new(checker.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return material


def world_points(items: list[bpy.types.Object]) -> Array:
    """Evaluated vertices (n, 3) of the objects in world space."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found = []
    for item in items:
        evaluated = item.evaluated_get(depsgraph)
        mesh = evaluated.to_mesh()
        flat = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", flat)
        evaluated.to_mesh_clear()
        matrix = np.array(item.matrix_world)
        found.append(flat.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(found)


def studio(samples: int, size: float = 0.0) -> None:
    """Ground for things of up to `size`, sky, key and fill light, and Cycles on the processor."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = True
    scene.cycles.adaptive_threshold = 0.03
    scene.cycles.use_denoising = bpy.app.version >= (4, 2, 0)  # Debian's Blender has no denoiser
    scene.cycles.max_bounces = 2
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.view_settings.view_transform = "Filmic"
    scene.view_settings.look = "High Contrast"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.world = bpy.data.worlds.new("Studio")
    scene.world.use_nodes = True
    sky = scene.world.node_tree.nodes["Background"]
    sky.inputs["Color"].default_value = (0.80, 0.88, 1.0, 1.0)
    sky.inputs["Strength"].default_value = 0.55
    corners = max(80.0, 30.0 * size) * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    ground = add_mesh("Ground", corners, [(0, 1, 2, 3)])
    ground.data.materials.append(plain_material("Ground", BACKDROP, 1.0))
    for name, energy, soft, direction in (
        ("Key", 2.3, 0.12, (-0.55, 0.75, -1.0)),
        ("Fill", 0.35, 0.6, (-1.0, -0.5, -0.5)),
    ):
        lamp = bpy.data.lights.new(name, "SUN")
        lamp.energy, lamp.angle = energy, soft
        item = bpy.data.objects.new(name, lamp)
        item.rotation_euler = Vector(direction).to_track_quat("-Z", "Y").to_euler()
        scene.collection.objects.link(item)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera


def frame(items: list[bpy.types.Object], azimuth: float, elevation: float, pixels: int, below: float = 0.0) -> None:
    """Aim a long lens at the objects so that they fill a picture `pixels` wide, as high as they need.

    `azimuth` in degrees from the creature's forward direction (-Y) to its left (+X); `below` widens the picture at the
    bottom by that share of its height, for captions.
    """
    scene = bpy.context.scene
    scene.render.resolution_percentage = 100
    camera = scene.camera
    a, e = math.radians(azimuth), math.radians(elevation)
    back = Vector((math.sin(a) * math.cos(e), -math.cos(a) * math.cos(e), math.sin(e)))
    turn = back.to_track_quat("Z", "Y")
    axes = np.array(turn.to_matrix()).T  # rows: right, up, back
    local = world_points(items) @ axes.T
    low, high = local.min(axis=0), local.max(axis=0)
    low[1] -= below * (high[1] - low[1])
    width, height = high[0] - low[0], high[1] - low[1]
    margin = 0.12 * max(height, 0.3 * width)  # perspective brings near things closer to the rim
    width, height = width + margin, height + margin
    shape = float(np.clip(height / width, 0.2, 0.65))
    scene.render.resolution_x, scene.render.resolution_y = pixels, 2 * round(0.5 * pixels * shape)
    width = max(width, height / shape)
    camera.data.lens_unit = "FOV"
    camera.data.angle = math.radians(12.0)
    distance = 0.5 * width / math.tan(0.5 * camera.data.angle)
    middle = 0.5 * (low + high)
    middle[2] += distance
    camera.matrix_world = Matrix.Translation(Vector(middle @ axes)) @ turn.to_matrix().to_4x4()
    # Users' files come in any unit.
    camera.data.clip_start, camera.data.clip_end = 0.01 * distance, 100.0 * distance
    bpy.context.view_layer.update()


def caption(text: str, under: bpy.types.Object, size: float) -> bpy.types.Object:
    """Words that face the camera just below an object."""
    camera = bpy.context.scene.camera
    axes = np.array(camera.matrix_world)[:3, :3].T
    local = world_points([under]) @ axes.T
    place = np.array((0.5 * (local[:, 0].min() + local[:, 0].max()), local[:, 1].min() - 1.6 * size, local[:, 2].max()))
    place[2] += max(0.0, 2.0 * size - float(place @ axes[:, 2])) / axes[2, 2]  # towards the camera, out of the ground
    curve = bpy.data.curves.new(text, "FONT")
    curve.body, curve.align_x, curve.size = text, "CENTER", size
    material = bpy.data.materials.get("Caption") or plain_material("Caption", (0.02, 0.025, 0.03), 1.0)
    curve.materials.append(material)
    item = bpy.data.objects.new(f"Caption {text}", curve)
    item.matrix_world = Matrix.Translation(Vector(place @ axes)) @ Matrix(camera.matrix_world.to_3x3()).to_4x4()
    item.visible_shadow = False
    bpy.context.scene.collection.objects.link(item)
    return item


def level(captions: list[bpy.types.Object]) -> None:
    """Lower the captions to one line as the camera sees them, and keep them out of the ground."""
    axes = np.array(bpy.context.scene.camera.matrix_world)[:3, :3].T
    heights = [float(np.array(item.matrix_world.translation) @ axes[1]) for item in captions]
    for item, height in zip(captions, heights, strict=True):
        step = axes[1] * (min(heights) - height)
        sunk = 2.0 * item.data.size - float(item.matrix_world.translation.z + step[2])
        step = step + axes[2] * max(0.0, sunk) / axes[2, 2]
        item.matrix_world = Matrix.Translation(Vector(step)) @ item.matrix_world
    bpy.context.view_layer.update()


def colour_bar(colours: Array, under: bpy.types.Object) -> bpy.types.Object:
    """A bar of linear colours (n, 4) from left to right, facing the camera, just above a caption."""
    size = under.data.size
    x = np.linspace(-4.0, 4.0, len(colours)) * size
    rows = [np.column_stack([x, np.full(len(x), y * size), np.zeros(len(x))]) for y in (1.05, 1.4)]
    i = np.arange(len(x) - 1)
    below, above = np.column_stack([i, i + 1, len(x) + i + 1]), np.column_stack([i, len(x) + i + 1, len(x) + i])
    bar = add_mesh("Colour bar", np.concatenate(rows), np.concatenate([below, above]))
    layer = bar.data.color_attributes.new("Heat", "FLOAT_COLOR", "POINT")
    layer.data.foreach_set("color", np.tile(colours, (2, 1)).astype(np.float32).ravel())
    bar.data.materials.append(attribute_material("Heat bar", layer.name, 1.0))
    bar.matrix_world = under.matrix_world.copy()
    bar.visible_shadow = False
    bpy.context.view_layer.update()
    return bar


def render(path: str) -> None:
    bpy.context.scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
