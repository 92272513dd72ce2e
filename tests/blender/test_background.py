# SPDX-License-Identifier: GPL-3.0-or-later
"""A saved file, worked on from a command line without a window."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
from conftest import IS_EXTENSION, MODULE
from scenes import Pair, uvs

EXPRESSION = """
import bpy
bpy.ops.object.isograft_match(preset='fast', scale='FIXED')
bpy.ops.object.isograft_transfer(what={'UV', 'COLOR'})
bpy.ops.wm.save_as_mainfile(filepath=bpy.data.filepath.replace('before', 'after'))
"""


def test_a_file_is_matched_and_transferred_by_one_expression(pair: Pair, tmp_path: Path) -> None:
    before = tmp_path / "before.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(before))
    if IS_EXTENSION:
        script = f"import addon_utils, bpy\naddon_utils.enable({MODULE!r})\n"
        script += f"bpy.ops.wm.open_mainfile(filepath={str(before)!r})\n{EXPRESSION}"
        command = [sys.executable, "-c", "import bpy\n" + script]
    else:
        command = [bpy.app.binary_path, "-b", "--factory-startup", "--addons", MODULE, str(before)]
        command += ["--python-exit-code", "1", "--python-expr", EXPRESSION]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=200, env=os.environ)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "matched" in done.stdout
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "after.blend"))
    receiver = bpy.data.objects["Scan"]
    assert receiver["isograft"]["donor"] == "Donor"
    assert uvs(receiver, "Atlas").any()
    assert "Paint" in receiver.data.color_attributes


def test_an_error_without_a_window_ends_with_a_code_and_words(pair: Pair, tmp_path: Path) -> None:
    path = tmp_path / "before.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    if IS_EXTENSION:
        script = f"import bpy, addon_utils\naddon_utils.enable({MODULE!r})\n"
        script += f"bpy.ops.wm.open_mainfile(filepath={str(path)!r})\nbpy.ops.object.isograft_transfer()"
        command = [sys.executable, "-c", script]
    else:
        command = [bpy.app.binary_path, "-b", "--factory-startup", "--addons", MODULE, str(path)]
        command += ["--python-exit-code", "1", "--python-expr", "import bpy; bpy.ops.object.isograft_transfer()"]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=200, env=os.environ)
    assert done.returncode == 1
    assert "Scan has no match" in done.stdout + done.stderr
