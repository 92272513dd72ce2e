# SPDX-License-Identifier: GPL-3.0-or-later
"""object.isograft_bake: the donor's images in the receiver's own UVs."""

from typing import Any

import bpy
import numpy as np
import pytest
import shapes
from scenes import MatchedPair, add_uv, filled_around, select, snapshot, uvs, values
from textures import atlas, image_at, material, new_image, pixels_of, texture

SIZE = 128


@pytest.fixture
def textured(matched: MatchedPair) -> MatchedPair:
    """A matched pair: the donor shows its atlas, the receiver has an atlas of its own of the same layout."""
    made, shader = material("Skin")
    texture(made, new_image("Paint", atlas(SIZE)), shader.inputs["Base Color"])
    shader.inputs["Roughness"].default_value = 0.25
    matched.donor.data.materials.append(made)
    give_uv(matched)
    return matched


def give_uv(matched: MatchedPair) -> None:
    """The receiver's own UV map: where the donor's has a direction, it has it too."""
    vertices = np.array([loop.vertex_index for loop in matched.receiver.data.loops])
    uv, _ = shapes.cube_uv(matched.directions[vertices].reshape(-1, 4, 3))
    add_uv(matched.receiver, "Own", uv.reshape(-1, 2))


def bake(matched: MatchedPair, **settings: Any) -> Any:
    """Bake; returns the receiver's last material."""
    select(matched.donor, matched.receiver)
    assert bpy.ops.object.isograft_bake(size=SIZE, margin=2, **settings) == {"FINISHED"}
    return matched.receiver.data.materials[-1]


def inside(matched: MatchedPair, name: str, size: int = SIZE) -> np.ndarray:
    """(size, size) True for texels at the centre of a matched receiver face in its UV map."""
    face = values(matched.receiver, "isograft_face", "value")
    vertices = np.array([loop.vertex_index for loop in matched.receiver.data.loops]).reshape(-1, 4)
    whole = (face[vertices] >= 0).all(axis=1)
    centre = uvs(matched.receiver, name).reshape(-1, 4, 2).mean(axis=1)[whole]
    texel = np.clip((centre * size).astype(int), 0, size - 1)
    mask = np.zeros((size, size), dtype=bool)
    mask[texel[:, 1], texel[:, 0]] = True
    return mask


def test_a_material_of_every_kind_of_subsurface_is_baked(textured: MatchedPair) -> None:
    """Which of them it is decides which inputs a Principled material shows."""
    shader = textured.donor.data.materials[0].node_tree.nodes["Principled BSDF"]
    kinds = [item.identifier for item in shader.bl_rna.properties["subsurface_method"].enum_items]
    assert len(kinds) >= 3
    shown = set()
    for kind in kinds:
        shader.subsurface_method = kind
        shown.add("Subsurface IOR" in shader.inputs)
        if "Subsurface IOR" in shader.inputs:
            shader.inputs["Subsurface IOR"].default_value = 1.7
        made = bake(textured).node_tree.nodes["Principled BSDF"]
        assert made.subsurface_method == kind
        assert {item.name for item in made.inputs} == {item.name for item in shader.inputs}
        if "Subsurface IOR" in made.inputs:
            assert made.inputs["Subsurface IOR"].default_value == pytest.approx(1.7)
    assert True in shown


def test_an_input_that_the_first_material_has_not_is_told(
    textured: MatchedPair, capfd: pytest.CaptureFixture[str]
) -> None:
    first = textured.donor.data.materials[0].node_tree.nodes["Principled BSDF"]
    kinds = [item.identifier for item in first.bl_rna.properties["subsurface_method"].enum_items]
    made, second = material("Other")
    texture(made, new_image("Other paint", atlas(SIZE)), second.inputs["Base Color"])
    for kind in kinds:
        second.subsurface_method = kind
        if "Subsurface IOR" in second.inputs and second.inputs["Subsurface IOR"].enabled:
            break
    hidden = [kind for kind in kinds if not _shows(first, kind)]
    if not hidden:
        pytest.skip("this Blender shows the input in every kind")
    first.subsurface_method = hidden[0]
    texture(made, new_image("IOR", atlas(SIZE)), second.inputs["Subsurface IOR"])
    textured.donor.data.materials.append(made)
    textured.donor.data.polygons[0].material_index = 1
    bake(textured)
    assert "Subsurface IOR of the material Other is left out" in capfd.readouterr().out


