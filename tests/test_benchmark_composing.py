# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/benchmark --compose: pairs that the listed ones imply, of known surfaces."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
import pytest
import surfaces

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from isograft.evaluation import Truth  # noqa: E402

from benchmarks import composing  # noqa: E402
from benchmarks.cases import Case  # noqa: E402

LISTED = ["id", "collection", "source", "target", "gt_kind", "gt_file", "gt_bary", "gt_minus1", "category", "core"]


def part(whole, faces, keep):
    """The part of a mesh whose triangles `keep` names, with its true places on the whole."""
    chosen = faces[keep]
    names = np.unique(chosen)
    number = np.full(len(whole), -1)
    number[names] = np.arange(len(names))
    return Case((whole[names], number[chosen].astype(np.int32)), (whole, faces), Truth(vertex=names), False)


def test_two_parts_match_where_both_are():
    whole, faces = surfaces.sphere(3)
    middle = whole[faces].mean(axis=1)[:, 0]
    left, right = part(whole, faces, middle < 0.4), part(whole, faces, middle > -0.4)
    truth = composing.composed(left, right)
    shared = np.isin(left.truth.vertex, right.truth.vertex)
    assert 0.3 < shared.mean() < 0.7
    np.testing.assert_array_equal(truth >= 0, shared)
    np.testing.assert_array_equal(right.truth.vertex[truth[shared]], left.truth.vertex[shared])


def test_pairs_are_new_and_their_truths_fit(tmp_path, capsys):
    whole, faces = surfaces.sphere(1)
    for name in ("a", "b", "c"):
        rows = [" ".join(map(str, row)) for row in whole.tolist()] + [f"3 {i} {j} {k}" for i, j, k in faces.tolist()]
        (tmp_path / f"{name}.off").write_text("\n".join(["OFF", f"{len(whole)} {len(faces)} 0", *rows]) + "\n")
    with (tmp_path / "pairs.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, LISTED, restval="")
        writer.writeheader()
        for target in ("b", "c"):
            row = {"id": f"a{target}", "collection": "x", "source": "a.off", "target": f"{target}.off"}
            writer.writerow(row | {"gt_kind": "identity", "category": "isometric"})
    assert composing.main([str(tmp_path / "out"), "--data", str(tmp_path), "--most", "9"], tmp_path) == 0
    assert "4 pairs" in capsys.readouterr().out
    with (tmp_path / "out" / "pairs.csv").open(newline="") as file:
        made = {(Path(row["source"]).stem, Path(row["target"]).stem) for row in csv.DictReader(file)}
    assert made == {("b", "a"), ("c", "a"), ("b", "c"), ("c", "b")}


@pytest.mark.parametrize(("most", "expected"), [(1, 1), (2, 2), (50, 4)])
def test_no_more_than_asked_for_are_chosen(most, expected):
    chosen = composing._some(4, most, np.random.default_rng(0))
    assert len(chosen) == expected
    assert len(set(chosen)) == expected
