# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft transfer --cut-seams` and `--mark-seams`: what the receiver carries is cut along, islands end at marks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from isograft.files import MeshFile, read_mesh
from isograft.formats.layers import Layers
from isograft.formats.mesh_output import MeshOutput, write_ply_mesh
from layer_files import own_data
from seamed_shapes import COARSE
from transfer_files import run

ROWS, COLUMNS = COARSE["cylinder"]


@pytest.fixture
def cut(layer_folder: Path) -> tuple[MeshFile, dict[str, np.ndarray], MeshFile, dict[str, np.ndarray]]:
    """Receiver and its data, whose numbers are linear in the place or tell the row; both after the cut."""
    mesh = read_mesh(layer_folder / "quads.obj")
    corners, polygons = mesh.polygons.corners, len(mesh.polygons.sizes)
    at_corners, of_polygon = mesh.vertices[corners], np.repeat(np.arange(polygons), 4)
    edges = np.unique(np.sort(np.stack([corners, np.roll(corners.reshape(-1, 4), -1, 1).ravel()], 1), 1), axis=0)
    normals = at_corners * [1, 1, 0] + [0, 0, 0.5]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[of_polygon % 5 == 0] = 0.0
    own = {
        "point/place": mesh.vertices,
        "point/number": np.arange(len(mesh.vertices)),
        "point/word": np.array([f"v{i}" for i in range(len(mesh.vertices))]),
        "point/half": mesh.vertices.astype(np.float32),
        "corner/place": at_corners + 100.0 * of_polygon[:, None],
        "corner/polygon": of_polygon,
        "face/polygon": np.arange(polygons),
        "face/name": np.array([f"p{i}" for i in range(polygons)]),
        "edges": edges.astype(np.int32),
        "edge/row": 1.0 + np.arange(len(edges)),
        "uv/Own": at_corners[:, :2] + 10.0 * of_polygon[:, None],
        "weights/Up": mesh.vertices[:, 2] / 4,
        "keys/Grow": 2 * mesh.vertices,
        "normals": normals,
    }
    options = own_data(layer_folder, **{name.replace("/", "_"): array for name, array in own.items()})
    assert run(layer_folder, "quads.obj", "--what", "uv", "--cut-seams", *options, out="out.obj") == 0
    return mesh, own, read_mesh(layer_folder / "out.obj"), dict(np.load(layer_folder / "out.npz"))


def test_numbers_lie_between_those_that_were_there_and_all_else_is_picked(cut) -> None:
    mesh, own, after, found = cut
    assert set(found) == set(own)
    corners = after.polygons.corners
    assert len(after.vertices) == len(mesh.vertices) + ROWS * 2 + 1
    for name, array in own.items():
        assert found[name].dtype == array.dtype, name
    np.testing.assert_allclose(found["point/place"], after.vertices, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found["point/half"], after.vertices, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found["weights/Up"], after.vertices[:, 2] / 4, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found["keys/Grow"], 2 * after.vertices, rtol=0, atol=1e-8)
    polygon = found["corner/polygon"]
    np.testing.assert_allclose(found["corner/place"] - 100.0 * polygon[:, None], after.vertices[corners], atol=1e-6)
    np.testing.assert_allclose(found["uv/Own"] - 10.0 * polygon[:, None], after.vertices[corners, :2], atol=1e-6)
    np.testing.assert_array_equal(found["point/word"], [f"v{i}" for i in found["point/number"]])
    # Of the two ends of its edge a new vertex has the label of the nearer one.
    number = found["point/number"]
    np.testing.assert_array_equal(number[: len(mesh.vertices)], np.arange(len(mesh.vertices)))
    new = after.vertices[len(mesh.vertices) :]
    nearest = np.linalg.norm(new[:, None] - mesh.vertices, axis=2).argmin(axis=1)
    assert (number[len(mesh.vertices) :] == nearest).mean() > 0.6


