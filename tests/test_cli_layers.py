# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft transfer` of attributes, vertex groups, shape keys and normals: .npz files and PLY properties."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograft.correspondence import Correspondence
from isograft.files import read_mesh
from isograft.formats.layers import Layers
from isograft.formats.mesh_output import MeshOutput, write_ply_mesh
from isograft.transfer import fill_point, transfer_corner, transfer_face
from seamed_shapes import COARSE, DONORS, SHAPES
from transfer_files import run, save, save_map, spoil_map

SIZE = 2.5
"""Of the twin, in units of the donor."""


def turn() -> np.ndarray:
    """A rotation about no axis of the coordinates."""
    c, s = np.cos(1.1), np.sin(1.1)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, s, -c], [0, c, s]])


def all_kinds(folder: Path) -> dict[str, np.ndarray]:
    """Something of every kind and domain for donor.obj, whose polygons are quads."""
    mesh = read_mesh(folder / "donor.obj")
    n, c, p = len(mesh.vertices), len(mesh.polygons.corners), len(mesh.polygons.sizes)
    # The edges along the columns of the grid, from vertex to vertex.
    columns = DONORS["cylinder"][1]
    edges = np.stack([np.arange(n - columns), np.arange(columns, n)], axis=1).astype(np.int32)
    middle = mesh.vertices[mesh.polygons.corners].reshape(p, -1, 3).mean(axis=1)
    axis, uvs = mesh.vertices * [1, 1, 0], mesh.corner_uvs
    return {
        "point/height": mesh.vertices[:, 2].astype(np.float32),
        "point/place": mesh.vertices,
        "point/number": np.arange(n, dtype=np.int32),
        "point/small": (np.arange(n) % 100).astype(np.int8),
        "point/flag": mesh.vertices[:, 0] > 0,
        "point/word": np.array([f"v{i}" for i in range(n)]),
        "corner/shade": np.repeat(middle[:, 2], 4),
        "corner/piece": np.repeat(np.arange(p), 4).astype(np.int64),
        "face/material": np.arange(p, dtype=np.int32) % 7,
        "face/name": np.array(["upper" if z > 2 else "lower" for z in middle[:, 2]]),
        "face/tint": middle.astype(np.float32),
        "edges": edges,
        "edge/crease": (np.arange(len(edges)) / len(edges)).astype(np.float32),
        "edge/seam": np.arange(len(edges)) % 3 == 0,
        "uv/Second": 0.5 * uvs,
        "uv/Third": uvs * [-1, 1],
        "weights/Up per": mesh.vertices[:, 2] / 4,
        "weights/Lower": 1 - mesh.vertices[:, 2] / 4,
        "keys/Swell": 0.1 * axis,
        "keys/Lift": np.tile([0.0, 0.0, 0.3], (n, 1)),
        "normals": np.tile([0.6, 0.0, 0.8], (c, 1)),
    }  # fmt: skip


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("layers")
    vertices, faces, uv = SHAPES["cylinder"](*DONORS["cylinder"])
    # Twisted, so that the shorter diagonal of a quad is the same one whatever is rounded.
    c, s = np.cos(0.05 * vertices[:, 2]), np.sin(0.05 * vertices[:, 2])
    x, y, z = vertices.T
    vertices = np.stack([c * x - s * y, s * x + c * y, z], axis=1)
    donor = vertices, faces, uv
    twin = (SIZE * vertices @ turn().T + [5, 1, -2], faces, uv)
    receiver = SHAPES["cylinder"](*COARSE["cylinder"], turn=0.37)
    save(folder / "donor.obj", donor, quads=True)
    save(folder / "twin.obj", twin, uvs=False, quads=True)
    save(folder / "bare.obj", receiver, uvs=False)
    save(folder / "quads.obj", receiver, uvs=False, quads=True)
    mesh = read_mesh(folder / "donor.obj")
    save_map(folder / "map.npz", receiver, (mesh.vertices, mesh.faces))
    save_map(folder / "same.npz", (mesh.vertices, mesh.faces), (mesh.vertices, mesh.faces))
    np.savez(folder / "all.npz", **all_kinds(folder))
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "files"))


