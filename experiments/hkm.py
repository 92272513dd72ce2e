# SPDX-License-Identifier: GPL-3.0-or-later
"""Heat kernel maps (Ovsjanikov, Merigot, Memoli, Guibas 2010) from given correspondences: our implementation.

HKM_p(x) is the function t -> k_t(p, x). Under an isometry that takes p to q it equals HKM_q(f(x)), so each vertex goes
to the target vertex whose heat kernels from the landmarks' images are nearest in the sup norm over the times, each time
scaled by its total heat; every vertex is matched, as the global model has it.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
import scipy.spatial

FUNCTIONS = 150
TIMES = 40


def heat_kernel_map(
    source: tuple[np.ndarray, np.ndarray], target: tuple[np.ndarray, np.ndarray], landmarks: np.ndarray
) -> np.ndarray:
    """The target vertex of every source vertex, from landmarks (k, 2)."""
    unit = [np.sqrt(_areas(*shape).sum()) for shape in (source, target)]
    spectra = [_spectrum(shape[0] / length, shape[1]) for shape, length in zip((source, target), unit, strict=True)]
    # Times from the decay of the finest function to that of the coarsest (Sun et al. 2009), common to both.
    lowest = min(values[1] for values, _ in spectra)
    highest = min(values[-1] for values, _ in spectra)
    times = np.geomspace(4.0 * np.log(10.0) / highest, 4.0 * np.log(10.0) / lowest, TIMES)
    signatures = [
        np.hstack([_kernels(values, functions, int(p), times) for p in landmarks[:, side]])
        for side, (values, functions) in enumerate(spectra)
    ]
    scale = np.abs(signatures[1]).max(axis=0)
    tree = scipy.spatial.cKDTree(signatures[1] / scale)
    return np.asarray(tree.query(signatures[0] / scale, p=np.inf)[1], np.int64)


def _kernels(values: np.ndarray, functions: np.ndarray, p: int, times: np.ndarray) -> np.ndarray:
    """k_t(p, x) over the total heat at t: a row for each x, a column for each t."""
    decay = np.exp(-np.outer(times, values))
    return (functions * functions[p]) @ decay.T / decay.sum(axis=1)


def _spectrum(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lowest eigenvalues and functions of the cotangent Laplacian with lumped masses."""
    n = len(vertices)
    rows, columns, weights = [], [], []
    for k in range(3):
        i, j, opposite = faces[:, (k + 1) % 3], faces[:, (k + 2) % 3], faces[:, k]
        u, v = vertices[i] - vertices[opposite], vertices[j] - vertices[opposite]
        cotangent = np.einsum("ij,ij->i", u, v) / np.maximum(np.linalg.norm(np.cross(u, v), axis=1), 1e-12)
        rows += [i, j]
        columns += [j, i]
        weights += [0.5 * cotangent] * 2
    shape = (n, n)
    w = scipy.sparse.coo_matrix((np.hstack(weights), (np.hstack(rows), np.hstack(columns))), shape).tocsr()
    stiffness = scipy.sparse.diags(np.asarray(w.sum(axis=1)).ravel()) - w
    mass = np.zeros(n)
    np.add.at(mass, faces.ravel(), np.repeat(_areas(vertices, faces) / 3.0, 3))
    start = np.random.default_rng(0).normal(size=n)
    values, functions = scipy.sparse.linalg.eigsh(
        stiffness.tocsc(), min(FUNCTIONS, n - 2), scipy.sparse.diags(np.maximum(mass, 1e-12)).tocsc(), -1e-3, v0=start
    )
    order = np.argsort(values)
    return np.maximum(values[order], 0.0), functions[:, order]


def _areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
