# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/transfer_benchmark: what each kind of transfer costs, between two meshes of many vertices.

Both are a bent ring in tessellations of their own, so that the map between them is known and no match is needed.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import resource
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import isograft
import numpy as np
from isograft import transfer

from benchmarks import transfer_quality

COLUMNS = ("kind", "vertices", "wall s", "CPU s", "longest silence s")
SLOW = 0.1
"""Seconds; what takes less is not stopped half way."""


class Watch:
    """The progress of one call: how long it was silent, and from when on the answer is to stop."""

    def __init__(self, stop_after: float = np.inf) -> None:
        self.silence = 0.0
        self._last = time.perf_counter()
        self.stop_at = self._last + stop_after

    def __call__(self, stage: str, fraction: float) -> bool:
        now = time.perf_counter()
        self.silence, self._last = max(self.silence, now - self._last), now
        return now < self.stop_at


class Ring:
    """A bent ring as a grid of so many rows around its tube and columns along it, cut open in UV space."""

    def __init__(self, vertices: int, share: float) -> None:
        self.rows = max(8, round((vertices * share) ** 0.5))
        self.columns = max(8, round(vertices / self.rows))
        i, j = np.divmod(np.arange(self.rows * self.columns), self.columns)
        self.around, self.along = i / self.rows, j / self.columns
        self.vertices = place(self.around, self.along)
        cell = np.array([[[0, 0], [0, 1], [1, 1]], [[0, 0], [1, 1], [1, 0]]])
        row = i[:, None, None] + cell[None, ..., 0]
        column = j[:, None, None] + cell[None, ..., 1]
        shape = (-1, 3)
        faces = (row % self.rows) * self.columns + column % self.columns
        self.faces = faces.reshape(shape).astype(np.int32)
        self.uv = np.stack([column / self.columns, row / self.rows], axis=-1).reshape(-1, 3, 2)

    def at(self, around: np.ndarray, along: np.ndarray) -> SimpleNamespace:
        """The points at angles, in turns: what a correspondence holds."""
        u, v = (around % 1.0) * self.rows, (along % 1.0) * self.columns
        i, j = u.astype(int) % self.rows, v.astype(int) % self.columns
        s, t = u - np.floor(u), v - np.floor(v)
        upper = s > t
        weights = np.where(upper[:, None], np.stack([1 - s, t, s - t], axis=1), np.stack([1 - t, t - s, s], axis=1))
        face = (2 * (i * self.columns + j) + upper).astype(np.int32)
        vertex = self.faces[face, weights.argmax(axis=1)]
        return SimpleNamespace(
            face=face, barycentric=weights, vertex=vertex, confidence=np.ones(len(face)), stretch=np.zeros(len(face)),
            region=np.zeros(len(face), np.int32),
        )  # fmt: skip


