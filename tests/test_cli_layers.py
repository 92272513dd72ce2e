# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft transfer` of attributes, vertex groups, shape keys and normals: .npz files and PLY properties."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograft.correspondence import Correspondence
from isograft.files import read_mesh
from isograft.formats.layers import Layers
from isograft.formats.mesh_output import MeshOutput, write_ply_mesh
from isograft.transfer import fill_point, transfer_corner, transfer_face
from layer_files import SIZE, all_kinds, layers, own_data, turn
from transfer_files import run, spoil_map


def test_a_turned_and_larger_twin_gets_every_layer_exactly(layer_folder: Path) -> None:
    found = layers(layer_folder, "twin.obj", "--what", "uv,attributes,weights,keys,normals", map_name="same.npz")
    expected = all_kinds(layer_folder)
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


def test_another_tessellation_gets_means_of_numbers_and_one_of_the_labels(layer_folder: Path) -> None:
    found = layers(layer_folder, "quads.obj", "--what", "attributes,weights")
    map_ = Correspondence.load(layer_folder / "map.npz")
    np.testing.assert_allclose(found["point/place"], map_.points, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["weights/Up per"], map_.points[:, 2] / 4, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(found["point/number"], map_.vertex)
    donor, receiver = (read_mesh(layer_folder / name) for name in ("donor.obj", "quads.obj"))
    geometry = receiver.vertices, receiver.faces, donor.vertices, donor.faces
    given = all_kinds(layer_folder)
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


def test_more_uv_maps_come_with_the_files_own_or_alone(layer_folder: Path, capsys: Any) -> None:
    found = layers(layer_folder, "quads.obj", "--what", "uv", "--names", "S*", "--json")
    assert json.loads(capsys.readouterr().out)["uv_maps"] == 1
    assert set(found) == {"uv/Second"}
    # Islands and seams are kept as those of the file's own map.
    np.testing.assert_allclose(
        2 * found["uv/Second"], read_mesh(layer_folder / "out.obj").corner_uvs, rtol=0, atol=1e-6
    )
    lines = (layer_folder / "donor.obj").read_text().splitlines()
    bare = [line if line[0] == "v" else re.sub(r"/\d+", "", line) for line in lines if line[:2] != "vt"]
    (layer_folder / "donor.obj").write_text("\n".join(bare))
    alone = layers(layer_folder, "quads.obj", "--what", "uv")
    assert set(alone) == {"uv/Second", "uv/Third"} and read_mesh(layer_folder / "out.obj").corner_uvs is None
    assert run(layer_folder, "quads.obj", "--what", "uv") == 2
    assert "the donor has no texture coordinates" in capsys.readouterr().err


def test_materials_of_an_obj_arrive_face_by_face(layer_folder: Path) -> None:
    lines = (layer_folder / "donor.obj").read_text().splitlines()
    first = next(row for row, line in enumerate(lines) if line.startswith("f "))
    lines[first + 144 : first + 144] = ["usemtl upper skin"]
    lines[first + 48 : first + 48] = ["usemtl lower"]
    (layer_folder / "sub").mkdir()
    (layer_folder / "sub" / "donor.obj").write_text("\n".join(["mtllib skin.mtl", *lines]))
    assert run(layer_folder, "quads.obj", "--what", "attributes", donor="sub/donor.obj") == 0
    donor, written = read_mesh(layer_folder / "sub" / "donor.obj"), read_mesh(layer_folder / "out.obj")
    given = np.array([""] * 48 + ["lower"] * 96 + ["upper skin"] * 144)
    np.testing.assert_array_equal(donor.layers.face["material"], given)
    geometry = written.vertices, written.faces, donor.vertices, donor.faces
    polygons = {"receiver_polygons": written.triangle_polygon, "donor_polygons": donor.triangle_polygon}
    expected = transfer_face(Correspondence.load(layer_folder / "map.npz"), *geometry, given, **polygons).values
    assert set(expected) == {"", "lower", "upper skin"}
    np.testing.assert_array_equal(np.load(layer_folder / "out.npz")["face/material"], expected)
    # An OBJ cannot take a material back: none is called so.
    np.testing.assert_array_equal(written.layers.face["material"], np.where(expected == "", "None", expected))
    assert f"mtllib {Path('sub', 'skin.mtl')}" in (layer_folder / "out.obj").read_text()
    # A receiver's own materials stay where only texture coordinates come.
    (layer_folder / "own.obj").write_bytes((layer_folder / "out.obj").read_bytes())
    assert run(layer_folder, "own.obj", "--what", "uv", out="again.obj") == 0
    again = read_mesh(layer_folder / "again.obj")
    np.testing.assert_array_equal(again.layers.face["material"], written.layers.face["material"])
    assert not (layer_folder / "again.npz").exists()


@pytest.mark.parametrize("text", [False, True])
def test_ply_properties_go_in_and_out(layer_folder: Path, text: bool) -> None:
    donor = read_mesh(layer_folder / "donor.obj")
    given = all_kinds(layer_folder)
    carried = Layers(
        point={"height": given["point/height"], "small": given["point/small"], "isograft_x": given["point/height"]},
        face={"material": given["face/material"]},
        edge={"crease": given["edge/crease"]},
        weights={"Upper": given["weights/Up per"]},
        edges=given["edges"],
    )
    polygons = donor.polygons
    path = layer_folder / "donor.ply"
    write_ply_mesh(path, MeshOutput(donor.vertices, polygons.sizes, polygons.corners, layers=carried))
    if text:
        as_text(path)
    options = ("--what", "attributes,weights")
    assert run(layer_folder, "twin.obj", *options, out="out.ply", map_name="same.npz", donor="donor.ply") == 0
    found, arrays = read_mesh(layer_folder / "out.ply").layers, dict(np.load(layer_folder / "out.npz"))
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


def test_a_ply_takes_what_it_has_a_place_for_and_the_npz_everything(layer_folder: Path, capsys: Any) -> None:
    assert layers(layer_folder, "quads.obj", "--what", "uv,attributes,weights", "--json", out="out.ply")
    assert json.loads(capsys.readouterr().out)["data"] == str(layer_folder / "out.npz")
    found = read_mesh(layer_folder / "out.ply")
    # One number a row; white space would end a name.
    assert set(found.layers.point) == {"height", "number", "small", "flag"}
    assert set(found.layers.weights) == {"Up_per", "Lower"}
    assert set(found.layers.face) == {"material"} and set(found.layers.edge) == {"crease", "seam"}
    # Polygons and texture coordinates are where they were.
    assert run(layer_folder, "quads.obj", "--what", "uv", out="plain.ply") == 0
    plain = read_mesh(layer_folder / "plain.ply")
    np.testing.assert_array_equal(found.polygons.corners, plain.polygons.corners)
    np.testing.assert_array_equal(found.corner_uvs, plain.corner_uvs)


def test_what_the_receivers_ply_carries_stays(layer_folder: Path) -> None:
    mesh = read_mesh(layer_folder / "quads.obj")
    own = Layers(point={"mine": np.arange(54, dtype=np.int32)}, face={"part": np.arange(45, dtype=np.uint8)})
    sizes, corners = mesh.polygons.sizes, mesh.polygons.corners
    write_ply_mesh(layer_folder / "own.ply", MeshOutput(mesh.vertices, sizes, corners, layers=own))
    assert run(layer_folder, "own.ply", "--what", "uv", out="out.ply") == 0
    found = read_mesh(layer_folder / "out.ply").layers
    np.testing.assert_array_equal(found.point["mine"], np.arange(54))
    np.testing.assert_array_equal(found.face["part"], np.arange(45))


def test_own_data_are_written_again_where_none_come_to_them(layer_folder: Path) -> None:
    own = own_data(layer_folder, keys_Wink=np.ones((54, 3)), point_mine=np.arange(54))
    assert run(layer_folder, "bare.obj", "--what", "uv", *own) == 0
    found = dict(np.load(layer_folder / "out.npz"))
    assert set(found) == {"keys/Wink", "point/mine"}
    np.testing.assert_array_equal(found["point/mine"], np.arange(54))


def test_only_named_layers_come_and_own_ones_stay(layer_folder: Path) -> None:
    n = len(read_mesh(layer_folder / "bare.obj").vertices)
    own = own_data(layer_folder, point_height=np.full(n, 9), weights_Lower=np.full(n, 0.5))
    chosen = ("--what", "attributes,weights", "--names", "hei*, Lower", *own)
    found = layers(layer_folder, "bare.obj", *chosen)
    assert set(found) == {"point/height", "point/height.001", "weights/Lower", "weights/Lower.001"}
    assert (found["point/height"] == 9).all() and (found["weights/Lower"] == 0.5).all()
    written = layers(layer_folder, "bare.obj", *chosen, "--overwrite")
    assert set(written) == {"point/height", "weights/Lower"}
    np.testing.assert_array_equal(written["point/height"], found["point/height.001"])
    np.testing.assert_array_equal(written["weights/Lower"], found["weights/Lower.001"])


def test_weights_are_mixed_limited_normalised_and_locked_as_asked(layer_folder: Path, capsys: Any) -> None:
    n = len(read_mesh(layer_folder / "bare.obj").vertices)
    upper = Correspondence.load(layer_folder / "map.npz").points[:, 2] / 4
    own = own_data(layer_folder, weights_Lower=np.full(n, 0.5))
    base = ("--what", "weights", *own, "--overwrite")
    found = layers(layer_folder, "bare.obj", *base, "--mix-mode", "add", "--mix-factor", "0.5")
    np.testing.assert_allclose(found["weights/Lower"], np.clip(0.5 * (1.5 - upper) + 0.25, 0, 1), rtol=0, atol=1e-9)
    found = layers(layer_folder, "bare.obj", *base, "--locked", "Low*", "--normalise")
    assert "locked vertex groups are as they were: Lower" in capsys.readouterr().err
    np.testing.assert_array_equal(found["weights/Lower"], np.full(n, 0.5))
    np.testing.assert_allclose(found["weights/Up per"][upper > 0], 0.5, rtol=0, atol=1e-9)
    found = layers(layer_folder, "bare.obj", *base, "--limit-total", "1")
    assert (np.minimum(found["weights/Lower"], found["weights/Up per"]) == 0).all()


def test_locked_keys_stay_and_the_scale_of_keys_may_be_given(layer_folder: Path) -> None:
    n = len(read_mesh(layer_folder / "twin.obj").vertices)
    own = own_data(layer_folder, keys_Lift=np.ones((n, 3)))
    found = layers(
        layer_folder, "twin.obj", "--what", "keys", *own, "--overwrite", "--locked", "Lift", "--key-scale", "3",
        "--key-smoothing", "2", map_name="same.npz",
    )  # fmt: skip
    np.testing.assert_array_equal(found["keys/Lift"], np.ones((n, 3)))
    expected = 3 * all_kinds(layer_folder)["keys/Swell"] @ turn().T
    np.testing.assert_allclose(found["keys/Swell"], expected, rtol=0, atol=1e-6)


def test_unmatched_rows_are_empty_or_own_or_filled_and_marked(layer_folder: Path) -> None:
    spoil_map(layer_folder, np.arange(20, 23))
    n, lost = len(read_mesh(layer_folder / "bare.obj").vertices), np.arange(20, 23)
    found = layers(layer_folder, "bare.obj", "--what", "attributes,weights,keys,normals")
    for name in ("point/height", "weights/Lower", "keys/Swell"):
        assert not found[name][lost].any(), name
    assert (found["point/word"][lost] == "").all()
    own = own_data(layer_folder, point_height=np.full(n, 9, np.float32))
    kept = layers(layer_folder, "bare.obj", "--what", "attributes", "--names", "height", "--overwrite", *own)
    assert (kept["point/height"][lost] == 9).all() and (kept["point/height"][:20] != 9).all()
    everything = layers(layer_folder, "bare.obj", "--what", "attributes,weights,keys,normals", "--fill", out="out.ply")
    marks = everything.pop("point/isograft_filled")
    assert np.flatnonzero(marks).tolist() == lost.tolist()
    map_ = Correspondence.load(layer_folder / "map.npz")
    mesh = read_mesh(layer_folder / "bare.obj")
    expected = fill_point(mesh.vertices, mesh.faces, np.nan_to_num(map_.points), map_.matched).values
    np.testing.assert_allclose(everything["point/place"], expected, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        everything["weights/Lower"] + everything["weights/Up per"], np.ones(n), rtol=0, atol=1e-6
    )
    assert everything["normals"].any(axis=1).all() and everything["keys/Swell"][lost].any(axis=1).all()
    assert (everything["face/name"] != "").all() and (everything["point/word"] != "").all()


def test_polygons_that_are_cut_carry_layers_too(layer_folder: Path, capsys: Any) -> None:
    found = layers(layer_folder, "quads.obj", "--what", "uv,attributes", "--cut-seams", out="out.ply")
    mesh = read_mesh(layer_folder / "out.ply")
    assert len(found["point/place"]) == len(mesh.vertices) > len(read_mesh(layer_folder / "quads.obj").vertices)
    assert len(found["face/material"]) == len(mesh.polygons.sizes)
    # New vertices lie on the receiver's flat sides, a little inside of the donor's round ones.
    assert np.abs(found["point/place"] - mesh.vertices).max() < 0.1


def test_normals_of_the_receiver_are_overwritten_on_request_only(layer_folder: Path, capsys: Any) -> None:
    own = own_data(layer_folder, normals=np.tile([0.0, 0.0, 1.0], (270, 1)))
    given = ("--what", "normals", "--target-data", str(layer_folder / "all.npz"), *own)
    assert run(layer_folder, "bare.obj", *given) == 2
    assert "custom normals of its own; give --overwrite" in capsys.readouterr().err
    found = layers(layer_folder, "bare.obj", "--what", "normals", *own, "--overwrite")
    assert not np.allclose(found["normals"], [0.0, 0.0, 1.0])


def with_normals(folder: Path, name: str, normals: np.ndarray) -> None:
    """Give an OBJ a vn of its own at every corner."""
    rows = iter(range(1, len(normals) + 1))
    lines = []
    for line in (folder / name).read_text().splitlines():
        keyword, *words = line.split()
        if keyword == "f":
            words = [f"{word}{'' if '/' in word else '/'}/{next(rows)}" for word in words]
        lines.append(" ".join([keyword, *words]))
    table = [f"vn {x!r} {y!r} {z!r}" for x, y, z in normals.tolist()]
    (folder / name).write_text("\n".join([*table, *lines]) + "\n")


def test_normals_of_an_obj_arrive_in_an_obj_turned(layer_folder: Path) -> None:
    given = np.random.default_rng(0).normal(size=(288, 4, 3))
    given /= np.linalg.norm(given, axis=2, keepdims=True)
    # Those of one quad are left out.
    given[10] = 0.0
    given = given.reshape(-1, 3)
    with_normals(layer_folder, "donor.obj", given)
    np.testing.assert_array_equal(read_mesh(layer_folder / "donor.obj").layers.normals, given)
    assert run(layer_folder, "twin.obj", "--what", "normals", map_name="same.npz") == 0
    found = read_mesh(layer_folder / "out.obj").layers.normals
    np.testing.assert_allclose(found, given @ turn().T, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found, np.load(layer_folder / "out.npz")["normals"], rtol=0, atol=1e-8)


def test_a_receivers_normals_stay_or_are_overwritten_on_request(layer_folder: Path, capsys: Any) -> None:
    mesh = read_mesh(layer_folder / "quads.obj")
    own = np.tile([0.0, 0.0, 1.0], (len(mesh.polygons.corners), 1))
    with_normals(layer_folder, "quads.obj", own)
    assert run(layer_folder, "quads.obj", "--what", "uv") == 0
    kept = read_mesh(layer_folder / "out.obj")
    np.testing.assert_array_equal(kept.layers.normals, own)
    assert kept.corner_uvs is not None
    options = ("--what", "normals", "--target-data", str(layer_folder / "all.npz"))
    assert run(layer_folder, "quads.obj", *options) == 2
    assert "the receiver has custom normals of its own; give --overwrite" in capsys.readouterr().err
    assert run(layer_folder, "quads.obj", *options, "--overwrite") == 0
    assert (read_mesh(layer_folder / "out.obj").layers.normals != own).any()


def test_a_ply_has_normals_where_each_vertex_has_one(layer_folder: Path) -> None:
    mesh = read_mesh(layer_folder / "quads.obj")
    smooth = mesh.vertices * [1, 1, 0]
    with_normals(layer_folder, "quads.obj", smooth[mesh.polygons.corners])
    assert run(layer_folder, "quads.obj", "--what", "uv", out="out.ply") == 0
    np.testing.assert_array_equal(read_mesh(layer_folder / "out.ply").normals, smooth)
    options = ("--what", "normals", "--overwrite", "--target-data", str(layer_folder / "all.npz"))
    flat = np.arange(len(mesh.polygons.corners)) % 4 == 0
    np.savez(layer_folder / "all.npz", normals=np.where(np.resize(flat, 1152)[:, None], [1.0, 0, 0], [0, 0.6, 0.8]))
    assert run(layer_folder, "quads.obj", *options, out="out.ply") == 0
    assert read_mesh(layer_folder / "out.ply").normals is None


def test_normals_of_a_donor_follow_the_shape_that_it_is_given(layer_folder: Path) -> None:
    given = np.tile([0.6, 0.0, 0.8], (1152, 1))
    with_normals(layer_folder, "donor.obj", given)
    assert run(layer_folder, "twin.obj", "--what", "shape", map_name="same.npz") == 0
    found = read_mesh(layer_folder / "out.obj")
    np.testing.assert_allclose(found.vertices, read_mesh(layer_folder / "twin.obj").vertices, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.layers.normals, given @ turn().T, rtol=0, atol=1e-6)
