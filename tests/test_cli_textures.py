# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft transfer --what texture`: every image of the donor's materials baked, and the material that shows them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograft import cli_transfer
from isograft.correspondence import Correspondence
from isograft.files import read_mesh
from isograft.formats.images import read_image, write_image
from isograft.formats.materials import read_mtl
from isograft.formats.mesh_output import MeshOutput, write_ply_mesh
from isograft.transfer import Channel, bake
from seamed_shapes import COARSE, DONORS, SHAPES
from transfer_files import assert_refused, run, save, save_map, spoil_map

pytest.importorskip("PIL")

SIZE = 64
COLOURS = ("map_Kd", "map_Ka", "map_Ks", "map_Ke")
VALUES = ("map_Ns", "map_d", "map_Tr", "map_Pr", "map_Pm", "map_Ps", "map_Pc", "map_Pcr", "disp")
WORDS = {"map_Kd": "", "map_Pr": "_roughness", "norm": "_normal", "map_Bump": "_bump", "map_d": "_opacity"}


def pixels(seed: int, *shape: int) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (*shape,), np.uint8)


def relief() -> np.ndarray:
    """A normal map of unit normals."""
    lean = np.random.default_rng(9).uniform(-0.6, 0.6, (SIZE, SIZE, 2))
    normals = np.concatenate([lean, np.sqrt(1 - (lean**2).sum(axis=2, keepdims=True))], axis=2)
    return np.rint(255 * (0.5 + 0.5 * normals)).astype(np.uint8)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A donor of quads with images, and the receivers bare.obj and mapped.obj."""
    donor, receiver = SHAPES["cylinder"](*DONORS["cylinder"]), SHAPES["cylinder"](*COARSE["cylinder"], turn=0.37)
    save(tmp_path / "donor.obj", donor, quads=True)
    save(tmp_path / "bare.obj", receiver, uvs=False, quads=True)
    save(tmp_path / "mapped.obj", receiver)
    mesh = read_mesh(tmp_path / "donor.obj")
    save_map(tmp_path / "map.npz", receiver, (mesh.vertices, mesh.faces))
    for seed, (name, components) in enumerate({"color": 3, "grey": 1, "clear": 4}.items()):
        image = pixels(seed, SIZE, SIZE, components)
        write_image(tmp_path / f"{name}.png", image)
    write_image(tmp_path / "relief.png", relief())
    return tmp_path


def paint(folder: Path, *lines: str, materials: dict[int, str] | None = None) -> None:
    """Give the donor a library of these lines, and materials from these faces on."""
    text = [line for line in (folder / "donor.obj").read_text().splitlines() if line[:6] not in ("mtllib", "usemtl")]
    first = next(row for row, line in enumerate(text) if line.startswith("f "))
    for face, name in sorted((materials or {0: "skin"}).items(), reverse=True):
        text.insert(first + face, f"usemtl {name}")
    (folder / "donor.obj").write_text("\n".join(["mtllib donor.mtl", *text]))
    (folder / "donor.mtl").write_text("\n".join(lines) + "\n")


def expected(folder: Path, channel: Channel, receiver: str = "mapped.obj", **options: Any) -> np.ndarray:
    donor, own = read_mesh(folder / "donor.obj"), read_mesh(folder / receiver)
    baked = bake(
        Correspondence.load(folder / "map.npz"), own.vertices, own.faces, own.triangle_uvs, donor.vertices, donor.faces,
        donor.triangle_uvs, channel, SIZE, **options,
    )  # fmt: skip
    return baked.images[0]


def transfer(folder: Path, *options: str, receiver: str = "mapped.obj") -> int:
    return run(folder, receiver, "--what", "texture", "--size", str(SIZE), *options)


def test_all_images_of_a_material_are_baked_and_shown_by_a_new_one(folder: Path, capsys: Any) -> None:
    lines = [f"{name} color.png" for name in COLOURS] + [f"{name} grey.png" for name in VALUES]
    paint(
        folder,
        "newmtl skin",
        "Ns 50",
        "illum 2",
        "Kd 0.1 0.2 0.3",
        "Pr 0.3",
        *lines,
        "norm relief.png",
        "bump grey.png",
    )
    assert transfer(folder, "--json") == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["images"] == len(summary["textures"]) == len(COLOURS) + len(VALUES) + 2
    found = read_mtl(folder / "out.mtl")["isograft"]
    assert set(found.textures) == {*COLOURS, *VALUES, "norm", "map_Bump"}
    assert {str(texture.path) for texture in found.textures.values()} == set(summary["textures"])
    for name, texture in found.textures.items():
        of = "color" if name in COLOURS else "relief" if name == "norm" else "grey"
        channel = Channel(read_image(folder / f"{of}.png"), kind="normal" if name == "norm" else "color")
        np.testing.assert_array_equal(read_image(texture.path), expected(folder, channel), err_msg=name)
    # Numbers are those of the donor's material, but where an image takes the place of one.
    assert found.numbers["Ns"] == (50.0,) and found.numbers["illum"] == (2.0,)
    assert found.numbers["Kd"] == (1.0, 1.0, 1.0) and found.numbers["Pr"] == (1.0,)
    assert set(read_mesh(folder / "out.obj").layers.face["material"]) == {"isograft"}


@pytest.mark.parametrize("keyword", ["norm", "map_Bump"])
def test_normal_maps_are_turned_into_the_receivers_tangent_frames(folder: Path, keyword: str) -> None:
    paint(folder, "newmtl skin", f"{keyword} -bm 0.5 relief.png")
    vertices, faces, uv = SHAPES["cylinder"](*DONORS["cylinder"])
    mesh = read_mesh(folder / "donor.obj")
    # As large again and lying on its side, its texture coordinates mirrored: what leans to the left leans to the right.
    save(folder / "turned.obj", (2 * vertices[:, [2, 0, 1]], faces, [1, 0] + uv * [-1, 1]), quads=True)
    save_map(folder / "map.npz", (mesh.vertices, mesh.faces), (mesh.vertices, mesh.faces))
    assert transfer(folder, receiver="turned.obj") == 0
    found = read_mtl(folder / "out.mtl")["isograft"].textures[keyword]
    mirrored = relief()[:, ::-1].astype(int)
    mirrored[..., 0] = 255 - mirrored[..., 0]
    assert np.abs(read_image(found.path).astype(int) - mirrored).max() <= 1
    assert found.strength == 0.5 and found.path.name == f"out{WORDS[keyword]}.png"


def test_every_face_is_read_in_the_image_of_its_own_material(folder: Path, capsys: Any) -> None:
    half = 144
    paint(
        folder, "newmtl skin", "map_Kd color.png", "Pr 0.2", "newmtl glass", "Kd 0.25 0.5 1", "Pr 1.5",
        "map_d clear.png", "newmtl unused", "map_Kd lost.png",
        materials={0: "skin", half: "glass", 2 * half - 24: "None"},
    )  # fmt: skip
    (folder / "donor.obj").write_text((folder / "donor.obj").read_text().replace("usemtl None", "usemtl"))
    assert transfer(folder) == 0
    assert "Pr of the material glass is not between 0 and 1" in capsys.readouterr().err
    material = read_mesh(folder / "donor.obj").triangle_polygon
    material = np.select([material < half, material < 2 * half - 24], [0, 1], 2).astype(np.int32)
    clear, color = read_image(folder / "clear.png"), read_image(folder / "color.png")
    srgb = np.rint(255 * np.array([0.5371, 0.7354, 1.0])).astype(np.uint8)
    byte = [np.array([value], np.uint8) for value in (51, 255, 255)]
    for name, images in {
        "map_Kd": [color, srgb, None],
        "map_Pr": [byte[0], byte[1], None],
        "map_d": [byte[2], clear[..., 3:], None],
    }.items():
        wanted = expected(folder, Channel(images), donor_materials=material)
        np.testing.assert_array_equal(read_image(folder / f"out{WORDS[name]}.png"), wanted, err_msg=name)


def test_images_are_placed_and_taken_apart_as_their_options_say(folder: Path) -> None:
    paint(
        folder, "newmtl skin", "map_Kd -s 2 3 1 -o 0.25 0.5 -clamp on color.png", "map_Pr -imfchan g color.png",
        "map_Pm -imfchan l color.png",
    )  # fmt: skip
    assert transfer(folder) == 0
    color = read_image(folder / "color.png")
    uv = read_mesh(folder / "donor.obj").triangle_uvs * [2, 3] + [0.25, 0.5]
    wanted = expected(folder, Channel(color, uv=uv, extension="extend"))
    np.testing.assert_array_equal(read_image(folder / "out.png"), wanted)
    np.testing.assert_array_equal(
        read_image(folder / "out_roughness.png"), expected(folder, Channel(np.ascontiguousarray(color[..., 1:2])))
    )
    grey = np.rint(color @ [0.2126, 0.7152, 0.0722]).astype(np.uint8)
    np.testing.assert_array_equal(read_image(folder / "out_metallic.png"), expected(folder, Channel(grey)))
    assert read_mtl(folder / "out.mtl")["isograft"].textures["map_Kd"].is_clamped


def test_float_images_stay_float_beside_images_of_bytes(folder: Path) -> None:
    image = np.random.default_rng(3).random((SIZE, SIZE, 3)).astype(np.float32)
    write_image(folder / "deep.npy", image)
    paint(folder, "newmtl skin", "map_Kd deep.npy", "newmtl eye", "map_Kd clear.png", materials={0: "skin", 100: "eye"})
    assert transfer(folder, "--texture-output", str(folder / "baked.npy")) == 0
    material = (read_mesh(folder / "donor.obj").triangle_polygon >= 100).astype(np.int32)
    wide = np.concatenate([image, np.ones((SIZE, SIZE, 1), np.float32)], axis=2)
    clear = read_image(folder / "clear.png").astype(np.float32) / np.float32(255)
    found = read_image(folder / "baked.npy")
    assert found.dtype == np.float32
    np.testing.assert_array_equal(found, expected(folder, Channel([wide, clear]), donor_materials=material))


def test_polygons_that_get_no_image_keep_their_material(folder: Path) -> None:
    paint(folder, "newmtl skin", "map_Kd color.png")
    own = (folder / "bare.obj").read_text().replace("\nf ", "\nusemtl isograft\nf ", 1)
    (folder / "bare.obj").write_text(f"mtllib own.mtl\n{own}")
    (folder / "own.mtl").write_text("newmtl isograft\nKd 1 0 0\n")
    spoil_map(folder, np.arange(20, 23))
    assert run(folder, "bare.obj", "--what", "uv,texture", "--size", str(SIZE)) == 0
    text = (folder / "out.obj").read_text()
    assert "mtllib out.mtl" in text and "mtllib own.mtl" in text
    mesh = read_mesh(folder / "out.obj")
    matched = np.load(folder / "map.npz")["face"] >= 0
    whole = matched[mesh.polygons.corners].reshape(-1, 4).all(axis=1)
    assert not whole.all()
    np.testing.assert_array_equal(mesh.layers.face["material"], np.where(whole, "isograft.001", "isograft"))
    assert set(read_mtl(folder / "out.mtl")) == {"isograft.001"}


def test_the_image_of_a_ply_is_found_and_named(folder: Path, capsys: Any) -> None:
    mesh = read_mesh(folder / "donor.obj")
    polygons = mesh.polygons
    given = MeshOutput(mesh.vertices, polygons.sizes, polygons.corners, corner_uvs=mesh.corner_uvs)
    write_ply_mesh(folder / "donor.ply", given, "color.png")
    options = ("--what", "uv,texture", "--size", str(SIZE))
    assert run(folder, "bare.obj", *options, out="out.ply", donor="donor.ply") == 0
    assert b"comment TextureFile out.png\n" in (folder / "out.ply").read_bytes()
    # The same as by way of an OBJ, but for a level: a PLY has texture coordinates of 32 bits.
    paint(folder, "newmtl skin", "map_Kd color.png")
    assert run(folder, "bare.obj", *options, out="other.obj") == 0
    found, other = (read_image(folder / name).astype(int) for name in ("out.png", "other.png"))
    assert np.abs(found - other).max() <= 1
    for name, words in (
        ("lost.png", "names the image lost.png (comment TextureFile), which is not there"),
        (None, "no image"),
    ):
        write_ply_mesh(folder / "donor.ply", given, name)
        assert run(folder, "bare.obj", *options, out="new.ply", donor="donor.ply") == 2
        assert words in capsys.readouterr().err
    assert not (folder / "new.ply").exists()


REFUSALS = [
    (["map_Pr lost.png"], "line 2: map_Pr of the material skin names the image lost.png, which is not there; put it"),
    (["map_Kd -mm 0.1 1 color.png"], "changes its image with -mm; work that into the image first"),
    (["map_Kd -o here color.png"], "-o is followed by here, not by numbers"),
    (["map_Kd -clamp on"], "map_Kd of the material skin names no image"),
    (["map_Kd map.npz"], "map.npz: not an image"),
    (["map_Pr -imfchan z color.png"], "takes the component z"),
    (["map_Pr -imfchan m color.png"], "the image of map_Pr has no alpha"),
    (["norm grey.png"], "the image of norm is grey, and a normal map has three components"),
    (["norm -s -1 1 1 relief.png"], "norm of the material skin is mirrored by -s"),
    (["bump relief.png", "newmtl other", "bump grey.png"], "map_Bump is a normal map in one of the donor's materials"),
    (["Kd 1 1 1"], "the donor's materials name no image; give --texture"),
]


@pytest.mark.parametrize(("lines", "words"), REFUSALS, ids=[lines[0] for lines, _ in REFUSALS])
def test_what_cannot_be_baked_is_refused_and_nothing_is_written(folder: Path, capsys: Any, lines, words) -> None:
    paint(folder, "newmtl skin", *lines, materials={0: "skin", 9: "other"} if "newmtl other" in lines else None)
    assert_refused(folder, capsys, ["--what", "uv,texture"], words)


def test_materials_that_are_not_there_are_refused(folder: Path, capsys: Any) -> None:
    paint(folder, "newmtl skin", "map_Kd color.png", materials={0: "skin", 9: "eye"})
    words = "the donor's faces use the material eye, which its libraries (mtllib) do not have"
    assert_refused(folder, capsys, ["--what", "uv,texture"], words)
    (folder / "donor.mtl").unlink()
    assert_refused(folder, capsys, ["--what", "uv,texture"], "donor.mtl does not exist; give --texture")


def test_nothing_that_is_read_is_written_over(folder: Path, capsys: Any) -> None:
    paint(folder, "newmtl skin", "map_Kd color.png")
    given = (folder / "color.png").read_bytes()
    for options in (["--texture-output", str(folder / "color.png")], ["-o", str(folder / "donor.obj")]):
        assert_refused(folder, capsys, ["--what", "uv,texture", *options], "would be written over, and is read")
    assert (folder / "color.png").read_bytes() == given
    words = "images of this kind cannot be written"
    assert_refused(folder, capsys, ["--what", "uv,texture", "--texture-output", str(folder / "x.what")], words)


def test_a_write_that_fails_leaves_nothing_behind(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    paint(folder, "newmtl skin", "map_Kd color.png", "map_Pr grey.png")
    before = sorted(folder.iterdir())

    def fail(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(cli_transfer, "write_obj", fail)
    assert run(folder, "bare.obj", "--what", "uv,texture", "--size", "16") == 1
    assert sorted(folder.iterdir()) == before
