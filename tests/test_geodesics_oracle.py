# SPDX-License-Identifier: GPL-3.0-or-later
"""Geodesic distances against an exact, independent implementation (Mitchell, Mount, Papadimitriou 1987; pygeodesic).

Polar marching takes the distance of a vertex from one virtual source per edge, the exact algorithm from all windows
of all edges: they differ where windows meet, behind bumps and, most, in the shadow of saddles.
"""

from __future__ import annotations

import isograft
import numpy as np
import pygeodesic.geodesic as pygeodesic
import pytest
import surfaces


def bumps(x: surfaces.Floats, y: surfaces.Floats) -> surfaces.Floats:
    """A landscape with hills, valleys and saddles, slopes up to about 0.8."""
    return 0.12 * np.sin(3.1 * x + 0.3) * np.cos(2.3 * y) + 0.06 * np.sin(5.3 * y - 2.0 * x + 1.0)


def landscape(columns: int, rows: int, width: float, height: float, shear: float) -> surfaces.Mesh:
    """`columns` by `rows` cells over a patch of the landscape, every row shifted by `shear` of its height."""
    i, j = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="xy")
    y = height * j / rows
    x = width * i / columns + shear * y
    vertices = np.stack([x, y, bumps(x, y)], axis=-1).reshape(-1, 3)
    a = (j[:-1, :-1] * (columns + 1) + i[:-1, :-1]).ravel()
    b, c, d = a + 1, a + columns + 2, a + columns + 1
    return vertices, np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def largest_angles(vertices: surfaces.Floats, faces: surfaces.Ints) -> surfaces.Floats:
    """Largest angle of every triangle, in degrees."""
    angles = []
    for k in range(3):
        p, q, r = (vertices[faces[:, (k + i) % 3]] for i in range(3))
        cosine = np.einsum("ij,ij->i", q - p, r - p)
        cosine /= np.linalg.norm(q - p, axis=1) * np.linalg.norm(r - p, axis=1)
        angles.append(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
    return np.max(angles, axis=0)


def relative_errors(vertices: surfaces.Floats, faces: surfaces.Ints, sources: int = 8) -> surfaces.Floats:
    """Of the distances from some vertices to all others farther than two mean edges."""
    surface = isograft.Surface(vertices, faces)
    exact = pygeodesic.PyGeodesicAlgorithmExact(vertices, faces.astype(np.int32))
    edges = np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2)
    rng = np.random.default_rng(0)
    errors = []
    for face in rng.choice(len(faces), sources, replace=False):
        truth, _ = exact.geodesicDistances(np.array([faces[face, 0]]), None)
        found = isograft.geodesic_distances(surface, int(face), [1.0, 0.0, 0.0])
        far = truth > 2.0 * edges.mean()
        errors.append(np.abs(found[far] / truth[far] - 1.0))
    return np.concatenate(errors)


CASES = {
    # name: (mesh, largest angle in degrees that at least a tenth of the triangles reaches)
    "regular sphere": (surfaces.sphere(4), 60.0),
    "regular blob": (surfaces.blob(4), 60.0),
    "right landscape": (landscape(50, 50, 3.0, 3.0, 0.0), 85.0),
    "obtuse landscape": (landscape(50, 50, 3.0, 3.0, 1.5), 120.0),
    "anisotropic landscape": (landscape(20, 160, 3.0, 3.0, 0.0), 85.0),
    "obtuse anisotropic landscape": (landscape(20, 100, 3.0, 3.0, 1.0), 130.0),
}


@pytest.mark.parametrize("name", CASES)
def test_distances_agree_with_exact_ones(name: str) -> None:
    (vertices, faces), angle = CASES[name]
    assert np.quantile(largest_angles(vertices, faces), 0.9) >= angle, "the mesh is not what its name says"
    errors = relative_errors(vertices, faces)
    assert errors.mean() < 0.003
    assert np.quantile(errors, 0.99) < 0.01


def test_distances_converge_to_exact_ones() -> None:
    coarse, fine = (relative_errors(*landscape(n, n, 3.0, 3.0, 0.5)).mean() for n in (15, 60))
    assert fine < 0.5 * coarse
