# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on in a Blender with a window (under Xvfb): the modal job, Esc, and undo."""

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import bpy
import pytest
from conftest import MODULE

pytestmark = pytest.mark.skipif(not bpy.app.binary_path, reason="a bpy wheel cannot open a window")


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What window_session.py saw."""
    assert shutil.which("xvfb-run"), "install xvfb, xauth and libgl1-mesa-dri"
    folder = Path(os.environ.get("ISOGRAFT_SCREENSHOTS") or tmp_path_factory.mktemp("window"))
    session = Path(__file__).with_name("window_session.py")
    command = ["xvfb-run", "-a", "-s", "-screen 0 1000x700x24 +extension GLX", bpy.app.binary_path]
    command += ["--factory-startup", "--window-geometry", "0", "0", "1000", "700", "--enable-event-simulate"]
    command += ["--addons", MODULE, "--python-exit-code", "1", "-P", str(session), "--", str(folder)]
    done = subprocess.run(
        command,
        check=False,
        env=os.environ | {"LIBGL_ALWAYS_SOFTWARE": "1"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    result: dict[str, Any] = json.loads((folder / "seen.json").read_text()) if done.returncode == 0 else {}
    output = done.stdout[-3000:] + done.stderr[-3000:]
    assert not result.get("error", output)
    assert "Traceback" not in output, output
    return result


def test_the_panel_is_drawn_in_the_sidebar(seen: dict[str, Any]) -> None:
    assert seen["panel_drawn"]


def test_the_match_runs_as_a_modal_job_in_a_worker_thread(seen: dict[str, Any]) -> None:
    assert seen["started"] == ["RUNNING_MODAL"]
    assert seen["worker_ran"]
    assert seen["matched"]


def test_keys_do_not_reach_blender_while_the_job_runs(seen: dict[str, Any]) -> None:
    assert seen["objects_after_delete_key"] == ["Donor", "Scan"]


def test_one_undo_takes_a_match_back(seen: dict[str, Any]) -> None:
    assert seen["one_undo_restores"]


def test_esc_cancels_soon_and_leaves_everything_as_it_was(seen: dict[str, Any]) -> None:
    assert seen["started_again"] == ["RUNNING_MODAL"]
    assert seen["seconds_to_cancel"] < 2.0
    assert seen["cancel_changes_nothing"]


def test_one_undo_takes_a_transfer_with_its_cuts_back_and_keeps_the_match(seen: dict[str, Any]) -> None:
    assert seen["transferred"] == ["RUNNING_MODAL"]
    assert seen["cut"] > 50
    assert seen["received"] == ["Atlas"]
    assert seen["one_undo_takes_the_transfer_back"]
    assert seen["still_matched"]


def test_one_undo_takes_a_bake_into_a_new_unwrap_back(seen: dict[str, Any]) -> None:
    assert seen["baked"] == ["Scan baked"]
    assert seen["one_undo_takes_the_bake_back"]


def test_one_undo_takes_a_wrap_back(seen: dict[str, Any]) -> None:
    assert seen["wrapped"] == ["Donor", "Donor on Scan", "Scan"]
    assert seen["objects_after_undo"] == ["Donor", "Scan"]
    assert seen["one_undo_takes_the_wrap_back"]
