# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on installed from the zip into this Blender, an empty file around every test, and things to test with."""

import importlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

import shapes  # noqa: E402

Array = np.ndarray[Any, Any]

ZIP = Path(os.environ["ISOGRAFT_ZIP"])
IS_EXTENSION = bpy.app.version >= (4, 2, 0)
MODULE = "bl_ext.user_default.isograft_addon" if IS_EXTENSION else "isograft_addon"


@pytest.fixture(scope="session", autouse=True)
def installed() -> str:
    """Install and enable the zip the way a user does; the add-on's module name."""
    if IS_EXTENSION:
        result = bpy.ops.extensions.package_install_files(
            filepath=str(ZIP), repo="user_default", enable_on_install=True
        )
    else:
        result = bpy.ops.preferences.addon_install(overwrite=True, filepath=str(ZIP))
        bpy.ops.preferences.addon_enable(module=MODULE)
    assert result == {"FINISHED"}
    assert MODULE in bpy.context.preferences.addons
    return MODULE


@pytest.fixture(autouse=True)
def empty_file(installed: str) -> Iterator[None]:
    """Nothing of one test is left for the next."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    assert not bpy.data.objects
    yield


def add_on(name: str) -> ModuleType:
    """A module of the installed add-on."""
    return importlib.import_module(f"{MODULE}.{name}")


def add_mesh(name: str, vertices: Array, faces: Any) -> Any:
    """A mesh object in the scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], [list(map(int, face)) for face in faces])
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    return obj


def add_uv(obj: Any, name: str, uv: Array) -> None:
    """A UV map from (l, 2)."""
    obj.data.uv_layers.new(name=name).data.foreach_set("uv", np.asarray(uv, dtype=np.float32).ravel())


def add_color(obj: Any, name: str, data_type: str, domain: str, values: Array) -> None:
    """A colour attribute from (n, 4) or (l, 4)."""
    obj.data.color_attributes.new(name, data_type, domain)
    obj.data.color_attributes[name].data.foreach_set("color", np.asarray(values, dtype=np.float32).ravel())


def values(obj: Any, name: str, key: str, width: int = 1) -> Array:
    """An attribute's values."""
    data = obj.data.attributes[name].data
    buffer = np.empty(len(data) * width, dtype=np.int32 if obj.data.attributes[name].data_type == "INT" else np.float32)
    data.foreach_get(key, buffer)
    return buffer.reshape(-1, width) if width > 1 else buffer


def uvs(obj: Any, name: str) -> Array:
    """A UV map's values (l, 2)."""
    data = obj.data.uv_layers[name].data
    buffer = np.empty(2 * len(data), dtype=np.float32)
    data.foreach_get("uv", buffer)
    return buffer.reshape(-1, 2)


def select(donor: Any, *receivers: Any) -> None:
    """Make `donor` active and select it with the receivers, nothing else."""
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj == donor or obj in receivers)
    bpy.context.view_layer.objects.active = donor
    bpy.context.view_layer.update()


def snapshot(obj: Any) -> dict[str, Any]:
    """Everything of an object that an operator of ours could change."""
    mesh = obj.data
    coordinates = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", coordinates)
    return {
        "co": coordinates.tobytes(),
        "faces": [tuple(polygon.vertices) for polygon in mesh.polygons],
        "materials": [(m.name if m else None) for m in mesh.materials],
        "material_index": [polygon.material_index for polygon in mesh.polygons],
        "attributes": sorted((a.name, a.data_type, a.domain) for a in mesh.attributes),
        "uv": {layer.name: uvs(obj, layer.name).tobytes() for layer in mesh.uv_layers},
        "properties": sorted(obj.keys()),
        "matrix": [tuple(row) for row in obj.matrix_world],
        "users": mesh.users,
    }


class Pair:
    """A donor and a receiver of the same creature: another tessellation, another pose, cut open below."""

    def __init__(self, cut: float = -0.55) -> None:
        self.donor_directions, donor_faces = shapes.triangle_sphere()
        directions, quads = shapes.quad_sphere()
        kept = directions[:, 2] >= cut
        quads = quads[kept[quads].all(axis=1)]
        used = np.unique(quads)
        renumbered = np.full(len(directions), -1)
        renumbered[used] = np.arange(len(used))
        self.directions = directions[used]
        self.truth = shapes.surface_points(self.directions)
        self.donor = add_mesh("Donor", shapes.surface_points(self.donor_directions), donor_faces)
        self.receiver = add_mesh("Scan", shapes.pose(self.truth), renumbered[quads])
        corners = self.donor_directions[donor_faces]
        uv, _ = shapes.cube_uv(corners)
        add_uv(self.donor, "Atlas", uv.reshape(-1, 2))
        add_color(self.donor, "Paint", "FLOAT_COLOR", "POINT", shapes.point_color(self.donor_directions))
        add_color(self.donor, "Corners", "BYTE_COLOR", "CORNER", shapes.point_color(corners).reshape(-1, 4))
        select(self.donor, self.receiver)


@pytest.fixture
def pair() -> Pair:
    """A fresh Pair, selected, not yet matched."""
    return Pair()


@pytest.fixture(scope="session")
def match_library(installed: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A .blend with a matched Pair: matching takes seconds, and many tests need but its result."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    Pair()
    assert bpy.ops.object.isograft_match() == {"FINISHED"}
    path = tmp_path_factory.mktemp("matched") / "matched.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


class MatchedPair:
    """The Pair of the file, as it was matched."""

    def __init__(self) -> None:
        self.donor = bpy.data.objects["Donor"]
        self.receiver = bpy.data.objects["Scan"]
        directions, quads = shapes.quad_sphere()
        used = np.unique(quads[(directions[:, 2] >= -0.55)[quads].all(axis=1)])
        self.directions = directions[used]
        self.truth = shapes.surface_points(self.directions)


@pytest.fixture
def matched(match_library: Path) -> MatchedPair:
    """A matched Pair, as fresh as when the match had ended."""
    bpy.ops.wm.open_mainfile(filepath=str(match_library))
    return MatchedPair()
