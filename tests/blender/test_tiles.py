# SPDX-License-Identifier: GPL-3.0-or-later
"""Donor images with UDIM tiles."""

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from conftest import add_on
from scenes import MatchedPair, select, uvs
from test_bake import SIZE, bake, inside, textured
from test_refusals import refused
from textures import atlas, image_at, pixels_of, tiled_image

__all__ = ["textured"]


def negative(size: int) -> np.ndarray:
    """The atlas with its colours turned over: another picture at every place."""
    pixels = atlas(size)
    pixels[..., :3] = 1.0 - pixels[..., :3]
    return pixels


@pytest.fixture
def tiled(textured: MatchedPair) -> MatchedPair:
    """The donor's upper row of islands lies in tile 1012, one to the right and one up."""
    uv = uvs(textured.donor, "Atlas")
    upper = np.repeat(uv.reshape(-1, 3, 2).mean(axis=1)[:, 1] > 0.5, 3)
    textured.donor.data.uv_layers["Atlas"].data.foreach_set("uv", (uv + upper[:, None]).astype(np.float32).ravel())
    textured.donor.data.update()
    return textured


def show(matched: MatchedPair, image: Any) -> None:
    nodes = matched.donor.data.materials[0].node_tree.nodes
    next(node for node in nodes if node.type == "TEX_IMAGE").image = image


@pytest.mark.parametrize("is_packed", [False, True])
def test_every_face_is_read_in_its_own_tile(tiled: MatchedPair, tmp_path: Path, is_packed: bool) -> None:
    show(tiled, tiled_image(tmp_path, {1001: atlas(SIZE), 1012: negative(2 * SIZE)}, is_packed))
    names = sorted(bpy.data.images.keys())
    image = image_at(bake(tiled), "Base Color")
    assert sorted(bpy.data.images.keys()) == sorted([*names, image.name])
    assert not image.is_float
    found, mask = pixels_of(image)[..., :3], inside(tiled, "Own")
    upper = mask & (np.arange(SIZE) >= SIZE // 2)[:, None]
    assert min(upper.sum(), (mask & ~upper).sum()) > 200
    # As for one image: matched points lie within a few percent of the truth, over which the colour drifts by as much.
    for part, truth in ((mask & ~upper, atlas(SIZE)), (upper, negative(SIZE))):
        error = np.abs(found - truth[..., :3])[part]
        assert np.median(error) < 0.02
        assert np.quantile(error, 0.9) < 0.1


def test_tiles_and_single_images_and_constants_stand_side_by_side(tiled: MatchedPair, tmp_path: Path) -> None:
    shader = tiled.donor.data.materials[0].node_tree.nodes["Principled BSDF"]
    plain = bpy.data.materials.new("Plain")
    plain.use_nodes = True
    plain.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.0, 1.0, 0.0, 1.0)
    plain.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.75
    shader.inputs["Roughness"].default_value = 0.25
    tiled.donor.data.materials.append(plain)
    centres = np.array([tuple(polygon.center) for polygon in tiled.donor.data.polygons])
    tiled.donor.data.polygons.foreach_set("material_index", (centres[:, 0] > 0).astype(np.int32))
    tiled.donor.data.update()
    show(tiled, tiled_image(tmp_path, {1001: atlas(SIZE), 1012: negative(SIZE)}, True))
    baked = bake(tiled)
    mask = inside(tiled, "Own")
    upper = np.broadcast_to((np.arange(SIZE) >= SIZE // 2)[:, None], mask.shape)
    direction = (atlas(SIZE)[..., :3] - 0.5) / 0.45
    color, rough = (pixels_of(image_at(baked, name)) for name in ("Base Color", "Roughness"))
    green, clear = mask & (direction[..., 0] > 0.1), mask & (direction[..., 0] < -0.1)
    assert np.mean(np.isclose(color[green][:, :3], [0, 1, 0], atol=0.01).all(axis=1)) > 0.95
    assert np.mean(np.isclose(rough[green][:, 0], 0.75, atol=0.01)) > 0.95
    truth = np.where(upper[..., None], negative(SIZE), atlas(SIZE))
    assert np.median(np.abs(color - truth)[clear][:, :3]) < 0.02
    assert np.mean(np.isclose(rough[clear][:, 0], 0.25, atol=0.01)) > 0.95


def test_faces_out_of_the_unit_square_are_counted(tiled: MatchedPair, tmp_path: Path) -> None:
    """The donor's own UV map on the receiver has its tiles, and the receiver's image has one square."""
    show(tiled, tiled_image(tmp_path, {1001: atlas(16), 1012: atlas(16)}, True))
    baking = add_on("baking")
    for source, expected in (("TRANSFERRED", True), ("EXISTING", False)):
        settings = baking.BakeSettings(size=64, uv_source=source)
        task = baking.prepare(tiled.donor, [tiled.receiver], bpy.context, settings)
        (found,) = task.run(lambda *_: True)
        assert any("reach out of the unit square of Atlas" in text for text in found.warnings) == expected


def test_tiles_that_are_missing_or_not_saved_are_refused(tiled: MatchedPair, tmp_path: Path) -> None:
    where = "Donor, Base Color of the material Skin: the image Tiles"
    select(tiled.donor, tiled.receiver)
    show(tiled, tiled_image(tmp_path, {1001: atlas(16)}, False))
    with refused(f"{where} has no tile 1012, and faces lie there; add the tile"):
        bpy.ops.object.isograft_bake(size=64)
    show(tiled, tiled_image(tmp_path, {1001: atlas(16), 1012: atlas(16)}, False))
    (tmp_path / "tiles.1012.png").unlink()
    with refused("its tile 1012 cannot be read from .*tiles.1012.png; find it"):
        bpy.ops.object.isograft_bake(size=64)
    new = bpy.data.images.new("Fresh", 16, 16, tiled=True)
    new.tiles.new(1012)
    show(tiled, new)
    with refused("the image Fresh has UDIM tiles that are not saved; save it first"):
        bpy.ops.object.isograft_bake(size=64)


def test_faces_across_tiles_are_told_and_faces_beside_all_tiles_refused(tiled: MatchedPair, tmp_path: Path) -> None:
    show(tiled, tiled_image(tmp_path, {1001: atlas(16), 1012: atlas(16)}, True))
    layer, uv = tiled.donor.data.uv_layers["Atlas"], uvs(tiled.donor, "Atlas")
    uv[:3] = [[0.9, 0.1], [1.05, 0.1], [0.9, 0.2]]
    layer.data.foreach_set("uv", uv.ravel())
    select(tiled.donor, tiled.receiver)
    assert bpy.ops.object.isograft_bake(size=64) == {"FINISHED"}
    uv[:3] = [[-0.9, 0.1], [-0.8, 0.1], [-0.9, 0.2]]
    layer.data.foreach_set("uv", uv.ravel())
    tiled.donor.data.update()
    with refused("has no tiles left of or below 1001, nor right of 1010"):
        bpy.ops.object.isograft_bake(size=64)
