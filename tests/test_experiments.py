# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/experiments runs and keeps, and the page it writes."""

from __future__ import annotations

import dataclasses
import json
import sys
from pathlib import Path
from typing import Any

import isograft
import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from experiments import run, shapes  # noqa: E402
from experiments.catalogue import CLEAN_RADII, EXPERIMENTS, NOISY, POSITIONED, Experiment, Pair  # noqa: E402
from experiments.page import write_page  # noqa: E402
from experiments.run import Settings, StageClock, run_pair  # noqa: E402

BY_NAME = {e.name: e for e in EXPERIMENTS}


def test_only_what_the_paper_varies_is_varied_and_to_the_values_it_prints() -> None:
    assert NOISY == {"paper_radius_min": 1.5, "paper_radius_max": 3.4}
    assert CLEAN_RADII == {"paper_radius_min": 0.9, "paper_radius_max": 1.7}
    assert isograft.preset_options("paper").items() >= CLEAN_RADII.items()
    noisy = {e.name for e in EXPERIMENTS if e.options.items() >= NOISY.items()}
    assert noisy == {"contacts", "clouds"}
    q = {e.name: e.options["paper_threshold"] for e in EXPERIMENTS}
    assert q.pop("samba") == 0.0
    assert q.pop("scape") == q.pop("size") == 1.9
    assert set(q.values()) == {1.0}
    printed = {*NOISY, "paper_threshold"}
    others = {e.name: set(e.options) - printed for e in EXPERIMENTS if set(e.options) - printed}
    # Two given correspondences, and the reach of N1, which the paper does not print.
    assert others == {"planes": {"seed_landmarks_only", "paper_near"}}


def test_pairs_in_other_positions_are_run_as_their_experiments_run_them() -> None:
    experiment_of = {
        "anim_samba_mesh_0000__mesh_0080": "samba",
        "scape_000_005": "scape",
        "topo_020_028": "contacts",
        "facescan_s101": "faces",
        "face_ict_s101_neutral_jawopen": "faces",
        "pc_faust_020_025": "clouds",
        "pc_cat0_cat5": "clouds",
        "pc_faust_033_037": "clouds",
    }
    assert set(experiment_of) == set(POSITIONED)
    positions = BY_NAME["positions"]
    assert not positions.drawn
    for pair, name in experiment_of.items():
        set_there = isograft.preset_options("paper") | BY_NAME[name].options
        assert isograft.preset_options("paper") | positions.options | POSITIONED[pair] == set_there, pair
        assert positions.limit(f"{pair}_1") == positions.limit(f"{pair}_2") == BY_NAME[name].limit(pair), pair


def test_one_experiment_runs_at_the_limit_of_the_preset_itself() -> None:
    assert BY_NAME["size"].vertices == isograft.preset_options("paper")["paper_vertices"] == 10000


def test_stages_are_timed_by_the_processor_from_the_last_hierarchy_on() -> None:
    now = [0.0]
    clock = StageClock(lambda: now[0])
    told = [("features", 1), ("growth", 3), ("hierarchy", 4), ("hierarchy", 6), ("features", 7), ("growth", 10)]
    told += [("blend", 30), ("merge", 34), ("dense", 36), ("merge", 39), ("done", 40)]
    for stage, at in told:
        now[0] = at
        clock(stage, 0.5)
    assert clock.seconds == {
        "surface": 4,
        "hierarchy": 3,
        "features": 3,
        "growth": 20,
        "clustering": 4,
        "merging": 6,
    }
    assert sum(clock.seconds.values()) == 40


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Experiment, Pair, Settings, dict[str, Any]]:
    """The planes with few vertices and few matches."""
    case, landmarks = shapes.planes(16)
    pair = Pair("planes", case, landmarks)
    experiment = dataclasses.replace(BY_NAME["planes"], vertices=200)
    settings = Settings(Path(), tmp_path_factory.mktemp("experiments"), 2, None, 4)
    return experiment, pair, settings, run_pair(experiment, pair, "paper", settings)


def test_a_mesh_above_the_limit_is_decimated_and_the_row_says_so(ran: Any) -> None:
    _, _, _, row = ran
    assert row["vertices"] == 289
    assert 100 < row["source_samples"] < 240
    assert any(w.startswith("source: decimated from 289 to ") for w in row["warnings"]), row["warnings"]
    # Every stage of the report has its seconds of the processor.
    assert set(row["cpu_stages"]) == set(row["stages"])


def test_what_is_kept_is_not_run_again_unless_the_settings_differ(ran: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    experiment, pair, settings, row = ran

    def refuse(*_: Any) -> None:
        raise AssertionError("ran again")

    monkeypatch.setattr(run, "_find", refuse)
    assert run_pair(experiment, pair, "paper", settings) == json.loads(json.dumps(row))
    with pytest.raises(AssertionError, match="ran again"):
        run_pair(experiment, pair, "paper", dataclasses.replace(settings, vertices=150))
    # So is one of the other preset; peers have none.
    assert settings.kept(experiment, pair, "default")["options"]["blend_cores"] == 3
    assert set(settings.kept(experiment, pair, "nearest")) == {"version"}
    # A preset that has changed since is other settings too.
    changed = isograft.preset_options("paper") | {"paper_iterations": 7}
    monkeypatch.setattr(isograft, "preset_options", lambda _name: changed)
    with pytest.raises(AssertionError, match="ran again"):
        run_pair(experiment, pair, "paper", settings)


def test_options_of_a_pair_replace_those_of_its_experiment_and_are_told(ran: Any, tmp_path: Path) -> None:
    experiment, pair, settings, row = ran
    settings = dataclasses.replace(settings, out=tmp_path / "out")
    # One that is refused shows that it reaches the match, in place of the experiment's.
    own = dataclasses.replace(pair, options={"paper_near": 0.1})
    refused = run_pair(experiment, own, "paper", settings)
    assert refused["failed"] == "paper.near must be in [0.5, 4]"
    assert refused["options"] == own.options
    (tmp_path / "out/planes/planes.paper.json").write_text(json.dumps(row | {"options": {"paper_near": 1.25}}))
    write_page([experiment], settings.out, tmp_path)
    page = tmp_path / "experiments.md"
    told = f"{row['seeds_tried']} of at most 4 oriented matches tried, "
    assert told in page.read_text("utf-8")
    assert "in the chosen cluster. With `paper_near=1.25`." in page.read_text("utf-8")
    # A row of an earlier version has other settings.
    (tmp_path / "out/planes/planes.paper.json").write_text(json.dumps(row | {"settings": {"version": "0"}}))
    write_page([experiment], settings.out, tmp_path)
    assert told.replace(" of at most 4", "") in page.read_text("utf-8")


def test_the_page_has_the_rows_their_sizes_and_their_times(ran: Any, tmp_path: Path) -> None:
    experiment, _, settings, row = ran
    write_page([experiment, BY_NAME["size"]], settings.out, tmp_path)
    page = (tmp_path / "experiments.md").read_text(encoding="utf-8")
    assert f"| planes | paper | {row['error']:.1f} |" in page
    assert f"`planes`: {row['source_samples']} vertices of 289, decimated, " in page
    assert "Not run for this page: size." in page
    times = " | ".join(f"{row['cpu_stages'][name]:.1f}" for name in ("features", "growth", "clustering", "merging"))
    assert f"| planes | {row['source_samples']} | {times} | {row['cpu_seconds']:.0f} |" in page
