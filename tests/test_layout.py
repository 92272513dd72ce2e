# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules of the checkout that no compiler looks at: layers, licence headers, small files, no machine's paths."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

# A stage may include headers of its own folder and of those before it.
STAGES = ["base", "surface", "geodesic", "hierarchy", "feature", "seed", "growth", "scale", "blend", "dense"]
MAY_INCLUDE = {stage: {*STAGES[: i + 1], "isograft"} for i, stage in enumerate(STAGES)}
# Transfer needs a correspondence and no part of how it was found.
MAY_INCLUDE["transfer"] = {"base", "transfer", "isograft"}

SOURCE_SUFFIXES = {".cpp", ".h", ".py", ".pyi", ".cmake"}
LONGEST = 400


def tracked() -> list[Path]:
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return [path for name in listed.stdout.split("\0") if name and (path := ROOT / name).is_file()]


def sources() -> list[Path]:
    return [
        path
        for path in tracked()
        if path.suffix in SOURCE_SUFFIXES or (path.parent.name == "scripts" and not path.suffix)
    ]


def named(paths: list[Path]) -> list[str]:
    return [path.relative_to(ROOT).as_posix() for path in paths]


def test_every_folder_of_the_engine_has_its_place_in_the_order_of_stages() -> None:
    folders = {path.name for path in (ROOT / "native/src").iterdir() if path.is_dir()}
    assert folders == set(MAY_INCLUDE)


@pytest.mark.parametrize("stage", sorted(MAY_INCLUDE))
def test_a_stage_includes_only_headers_of_stages_before_it(stage: str) -> None:
    files = [path for path in (ROOT / "native/src" / stage).iterdir() if path.suffix in {".h", ".cpp"}]
    assert files
    wrong = [
        f"{path.name}: {include}"
        for path in files
        for include in re.findall(r'^#include "(.*)"', path.read_text(), re.MULTILINE)
        if include.partition("/")[0] not in MAY_INCLUDE[stage]
    ]
    assert wrong == []


def test_public_headers_include_public_headers_only() -> None:
    wrong = [
        f"{path.name}: {include}"
        for path in (ROOT / "native/include").rglob("*.h")
        for include in re.findall(r'^#include "(.*)"', path.read_text(), re.MULTILINE)
        if not include.startswith("isograft/")
    ]
    assert wrong == []


def test_every_source_file_names_its_licence_at_the_top() -> None:
    files = sources()
    assert len(files) > 100
    lacking = [path for path in files if "SPDX-License-Identifier: GPL-3.0-or-later" not in path.read_text()[:200]]
    assert named(lacking) == []


def test_no_source_file_is_longer_than_400_lines() -> None:
    long = [path for path in sources() if path.read_text().count("\n") > LONGEST]
    assert named(long) == []


def test_no_tracked_file_is_over_300_kilobytes() -> None:
    assert named([path for path in tracked() if path.stat().st_size > 300_000]) == []


def test_no_file_holds_a_path_of_one_machine() -> None:
    # In two pieces, so that this file does not hold what it looks for.
    pattern = re.compile(r"(?<![\w.{}$/~-])/" + r"(home|root|Users|work|mnt)/\w")
    holding = [
        path
        for path in tracked()
        if path.suffix not in {".png", ".npz"} and pattern.search(path.read_text(errors="replace"))
    ]
    assert named(holding) == []
