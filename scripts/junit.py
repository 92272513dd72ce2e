# SPDX-License-Identifier: GPL-3.0-or-later
"""Count the tests of junit files: junit.py MINIMUM FILE... prints "RUN PASSED FAILED SKIPPED".

Exit code 1, with the reason on stderr, if a test failed, fewer than MINIMUM were run, or a file is missing or broken.
"""

import sys
from pathlib import Path
from xml.etree import ElementTree


def count(path: Path) -> tuple[int, int, int]:
    """The numbers of passed, failed and skipped test cases; those that were never started count nowhere."""
    passed = failed = skipped = 0
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        if case.find("failure") is not None or case.find("error") is not None:
            failed += 1
        elif case.find("skipped") is not None:
            skipped += 1
        elif case.get("status") != "notrun":  # GoogleTest's word for a disabled test
            passed += 1
    return passed, failed, skipped


def main() -> int:
    """Count and judge."""
    minimum, paths = int(sys.argv[1]), [Path(name) for name in sys.argv[2:]]
    reasons = []
    totals = [0, 0, 0]
    for path in paths:
        try:
            totals = [a + b for a, b in zip(totals, count(path), strict=True)]
        except (OSError, ElementTree.ParseError) as error:
            reasons.append(f"no usable junit file: {error}")
    passed, failed, skipped = totals
    if failed:
        reasons.append(f"{failed} failed")
    if passed + failed < minimum:
        reasons.append(f"{passed + failed} tests were run, fewer than the {minimum} there must be")
    print(passed + failed, passed, failed, skipped)
    print("; ".join(reasons), file=sys.stderr)
    return 1 if reasons else 0


if __name__ == "__main__":
    sys.exit(main())
