# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of meshes: row i is vertex i, polygons keep their way back, damage is named with its place."""

from __future__ import annotations

import struct
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import isograft
import numpy as np
import pytest
import surfaces
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from isograft.files import MeshFile, read_mesh

BAD_INPUTS = Path(__file__).parent / "bad_inputs"
CODES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}

# A pentagonal prism's roof: five triangles' worth of one pentagon, a quad, a triangle; a concave quad at the end.
VERTICES = np.array(
    [[0, 0, 0], [2, 0, 0], [3, 1, 0], [1, 3, 0], [-1, 1, 0], [2, 0, -1], [0, 0, -1], [5, 5, 1], [0.5, 0.25, 0.125]]
)
POLYGONS = [[0, 1, 2, 3, 4], [1, 0, 6, 5], [5, 6, 7], [0, 1, 8, 4]]
SIZES = [5, 4, 3, 4]
CORNERS = [corner for polygon in POLYGONS for corner in polygon]


def save(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def ply(order: str, count_type: str = "uchar", index_type: str = "int", extra: bool = True) -> bytes:
    """The polygons above as PLY, with properties and an element that readers must pass over."""
    head = ["ply", f"format {order} 1.0", "comment made by a test", "obj_info nothing"]
    if extra:
        head += ["element material 2", "property list uchar float weights", "property short kind"]
    head += [f"element vertex {len(VERTICES)}", "property double x", "property float quality", "property double y"]
    head += ["property double z", "property uchar red", "property uchar green", "property uchar blue"]
    head += [f"element face {len(POLYGONS)}", "property uchar flags"]
    head += [f"property list {count_type} {index_type} vertex_indices", "property float area", "end_header", ""]
    rows: list[list[tuple[str, float]]] = []
    if extra:
        rows += [[("uchar", 1), ("float", 0.5), ("short", -3)], [("uchar", 0), ("short", 4)]]
    for i, (x, y, z) in enumerate(VERTICES):
        colour = [("uchar", 10.0 * i), ("uchar", 255.0), ("uchar", 0.0)]
        rows.append([("double", x), ("float", i), ("double", y), ("double", z), *colour])
    for polygon in POLYGONS:
        items = [(index_type, float(corner)) for corner in polygon]
        rows.append([("uchar", 7), (count_type, len(polygon)), *items, ("float", 1.5)])
    if order == "ascii":
        body = "".join(" ".join(f"{value:g}" for _, value in row) + "\n" for row in rows).encode()
    else:
        mark = "<" if "little" in order else ">"
        body = b"".join(
            struct.pack(mark + CODES[kind], value if kind in ("float", "double") else int(value))
            for row in rows
            for kind, value in row
        )
    return "\n".join(head).encode() + body


def check_polygons(mesh: MeshFile) -> None:
    assert mesh.vertices.dtype == np.float64
    assert mesh.faces.dtype == np.int32
    assert np.allclose(mesh.vertices, VERTICES)
    assert mesh.polygons.sizes.tolist() == SIZES
    assert mesh.polygons.corners.tolist() == CORNERS
    check_triangles(mesh)


def check_triangles(mesh: MeshFile) -> None:
    """Every polygon is covered once by its size - 2 triangles, in the polygon's own sense."""
    polygons = mesh.polygons
    assert (polygons.corners[mesh.triangle_corners] == mesh.faces).all()
    owner = np.repeat(np.arange(len(polygons.sizes)), polygons.sizes)
    assert (owner[mesh.triangle_corners] == mesh.triangle_polygon[:, None]).all()
    assert (np.diff(mesh.triangle_polygon) >= 0).all()
    assert (np.bincount(mesh.triangle_polygon, minlength=len(polygons.sizes)) == polygons.sizes - 2).all()
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    start = 0
    for polygon, size in enumerate(polygons.sizes):
        ring = mesh.vertices[polygons.corners[start : start + size]]
        start += size
        newell = np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0)
        own = normals[mesh.triangle_polygon == polygon]
        # The vector areas always add up; if the lengths do too, no triangle is turned over.
        assert np.allclose(own.sum(axis=0), newell)
        if np.ptp(ring @ newell) < 1e-9:
            assert np.linalg.norm(own, axis=1).sum() == pytest.approx(np.linalg.norm(newell))


