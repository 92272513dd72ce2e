# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on installed from the zip into this Blender, an empty file around every test, and things to test with."""

import importlib
import os
import sys
from pathlib import Path
from types import ModuleType

import bpy
import pytest

sys.path.insert(0, str(Path(__file__).parent))

from scenes import MatchedPair, Pair

ZIP = Path(os.environ["ISOGRAFT_ZIP"])
IS_EXTENSION = bpy.app.version >= (4, 2, 0)
MODULE = "bl_ext.user_default.isograft_addon" if IS_EXTENSION else "isograft_addon"


def pytest_sessionstart() -> None:
    """Install and enable the zip the way a user does, before test modules import what it brings."""
    if IS_EXTENSION:
        result = bpy.ops.extensions.package_install_files(
            filepath=str(ZIP), repo="user_default", enable_on_install=True
        )
    else:
        result = bpy.ops.preferences.addon_install(overwrite=True, filepath=str(ZIP))
        bpy.ops.preferences.addon_enable(module=MODULE)
    assert result == {"FINISHED"}
    assert MODULE in bpy.context.preferences.addons


@pytest.fixture(autouse=True)
def empty_file() -> None:
    """Nothing of one test is left for the next."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    assert not bpy.data.objects


def add_on(name: str) -> ModuleType:
    """A module of the installed add-on."""
    return importlib.import_module(f"{MODULE}.{name}")


@pytest.fixture
def pair() -> Pair:
    """A fresh Pair, selected, not yet matched."""
    return Pair()


@pytest.fixture(scope="session")
def match_library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A .blend with a matched Pair: matching takes seconds, and many tests need but its result."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    Pair()
    assert bpy.ops.object.isograft_match() == {"FINISHED"}
    path = tmp_path_factory.mktemp("matched") / "matched.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def matched(match_library: Path) -> MatchedPair:
    """A matched Pair, as fresh as when the match had ended."""
    bpy.ops.wm.open_mainfile(filepath=str(match_library))
    return MatchedPair()