def _shows(shader: Any, kind: str) -> bool:
    shader.subsurface_method = kind
    return "Subsurface IOR" in shader.inputs


def test_the_base_colour_arrives_in_the_receivers_own_map(textured: MatchedPair) -> None:
    donor = snapshot(textured.donor)
    made = bake(textured)
    image = image_at(made, "Base Color")
    assert tuple(image.size) == (SIZE, SIZE)
    assert not image.is_float
    assert image.packed_file is not None
    assert image.colorspace_settings.name == "sRGB"
    mask = inside(textured, "Own")
    assert mask.sum() > 500
    error = np.abs(pixels_of(image) - atlas(SIZE))[mask][:, :3]
    # Matched points lie within a few percent of the truth, over which the colour drifts by as much.
    assert np.median(error) < 0.02
    assert np.quantile(error, 0.9) < 0.1
    assert made.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value == pytest.approx(0.25)
    assert snapshot(textured.donor) == donor


def test_faces_without_a_match_keep_their_material(textured: MatchedPair) -> None:
    own, _ = material("Own")
    textured.receiver.data.materials.append(own)
    face = np.where(textured.directions[:, 2] > 0.8, -1, values(textured.receiver, "isograft_face", "value"))
    textured.receiver.data.attributes["isograft_face"].data.foreach_set("value", face.astype(np.int32))
    made = bake(textured)
    assert list(textured.receiver.data.materials) == [own, made]
    index = np.array([polygon.material_index for polygon in textured.receiver.data.polygons])
    vertices = np.array([tuple(polygon.vertices) for polygon in textured.receiver.data.polygons])
    assert np.array_equal(index == 1, (face[vertices] >= 0).all(axis=1))


