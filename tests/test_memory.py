# SPDX-License-Identifier: GPL-3.0-or-later
"""match(memory_limit=): refused beforehand, and the estimate is near what a match takes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import isograft
import pytest
import surfaces
from isograft import _native

ROOT = Path(__file__).resolve().parents[1]


def test_a_match_over_the_limit_is_refused_before_the_surfaces_are_made():
    vertices, faces = surfaces.blob(3)
    broken = faces.copy()
    broken[0, 0] = 10**6  # the gate would object to this
    calls = []
    with pytest.raises(isograft.ResourceLimit, match=r"642 to 642 vertices takes about \d+ MB, the limit is 1 MB"):
        isograft.match((vertices, broken), (vertices, faces), memory_limit=10**6, progress=calls.append)
    assert calls == []


def test_a_limit_that_is_no_number_of_bytes_is_refused():
    mesh = surfaces.blob(1)
    for limit in (0, -5, 1.5, "1 GB"):
        with pytest.raises(isograft.InvalidInput, match="memory_limit"):
            isograft.match(mesh, mesh, memory_limit=limit)


CHILD = """
import json
import isograft, surfaces
from benchmarks.child import peak_mb
from benchmarks.refine import refined
mesh = refined(*surfaces.blob(4), 60_000)
before = peak_mb()
isograft.match(mesh, mesh, preset="fast", threads=1, scale="fixed")
print(json.dumps([len(mesh[0]), len(mesh[1]), peak_mb() - before]))
"""


def test_the_estimate_is_above_what_a_match_takes_but_not_far():
    paths = os.pathsep.join([str(ROOT), str(ROOT / "tests"), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-c", CHILD],
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": paths},
    )
    vertices, triangles, taken = json.loads(done.stdout)
    size = (vertices, triangles)
    estimate = _native.check_memory(size, size, "fast", {}, 1, 0) / 1e6
    assert 0.9 * taken < estimate < 2.0 * taken
