# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/benchmark --scaling: refinement of meshes, exponents, and the page that is made of them."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
import surfaces

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks import cancelling, performance, scaling
from benchmarks.refine import refined


def area(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


def edge_uses(faces):
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    return np.unique(ends, axis=0, return_counts=True)[1]


@pytest.mark.parametrize("count", [643, 1000, 5000])
def test_a_refined_surface_is_the_same_surface_with_as_many_vertices_as_asked_for(count):
    vertices, faces = surfaces.blob(3)
    more, finer = refined(vertices, faces, count)
    assert len(more) == count
    assert np.array_equal(more[: len(vertices)], vertices)
    assert (edge_uses(finer) == 2).all()
    assert len(more) - len(finer) / 2 == 2  # a sphere still
    assert area(more, finer) == pytest.approx(area(vertices, faces))


def test_refinement_evens_edges_out():
    vertices, faces = surfaces.blob(3)
    more, finer = refined(vertices, faces, 8 * len(vertices))
    length = np.linalg.norm(more[finer] - more[np.roll(finer, 1, axis=1)], axis=2)
    assert length.max() < 4.0 * length.mean()


def test_a_surface_is_not_made_coarser():
    vertices, faces = surfaces.blob(3)
    with pytest.raises(ValueError, match="more than 10"):
        refined(vertices, faces, 10)


def rows(power, memory=1.0):
    return [
        {
            "vertices": n, "threads": threads, "status": "ok", "seconds": (3 - threads) * (n / 10_000) ** power,
            "peak_mb": 100.0 * (n / 10_000) ** memory, "cost_unit_seconds": n / 2_000, "stages": {"seeds": 0.5},
            "error": 1.2, "coverage": 0.9,
        }
        for n in scaling.SIZES for threads in (1, 2)
    ]  # fmt: skip


def test_exponents_are_the_powers_that_went_in():
    two = [row for row in rows(1.3, 0.7) if row["threads"] == 2]
    assert scaling.exponent(two, "seconds") == pytest.approx(1.3)
    assert scaling.exponent(two, "peak_mb") == pytest.approx(0.7)
    assert scaling.exponent(two[:3], "seconds") is None


def test_the_page_says_what_holds_and_what_falls_short(tmp_path):
    page = tmp_path / "performance.md"
    page.write_text(f"before\n{performance.BEGIN}\nof yesterday\n{performance.END}\nafter\n")
    scaling.write(tmp_path, rows(1.0), {"pair": "p", "repeats": 1, "preset": "default"})
    assert performance.main([str(tmp_path), "--page", str(page)]) == 0
    text = page.read_text()
    assert text.startswith("before")
    assert text.endswith("after\n")
    assert "of yesterday" not in text
    assert "| 5,100 vertices | 4 s | 1.5 s | 0.51 s | holds |" in text
    assert "| exponent of time | 1.1 |  | 1.00 | holds |" in text
    assert "| least gain of 2 threads over one | 1.6 |  | 2.00 | holds |" in text
    assert (tmp_path / "pictures/scaling.svg").read_text().startswith("<svg")
    scaling.write(tmp_path, rows(1.5), {"pair": "p", "repeats": 1, "preset": "default"})
    performance.main([str(tmp_path), "--page", str(page)])
    assert "| exponent of time | 1.1 |  | 1.50 | **falls short** |" in page.read_text()


def test_a_size_that_failed_is_told_and_not_fitted(tmp_path):
    some = rows(1.0)
    some[-1] = {"vertices": 1_000_000, "threads": 2, "status": "ended with -9"}
    scaling.write(tmp_path, some, {"pair": "p", "repeats": 1, "preset": "default"})
    content = json.loads((tmp_path / "scaling.json").read_text())
    assert content["exponents"]["seconds"] == pytest.approx(1.0)
    assert "ended with -9" in (tmp_path / "scaling.md").read_text()


def test_cancelled_matches_are_timed_from_the_wish_on_and_finished_ones_left_out() -> None:
    blob = surfaces.blob(3)
    row = cancelling.measure(blob, blob, np.random.default_rng(0), 3, preset="fast", threads=1)
    assert row["cancelled"] <= 3
    assert all(0.0 <= stop["seconds"] < 5.0 and 0.0 <= stop["fraction"] <= 1.0 for stop in row["stops"])
    assert row["median"] <= row["p99"] <= row["worst"]["seconds"] + 1e-4
    assert cancelling.stop_at(1e6, blob, blob, preset="fast", threads=1) is None
    assert cancelling.stop_at(0.0, blob, blob, preset="fast", threads=1) is not None
