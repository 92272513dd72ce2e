# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft transfer`: what it writes, what it says, and what it refuses."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograft.correspondence import Correspondence
from isograft.files import read_mesh
from isograft.formats.images import read_image, write_image
from isograft.matching import Match
from isograft.report import Report
from isograft.transfer import Channel, bake, invert, transfer_corner_uv, wrap
from seamed_shapes import COARSE, DONORS, SHAPES
from transfer_files import assert_refused, run, save, save_map, spoil_map


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("transfer")
    donor, receiver = SHAPES["cylinder"](*DONORS["cylinder"]), SHAPES["cylinder"](*COARSE["cylinder"], turn=0.37)
    save(folder / "donor.obj", donor, colors=True)
    save(folder / "bare.obj", receiver, uvs=False)
    save(folder / "quads.obj", receiver, uvs=False, quads=True)
    save(folder / "mapped.obj", receiver)
    save_map(folder / "map.npz", receiver, donor)
    save_map(folder / "back.npz", donor, receiver)
    write_image(folder / "image.npy", np.random.default_rng(0).random((32, 48, 3)).astype(np.float32))
    write_image(folder / "image.png", np.random.default_rng(0).integers(0, 256, (32, 48, 3), np.uint8))
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "files"))


@pytest.mark.parametrize("out", ["out.obj", "out.ply"])
def test_uvs_in_the_file_are_those_of_the_function(folder: Path, out: str) -> None:
    assert run(folder, "bare.obj", "--what", "uv", out=out) == 0
    donor, receiver, written = (read_mesh(folder / name) for name in ("donor.obj", "bare.obj", out))
    moved = transfer_corner_uv(
        Correspondence.load(folder / "map.npz"), receiver.vertices, receiver.faces, donor.vertices, donor.faces,
        donor.triangle_uvs,
    )  # fmt: skip
    np.testing.assert_allclose(written.vertices, receiver.vertices, rtol=1e-8)
    np.testing.assert_array_equal(written.faces, receiver.faces)
    np.testing.assert_allclose(written.triangle_uvs.reshape(-1, 2), moved.uv, rtol=0, atol=1e-6)


def test_polygons_stay_polygons_and_are_never_parted(folder: Path) -> None:
    for out in ("out.obj", "out.ply"):
        assert run(folder, "quads.obj", "--what", "uv,color", out=out) == 0
        written = read_mesh(folder / out)
        assert set(written.polygons.sizes) == {4}
        uvs = written.corner_uvs.reshape(-1, 4, 2)
        assert np.ptp(uvs[..., 0], axis=1).max() < 1.3 / COARSE["cylinder"][1]


def test_polygons_are_cut_along_the_seams_on_request_and_no_others(folder: Path, capsys: Any) -> None:
    assert run(folder, "quads.obj", "--what", "uv,color", "--cut-seams", "--json", out="out.ply") == 0
    receiver, written = (read_mesh(folder / name) for name in ("quads.obj", "out.ply"))
    rows, columns = COARSE["cylinder"]
    # The tube's one seam crosses a quad in every row, and the row's edges.
    assert json.loads(capsys.readouterr().out)["polygons_cut"] == rows
    assert sorted(set(written.polygons.sizes)) == [3, 4]
    assert (written.polygons.sizes == 4).sum() == rows * (columns - 1)
    np.testing.assert_allclose(written.vertices[: len(receiver.vertices)], receiver.vertices, rtol=0, atol=1e-6)
    # New vertices lie on the seam: UVs go from one end of the square to the other, never beyond.
    uvs = written.triangle_uvs
    assert uvs.min() > -1e-4 and uvs.max() < 1 + 1e-4
    assert len(written.colors) == len(written.vertices) > len(receiver.vertices)
    assert run(folder, "quads.obj", "--what", "color", "--cut-seams") == 2


def test_colours_are_interpolated_and_kept_in_either_format(folder: Path) -> None:
    for out, step in (("out.obj", 1e-5), ("out.ply", 1 / 255)):
        assert run(folder, "bare.obj", "--what", "color", out=out) == 0
        donor, written = read_mesh(folder / "donor.obj"), read_mesh(folder / out)
        expected = Correspondence.load(folder / "map.npz").interpolate(donor.colors)
        np.testing.assert_allclose(written.colors, expected, rtol=0, atol=step)


