# SPDX-License-Identifier: GPL-3.0-or-later
"""The judge of these runs: red for failures, for too few tests and for no tests; a crash at exit is told apart."""

from pathlib import Path

import pytest
from judge import judge


def junit(folder: Path, tests: int, failures: int = 0, skipped: int = 0) -> Path:
    path = folder / "junit.xml"
    path.write_text(
        f'<testsuites><testsuite tests="{tests}" failures="{failures}" errors="0" skipped="{skipped}"/></testsuites>'
    )
    return path


@pytest.mark.parametrize(
    ("tests", "failures", "skipped", "code", "green"),
    [(9, 0, 0, 0, True), (9, 1, 0, 1, False), (9, 0, 5, 0, False), (0, 0, 0, 0, False), (9, 0, 0, 1, False)],
)
def test_a_run_is_green_only_if_enough_tests_passed_and_none_failed(
    tmp_path: Path, tests: int, failures: int, skipped: int, code: int, green: bool
) -> None:
    assert judge(junit(tmp_path, tests, failures, skipped), code, 5)[0] == green


def test_a_crash_after_all_tests_passed_is_told_and_is_no_failure(tmp_path: Path) -> None:
    green, words = judge(junit(tmp_path, 9), 139, 5)
    assert green
    assert "crashed at exit" in words


def test_a_crash_before_the_tests_ended_is_a_failure(tmp_path: Path) -> None:
    green, words = judge(tmp_path / "none.xml", 139, 5)
    assert not green
    assert "139" in words
