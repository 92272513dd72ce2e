# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft transfer --what texture` of images made of UDIM tiles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograft.files import read_mesh
from isograft.formats.images import read_image, write_image
from isograft.formats.mesh_output import MeshOutput, write_ply_mesh
from isograft.formats.tiles import has_tiles, is_tiled, tile_path
from isograft.transfer import Channel
from seamed_shapes import COARSE, DONORS, SHAPES
from test_cli_textures import SIZE, expected, paint, pixels, transfer
from transfer_files import assert_refused, run, save, save_map

pytest.importorskip("PIL")

# Rows of the receiver's image that lie where the images end, within a texel and the four pixels around.
AWAY = np.minimum(np.arange(SIZE) % (SIZE // 2), SIZE // 2 - 1 - np.arange(SIZE) % (SIZE // 2)) >= 2


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The donor's lower half in tile 1001, the upper one to the right above it; plain.obj has both in one square."""
    vertices, faces, uv = SHAPES["cylinder"](*DONORS["cylinder"])
    receiver = SHAPES["cylinder"](*COARSE["cylinder"], turn=0.37)
    save(tmp_path / "plain.obj", (vertices, faces, uv), quads=True)
    upper = uv[..., 1].mean(axis=1) > 0.5
    save(tmp_path / "donor.obj", (vertices, faces, uv * [1, 2] + upper[:, None, None] * [1, 0]), quads=True)
    save(tmp_path / "bare.obj", receiver, uvs=False, quads=True)
    save(tmp_path / "mapped.obj", receiver)
    mesh = read_mesh(tmp_path / "donor.obj")
    save_map(tmp_path / "map.npz", receiver, (mesh.vertices, mesh.faces))
    for seed, number in enumerate((1001, 1012)):
        # Tiles may differ in size.
        write_image(tmp_path / f"skin.{number}.png", pixels(seed, SIZE // 2, SIZE * (seed + 1), 3))
        write_image(tmp_path / f"skin_{('u1_v1', 'u2_v2')[seed]}.png", pixels(seed, SIZE // 2, SIZE * (seed + 1), 3))
    return tmp_path


def whole(folder: Path) -> np.ndarray:
    """Both tiles in one image, pixels of the lower one twice as wide."""
    low, high = (read_image(folder / f"skin.{number}.png") for number in (1001, 1012))
    return np.concatenate([np.repeat(low, 2, axis=1), high])


def assert_shows_both(folder: Path, found: np.ndarray) -> None:
    """The upper half bit for bit, the lower one but for what lies between its pixels: repeated ones are wider."""
    uv = read_mesh(folder / "plain.obj").triangle_uvs
    wanted = expected(folder, Channel(whole(folder), uv=uv))
    upper = AWAY & (np.arange(SIZE) >= SIZE // 2)
    assert upper.sum() > SIZE // 3
    np.testing.assert_array_equal(found[upper], wanted[upper])
    low = read_image(folder / "skin.1001.png")
    lower = AWAY & (np.arange(SIZE) < SIZE // 2)
    wanted = expected(folder, Channel(np.concatenate([low, low]), uv=uv))
    np.testing.assert_array_equal(found[lower], wanted[lower])


@pytest.mark.parametrize("name", ["skin.<UDIM>.png", "skin_<UVTILE>.png"])
def test_every_face_is_read_in_its_own_tile(folder: Path, name: str) -> None:
    paint(folder, "newmtl skin", f"map_Kd {name}")
    assert transfer(folder) == 0
    assert_shows_both(folder, read_image(folder / "out.png"))


def test_one_image_of_tiles_is_given_by_hand_or_named_by_a_ply(folder: Path) -> None:
    assert transfer(folder, "--texture", str(folder / "skin.<UDIM>.png")) == 0
    assert_shows_both(folder, read_image(folder / "out.png"))
    mesh = read_mesh(folder / "donor.obj")
    given = MeshOutput(mesh.vertices, mesh.polygons.sizes, mesh.polygons.corners, corner_uvs=mesh.corner_uvs)
    write_ply_mesh(folder / "donor.ply", given, "skin.<UDIM>.png")
    options = ("--what", "texture", "--size", str(SIZE), "--texture-output", str(folder / "ply.png"))
    assert run(folder, "mapped.obj", *options, out="new.obj", donor="donor.ply") == 0
    found, other = (read_image(folder / name).astype(int) for name in ("ply.png", "out.png"))
    # A PLY has texture coordinates of 32 bits.
    assert np.abs(found - other)[AWAY].max() <= 1


def test_tiles_and_single_images_and_numbers_stand_side_by_side(folder: Path) -> None:
    half = 144
    paint(
        folder, "newmtl skin", "map_Kd skin.<UDIM>.png", "Pr 0.25", "newmtl plain", "Kd 0 1 0", "map_Pr rough.png",
        materials={0: "skin", half: "plain"},
    )  # fmt: skip
    write_image(folder / "rough.png", pixels(5, 8, 8, 1))
    assert transfer(folder) == 0
    mesh = read_mesh(folder / "donor.obj")
    material = (mesh.triangle_polygon >= half).astype(np.int32)
    tile = (mesh.triangle_uvs[..., 1].mean(axis=1) > 1).astype(np.int32)
    low, high = (read_image(folder / f"skin.{number}.png") for number in (1001, 1012))
    green, dull = np.array([0, 255, 0], np.uint8), np.array([64], np.uint8)
    for word, images in {
        "": [low, high, green, green],
        "_roughness": [dull, dull, *2 * [read_image(folder / "rough.png")]],
    }.items():
        wanted = expected(folder, Channel(images), donor_materials=2 * material + tile)
        np.testing.assert_array_equal(read_image(folder / f"out{word}.png"), wanted, err_msg=word)


def test_faces_across_tiles_are_told(folder: Path, capsys: Any) -> None:
    paint(folder, "newmtl skin", "map_Kd -o 0.5 0 0 skin.<UDIM>.png")
    for number in (1002, 1011, 1013):
        write_image(folder / f"skin.{number}.png", pixels(number, 4, 4, 3))
    assert transfer(folder) == 0
    assert (
        "faces reach from one UDIM tile into another; each is read in that of its middle" not in capsys.readouterr().err
    )
    paint(folder, "newmtl skin", "map_Kd -o 0.52 0 0 skin.<UDIM>.png")
    assert transfer(folder) == 0
    # One face of the 24 around in each of the 12 rows.
    assert "map_Kd of the material skin: 12 faces reach from one UDIM tile into another" in capsys.readouterr().err


REFUSALS = [
    ("map_Kd lost.<UDIM>.png", "names the image lost.<UDIM>.png, which is not there; put it there"),
    ("map_Kd -o 1 0 0 skin.<UDIM>.png", "map_Kd of the material skin has no tile 1002 (skin.1002.png), and faces lie"),
    ("map_Kd -o -1 0 0 skin.<UDIM>.png", "faces lie left of or below tile 1001, or right of 1010"),
    ("map_Kd -o 9 0 0 skin.<UDIM>.png", "faces lie left of or below tile 1001, or right of 1010"),
    ("map_Kd ../skin_<UVTILE>.png", "which is not there"),
]


@pytest.mark.parametrize(("line", "words"), REFUSALS, ids=[line for line, _ in REFUSALS])
def test_tiles_that_are_not_there_are_refused(folder: Path, capsys: Any, line: str, words: str) -> None:
    paint(folder, "newmtl skin", line)
    assert_refused(folder, capsys, ["--what", "uv,texture"], words)


def test_no_tile_is_written_over(folder: Path, capsys: Any) -> None:
    paint(folder, "newmtl skin", "map_Kd skin.<UDIM>.png")
    given = (folder / "skin.1012.png").read_bytes()
    options = ["--what", "uv,texture", "--texture-output", str(folder / "skin.1012.png")]
    assert_refused(folder, capsys, options, "would be written over, and is read")
    assert (folder / "skin.1012.png").read_bytes() == given


def test_names_of_tiles(tmp_path: Path) -> None:
    assert is_tiled("a/b.<udim>.png") and is_tiled("b<UVTILE>.exr") and not is_tiled("<UDIM>/b.1001.png")
    assert tile_path(Path("a/b.<UDIM>.png"), 1010) == Path("a/b.1010.png")
    assert tile_path(Path("b_<UVTILE>.png"), 1010) == Path("b_u10_v1.png")
    assert tile_path(Path("b_<UVTILE>.png"), 1021) == Path("b_u1_v3.png")
    for name in ("b+1005.png", "b+105.png", "bb1005.png"):
        assert not has_tiles(tmp_path / "b+<UDIM>.png")
        (tmp_path / name).touch()
        assert has_tiles(tmp_path / "b+<UDIM>.png") == (name == "b+1005.png")
        (tmp_path / name).unlink()
    assert not has_tiles(tmp_path / "none" / "b.<UDIM>.png")
