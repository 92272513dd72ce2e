# SPDX-License-Identifier: GPL-3.0-or-later
"""match(memory_limit=): refused beforehand, the estimate is near what a match takes; what baking takes."""

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


def in_a_child(code: str, *arguments: str) -> list[float]:
    """What Python code prints as JSON, run alone so that nothing else has taken memory before."""
    paths = os.pathsep.join([str(ROOT), str(ROOT / "tests"), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": paths},
    )
    return json.loads(done.stdout)


def test_the_estimate_is_above_what_a_match_takes_but_not_far():
    vertices, triangles, taken = in_a_child(CHILD)
    size = (vertices, triangles)
    estimate = _native.check_memory(size, size, "fast", {}, 1, 0) / 1e6
    assert 0.9 * taken < estimate < 2.0 * taken


BAKE = """
import json, sys
import numpy as np
from benchmarks.child import peak_mb
from isograft import transfer
from seamed_shapes import identity_map, torus
vertices, faces, uv = torus(60, 40)
uv = 0.9 * uv / np.abs(uv).max() + 0.05
image = np.random.default_rng(1).random((64, 64, 3)).astype(np.float32)
channels = [transfer.Channel((255 * image).astype(np.uint8)), transfer.Channel(image[..., :1], uv=uv)]
arguments = identity_map(vertices, faces), vertices, faces, uv, vertices, faces, uv, channels
wanted = vertices[faces].mean(axis=1)[:, 0] < 0.8 * vertices[:, 0].max()
def bake(size):
    return transfer.bake(*arguments, size, receiver_mask=wanted, fill=sys.argv[1] == "fill", margin=16, threads=2)
bake(64)
before = peak_mb()
baked = bake(int(sys.argv[2]))
assert set(np.unique(baked.mask)) == {0, 1, 2, 3} - ({3} if sys.argv[1] == "plain" else set())
results = sum(image.nbytes for image in baked.images) + baked.mask.nbytes
print(json.dumps([results / 2**20, peak_mb() - before]))
"""


@pytest.mark.parametrize("kind", ["plain", "fill"])
def test_a_bake_takes_its_images_and_a_byte_a_texel_and_no_more_however_large_they_are(kind):
    for size in (1024, 2048):
        results, taken = in_a_child(BAKE, kind, str(size))
        assert results == pytest.approx(8 * size**2 / 2**20)
        # One number a texel beside, of 4 bytes, would be 16 MiB at the larger size.
        assert 0.9 * results < taken < results + 8.0
