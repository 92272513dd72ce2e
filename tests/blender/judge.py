# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges a run of Blender by its junit file: judge.py JUNIT EXIT_CODE MINIMUM. A run of too few tests is red."""

import sys
from pathlib import Path
from xml.etree import ElementTree

SIGNAL = 128
"""Exit codes from here on are a shell's word for the signal that ended Blender."""


def judge(junit: Path, code: int, minimum: int) -> tuple[bool, str]:
    """Whether the run is green, and why."""
    if not junit.exists():
        return False, f"no junit file was written: Blender ended with exit code {code} before the tests did"
    suites = list(ElementTree.parse(junit).getroot().iter("testsuite"))
    total, failed, errors, skipped = (
        sum(int(suite.get(key, 0)) for suite in suites) for key in ("tests", "failures", "errors", "skipped")
    )
    passed = total - failed - errors - skipped
    counts = f"{passed} passed, {failed} failed, {errors} errors, {skipped} skipped"
    if failed or errors:
        return False, counts
    if passed < minimum:
        return False, f"{counts}: fewer than the {minimum} tests there must be"
    if code >= SIGNAL or code < 0:
        return True, f"{counts}; WARNING: Blender crashed at exit after that (exit code {code})"
    return code == 0, counts if code == 0 else f"{counts}, but the exit code is {code}"


if __name__ == "__main__":
    green, words = judge(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
    print(f"{Path(sys.argv[1]).stem}: {words}")
    sys.exit(0 if green else 1)
