# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip, installed as a legacy add-on or as an extension."""

import io
import subprocess
import sys
import zipfile
from pathlib import Path
from types import SimpleNamespace

import bpy
import isograft
import pytest
from conftest import IS_EXTENSION, MODULE, ZIP, add_on

LEGACY_ENABLE = """
import bpy
bpy.ops.preferences.addon_install(overwrite=True, filepath={zip!r})
bpy.ops.preferences.addon_enable(module="isograft_addon")
import isograft
print("WHEEL", isograft.__file__, isograft.presets())
bpy.ops.preferences.addon_disable(module="isograft_addon")
"""


def wheel_bytes() -> tuple[str, bytes]:
    with zipfile.ZipFile(ZIP) as archive:
        name = next(name for name in archive.namelist() if name.endswith(".whl"))
        return name.rsplit("/", 1)[1], archive.read(name)


def traces() -> dict[str, object]:
    """What a registered add-on leaves in Blender."""
    return {
        "operators": [name for name in dir(bpy.ops.object) if name.startswith("isograft")],
        "panel": hasattr(bpy.types, "VIEW3D_PT_isograft"),
        "operator classes": [name for name in dir(bpy.types) if "isograft" in name.lower()],
        "window manager": [name for name in dir(bpy.types.WindowManager) if "isograft" in name],
        "object": [name for name in dir(bpy.types.Object) if "isograft" in name],
        "scene": [name for name in dir(bpy.types.Scene) if "isograft" in name],
        "path": [path for path in sys.path if "/isograft/" in path],
    }


def test_installing_the_zip_registers_operators_and_panel() -> None:
    found = traces()
    assert found["operators"] == ["isograft_bake", "isograft_match", "isograft_transfer", "isograft_wrap"]
    assert found["panel"]


def test_the_native_package_comes_from_the_wheel_in_the_zip() -> None:
    where = Path(isograft.__file__)
    if IS_EXTENSION:
        assert bpy.utils.user_resource("EXTENSIONS") in str(where)
    else:
        assert add_on("native_loader").user_folder() in where.parents
    name, content = wheel_bytes()
    assert name.startswith(f"isograft-{isograft.__version__}-cp311-")
    with zipfile.ZipFile(io.BytesIO(content)) as wheel:
        assert wheel.read("isograft/__init__.py") == where.read_bytes()


def test_every_file_of_the_zip_lies_in_the_top_folder_and_equal_input_gives_an_equal_zip(tmp_path: Path) -> None:
    with zipfile.ZipFile(ZIP) as archive:
        names = archive.namelist()
    assert {name.split("/")[0] for name in names} == {"isograft_addon"}
    assert {"isograft_addon/__init__.py", "isograft_addon/blender_manifest.toml"} <= set(names)
    name, content = wheel_bytes()
    (tmp_path / name).write_bytes(content)
    package = Path(__file__).parents[2] / "blender_addon" / "package.py"
    command = ["python3", str(package), "--wheel", str(tmp_path / name), "--output", str(tmp_path / "out")]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert Path(done.stdout.strip()).read_bytes() == ZIP.read_bytes()


def test_unregistering_and_registering_twice_leaves_nothing_behind_and_nothing_out() -> None:
    registered = traces()
    for _ in range(2):
        bpy.ops.preferences.addon_disable(module=MODULE)
        try:
            assert not any(traces().values()), traces()
        finally:
            bpy.ops.preferences.addon_enable(module=MODULE)
        assert traces() == registered


def test_settings_take_their_defaults_from_the_native_options() -> None:
    options = isograft.preset_options("default")
    operator = bpy.ops.object.isograft_match.get_rna_type().properties
    assert operator["hierarchy_samples"].default == options["hierarchy_samples"]
    assert operator["growth_stretch_limit"].default == pytest.approx(options["growth_stretch_limit"])
    assert (operator["preset"].default, operator["scale"].default, operator["seed"].default) == ("default", "AUTO", 0)
    assert [item.identifier for item in operator["preset"].enum_items] == isograft.presets()


def test_another_python_is_refused_with_words_that_name_the_pythons_there_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    loader = add_on("native_loader")
    (tmp_path / "isograft-0.1.0-cp311-cp311-manylinux_2_35_x86_64.whl").touch()
    monkeypatch.setattr(loader.sys, "version_info", SimpleNamespace(major=3, minor=12))
    with pytest.raises(loader.NativeUnavailableError, match=r"Python 3\.12.*it has: Python 3\.11"):
        loader.matching_wheel(tmp_path)


def test_another_system_is_refused(tmp_path: Path) -> None:
    loader = add_on("native_loader")
    (tmp_path / "isograft-0.1.0-cp311-cp311-win_amd64.whl").touch()
    with pytest.raises(loader.NativeUnavailableError, match="win_amd64"):
        loader.matching_wheel(tmp_path)


def test_a_wheel_is_unpacked_once_per_version_and_content(tmp_path: Path) -> None:
    loader = add_on("native_loader")
    name, content = wheel_bytes()
    (tmp_path / name).write_bytes(content)
    first = loader.unpack(tmp_path / name, tmp_path / "user")
    stamp = (first / "isograft" / "__init__.py").stat().st_mtime_ns
    assert loader.unpack(tmp_path / name, tmp_path / "user") == first
    assert (first / "isograft" / "__init__.py").stat().st_mtime_ns == stamp
    (tmp_path / name).write_bytes(content + b"another build")
    assert loader.unpack(tmp_path / name, tmp_path / "user") != first
    assert len(list((tmp_path / "user").iterdir())) == 2


def test_a_wheel_that_is_cut_short_leaves_no_folder_behind(tmp_path: Path) -> None:
    loader = add_on("native_loader")
    name, content = wheel_bytes()
    (tmp_path / name).write_bytes(content[: len(content) // 2])
    with pytest.raises(zipfile.BadZipFile):
        loader.unpack(tmp_path / name, tmp_path / "user")
    assert list((tmp_path / "user").iterdir()) == []


def test_another_version_that_is_loaded_already_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    loader = add_on("native_loader")
    monkeypatch.setattr(isograft, "__version__", "9.9.9")
    with pytest.raises(loader.NativeUnavailableError, match=r"9\.9\.9.*restart Blender"):
        loader.load()


@pytest.mark.skipif(not IS_EXTENSION, reason="Blender 3.4 knows no extensions")
def test_blenders_own_validation_accepts_the_zip() -> None:
    tool = next(Path(bpy.utils.system_resource("SCRIPTS")).rglob("blender_ext.py"))
    done = subprocess.run(
        [sys.executable, str(tool), "validate", str(ZIP)], check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(not IS_EXTENSION, reason="the 3.4 lane is itself a legacy install")
def test_the_same_zip_installs_as_a_legacy_add_on_here_too(tmp_path: Path) -> None:
    script = f"import os\nos.environ['BLENDER_USER_RESOURCES'] = {str(tmp_path)!r}\n"
    script += "for name in ('SCRIPTS', 'CONFIG', 'DATAFILES'): os.environ.pop('BLENDER_USER_' + name, None)\n"
    script += LEGACY_ENABLE.format(zip=str(ZIP))
    done = subprocess.run([sys.executable, "-c", script], check=False, capture_output=True, text=True, timeout=120)
    assert f"WHEEL {tmp_path}/datafiles/isograft/" in done.stdout, done.stdout + done.stderr
