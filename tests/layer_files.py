# SPDX-License-Identifier: GPL-3.0-or-later
"""A donor that carries something of every kind, receivers, and `isograft transfer` run on them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from isograft.files import read_mesh
from seamed_shapes import COARSE, DONORS, SHAPES
from transfer_files import run, save, save_map

SIZE = 2.5
"""Of the twin, in units of the donor."""


def turn() -> np.ndarray:
    """A rotation about no axis of the coordinates."""
    c, s = np.cos(1.1), np.sin(1.1)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, s, -c], [0, c, s]])


def all_kinds(folder: Path) -> dict[str, np.ndarray]:
    """Something of every kind and domain for donor.obj, whose polygons are quads."""
    mesh = read_mesh(folder / "donor.obj")
    n, c, p = len(mesh.vertices), len(mesh.polygons.corners), len(mesh.polygons.sizes)
    # The edges along the columns of the grid, from vertex to vertex.
    columns = DONORS["cylinder"][1]
    edges = np.stack([np.arange(n - columns), np.arange(columns, n)], axis=1).astype(np.int32)
    middle = mesh.vertices[mesh.polygons.corners].reshape(p, -1, 3).mean(axis=1)
    axis, uvs = mesh.vertices * [1, 1, 0], mesh.corner_uvs
    return {
        "point/height": mesh.vertices[:, 2].astype(np.float32),
        "point/place": mesh.vertices,
        "point/number": np.arange(n, dtype=np.int32),
        "point/small": (np.arange(n) % 100).astype(np.int8),
        "point/flag": mesh.vertices[:, 0] > 0,
        "point/word": np.array([f"v{i}" for i in range(n)]),
        "corner/shade": np.repeat(middle[:, 2], 4),
        "corner/piece": np.repeat(np.arange(p), 4).astype(np.int64),
        "face/material": np.arange(p, dtype=np.int32) % 7,
        "face/name": np.array(["upper" if z > 2 else "lower" for z in middle[:, 2]]),
        "face/tint": middle.astype(np.float32),
        "edges": edges,
        "edge/crease": (np.arange(len(edges)) / len(edges)).astype(np.float32),
        "edge/seam": np.arange(len(edges)) % 3 == 0,
        "uv/Second": 0.5 * uvs,
        "uv/Third": uvs * [-1, 1],
        "weights/Up per": mesh.vertices[:, 2] / 4,
        "weights/Lower": 1 - mesh.vertices[:, 2] / 4,
        "keys/Swell": 0.1 * axis,
        "keys/Lift": np.tile([0.0, 0.0, 0.3], (n, 1)),
        "normals": np.tile([0.6, 0.0, 0.8], (c, 1)),
    }  # fmt: skip


def make_layer_files(folder: Path) -> None:
    """Donor and receivers, maps, and all.npz with what the donor carries."""
    vertices, faces, uv = SHAPES["cylinder"](*DONORS["cylinder"])
    # Twisted, so that the shorter diagonal of a quad is the same one whatever is rounded.
    c, s = np.cos(0.05 * vertices[:, 2]), np.sin(0.05 * vertices[:, 2])
    x, y, z = vertices.T
    vertices = np.stack([c * x - s * y, s * x + c * y, z], axis=1)
    donor = vertices, faces, uv
    twin = (SIZE * vertices @ turn().T + [5, 1, -2], faces, uv)
    receiver = SHAPES["cylinder"](*COARSE["cylinder"], turn=0.37)
    save(folder / "donor.obj", donor, quads=True)
    save(folder / "twin.obj", twin, uvs=False, quads=True)
    save(folder / "bare.obj", receiver, uvs=False)
    save(folder / "quads.obj", receiver, uvs=False, quads=True)
    mesh = read_mesh(folder / "donor.obj")
    save_map(folder / "map.npz", receiver, (mesh.vertices, mesh.faces))
    save_map(folder / "same.npz", (mesh.vertices, mesh.faces), (mesh.vertices, mesh.faces))
    np.savez(folder / "all.npz", **all_kinds(folder))


def layers(folder: Path, receiver: str, *options: str, **names: str) -> dict[str, np.ndarray]:
    """The arrays that are written, all.npz given to the donor."""
    assert run(folder, receiver, "--target-data", str(folder / "all.npz"), *options, **names) == 0
    return dict(np.load(folder / "out.npz"))


def own_data(folder: Path, **arrays: np.ndarray) -> tuple[str, str]:
    """Data of the receiver's as options; _ stands for /."""
    np.savez(folder / "own.npz", **{name.replace("_", "/", 1): array for name, array in arrays.items()})
    return "--source-data", str(folder / "own.npz")