def place(around: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Points of the ring at angles in turns."""
    tube, circle = 2 * np.pi * around, 2 * np.pi * along
    radius = 0.4 + 0.05 * np.sin(5 * circle) * np.cos(3 * tube)
    out = 1.0 + radius * np.cos(tube)
    return np.stack([out * np.cos(circle), out * np.sin(circle), radius * np.sin(tube)], axis=1)


def kinds(vertices: int, size: int, threads: int) -> dict[str, Callable[[Watch], Any]]:
    """Every kind of transfer between two rings of so many vertices; each is called with its progress."""
    donor, receiver = Ring(vertices, 0.5), Ring(vertices, 0.35)
    found = donor.at(receiver.around + 0.003, receiver.along + 0.002)
    partial = SimpleNamespace(**vars(found))
    # A twentieth has no counterpart: what filling is for.
    hole = (np.abs(receiver.along - 0.5) < 0.025) & (receiver.around > 0.01)
    partial.face = np.where(hole, -1, found.face).astype(np.int32)
    partial.vertex = np.where(hole, -1, found.vertex).astype(np.int32)
    meshes = receiver.vertices, receiver.faces, donor.vertices, donor.faces
    random = np.random.default_rng(0)
    count, triangles = len(donor.vertices), len(donor.faces)
    weights = random.random((count, 40))
    keys = 0.01 * random.normal(size=(10, count, 3))
    normals = donor.vertices[donor.faces] + [0.0, 0.0, 0.1]
    edges = {name: np.unique(np.sort(np.concatenate([ring.faces[:, [0, 1]], ring.faces[:, [1, 2]]]), axis=1), axis=0)
             for name, ring in (("own", receiver), ("other", donor))}  # fmt: skip
    marks = np.arange(len(edges["other"]))
    known = partial.face >= 0
    colors = transfer.transfer_point(partial, donor.faces, weights[:, :4]).values
    image = random.integers(0, 255, (size, size, 3), dtype=np.uint8)
    channels = [
        transfer.Channel(image),
        transfer.Channel(np.ascontiguousarray(image[..., :1])),
        transfer.Channel(image, kind="normal"),
    ]

    def bake(correspondence: Any, fill: bool, watch: Watch) -> Any:
        return transfer.bake(
            correspondence, *meshes[:2], receiver.uv, *meshes[2:], donor.uv, channels, size,
            fill=fill, threads=threads, progress=watch,
        )  # fmt: skip

    def along(move: Callable[..., Any], *values: Any) -> Callable[[Watch], Any]:
        return lambda watch: move(found, *meshes, *values, threads=threads, progress=watch)

    edge_values = marks[np.arange(len(edges["own"])) % len(marks)].astype(float)
    edges_known = known[edges["own"]].all(axis=1)
    return {
        "UV map": along(transfer.transfer_corner_uv, donor.uv),
        "colours of corners": along(transfer.transfer_corner, donor.uv),
        "40 vertex groups": lambda _: transfer.transfer_weights(found, donor.faces, weights),
        "10 shape keys": along(transfer.transfer_shape_keys, keys),
        "custom normals": along(transfer.transfer_normals, normals),
        "values of faces": along(transfer.transfer_face, np.arange(triangles)),
        "values of edges": lambda watch: transfer.transfer_edge(
            found, *meshes[:2], edges["own"], *meshes[2:], edges["other"], marks, threads=threads, progress=watch
        ),
        "cut along seams": along(transfer.cut_along_seams, donor.uv),
        "inverse map": along(transfer.invert),
        f"bake, 3 channels of {size} x {size}": lambda watch: bake(found, False, watch),
        "bake, filled": lambda watch: bake(partial, True, watch),
        "fill colours": lambda watch: transfer.fill_point(
            *meshes[:2], np.nan_to_num(colors), known, progress=watch
        ),
        "fill edges": lambda watch: transfer.fill_edge(
            receiver.vertices, edges["own"], edge_values, edges_known, progress=watch
        ),
        "fill faces": lambda watch: transfer.fill_face(
            *meshes[:2], np.arange(len(receiver.faces)), known[receiver.faces].all(axis=1), progress=watch
        ),
        "wrap": lambda watch: transfer.wrap(partial, *meshes, threads=threads, progress=watch),
    }  # fmt: skip


def seconds_to_stop(run: Callable[[Watch], Any], wall: float) -> float:
    """From the wish to stop, half way through, to the return."""
    watch = Watch(0.5 * wall)
    with contextlib.suppress(isograft.Cancelled):
        run(watch)
    return max(0.0, time.perf_counter() - watch.stop_at)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="scripts/transfer_benchmark", description=__doc__)
    parser.add_argument("--vertices", metavar="A,B", default="100000", help="(default: 100000)")
    parser.add_argument("--size", type=int, default=4096, help="of the images baked (default: 4096)")
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1, help="(default: all cores)")
    parser.add_argument("--only", metavar="WORD", default="", help="kinds whose name has this in it")
    parser.add_argument("--quality", action="store_true", help="instead: how well it arrives, on ../shared/data")
    parser.add_argument("--cancel", action="store_true", help="run each again and stop it half way")
    given = parser.parse_args(arguments)
    if given.quality:
        return transfer_quality.main()
    columns = (*COLUMNS, "stopped after s") if given.cancel else COLUMNS
    print("| " + " | ".join(columns) + " |\n|" + " --- |" * len(columns), flush=True)
    for vertices in (int(text) for text in given.vertices.split(",")):
        total = np.zeros(2)
        for name, run in kinds(vertices, given.size, given.threads).items():
            if given.only not in name:
                continue
            watch, before = Watch(), np.array([time.perf_counter(), time.process_time()])
            run(watch)
            watch("", 1.0)
            wall, spent = np.array([time.perf_counter(), time.process_time()]) - before
            total += wall, spent
            row = f"| {name} | {vertices:,} | {wall:.2f} | {spent:.2f} | {watch.silence:.2f} |"
            if given.cancel:
                row += f" {seconds_to_stop(run, wall):.2f} |" if wall > SLOW else " |"
            print(row, flush=True)
        print(f"| all of these | {vertices:,} | {total[0]:.2f} | {total[1]:.2f} | |" + " |" * given.cancel, flush=True)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"\n{given.threads} threads, peak memory {peak:,.0f} MB")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