def test_pieces_have_what_their_polygon_had(cut) -> None:
    mesh, _, after, found = cut
    sizes, corners = after.polygons.sizes, after.polygons.corners
    np.testing.assert_array_equal(np.repeat(found["face/polygon"], sizes), found["corner/polygon"])
    np.testing.assert_array_equal(found["face/name"], [f"p{i}" for i in found["face/polygon"]])
    # All of every polygon is there: the pieces' areas sum to its own.
    areas = [
        0.5
        * np.linalg.norm(np.cross(*np.moveaxis(m.vertices[m.faces[:, 1:]] - m.vertices[m.faces[:, :1]], 1, 0)), axis=1)
        for m in (mesh, after)
    ]
    before = np.bincount(mesh.triangle_polygon, areas[0])
    np.testing.assert_allclose(np.bincount(found["face/polygon"][after.triangle_polygon], areas[1]), before, rtol=1e-6)
    assert len(sizes) > len(before)
    # Custom normals are units between the two, none where there was none.
    normals, none = found["normals"], found["corner/polygon"] % 5 == 0
    assert (normals[none] == 0).all()
    np.testing.assert_allclose(np.linalg.norm(normals[~none], axis=1), 1, rtol=0, atol=1e-9)
    radial = after.vertices[corners] * [1, 1, 0] + [0, 0, 0.5]
    radial /= np.linalg.norm(radial, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", normals[~none], radial[~none]).min() > 0.99
    np.testing.assert_array_equal(after.layers.normals != 0, normals != 0)


def test_halves_of_edges_have_what_the_edge_had_and_new_ones_nothing(cut) -> None:
    mesh, own, after, found = cut
    edges, row = found["edges"], found["edge/row"]
    ends = {tuple(pair) for pair in np.sort(edges, axis=1).tolist()}
    corners = [
        after.polygons.corners[a : a + n]
        for a, n in zip(np.cumsum(after.polygons.sizes) - after.polygons.sizes, after.polygons.sizes, strict=True)
    ]
    wanted = {tuple(sorted((int(a), int(b)))) for c in corners for a, b in zip(c, np.roll(c, -1), strict=True)}
    assert ends == wanted and len(ends) == len(edges)
    old = row > 0
    assert (~old).sum() == len(edges) - len(own["edges"]) - (ROWS + 1) and (~old).sum() > ROWS
    a, b = (mesh.vertices[own["edges"][row[old].astype(int) - 1, k]] for k in range(2))
    for k in range(2):
        # Each end lies on the edge whose value it has.
        point = after.vertices[edges[old, k]]
        off = np.linalg.norm(a - point, axis=1) + np.linalg.norm(b - point, axis=1) - np.linalg.norm(a - b, axis=1)
        assert off.max() < 1e-7
    pieces = np.bincount(row[old].astype(int), minlength=len(own["edges"]) + 1)[1:]
    assert (np.sort(pieces)[-(ROWS + 1) :] == 2).all() and (np.sort(pieces)[: -(ROWS + 1)] == 1).all()


def test_what_a_ply_carries_is_cut_along(layer_folder: Path) -> None:
    mesh = read_mesh(layer_folder / "quads.obj")
    own = Layers(point={"mine": mesh.vertices[:, 2]}, face={"part": np.arange(45, dtype=np.uint8)})
    sizes, corners = mesh.polygons.sizes, mesh.polygons.corners
    uvs = mesh.vertices[corners, :2] + 2.0
    write_ply_mesh(layer_folder / "own.ply", MeshOutput(mesh.vertices, sizes, corners, corner_uvs=uvs, layers=own))
    assert run(layer_folder, "own.ply", "--what", "uv", "--cut-seams", "--overwrite", out="cut.ply") == 0
    found = read_mesh(layer_folder / "cut.ply")
    np.testing.assert_allclose(found.layers.point["mine"], found.vertices[:, 2], rtol=0, atol=1e-6)
    assert len(found.layers.face["part"]) == len(found.polygons.sizes) > 45
    assert set(found.layers.face["part"].tolist()) == set(range(45))


def test_edges_along_which_the_islands_part_are_marked(layer_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--what", "uv", "--cut-seams", "--mark-seams")
    assert run(layer_folder, "quads.obj", *options, out="out.ply") == 0
    found, mesh = dict(np.load(layer_folder / "out.npz")), read_mesh(layer_folder / "out.ply")
    seams = found["edges"][found["edge/uv_seam"]]
    # The tube's one seam, from end to end along new vertices.
    ends, count = np.unique(seams, return_counts=True)
    assert (np.sort(count)[:2] == 1).all() and (np.sort(count)[2:] == 2).all()
    assert ends.min() >= ROWS * COLUMNS + COLUMNS
    np.testing.assert_allclose(np.sort(mesh.vertices[ends[count == 1], 2]), [0, 4], rtol=0, atol=1e-6)
    np.testing.assert_array_equal(mesh.layers.edges[mesh.layers.edge["uv_seam"] != 0], seams)
    # Beside own marks, in a table that has few edges.
    mine = np.array([[1, 0], [2, 1]], np.int32)
    own = own_data(layer_folder, edges=mine, edge_uv_seam=np.array([True, False]), edge_row=np.array([7, 8]))
    assert run(layer_folder, "quads.obj", "--what", "uv", "--mark-seams", *own) == 0
    found = dict(np.load(layer_folder / "out.npz"))
    np.testing.assert_array_equal(found["edges"][:2], mine)
    assert found["edge/uv_seam"].tolist() == [True, False, *[True] * (len(found["edges"]) - 2)]
    assert found["edge/row"].tolist() == [7, 8, *[0] * (len(found["edges"]) - 2)]
    assert len(found["edges"]) > 2 + ROWS - 1
    given = ("--target-data", str(layer_folder / "all.npz"))
    assert run(layer_folder, "quads.obj", "--what", "weights", *given, "--mark-seams") == 2
    assert "--mark-seams marks the seams of texture coordinates; add uv to --what" in capsys.readouterr().err