def layers(folder: Path, receiver: str, *options: str, **names: str) -> dict[str, np.ndarray]:
    """The arrays that are written, all.npz given to the donor."""
    assert run(folder, receiver, "--target-data", str(folder / "all.npz"), *options, **names) == 0
    return dict(np.load(folder / "out.npz"))


def own_data(folder: Path, **arrays: np.ndarray) -> tuple[str, str]:
    """Data of the receiver's as options; _ stands for /."""
    np.savez(folder / "own.npz", **{name.replace("_", "/", 1): array for name, array in arrays.items()})
    return "--source-data", str(folder / "own.npz")


def test_a_turned_and_larger_twin_gets_every_layer_exactly(folder: Path) -> None:
    found = layers(folder, "twin.obj", "--what", "uv,attributes,weights,keys,normals", map_name="same.npz")
    expected = all_kinds(folder)
    # Edges are those of the polygons; the donor has told of those along the columns.
    ends = {tuple(pair): row for row, pair in enumerate(found.pop("edges").tolist())}
    rows = [ends[tuple(pair)] for pair in expected.pop("edges").tolist()]
    assert set(found) == set(expected)
    for name in ("edge/crease", "edge/seam"):
        values = found.pop(name)
        assert values.dtype == expected[name].dtype and len(values) == len(ends)
        np.testing.assert_array_equal(values[rows], expected.pop(name))
    # What has a direction is turned, and keys grow with the size.
    for name in ("keys/Swell", "keys/Lift"):
        np.testing.assert_allclose(found.pop(name), SIZE * expected.pop(name) @ turn().T, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.pop("normals"), expected.pop("normals") @ turn().T, rtol=0, atol=1e-3)
    for name, values in expected.items():
        assert found[name].dtype == values.dtype, name
        if values.dtype.kind == "f":
            np.testing.assert_allclose(found[name], values, rtol=0, atol=1e-6, err_msg=name)
        else:
            np.testing.assert_array_equal(found[name], values, err_msg=name)