@pytest.mark.parametrize(("kind", "words"), [("uv", "texture coordinates"), ("color", "vertex colours")])
def test_what_the_receiver_has_is_overwritten_on_request_only(folder: Path, capsys: Any, kind: str, words: str) -> None:
    shape = SHAPES["cylinder"](*COARSE["cylinder"], turn=0.37)
    save(folder / "own.obj", shape, colors=True, quads=True)
    own, unmatched = read_mesh(folder / "own.obj"), np.arange(20, 23)
    spoil_map(folder, unmatched)
    assert run(folder, "own.obj", "--what", kind) == 2
    assert f"own.obj: the receiver has {words} of its own; give --overwrite" in capsys.readouterr().err
    assert not (folder / "out.obj").exists()
    assert run(folder, "own.obj", "--what", kind, "--overwrite") == 0
    found = read_mesh(folder / "out.obj")
    # What is unmatched has its own yet, and no quad has something of both.
    at_hole = np.isin(own.polygons.corners, unmatched).reshape(-1, 4).any(axis=1)[own.triangle_polygon]
    same_uvs = np.isclose(found.triangle_uvs, own.triangle_uvs, rtol=0, atol=1e-6).all(axis=(1, 2))
    same_colors = np.isclose(found.colors, own.colors, rtol=0, atol=1e-5).all(axis=1)
    if kind == "uv":
        assert same_uvs[at_hole].all() and not same_uvs[~at_hole].any() and same_colors.all()
    else:
        assert same_colors[unmatched].all() and not same_colors.all() and same_uvs.all()


@pytest.mark.parametrize("kind", ["npy", "png"])
def test_a_baked_texture_is_that_of_the_function_and_named_by_the_mesh(folder: Path, kind: str) -> None:
    pytest.importorskip("PIL")
    options = ["--what", "texture", "--texture", str(folder / f"image.{kind}"), "--size", "64"]
    assert run(folder, "mapped.obj", *options, "--texture-output", str(folder / f"baked.{kind}")) == 0
    donor, receiver = read_mesh(folder / "donor.obj"), read_mesh(folder / "mapped.obj")
    image = read_image(folder / f"image.{kind}")
    baked = bake(
        Correspondence.load(folder / "map.npz"), receiver.vertices, receiver.faces, receiver.triangle_uvs,
        donor.vertices, donor.faces, donor.triangle_uvs, Channel(image), 64,
    )  # fmt: skip
    np.testing.assert_array_equal(read_image(folder / f"baked.{kind}"), baked.images[0])
    assert "mtllib out.mtl" in (folder / "out.obj").read_text()
    assert f"map_Kd baked.{kind}" in (folder / "out.mtl").read_text()


def test_the_image_is_found_through_the_donors_material(folder: Path) -> None:
    pytest.importorskip("PIL")
    text = (folder / "donor.obj").read_text()
    (folder / "donor.obj").write_text("mtllib donor.mtl\n" + text)
    (folder / "donor.mtl").write_text("newmtl skin\nmap_Kd image.png\n")
    assert run(folder, "bare.obj", "--what", "uv,texture", "--size", "32") == 0
    assert read_image(folder / "out.png").shape == (32, 32, 3)
    (folder / "donor.mtl").write_text("newmtl skin\nmap_Kd image.png\nnewmtl eye\nmap_Kd eye.png\n")
    assert run(folder, "bare.obj", "--what", "uv,texture", out="other.obj") == 2
    assert not (folder / "other.obj").exists()


def test_shape_writes_the_donors_polygons_in_the_receivers_place(folder: Path) -> None:
    assert run(folder, "bare.obj", "--what", "shape", out="out.ply") == 0
    donor, written = read_mesh(folder / "donor.obj"), read_mesh(folder / "out.ply")
    np.testing.assert_array_equal(written.faces, donor.faces)
    np.testing.assert_allclose(written.triangle_uvs, donor.triangle_uvs, atol=1e-6)
    # The receiver's nine flat sides lie inside of the donor's 24.
    assert np.hypot(written.vertices[:, 0], written.vertices[:, 1]).max() <= 1.0 + 1e-9
    np.testing.assert_allclose(written.vertices[:, 2], donor.vertices[:, 2], rtol=0, atol=0.05)


@pytest.mark.parametrize("method", ["rigid", "smooth"])
def test_the_shape_is_completed_as_asked_and_marked(folder: Path, method: str) -> None:
    spoil_map(folder, np.arange(18, 27))
    options = () if method == "rigid" else ("--unmatched", method)
    assert run(folder, "bare.obj", "--what", "shape", *options, out="out.ply") == 0
    donor, receiver, written = (read_mesh(folder / name) for name in ("donor.obj", "bare.obj", "out.ply"))
    wrapped = wrap(
        Correspondence.load(folder / "map.npz"), receiver.vertices, receiver.faces, donor.vertices, donor.faces,
        method=method,
    )  # fmt: skip
    np.testing.assert_array_equal(written.vertices, wrapped.vertices)
    assert 20 < wrapped.filled.sum() < 200
    assert run(folder, "bare.obj", "--what", "uv", "--unmatched", method) == 2


