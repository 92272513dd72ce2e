# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo reads the user's own files, dresses what comes bare, and refuses what is no surface."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from demo import own_files, scene

BAD = Path(__file__).resolve().parents[1] / "bad_inputs"
CORNERS = ["0 0 0", "1 0 0", "0 1 0", "0.2 0.2 1"]
TRIANGLES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("nan.ply", "`vertices` holds NaN or infinity in 1 row, the first is row 1"),
        ("no_area.stl", "has an area"),
        ("index_too_large.obj", 'line 4: face: corner "4" is out of range'),
        ("empty.ply", "line 1"),
    ],
)
def test_a_file_that_holds_no_surface_is_refused_with_its_name_and_the_place(
    name: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as refusal:
        own_files.read(BAD / name, "Donor")
    assert refusal.value.code == 2
    told = capsys.readouterr().out
    assert told.startswith("demo: ")
    assert name in told
    assert words in told


def test_points_alone_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "points.off"
    path.write_text("\n".join(["OFF", "4 0 0", *CORNERS]) + "\n")
    with pytest.raises(SystemExit):
        own_files.read(path, "Donor")
    assert "holds no faces" in capsys.readouterr().out


def write_obj(path: Path, image: Path | None) -> None:
    lines = [f"v {corner}" for corner in CORNERS] + ["vt 0 0", "vt 1 0", "vt 0 1"]
    if image is not None:
        path.with_suffix(".mtl").write_text(f"newmtl Skin\nmap_Kd {image.name}\n")
        lines += [f"mtllib {path.with_suffix('.mtl').name}", "usemtl Skin"]
    lines += ["f " + " ".join(f"{v + 1}/{k + 1}" for k, v in enumerate(triangle)) for triangle in TRIANGLES]
    path.write_text("\n".join(lines) + "\n")


def test_an_obj_keeps_its_uv_map_and_its_image(tmp_path: Path) -> None:
    scene.clear()
    image = bpy.data.images.new("Skin", 8, 8)
    image.filepath_raw, image.file_format = str(tmp_path / "skin.png"), "PNG"
    image.save()
    write_obj(tmp_path / "worn.obj", tmp_path / "skin.png")
    worn = own_files.read(tmp_path / "worn.obj", "Donor")
    assert own_files.dress(worn) == "its own UV map and texture"
    write_obj(tmp_path / "bare.obj", None)
    bare = own_files.read(tmp_path / "bare.obj", "Other")
    assert own_files.dress(bare) == "its own UV map, shown with a checker"
    assert [len(item.data.vertices) for item in (worn, bare)] == [4, 4]


@pytest.mark.parametrize("coloured", [True, False])
def test_what_has_no_uv_map_gets_one_and_colours(tmp_path: Path, coloured: bool) -> None:
    scene.clear()
    names = ["x", "y", "z"]
    properties = [f"property float {name}" for name in names]
    rows = CORNERS
    if coloured:
        properties += [f"property uchar {name}" for name in ("red", "green", "blue")]
        rows = [f"{corner} 255 0 128" for corner in CORNERS]
    head = ["ply", "format ascii 1.0", f"element vertex {len(rows)}", *properties, f"element face {len(TRIANGLES)}"]
    faces = ["3 " + " ".join(map(str, triangle)) for triangle in TRIANGLES]
    path = tmp_path / "bare.ply"
    path.write_text("\n".join([*head, "property list uchar int vertex_indices", "end_header", *rows, *faces]) + "\n")
    item = own_files.read(path, "Donor")
    name = "Color" if coloured else "Place"
    assert own_files.dress(item) == f"the colours “{name}” and a generated UV map"
    assert len(item.data.uv_layers) == 1
    assert name in item.data.color_attributes