def test_another_tessellation_gets_means_of_numbers_and_one_of_the_labels(folder: Path) -> None:
    found = layers(folder, "quads.obj", "--what", "attributes,weights")
    map_ = Correspondence.load(folder / "map.npz")
    np.testing.assert_allclose(found["point/place"], map_.points, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["weights/Up per"], map_.points[:, 2] / 4, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(found["point/number"], map_.vertex)
    donor, receiver = (read_mesh(folder / name) for name in ("donor.obj", "quads.obj"))
    geometry = receiver.vertices, receiver.faces, donor.vertices, donor.faces
    given = all_kinds(folder)
    moved = transfer_corner(
        map_, *geometry, given["corner/shade"][donor.triangle_corners], receiver_polygons=receiver.triangle_polygon
    )
    np.testing.assert_array_equal(found["corner/shade"][receiver.triangle_corners].ravel(), moved.values)
    names = transfer_face(
        map_, *geometry, given["face/name"], receiver_polygons=receiver.triangle_polygon,
        donor_polygons=donor.triangle_polygon,
    ).values  # fmt: skip
    np.testing.assert_array_equal(found["face/name"], names)
    height = receiver.vertices[receiver.polygons.corners].reshape(-1, 4, 3).mean(axis=1)[:, 2]
    clear = np.abs(height - 2) > 0.2
    np.testing.assert_array_equal(found["face/name"][clear], np.where(height > 2, "upper", "lower")[clear])


def test_more_uv_maps_come_with_the_files_own_or_alone(folder: Path, capsys: Any) -> None:
    found = layers(folder, "quads.obj", "--what", "uv", "--names", "S*", "--json")
    assert json.loads(capsys.readouterr().out)["uv_maps"] == 1
    assert set(found) == {"uv/Second"}
    # Islands and seams are kept as those of the file's own map.
    np.testing.assert_allclose(2 * found["uv/Second"], read_mesh(folder / "out.obj").corner_uvs, rtol=0, atol=1e-6)
    save(folder / "donor.obj", SHAPES["cylinder"](*DONORS["cylinder"]), uvs=False, quads=True)
    alone = layers(folder, "quads.obj", "--what", "uv")
    assert set(alone) == {"uv/Second", "uv/Third"} and read_mesh(folder / "out.obj").corner_uvs is None
    assert run(folder, "quads.obj", "--what", "uv") == 2
    assert "the donor has no texture coordinates" in capsys.readouterr().err


@pytest.mark.parametrize("text", [False, True])
def test_ply_properties_go_in_and_out(folder: Path, text: bool) -> None:
    donor = read_mesh(folder / "donor.obj")
    given = all_kinds(folder)
    carried = Layers(
        point={"height": given["point/height"], "small": given["point/small"], "isograft_x": given["point/height"]},
        face={"material": given["face/material"]},
        edge={"crease": given["edge/crease"]},
        weights={"Upper": given["weights/Up per"]},
        edges=given["edges"],
    )
    polygons = donor.polygons
    path = folder / "donor.ply"
    write_ply_mesh(path, MeshOutput(donor.vertices, polygons.sizes, polygons.corners, layers=carried))
    if text:
        as_text(path)
    options = ("--what", "attributes,weights")
    assert run(folder, "twin.obj", *options, out="out.ply", map_name="same.npz", donor="donor.ply") == 0
    found, arrays = read_mesh(folder / "out.ply").layers, dict(np.load(folder / "out.npz"))
    # Marks of maps and of transfers are nothing to carry on.
    assert set(found.point) == {"height", "small"}
    np.testing.assert_allclose(found.point["height"], given["point/height"], rtol=0, atol=1e-6)
    np.testing.assert_array_equal(found.point["small"], given["point/small"])
    assert (found.point["small"].dtype, found.face["material"].dtype) == (np.int8, np.int32)
    np.testing.assert_array_equal(found.face["material"], given["face/material"])
    np.testing.assert_allclose(found.weights["Upper"], given["weights/Up per"], rtol=0, atol=1e-6)
    ends = {tuple(pair): row for row, pair in enumerate(found.edges.tolist())}
    rows = [ends[tuple(pair)] for pair in given["edges"].tolist()]
    np.testing.assert_allclose(found.edge["crease"][rows], given["edge/crease"], rtol=0, atol=1e-6)
    for name in ("point/height", "face/material", "edge/crease", "weights/Upper"):
        kind, _, key = name.partition("/")
        np.testing.assert_array_equal(arrays[name], found.of(kind)[key])


def as_text(path: Path) -> None:
    """Write a binary PLY of quads again as text."""
    mesh = read_mesh(path)
    header = path.read_bytes().split(b"end_header\n")[0].decode().replace("binary_little_endian", "ascii")
    own = mesh.layers
    # read_mesh() passes isograft_x over: any number will do.
    lines = [
        f"{x!r} {y!r} {z!r} {h!r} {s} 7 {w!r}"
        for (x, y, z), h, s, w in zip(
            mesh.vertices.tolist(), *(a.tolist() for a in (own.point["height"], own.point["small"])),
            own.weights["Upper"].tolist(), strict=True,
        )
    ]  # fmt: skip
    quads = mesh.polygons.corners.reshape(-1, 4).tolist()
    lines += [f"4 {' '.join(map(str, q))} {m}" for q, m in zip(quads, own.face["material"].tolist(), strict=True)]
    lines += [f"{a} {b} {c!r}" for (a, b), c in zip(own.edges.tolist(), own.edge["crease"].tolist(), strict=True)]
    path.write_text(header + "end_header\n" + "\n".join(lines) + "\n")


def test_a_ply_takes_what_it_has_a_place_for_and_the_npz_everything(folder: Path, capsys: Any) -> None:
    assert layers(folder, "quads.obj", "--what", "uv,attributes,weights", "--json", out="out.ply")
    assert json.loads(capsys.readouterr().out)["data"] == str(folder / "out.npz")
    found = read_mesh(folder / "out.ply")
    # One number a row; white space would end a name.
    assert set(found.layers.point) == {"height", "number", "small", "flag"}
    assert set(found.layers.weights) == {"Up_per", "Lower"}
    assert set(found.layers.face) == {"material"} and set(found.layers.edge) == {"crease", "seam"}
    # Polygons and texture coordinates are where they were.
    assert run(folder, "quads.obj", "--what", "uv", out="plain.ply") == 0
    plain = read_mesh(folder / "plain.ply")
    np.testing.assert_array_equal(found.polygons.corners, plain.polygons.corners)
    np.testing.assert_array_equal(found.corner_uvs, plain.corner_uvs)


def test_what_the_receivers_ply_carries_stays_unless_it_is_cut(folder: Path, capsys: Any) -> None:
    mesh = read_mesh(folder / "quads.obj")
    own = Layers(point={"mine": np.arange(54, dtype=np.int32)}, face={"part": np.arange(45, dtype=np.uint8)})
    sizes, corners = mesh.polygons.sizes, mesh.polygons.corners
    write_ply_mesh(folder / "own.ply", MeshOutput(mesh.vertices, sizes, corners, layers=own))
    assert run(folder, "own.ply", "--what", "uv", out="out.ply") == 0
    found = read_mesh(folder / "out.ply").layers
    np.testing.assert_array_equal(found.point["mine"], np.arange(54))
    np.testing.assert_array_equal(found.face["part"], np.arange(45))
    assert "left out" not in capsys.readouterr().err
    assert run(folder, "own.ply", "--what", "uv", "--cut-seams", out="cut.ply") == 0
    assert "the receiver's own layers are not cut along, and are left out" in capsys.readouterr().err
    assert not read_mesh(folder / "cut.ply").layers


def test_own_data_are_written_again_where_none_come_to_them(folder: Path) -> None:
    own = own_data(folder, keys_Wink=np.ones((54, 3)), point_mine=np.arange(54))
    assert run(folder, "bare.obj", "--what", "uv", *own) == 0
    found = dict(np.load(folder / "out.npz"))
    assert set(found) == {"keys/Wink", "point/mine"}
    np.testing.assert_array_equal(found["point/mine"], np.arange(54))


def test_only_named_layers_come_and_own_ones_stay(folder: Path) -> None:
    n = len(read_mesh(folder / "bare.obj").vertices)
    own = own_data(folder, point_height=np.full(n, 9), weights_Lower=np.full(n, 0.5))
    chosen = ("--what", "attributes,weights", "--names", "hei*, Lower", *own)
    found = layers(folder, "bare.obj", *chosen)
    assert set(found) == {"point/height", "point/height.001", "weights/Lower", "weights/Lower.001"}
    assert (found["point/height"] == 9).all() and (found["weights/Lower"] == 0.5).all()
    written = layers(folder, "bare.obj", *chosen, "--overwrite")
    assert set(written) == {"point/height", "weights/Lower"}
    np.testing.assert_array_equal(written["point/height"], found["point/height.001"])
    np.testing.assert_array_equal(written["weights/Lower"], found["weights/Lower.001"])


def test_weights_are_mixed_limited_normalised_and_locked_as_asked(folder: Path, capsys: Any) -> None:
    n = len(read_mesh(folder / "bare.obj").vertices)
    upper = Correspondence.load(folder / "map.npz").points[:, 2] / 4
    own = own_data(folder, weights_Lower=np.full(n, 0.5))
    base = ("--what", "weights", *own, "--overwrite")
    found = layers(folder, "bare.obj", *base, "--mix-mode", "add", "--mix-factor", "0.5")
    np.testing.assert_allclose(found["weights/Lower"], np.clip(0.5 * (1.5 - upper) + 0.25, 0, 1), rtol=0, atol=1e-9)
    found = layers(folder, "bare.obj", *base, "--locked", "Low*", "--normalise")
    assert "locked vertex groups are as they were: Lower" in capsys.readouterr().err
    np.testing.assert_array_equal(found["weights/Lower"], np.full(n, 0.5))
    np.testing.assert_allclose(found["weights/Up per"][upper > 0], 0.5, rtol=0, atol=1e-9)
    found = layers(folder, "bare.obj", *base, "--limit-total", "1")
    assert (np.minimum(found["weights/Lower"], found["weights/Up per"]) == 0).all()


def test_locked_keys_stay_and_the_scale_of_keys_may_be_given(folder: Path) -> None:
    n = len(read_mesh(folder / "twin.obj").vertices)
    own = own_data(folder, keys_Lift=np.ones((n, 3)))
    found = layers(
        folder, "twin.obj", "--what", "keys", *own, "--overwrite", "--locked", "Lift", "--key-scale", "3",
        "--key-smoothing", "2", map_name="same.npz",
    )  # fmt: skip
    np.testing.assert_array_equal(found["keys/Lift"], np.ones((n, 3)))
    expected = 3 * all_kinds(folder)["keys/Swell"] @ turn().T
    np.testing.assert_allclose(found["keys/Swell"], expected, rtol=0, atol=1e-6)


def test_unmatched_rows_are_empty_or_own_or_filled_and_marked(folder: Path) -> None:
    spoil_map(folder, np.arange(20, 23))
    n, lost = len(read_mesh(folder / "bare.obj").vertices), np.arange(20, 23)
    found = layers(folder, "bare.obj", "--what", "attributes,weights,keys,normals")
    for name in ("point/height", "weights/Lower", "keys/Swell"):
        assert not found[name][lost].any(), name
    assert (found["point/word"][lost] == "").all()
    own = own_data(folder, point_height=np.full(n, 9, np.float32))
    kept = layers(folder, "bare.obj", "--what", "attributes", "--names", "height", "--overwrite", *own)
    assert (kept["point/height"][lost] == 9).all() and (kept["point/height"][:20] != 9).all()
    everything = layers(folder, "bare.obj", "--what", "attributes,weights,keys,normals", "--fill", out="out.ply")
    marks = everything.pop("point/isograft_filled")
    assert np.flatnonzero(marks).tolist() == lost.tolist()
    map_ = Correspondence.load(folder / "map.npz")
    mesh = read_mesh(folder / "bare.obj")
    expected = fill_point(mesh.vertices, mesh.faces, np.nan_to_num(map_.points), map_.matched).values
    np.testing.assert_allclose(everything["point/place"], expected, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        everything["weights/Lower"] + everything["weights/Up per"], np.ones(n), rtol=0, atol=1e-6
    )
    assert everything["normals"].any(axis=1).all() and everything["keys/Swell"][lost].any(axis=1).all()
    assert (everything["face/name"] != "").all() and (everything["point/word"] != "").all()


def test_polygons_that_are_cut_carry_layers_too(folder: Path, capsys: Any) -> None:
    found = layers(folder, "quads.obj", "--what", "uv,attributes", "--cut-seams", out="out.ply")
    mesh = read_mesh(folder / "out.ply")
    assert len(found["point/place"]) == len(mesh.vertices) > len(read_mesh(folder / "quads.obj").vertices)
    assert len(found["face/material"]) == len(mesh.polygons.sizes)
    # New vertices lie on the receiver's flat sides, a little inside of the donor's round ones.
    assert np.abs(found["point/place"] - mesh.vertices).max() < 0.1
    own = own_data(folder, point_height=np.zeros(54))
    assert run(folder, "quads.obj", "--what", "uv,attributes", "--cut-seams", *own) == 2
    assert "leave one of the two out" in capsys.readouterr().err


REFUSALS = [
    (["--what", "weights"], "donor.obj: the donor has no vertex group; give a file that has with --target-data"),
    (["--what", "color", "--target-data", "all.npz"], "--target-data is given and none of uv, attributes, weights"),
    (["--what", "weights", "--key-scale", "2"], "--key-scale is given and none of keys is in --what"),
    (
        ["--what", "weights", "--target-data", "all.npz", "--names", "Arm*"],
        "no vertex group called Arm*; it has: Up per",
    ),
    (["--what", "weights", "--target-data", "none.npz"], "none.npz: No such file"),
    (["--what", "weights", "--target-data", "donor.obj"], "donor.obj: layers are read from .npz files"),
    (["--what", "weights", "--target-data", "map.npz"], "map.npz: the array target_size is none of point/NAME"),
    (["--what", "weights", "--source-data", "all.npz"], "all.npz: edges row"),
    (["--what", "weights", "--target-data", "all.npz", "--locked", "Arm"], "receiver has no vertex group or shape key"),
    (["--what", "weights", "--target-data", "all.npz", "--mix-factor", "2"], "--mix-factor must be from 0 to 1"),
    (["--what", "weights", "--target-data", "all.npz", "--limit-total", "0"], "--limit-total must be at least 1"),
    (["--what", "keys", "--target-data", "all.npz", "--key-scale", "tall"], "global, local or a positive number"),
    (["--what", "keys", "--target-data", "all.npz", "--key-smoothing", "-1"], "--key-smoothing must not be negative"),
    (["--what", "keys", "--target-data", "all.npz", "--data-output", "all.npz"], "would be written over, and is read"),
    (["--what", "keys", "--target-data", "all.npz", "--data-output", "keys.txt"], "must end in .npz"),
]


@pytest.mark.parametrize(("options", "words"), REFUSALS, ids=[" ".join(options) for options, _ in REFUSALS])
def test_what_cannot_be_done_is_refused_and_nothing_is_written(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, options, words
) -> None:
    monkeypatch.chdir(folder)
    before = sorted(folder.iterdir())
    assert run(folder, "bare.obj", *options) == 2
    assert words in capsys.readouterr().err
    assert sorted(folder.iterdir()) == before


WRONG = [
    ("point/height", np.zeros(3), "point/height has 3 rows, "),
    ("corner/tint", np.zeros(3), "1152 corners of polygons"),
    ("face/material", np.zeros(3), "288 polygons"),
    ("edge/crease", np.zeros(3), "edge/crease needs the array edges"),
    ("weights/Arm", np.zeros((312, 2)), "weights/Arm should be numbers of shape (312,)"),
    ("weights/Arm", np.full(312, -1.0), "weights: donor_weights: 312 weights are negative"),
    ("keys/Smile", np.zeros(312), "keys/Smile should be numbers of shape (312, 3)"),
    ("keys/Smile", np.full((312, 3), np.nan), "keys: donor_keys: key 0 is not finite in 312 vertices"),
    ("uv/Second", np.zeros((1152, 3)), "uv/Second should be numbers of shape (1152, 2)"),
    ("normals", np.zeros((1152, 2)), "normals should be numbers of shape (1152, 3)"),
    ("point/when", np.zeros(312, "datetime64[s]"), "point/when holds datetime64[s]"),
    ("corner/tint", np.full(1152, np.nan), "corner/tint: "),
    ("height", np.zeros(312), "the array height is none of point/NAME"),
]


@pytest.mark.parametrize(("name", "array", "words"), WRONG, ids=[f"{name} {words}" for name, _, words in WRONG])
def test_data_that_do_not_fit_are_refused_by_the_name_of_the_array(
    folder: Path, capsys: pytest.CaptureFixture[str], name, array, words
) -> None:
    np.savez(folder / "all.npz", **{name: array})
    kind = {"weights": "weights", "keys": "keys", "normals": "normals", "uv": "uv"}.get(
        name.partition("/")[0], "attributes"
    )
    assert run(folder, "bare.obj", "--what", kind, "--target-data", str(folder / "all.npz")) == 2
    assert words in capsys.readouterr().err
    assert not (folder / "out.obj").exists() and not (folder / "out.npz").exists()


def test_normals_of_the_receiver_are_overwritten_on_request_only(folder: Path, capsys: Any) -> None:
    own = own_data(folder, normals=np.tile([0.0, 0.0, 1.0], (270, 1)))
    given = ("--what", "normals", "--target-data", str(folder / "all.npz"), *own)
    assert run(folder, "bare.obj", *given) == 2
    assert "custom normals of its own; give --overwrite" in capsys.readouterr().err
    found = layers(folder, "bare.obj", "--what", "normals", *own, "--overwrite")
    assert not np.allclose(found["normals"], [0.0, 0.0, 1.0])