def test_every_image_textured_input_is_baked_and_shown_alike(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    shader = made.node_tree.nodes["Principled BSDF"]
    grey = np.repeat(atlas(SIZE)[..., :1], 4, axis=2)
    grey[..., 3] = 1.0
    texture(made, new_image("Rough", grey, space="Non-Color"), shader.inputs["Roughness"])
    flat = np.broadcast_to([0.5, 0.5, 1.0, 1.0], (8, 8, 4))
    texture(made, new_image("Bumps", flat, space="Non-Color"), shader.inputs["Normal"], "ShaderNodeNormalMap")
    orm = new_image("ORM", np.broadcast_to([0.1, 0.2, 0.7, 1.0], (8, 8, 4)), space="Non-Color")
    nodes, links = made.node_tree.nodes, made.node_tree.links
    node = nodes.new("ShaderNodeTexImage")
    node.image = orm
    parts = nodes.new("ShaderNodeSeparateColor")
    links.new(node.outputs["Color"], parts.inputs[0])
    links.new(parts.outputs[2], shader.inputs["Metallic"])
    baked = bake(textured)
    mask = inside(textured, "Own")
    rough, metal, normal = (pixels_of(image_at(baked, name))[mask] for name in ("Roughness", "Metallic", "Normal"))
    assert np.median(np.abs(rough[:, 0] - grey[mask][:, 0])) < 0.02
    assert np.allclose(metal[:, :3], 0.7, atol=0.005)
    assert np.allclose(normal[:, :3], [0.5, 0.5, 1.0], atol=0.01)
    assert image_at(baked, "Roughness").colorspace_settings.name == "Non-Color"
    link = baked.node_tree.nodes["Principled BSDF"].inputs["Normal"].links[0].from_node
    assert (link.type, link.uv_map) == ("NORMAL_MAP", "Own")


def test_a_normal_map_is_turned_into_the_receivers_frames(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    shader = made.node_tree.nodes["Principled BSDF"]
    tilted = np.broadcast_to([0.8, 0.5, 0.9, 1.0], (8, 8, 4))
    texture(made, new_image("Tilt", tilted, space="Non-Color"), shader.inputs["Normal"], "ShaderNodeNormalMap")
    uv = uvs(textured.receiver, "Own")
    quarter = np.stack([1.0 - uv[:, 1], uv[:, 0]], axis=1).astype(np.float32)
    textured.receiver.data.uv_layers["Own"].data.foreach_set("uv", quarter.ravel())
    baked = bake(textured)
    found = pixels_of(image_at(baked, "Normal"))[inside(textured, "Own")]
    # What leans along the donor's u leans along the receiver's v, a quarter turn on.
    assert np.median(found[:, 0]) == pytest.approx(0.5, abs=0.1)
    assert np.median(found[:, 1]) == pytest.approx(0.8, abs=0.1)
    assert np.median(found[:, 2]) == pytest.approx(0.9, abs=0.05)


def test_float_images_stay_float_and_keep_what_lies_above_one(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    node = next(node for node in made.node_tree.nodes if node.type == "TEX_IMAGE")
    node.image = new_image("Bright", 4.0 * atlas(SIZE), is_float=True)
    baked = image_at(bake(textured), "Base Color")
    assert baked.is_float
    mask = inside(textured, "Own")
    assert np.median(np.abs(pixels_of(baked) - 4.0 * atlas(SIZE))[mask][:, :3]) < 0.08


def test_a_byte_image_becomes_linear_when_float_is_asked_for(textured: MatchedPair) -> None:
    baked = image_at(bake(textured, float_images=True), "Base Color")
    assert baked.is_float
    encoded = atlas(SIZE)[..., :3]
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    mask = inside(textured, "Own")
    assert np.median(np.abs(pixels_of(baked)[..., :3] - linear)[mask]) < 0.03


def test_several_materials_end_in_one_with_the_constants_painted_in(textured: MatchedPair) -> None:
    plain, shader = material("Plain")
    shader.inputs["Base Color"].default_value = (0.0, 1.0, 0.0, 1.0)
    shader.inputs["Roughness"].default_value = 0.75
    textured.donor.data.materials.append(plain)
    centres = np.array([tuple(polygon.center) for polygon in textured.donor.data.polygons])
    textured.donor.data.polygons.foreach_set("material_index", (centres[:, 0] > 0).astype(np.int32))
    textured.donor.data.update()
    baked = bake(textured)
    mask = inside(textured, "Own")
    direction = (atlas(SIZE)[mask][:, :3] - 0.5) / 0.45
    color, rough = (pixels_of(image_at(baked, name))[mask] for name in ("Base Color", "Roughness"))
    green, clear = direction[:, 0] > 0.1, np.abs(direction[:, 0]) > 0.1
    assert np.mean(np.isclose(color[green][:, :3], [0, 1, 0], atol=0.01).all(axis=1)) > 0.95
    assert np.mean(np.isclose(rough[clear][:, 0], np.where(green[clear], 0.75, 0.25), atol=0.01)) > 0.95


@pytest.mark.parametrize("source", ["TRANSFERRED", "UNWRAP"])
def test_a_receiver_without_a_map_gets_one_and_shows_the_same_colours(textured: MatchedPair, source: str) -> None:
    textured.receiver.data.uv_layers.remove(textured.receiver.data.uv_layers["Own"])
    baked = bake(textured, uv_source=source)
    name = {"TRANSFERRED": "Atlas", "UNWRAP": "Baked"}[source]
    assert [layer.name for layer in textured.receiver.data.uv_layers] == [name]
    place = next(node for node in baked.node_tree.nodes if node.type == "UVMAP")
    assert place.uv_map == name
    pixels = pixels_of(image_at(baked, "Base Color"))
    face = values(textured.receiver, "isograft_face", "value")
    vertices = np.array([loop.vertex_index for loop in textured.receiver.data.loops]).reshape(-1, 4)
    whole = (face[vertices] >= 0).all(axis=1)
    uv = uvs(textured.receiver, name).reshape(-1, 4, 2).mean(axis=1)[whole]
    texel = np.clip((uv * SIZE).astype(int), 0, SIZE - 1)
    truth = shapes.point_color(textured.directions[vertices].mean(axis=1)[whole])
    assert np.median(np.abs(pixels[texel[:, 1], texel[:, 0]] - truth)[:, :3]) < 0.03
    assert [obj.name for obj in bpy.context.selected_objects] == ["Donor", "Scan"]
    assert sorted(bpy.data.meshes.keys()) == ["Donor", "Scan"]


def test_baking_again_adds_a_material_or_overwrites_it_when_asked(textured: MatchedPair) -> None:
    first = bake(textured)
    second = bake(textured)
    assert {first.name, second.name} == {"Scan baked", "Scan baked.001"}
    images = len(bpy.data.images)
    bake(textured, overwrite=True)
    assert len(bpy.data.images) == images
    assert sorted(m.name for m in textured.receiver.data.materials if m) == ["Scan baked", "Scan baked.001"]


def test_a_mapping_node_is_followed(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    nodes, links = made.node_tree.nodes, made.node_tree.links
    node = next(node for node in nodes if node.type == "TEX_IMAGE")
    pixels = atlas(SIZE)
    node.image = new_image("Turned", np.rot90(pixels, 2))
    place, mapping = nodes.new("ShaderNodeUVMap"), nodes.new("ShaderNodeMapping")
    place.uv_map = "Atlas"
    mapping.inputs["Rotation"].default_value[2] = np.pi
    mapping.inputs["Location"].default_value[:2] = (1.0, 1.0)
    links.new(place.outputs[0], mapping.inputs["Vector"])
    links.new(mapping.outputs[0], node.inputs["Vector"])
    mask = inside(textured, "Own")
    assert np.median(np.abs(pixels_of(image_at(bake(textured), "Base Color")) - pixels)[mask][:, :3]) < 0.02


def in_group(made: Any, source: Any, socket: Any) -> Any:
    """A node group that hands its input on to its output, between an output and an input."""
    tree = bpy.data.node_groups.new("Through", "ShaderNodeTree")
    if hasattr(tree, "interface"):
        for direction in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Colour", in_out=direction, socket_type="NodeSocketColor")
    else:
        tree.inputs.new("NodeSocketColor", "Colour")
        tree.outputs.new("NodeSocketColor", "Colour")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(start.outputs[0], end.inputs[0])
    node = made.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = tree
    if source is not None:
        made.node_tree.links.new(source, node.inputs[0])
    made.node_tree.links.new(node.outputs[0], socket)
    return node


def test_images_and_constants_come_through_node_groups(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    shader = made.node_tree.nodes["Principled BSDF"]
    picture = next(node for node in made.node_tree.nodes if node.type == "TEX_IMAGE")
    in_group(made, picture.outputs["Color"], shader.inputs["Base Color"])
    in_group(made, None, shader.inputs["Roughness"]).inputs[0].default_value = (0.6, 0.6, 0.6, 1.0)
    baked = bake(textured)
    error = np.abs(pixels_of(image_at(baked, "Base Color")) - atlas(SIZE))[inside(textured, "Own")][:, :3]
    assert np.median(error) < 0.02
    assert baked.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value == pytest.approx(0.6)


def test_muted_nodes_are_passed_by(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    nodes, links = made.node_tree.nodes, made.node_tree.links
    picture = next(node for node in nodes if node.type == "TEX_IMAGE")
    invert = nodes.new("ShaderNodeInvert")
    links.new(picture.outputs["Color"], invert.inputs["Color"])
    links.new(invert.outputs[0], nodes["Principled BSDF"].inputs["Base Color"])
    invert.mute = True
    error = np.abs(pixels_of(image_at(bake(textured), "Base Color")) - atlas(SIZE))[inside(textured, "Own")][:, :3]
    assert np.median(error) < 0.02


def test_unmatched_faces_are_filled_on_request_and_marked(textured: MatchedPair) -> None:
    hole = textured.directions @ np.array([-0.7, 0.6, 0.39]) > 0.9
    face = np.where(hole, -1, values(textured.receiver, "isograft_face", "value")).astype(np.int32)
    textured.receiver.data.attributes["isograft_face"].data.foreach_set("value", face)
    bake(textured)
    assert "isograft_filled" not in textured.receiver.data.attributes
    made = bake(textured, fill=True, overwrite=True)
    filled = values(textured.receiver, "isograft_filled", "value").astype(bool)
    assert np.array_equal(filled[hole], np.ones(hole.sum(), bool))
    assert not filled[~filled_around(textured.receiver, face < 0)].any()
    vertices = np.array([loop.vertex_index for loop in textured.receiver.data.loops]).reshape(-1, 4)
    inner = hole[vertices].all(axis=1)
    texel = (uvs(textured.receiver, "Own").reshape(-1, 4, 2).mean(axis=1)[inner] * SIZE).astype(int)
    error = np.abs(pixels_of(image_at(made, "Base Color")) - atlas(SIZE))[texel[:, 1], texel[:, 0], :3]
    # The colour is smooth over the sphere: what is around the hole tells what is in it.
    assert error.max() < 0.2
    slots = np.array([polygon.material_index for polygon in textured.receiver.data.polygons])
    assert len(set(slots[inner])) == 1
    assert textured.receiver.data.materials[slots[inner][0]] == made