def test_a_map_of_the_other_direction_serves_too(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(folder, "bare.obj", "--what", "color", map_name="back.npz") == 2
    assert "give --inverse" in capsys.readouterr().err
    assert run(folder, "bare.obj", "--what", "color", "--inverse", map_name="back.npz") == 0
    donor, receiver = read_mesh(folder / "donor.obj"), read_mesh(folder / "bare.obj")
    turned = invert(
        Correspondence.load(folder / "back.npz"), donor.vertices, donor.faces, receiver.vertices, receiver.faces
    )
    expected = turned.interpolate(donor.colors)[turned.matched]
    assert turned.coverage > 0.5
    np.testing.assert_allclose(read_mesh(folder / "out.obj").colors[turned.matched], expected, rtol=0, atol=1e-5)


def test_what_is_unmatched_is_left_alone_or_filled_and_marked(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spoil_map(folder, np.arange(20, 23))
    assert run(folder, "bare.obj", "--what", "uv,color", out="out.ply") == 0
    assert "51 of 54 vertices matched" in capsys.readouterr().out
    left = read_mesh(folder / "out.ply")
    assert (left.colors[20:23] == 0).all() and b"isograft_filled" not in (folder / "out.ply").read_bytes()
    assert run(folder, "bare.obj", "--what", "uv,color", "--fill", "--json", out="out.ply") == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["vertices_coloured"] == 54 and summary["filled"] >= 3
    filled = read_mesh(folder / "out.ply")
    assert (filled.colors[20:23] > 0).any(axis=1).all() and b"isograft_filled" in (folder / "out.ply").read_bytes()
    assert (filled.triangle_uvs.reshape(-1, 6) != 0).any(axis=1).all()


def test_an_empty_map_is_told_by_the_exit_code(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spoil_map(folder, slice(None))
    assert run(folder, "bare.obj", "--what", "uv,color") == 3
    assert "0 of 54 vertices matched" in capsys.readouterr().out
    assert (folder / "out.obj").exists()


REFUSALS = [
    (
        ["--what", "uv,hair"],
        "must name some of uv, color, texture, attributes, weights, keys, normals, shape, not hair",
    ),
    (["--what", ""], "not nothing"),
    (["--what", "shape,uv"], "shape stands alone"),
    (["--what", "uv", "--texture", "image.npy"], "--texture is given and texture is not in --what"),
    (["--what", "texture"], "bare.obj: the receiver has no texture coordinates to bake into; add uv"),
    (["--what", "uv,texture"], "the donor names no materials (mtllib) and so no image; give --texture"),
    (["--what", "uv,texture", "--texture", "none.npy"], "none.npy: No such file"),
    (["--what", "uv,texture", "--texture", "map.npz"], "map.npz: not an image"),
    (["--what", "uv,texture", "--texture", "image.npy", "--size", "0"], "size must be from 1"),
    (["--what", "uv", "--min-confidence", "2"], "--min-confidence must be from 0 to 1"),
]


@pytest.mark.parametrize(("options", "words"), REFUSALS, ids=[" ".join(options) for options, _ in REFUSALS])
def test_what_cannot_be_done_is_refused_and_nothing_is_written(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, options, words
) -> None:
    monkeypatch.chdir(folder)
    assert_refused(folder, capsys, options, words)


def test_a_donor_without_the_data_or_a_map_of_another_donor_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save(folder / "donor.obj", SHAPES["cylinder"](*DONORS["cylinder"]), uvs=False)
    for what, words in (("uv", "no texture coordinates; leave uv out"), ("color", "no vertex colours")):
        assert run(folder, "bare.obj", "--what", what) == 2
        assert words in capsys.readouterr().err
    save(folder / "donor.obj", SHAPES["cylinder"](5, 9))
    assert run(folder, "bare.obj", "--what", "uv") == 2
    assert "the map leads to a target of 312 vertices, this one has 54" in capsys.readouterr().err
    assert not (folder / "out.obj").exists()


def test_without_pillow_images_are_refused_with_the_command_to_type(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "PIL", None)
    options = ["--what", "uv,texture", "--texture", str(folder / "image.png")]
    assert run(folder, "bare.obj", *options) == 2
    assert "pip install isograft[textures]" in capsys.readouterr().err
    options[-1] = str(folder / "image.npy")
    assert run(folder, "bare.obj", *options, "--texture-output", str(folder / "baked.npy"), "--size", "16") == 0
    assert read_image(folder / "baked.npy").shape == (16, 16, 3)


@pytest.mark.parametrize("edited", ["donor", "bare"])
def test_a_mesh_that_was_edited_since_the_match_is_refused(folder: Path, capsys: Any, edited: str) -> None:
    shape = SHAPES["cylinder"](*COARSE["cylinder"], turn=0.37)
    # As isograft match writes it.
    best = Correspondence.load(folder / "map.npz")
    Match(best, [], Report()).save(folder / "map.npz", shape[0])
    assert run(folder, "bare.obj", "--what", "color") == 0
    text = (folder / f"{edited}.obj").read_text().splitlines()
    # A vertex written with fewer digits is the same; one that lies elsewhere is not.
    words = text[20].split()
    words[1:4] = [f"{float(word):.5f}" for word in words[1:4]]
    for x, code in ((words[1], 0), (f"{float(words[1]) + 0.05:.5f}", 2)):
        words[1] = x
        text[20] = " ".join(words)
        (folder / f"{edited}.obj").write_text("\n".join(text) + "\n")
        (folder / "out.obj").unlink()
        assert run(folder, "bare.obj", "--what", "color") == code
    assert f"{edited}.obj: was edited after" in capsys.readouterr().err
    assert not (folder / "out.obj").exists()
