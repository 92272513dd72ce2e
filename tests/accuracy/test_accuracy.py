# SPDX-License-Identifier: GPL-3.0-or-later
"""One small pair of each kind of surface, held to the level that is asked of its whole collection.

The pairs may not be given away, so they lie beside the checkout: in ../shared/data, or where the environment
variable ISOGRAFT_DATA says.
"""

from __future__ import annotations

import csv
import os
import sys
from pathlib import Path

import isograft
import pytest
from isograft.evaluation import FALSE_MATCH_ERROR, evaluate

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from benchmarks.cases import read_case  # noqa: E402

DATA = Path(os.environ.get("ISOGRAFT_DATA") or ROOT.parent / "shared" / "data")

#: Pair, mean error at most, coverage at least.
LEVELS = [
    ("faustrem_000_004", 3.5, 0.88),
    ("scape_000_001", 4.0, 0.88),
    ("tosca_wolf1_wolf2", 3.0, 0.85),
    ("shrec16_cuts_dog_shape_8", 6.0, 0.75),
    ("anim_samba_mesh_0000__mesh_0080", 3.0, 0.88),
]


@pytest.mark.parametrize(("name", "error", "coverage"), LEVELS, ids=[level[0] for level in LEVELS])
def test_a_pair_reaches_the_level_of_its_collection(name: str, error: float, coverage: float) -> None:
    listing = DATA / "pairs.csv"
    if not listing.is_file():
        pytest.skip(f"{name}: there is no folder of pairs at {DATA}")
    with listing.open(newline="", encoding="utf-8") as file:
        pair = next(row for row in csv.DictReader(file) if row["id"] == name)
    case = read_case(DATA, pair)
    assert case.truth is not None
    result = evaluate(isograft.match(case.source, case.target).best, case.truth, case.target)
    found = f"error {result.error:.2f} at coverage {100 * result.coverage:.1f} %"
    assert result.coverage >= coverage, found
    assert result.error <= error, found
    # A mean within the level leaves this much room for images that are altogether wrong.
    assert result.false_matches <= error / FALSE_MATCH_ERROR, found
