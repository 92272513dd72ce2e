# SPDX-License-Identifier: GPL-3.0-or-later
"""What cannot be baked is refused with words that name the object, and changes nothing."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from scenes import MatchedPair, add_uv, select
from test_bake import give_uv
from test_refusals import refused
from textures import atlas, material, new_image, texture


@pytest.fixture
def textured(matched: MatchedPair) -> MatchedPair:
    """A matched pair with an image on the donor and a UV map on the receiver."""
    made, shader = material("Skin")
    texture(made, new_image("Paint", atlas(16)), shader.inputs["Base Color"])
    matched.donor.data.materials.append(made)
    give_uv(matched)
    select(matched.donor, matched.receiver)
    return matched


def bake(**settings: Any) -> None:
    bpy.ops.object.isograft_bake(size=32, **settings)


def skin(pair: MatchedPair) -> Any:
    return next(node for node in pair.donor.data.materials[0].node_tree.nodes if node.type == "TEX_IMAGE")


def test_a_missing_file_is_named_with_its_image_and_material(textured: MatchedPair, tmp_path: Path) -> None:
    image = bpy.data.images.new("Lost", 4, 4)
    image.source, image.filepath = "FILE", str(tmp_path / "lost.png")
    skin(textured).image = image
    with refused("Donor, Base Color of the material Skin: the image Lost cannot be read from .*lost.png; find it"):
        bake()


def test_an_image_packed_in_an_unknown_format_is_refused(textured: MatchedPair) -> None:
    image = bpy.data.images.new("Odd", 4, 4)
    image.pack(data=b"no image at all", data_len=15)
    image.source = "FILE"
    image.reload()
    skin(textured).image = image
    with refused("the image Odd is packed in a format that Blender cannot read; replace it"):
        bake()


def test_a_node_without_an_image_is_refused(textured: MatchedPair) -> None:
    skin(textured).image = None
    with refused("Donor: Base Color of the material Skin: the node Image Texture has no image"):
        bake()


@pytest.mark.parametrize("source", ["SEQUENCE", "MOVIE"])
def test_images_that_are_no_single_picture_are_refused(textured: MatchedPair, source: str) -> None:
    skin(textured).image.source = source
    with refused("the image Paint is a (sequence|movie)"):
        bake()


def test_an_image_behind_other_nodes_is_refused(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    nodes, links = made.node_tree.nodes, made.node_tree.links
    hue = nodes.new("ShaderNodeHueSaturation")
    links.new(skin(textured).outputs["Color"], hue.inputs["Color"])
    links.new(hue.outputs[0], nodes["Principled BSDF"].inputs["Base Color"])
    with refused("the image Paint goes through the node Hue"):
        bake()


def test_a_colour_ramp_between_image_and_shader_is_refused(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    nodes, links = made.node_tree.nodes, made.node_tree.links
    ramp = nodes.new("ShaderNodeValToRGB")
    links.new(skin(textured).outputs["Color"], ramp.inputs[0])
    links.new(ramp.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    with refused("Donor: Base Color of the material Skin: the image Paint goes through the node Color ?Ramp; connect"):
        bake()


def test_a_normal_map_whose_image_is_turned_alone_is_refused(textured: MatchedPair) -> None:
    made = textured.donor.data.materials[0]
    nodes, links = made.node_tree.nodes, made.node_tree.links
    node = texture(made, new_image("Tilt", atlas(16)), nodes["Principled BSDF"].inputs["Normal"], "ShaderNodeNormalMap")
    place, turn = nodes.new("ShaderNodeUVMap"), nodes.new("ShaderNodeMapping")
    turn.inputs["Rotation"].default_value[2] = 0.5
    links.new(place.outputs[0], turn.inputs["Vector"])
    links.new(turn.outputs[0], node.inputs["Vector"])
    with refused("Normal of the material Skin is turned or mirrored by a Mapping node"):
        bake()
    turn.inputs["Rotation"].default_value[2] = 0.0
    bump = next(node for node in nodes if node.type == "NORMAL_MAP")
    bump.uv_map = "Elsewhere"
    with refused("takes its tangents from the UV map Elsewhere and its image from Atlas"):
        bake()


def no_material(pair: MatchedPair) -> None:
    pair.donor.data.materials.clear()


def no_shader(pair: MatchedPair) -> None:
    nodes = pair.donor.data.materials[0].node_tree.nodes
    nodes.remove(nodes["Principled BSDF"])


def no_image(pair: MatchedPair) -> None:
    made = pair.donor.data.materials[0]
    made.node_tree.nodes.remove(skin(pair))


def no_donor_map(pair: MatchedPair) -> None:
    pair.donor.data.uv_layers.remove(pair.donor.data.uv_layers["Atlas"])
    pair.donor.data.update()


def no_receiver_map(pair: MatchedPair) -> None:
    pair.receiver.data.uv_layers.remove(pair.receiver.data.uv_layers["Own"])


def other_map(pair: MatchedPair) -> None:
    made = pair.donor.data.materials[0]
    place = made.node_tree.nodes.new("ShaderNodeUVMap")
    place.uv_map = "Gone"
    made.node_tree.links.new(place.outputs[0], skin(pair).inputs["Vector"])


def generated(pair: MatchedPair) -> None:
    made = pair.donor.data.materials[0]
    place = made.node_tree.nodes.new("ShaderNodeTexCoord")
    made.node_tree.links.new(place.outputs["Object"], skin(pair).inputs["Vector"])


def edited(pair: MatchedPair) -> None:
    pair.donor.data.vertices[3].co.z += 0.01
    pair.donor.data.update()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (no_material, "Donor has no material"),
        (no_shader, "Donor: the material Skin has no Principled BSDF at its output"),
        (no_image, "Donor: no material of it has an image"),
        (no_donor_map, "Donor has no UV map that would place its images"),
        (no_receiver_map, "Scan has no UV map to bake into; choose the donor's, or a new unwrap"),
        (other_map, "the material Skin asks for a UV map called Gone"),
        (generated, "its image is placed by the node Texture Coordinate, not by a UV map"),
        (edited, "Donor was edited after Scan was matched to it; run Match again"),
    ],
)
def test_what_is_not_there_is_named(textured: MatchedPair, change: Callable[[Any], None], words: str) -> None:
    change(textured)
    with refused(words):
        bake()


def test_an_unknown_map_of_the_receiver_is_refused_with_those_there_are(textured: MatchedPair) -> None:
    with refused("Scan has no UV map called Other; it has: Own"):
        bake(uv_map="Other")


def test_a_map_on_which_nothing_lies_is_refused(textured: MatchedPair) -> None:
    loops = len(textured.receiver.data.loops)
    add_uv(textured.receiver, "Flat", np.full((loops, 2), 5.0))
    with refused("Scan: no texel of its UV map lies on a matched face"):
        bake(uv_map="Flat")


def test_a_full_set_of_uv_maps_is_refused(textured: MatchedPair) -> None:
    for number in range(7):
        add_uv(textured.receiver, f"Map {number}", np.zeros((len(textured.receiver.data.loops), 2)))
    with refused("Scan has 8 UV maps already"):
        bake(uv_source="UNWRAP")
