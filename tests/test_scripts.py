# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/test judges its lanes, and the scripts refuse what they cannot do, in words."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

PASSED = '<testcase name="a"/>'
FAILED = '<testcase name="b"><failure message="no"/></testcase>'
BROKEN = '<testcase name="c"><error message="no"/></testcase>'
SKIPPED = '<testcase name="d"><skipped/></testcase>'
DISABLED = '<testcase name="e" status="notrun"/>'


def run(*command: object, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(part) for part in command],
        env={**os.environ, **environment},
        text=True,
        capture_output=True,
        timeout=120,
        check=False,
    )


def counted(folder: Path, minimum: int, *contents: str) -> tuple[int, str, str]:
    """Exit code, counts and reason of scripts/junit.py over files with these contents."""
    paths = []
    for content in contents:
        paths.append(folder / f"{len(paths)}.xml")
        paths[-1].write_text(content)
    done = run(sys.executable, ROOT / "scripts/junit.py", minimum, *paths)
    return done.returncode, done.stdout.strip(), done.stderr.strip()


def suite(*cases: str) -> str:
    return f"<testsuites><testsuite>{''.join(cases)}</testsuite></testsuites>"


def test_tests_are_counted_over_all_files_of_a_lane(tmp_path: Path) -> None:
    assert counted(tmp_path, 3, suite(PASSED, PASSED), suite(PASSED, SKIPPED)) == (0, "3 3 0 1", "")


@pytest.mark.parametrize(
    ("cases", "reason"),
    [
        ((), "0 tests were run, fewer than the 2 there must be"),
        ((SKIPPED, SKIPPED, SKIPPED), "0 tests were run"),
        ((DISABLED, DISABLED, DISABLED), "0 tests were run"),
        ((PASSED, SKIPPED), "1 tests were run"),
        ((PASSED, PASSED, FAILED), "1 failed"),
        ((PASSED, PASSED, BROKEN), "1 failed"),
    ],
)
def test_too_few_tests_and_failed_ones_are_told(tmp_path: Path, cases: tuple[str, ...], reason: str) -> None:
    code, _, words = counted(tmp_path, 2, suite(*cases))
    assert code == 1
    assert reason in words


@pytest.mark.parametrize("content", ["", "<testsuites><testsuite>"])
def test_a_broken_file_counts_for_nothing(tmp_path: Path, content: str) -> None:
    code, counts, words = counted(tmp_path, 1, content)
    assert (code, counts) == (1, "0 0 0 0")
    assert "no usable junit file" in words


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout with the judge alone; what sets up and what tests are to be put in by make()."""
    folder = tmp_path / "checkout"
    (folder / "scripts").mkdir(parents=True)
    (folder / ".ci").mkdir()
    for name in ("scripts/test", "scripts/lib.sh", "scripts/junit.py", ".ci/run"):
        shutil.copy(ROOT / name, folder / name)
    make(folder, "scripts/setup", "exit 0")
    return folder


def make(folder: Path, name: str, body: str) -> None:
    path = folder / name
    path.write_text(f"#!/usr/bin/env bash\n{body}\n")
    path.chmod(0o755)


def lint_that_writes(*cases: str) -> str:
    return f"mkdir -p build/junit; echo '{suite(*cases)}' >build/junit/lint.xml"


def line_of(output: str, lane: str) -> str:
    return next(line for line in output.splitlines() if line.startswith(f"{lane} "))


def test_a_lane_that_ran_its_tests_is_green(checkout: Path) -> None:
    make(checkout, "scripts/lint", lint_that_writes(*[PASSED] * 5))
    done = run(checkout / "scripts/test", "lint")
    assert done.returncode == 0
    assert "green" in line_of(done.stdout, "lint")
    assert "not asked for" in line_of(done.stdout, "python")
    assert done.stdout.endswith("5 passed, 0 failed, 0 skipped\n")


def test_a_lane_that_ran_nothing_is_red_whatever_its_exit_code(checkout: Path) -> None:
    make(checkout, "scripts/lint", lint_that_writes(*[PASSED] * 5))
    assert run(checkout / "scripts/test", "lint").returncode == 0
    # The file of the run before must not stand for this one.
    make(checkout, "scripts/lint", "exit 0")
    done = run(checkout / "scripts/test", "lint")
    assert done.returncode == 1
    assert "red" in line_of(done.stdout, "lint")
    assert "no usable junit file" in line_of(done.stdout, "lint")
    assert done.stdout.endswith("0 passed, 1 failed, 0 skipped\n")


def test_a_lane_that_lost_tests_or_ended_badly_is_red(checkout: Path) -> None:
    make(checkout, "scripts/lint", lint_that_writes(*[PASSED] * 4))
    done = run(checkout / "scripts/test", "lint")
    assert done.returncode == 1
    assert "4 tests were run, fewer than the 5 there must be" in line_of(done.stdout, "lint")
    make(checkout, "scripts/lint", lint_that_writes(*[PASSED] * 5) + "; exit 7")
    done = run(checkout / "scripts/test", "lint")
    assert done.returncode == 1
    assert "exit code 7" in line_of(done.stdout, "lint")


def test_only_the_lane_without_data_may_be_left_out_and_not_where_ci_runs(checkout: Path) -> None:
    without = {"ISOGRAFT_DATA": str(checkout / "none")}
    done = run(checkout / "scripts/test", "accuracy", CI="", **without)
    assert done.returncode == 0
    assert "no data in" in line_of(done.stdout, "accuracy")
    assert run(checkout / "scripts/test", "accuracy", CI="1", **without).returncode == 1


def test_a_lane_that_does_not_exist_and_a_setup_that_fails_end_the_run(checkout: Path) -> None:
    done = run(checkout / "scripts/test", "speed")
    assert done.returncode == 1
    assert "there is no lane speed; lanes: lint cpp" in done.stderr
    make(checkout, "scripts/setup", "exit 3")
    done = run(checkout / "scripts/test", "lint")
    assert done.returncode == 1
    assert "scripts/setup failed: no lane was run" in done.stdout


def test_ci_runs_all_lanes_and_ends_as_they_do(checkout: Path) -> None:
    make(checkout, "scripts/test", 'echo "lanes:$*"; exit 5')
    done = run(checkout / ".ci/run")
    assert (done.returncode, done.stdout) == (5, "lanes:\n")


def test_on_another_system_the_setup_says_what_it_is_made_for(tmp_path: Path) -> None:
    make(tmp_path, "uname", "echo riscv64")
    done = run(ROOT / "scripts/setup", PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert done.returncode == 1
    assert "(riscv64); the build is made for Debian 12 on x86_64" in done.stderr
    assert "docs/development.md" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("{folder}/none.ply", "{folder}/there.ply"), "none.ply: there is no such file"),
        (("{folder}/there.ply", "{folder}/there.xyz"), "there.xyz: only .ply, .obj, .off and .stl are read"),
        (("{folder}", "{folder}/there.ply"), "this cannot be read"),
        (("--zip", "{folder}/none.zip"), "none.zip: there is no such file"),
        (("{folder}/there.ply",), "DONOR RECEIVER"),
        (("--fast",), "DONOR RECEIVER"),
        (("--out",), "DONOR RECEIVER"),
    ],
)
def test_the_demo_refuses_before_it_builds_anything(tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    for name in ("there.ply", "there.xyz"):
        (tmp_path / name).write_text("ply\n")
    done = run(ROOT / "scripts/demo", *(argument.format(folder=tmp_path) for argument in arguments))
    assert done.returncode == 2
    assert words in done.stderr
    assert done.stdout == ""