@pytest.mark.parametrize("order", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("extra", [True, False])
@pytest.mark.parametrize(("count_type", "index_type"), [("uchar", "int"), ("int", "uint"), ("ushort", "uchar")])
def test_ply_of_every_kind_gives_the_same_polygons(
    tmp_path: Path, order: str, extra: bool, count_type: str, index_type: str
) -> None:
    mesh = read_mesh(save(tmp_path / "a.ply", ply(order, count_type, index_type, extra)))
    check_polygons(mesh)
    assert mesh.colors is not None
    assert np.allclose(mesh.colors, [[10 * i / 255, 1.0, 0.0] for i in range(len(VERTICES))])


OBJ = """# comment
mtllib x.mtl
o thing
v 0 0 0
v 2 0 0 # at the end
v 3 1 0
v 1 3 0
v -1 1 0
vt 0 0
vt 1 0.5
vt 0.25 1 0
vn 0 0 1
f 1 2 3 4 5
v 2 0 -1
v 0 0 -1
usemtl m
s off
f 2/1 1/2 -1/-1 -2/1
v 5 5 1
v 0.5 0.25 0.125
f 6//1 7//1 8//1
f 1/3/1 \\
 2/2/1 9/1/1 5/3/1
l 1 2
"""


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_obj_keeps_vertices_whole_and_corner_uvs_apart(tmp_path: Path, ending: str) -> None:
    mesh = read_mesh(save(tmp_path / "a.obj", OBJ.replace("\n", ending)))
    check_polygons(mesh)
    uvs = mesh.corner_uvs
    assert uvs is not None
    assert uvs.shape == (len(CORNERS), 2)
    assert np.isnan(uvs[:5]).all()
    assert uvs[5:9].tolist() == [[0, 0], [1, 0.5], [0.25, 1], [0, 0]]
    assert np.isnan(uvs[9:12]).all()
    assert uvs[12:].tolist() == [[0.25, 1], [1, 0.5], [0, 0], [0.25, 1]]
    triangle_uvs = mesh.triangle_uvs
    assert triangle_uvs is not None
    assert triangle_uvs.shape == (len(mesh.faces), 3, 2)
    normals = mesh.layers.normals
    assert normals is not None
    assert normals.tolist() == [[0, 0, 0]] * 9 + [[0, 0, 1]] * 7


def test_normals_that_a_file_numbers_and_does_not_write_are_passed_over(tmp_path: Path) -> None:
    mesh = read_mesh(save(tmp_path / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//2 3//3\n"))
    assert mesh.faces.tolist() == [[0, 1, 2]]
    assert mesh.layers.normals is None


def test_obj_colours_behind_the_coordinates_are_read(tmp_path: Path) -> None:
    mesh = read_mesh(save(tmp_path / "a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n"))
    assert mesh.colors is not None
    assert (mesh.colors == np.eye(3)).all()
    assert mesh.corner_uvs is None


def off_text(head: str, colours: str = "", face_colours: str = "") -> str:
    vertices = "".join(f"{x:g} {y:g}\t{z:g}{colours}\n" for x, y, z in VERTICES)
    faces = "".join(f"{len(p)}  {' '.join(map(str, p))}{face_colours}\n" for p in POLYGONS)
    return f"{head}\n# a comment\n\n{vertices}\n{faces}"


@pytest.mark.parametrize(
    ("head", "colours", "face_colours", "expected"),
    [
        ("OFF\n9 4 0", "", "", None),
        ("OFF 9 4 0", "", " 255 0 0", None),
        ("OFF\n9 4 0", "", " 0.5 0.5 0.5 1", None),
        ("COFF\n9 4 0", " 255 0 51 255", "", [1.0, 0.0, 0.2, 1.0]),
        ("COFF\n9 4 0", " 1 0 0.2 1", "", [1.0, 0.0, 0.2, 1.0]),
        ("OFF\n9 4 0", " 255 0 51", "", [1.0, 0.0, 0.2]),
        ("9 4", "", "", None),
    ],
)
def test_off_with_and_without_colours_gives_the_same_polygons(
    tmp_path: Path, head: str, colours: str, face_colours: str, expected: list[float] | None
) -> None:
    mesh = read_mesh(save(tmp_path / "a.off", off_text(head, colours, face_colours)))
    check_polygons(mesh)
    if expected is None:
        assert mesh.colors is None
    else:
        assert mesh.colors is not None
        assert np.allclose(mesh.colors, expected)


def stl_bytes(mesh: surfaces.Mesh, header: bytes = b"solid facet is a lie") -> bytes:
    corners = mesh[0][mesh[1]].astype("<f4")
    body = b"".join(struct.pack("<3f", 0, 0, 0) + triangle.tobytes() + b"\0\0" for triangle in corners)
    return header.ljust(80) + struct.pack("<I", len(corners)) + body


def stl_text(mesh: surfaces.Mesh) -> str:
    facets = ""
    for triangle in mesh[0][mesh[1]].astype(np.float32):
        lines = "".join(f"      vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in triangle)
        facets += f"  facet normal 0 0 0\n    outer loop\n{lines}    endloop\n  endfacet\n"
    return f"solid thing\n{facets}endsolid thing\n"


@pytest.mark.parametrize("write", [stl_bytes, stl_text])
def test_stl_joins_equal_positions_in_the_order_of_their_first_use(
    tmp_path: Path, write: Callable[[surfaces.Mesh], Any]
) -> None:
    ball = surfaces.sphere(2)
    mesh = read_mesh(save(tmp_path / "a.stl", write(ball)))
    assert len(mesh.vertices) == len(ball[0])
    assert np.array_equal(mesh.vertices[mesh.faces].astype(np.float32), ball[0][ball[1]].astype(np.float32))
    first = np.unique(mesh.faces.ravel(), return_index=True)[1]
    assert (np.diff(first) > 0).all()
    assert mesh.surface().warnings == []


@pytest.mark.parametrize("name", ["l_shape", "star", "spiral"])
@pytest.mark.parametrize("turn", range(4))
def test_concave_polygons_are_cut_without_overlap(tmp_path: Path, name: str, turn: int) -> None:
    ring = {
        "l_shape": [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]],
        "star": [[(1 if i % 2 else 3) * f(i * np.pi / 6) for f in (np.cos, np.sin)] for i in range(12)],
        "spiral": [[0, 0], [6, 0], [6, 5], [1, 5], [1, 2], [4, 2], [4, 3], [2, 3], [2, 4], [5, 4], [5, 1], [0, 1]],
    }[name]
    points = np.c_[np.roll(ring, turn, axis=0), np.zeros(len(ring))] @ surfaces.rotation(turn).T
    text = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
    mesh = read_mesh(save(tmp_path / "a.obj", f"{text}f {' '.join(str(i + 1) for i in range(len(ring)))}\n"))
    check_triangles(mesh)


def test_polygons_without_an_area_are_told_and_keep_their_place(tmp_path: Path) -> None:
    text = "OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n1 2\n"
    mesh = read_mesh(save(tmp_path / "a.off", text))
    assert mesh.triangle_polygon.tolist() == [1]
    assert "2 polygons have fewer than three corners" in mesh.warnings[0]


def test_a_file_of_points_alone_is_a_cloud_and_may_be_too_small_for_a_surface(tmp_path: Path) -> None:
    mesh = read_mesh(save(tmp_path / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"))
    assert mesh.vertices.shape == (3, 3)
    with pytest.raises(isograft.InvalidInput, match=r"a\.obj: a point cloud of 3 rows is too small"):
        mesh.surface()


def test_the_suffix_decides_and_another_one_is_refused(tmp_path: Path) -> None:
    check_polygons(read_mesh(save(tmp_path / "A.PLY", ply("ascii"))))
    with pytest.raises(isograft.InvalidInput, match=r"cannot read \.fbx, only \.ply, \.obj, \.off, \.stl"):
        read_mesh(save(tmp_path / "a.fbx", ""))
    with pytest.raises(FileNotFoundError):
        read_mesh(tmp_path / "none.ply")


def expectations() -> list[tuple[str, str]]:
    lines = (BAD_INPUTS / "expected.txt").read_text().splitlines()
    pairs = [line.split(": ", 1) for line in lines if line and not line.startswith("#")]
    return [(name, words) for name, words in pairs]


def test_every_bad_input_has_an_expectation() -> None:
    files = {path.name for path in BAD_INPUTS.iterdir() if path.suffix in (".ply", ".obj", ".off", ".stl")}
    assert files == {name for name, _ in expectations()}
    assert len(files) >= 30


@pytest.mark.parametrize(("name", "words"), expectations())
def test_a_bad_file_is_refused_with_its_name_and_the_place(name: str, words: str) -> None:
    with pytest.raises(isograft.InvalidInput) as caught:
        read_mesh(BAD_INPUTS / name).surface()
    text = str(caught.value)
    assert text.startswith(str(BAD_INPUTS / name) + ": ")
    assert words in text


WHOLE = {
    "a.ply": ply("binary_little_endian"),
    "b.ply": ply("binary_big_endian", extra=False),
    "c.ply": ply("ascii"),
    "d.obj": OBJ.encode(),
    "e.off": off_text("COFF\n9 4 0", " 255 0 51 255").encode(),
    "f.stl": stl_bytes(surfaces.icosahedron()),
    "g.stl": stl_text(surfaces.icosahedron()).encode(),
}


@pytest.mark.parametrize("name", [name for name in WHOLE if name != "d.obj"])
def test_a_file_cut_anywhere_is_refused(tmp_path: Path, name: str) -> None:
    data = WHOLE[name].rstrip(b"\n") if name in ("c.ply", "e.off") else WHOLE[name]
    # Text may lose digits of its last number without trace; every loss of a line or a byte must show.
    last = {"c.ply": 6, "e.off": 1, "g.stl": 16}.get(name, 0)
    for end in [*range(0, len(data) - last, 7), len(data) - last - 1]:
        with pytest.raises(isograft.InvalidInput, match=r"(line|byte) \d+"):
            read_mesh(save(tmp_path / name, data[:end]))


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
@pytest.mark.parametrize("name", list(WHOLE))
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_file_with_changed_bytes_is_read_or_refused_but_never_crashes(
    tmp_path: Path, name: str, data: st.DataObject
) -> None:
    content = bytearray(WHOLE[name])
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.sampled_from(b"\0\n -.0123459aef/\xff\x80"))
    try:
        mesh = read_mesh(save(tmp_path / name, bytes(content)))
    except isograft.InvalidInput:
        return
    assert mesh.faces.min(initial=0) >= 0
    assert mesh.faces.max(initial=-1) < max(len(mesh.vertices), 1)
    assert (mesh.polygons.corners[mesh.triangle_corners] == mesh.faces).all()


@pytest.mark.parametrize("kind", ["ply", "ascii", "obj", "obj_uv", "off", "stl"])
def test_forty_thousand_vertices_are_read_within_seconds(tmp_path: Path, kind: str) -> None:
    vertices, faces = surfaces.sphere(6)
    count, triangles = len(vertices), len(faces)
    head = f"element vertex {count}\nproperty float x\nproperty float y\nproperty float z\nelement face {triangles}\n"
    head += "property list uchar int vertex_indices\nend_header\n"
    lines = "".join(f"{x:.7g} {y:.7g} {z:.7g}\n" for x, y, z in vertices)
    rows = "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)
    if kind == "ply":
        records = np.zeros(triangles, [("n", "u1"), ("i", "<i4", 3)])
        records["n"], records["i"] = 3, faces
        content = f"ply\nformat binary_little_endian 1.0\n{head}".encode() + vertices.astype("<f4").tobytes()
        path = save(tmp_path / "a.ply", content + records.tobytes())
    elif kind == "ascii":
        path = save(tmp_path / "a.ply", f"ply\nformat ascii 1.0\n{head}{lines}{rows}")
    elif kind == "off":
        path = save(tmp_path / "a.off", f"OFF\n{count} {triangles} 0\n{lines}{rows}")
    elif kind == "stl":
        records = np.zeros(triangles, [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
        records["v"] = vertices[faces]
        path = save(tmp_path / "a.stl", b"\0" * 80 + struct.pack("<I", triangles) + records.tobytes())
    else:
        corner = "{0}/{0}/{0}" if kind == "obj_uv" else "{0}"
        text = "v " + lines.strip().replace("\n", "\nv ") + "\n"
        text += "".join(f"vt {x:.5g} {y:.5g}\n" for x, y, _ in vertices) if kind == "obj_uv" else ""
        text += "".join(f"f {corner.format(a)} {corner.format(b)} {corner.format(c)}\n" for a, b, c in faces + 1)
        path = save(tmp_path / "a.obj", text)
    start = time.process_time()  # of this process alone: the machine may be busy
    mesh = read_mesh(path)
    seconds = time.process_time() - start
    assert len(mesh.vertices) == count
    assert len(mesh.faces) == triangles
    assert np.allclose(mesh.vertices[mesh.faces], vertices[faces], atol=1e-6)
    assert seconds < 4.0
