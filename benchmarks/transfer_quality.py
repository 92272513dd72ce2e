# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/transfer_benchmark --quality: how well UVs, textures and shape keys arrive where the truth is known.

Poses of one mesh, the receiver in a tessellation of its own, so that every receiver vertex is a known point of the
donor; expressions of two persons in one vertex order. Along the true map, which measures the transfer alone, and along
the one that match() finds.
"""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import isograft
import numpy as np
from isograft import transfer
from isograft.files import read_mesh

ROOT = Path(__file__).resolve().parents[1]
DATA = Path(os.environ.get("ISOGRAFT_DATA") or ROOT.parent / "shared" / "data")

PAIRS = [
    ("faces/ict_s101_neutral.obj", "faces/ict_s101_smile.obj"),
    ("faces/ict_s102_neutral.obj", "faces/ict_s102_smileopen.obj"),
    ("textured/CesiumMan_t010.obj", "textured/CesiumMan_t080.obj"),
]


def other_tessellation(faces):
    """Triangles that lie across the edges of the given ones: every vertex is a point of a face, known by its weights.

    The corners of the old mesh and the middles of its triangles are the vertices; every old edge between two triangles
    becomes the edge between their middles (a step of Kobbelt's sqrt(3) subdivision), so that no new triangle lies in an
    old one, and seams run through their middle.
    """
    count = int(faces.max()) + 1
    half = {}
    for f, (a, b, c) in enumerate(faces.tolist()):
        for start, end in ((a, b), (b, c), (c, a)):
            half[start, end] = f
    new = []
    for (start, end), f in half.items():
        other = half.get((end, start))
        if other is None:
            new.append((start, end, count + f))
        else:
            new.append((start, count + other, count + f))
    face, weights = np.full(count + len(faces), -1, np.int32), np.zeros((count + len(faces), 3))
    for c in range(3):
        face[faces[:, c]] = np.arange(len(faces))
    for c in range(3):
        at = faces[face[:count].clip(0), c] == np.arange(count)
        weights[:count][at] = np.eye(3)[c]
    face[count:], weights[count:] = np.arange(len(faces)), 1 / 3
    vertex = np.where(face < 0, -1, faces[face.clip(0), weights.argmax(axis=1)]).astype(np.int32)
    weights[face < 0] = np.nan
    return np.array(new, np.int32), SimpleNamespace(face=face, barycentric=weights, vertex=vertex)


def on_surface(correspondence, vertices, faces):
    """The vertices of the other tessellation on any pose of the mesh."""
    corners = vertices[faces[correspondence.face.clip(0)]]
    return np.nan_to_num(np.einsum("ij,ijk->ik", correspondence.barycentric, corners))


def measure_pose(donor_name: str, pose_name: str, matched: bool = False) -> dict[str, float]:
    """What look() finds for a pose in another tessellation, along the true map or the one that is found."""
    donor, pose = read_mesh(DATA / donor_name), read_mesh(DATA / pose_name)
    faces, uv = donor.faces, donor.triangle_uvs
    new_faces, truth = other_tessellation(faces)
    receiver = on_surface(truth, pose.vertices, faces)
    found = isograft.match((receiver, new_faces), (donor.vertices, faces)).best if matched else truth
    moved = transfer.transfer_corner_uv(found, receiver, new_faces, donor.vertices, faces, uv)
    return look(truth, found, donor, new_faces, receiver, moved.uv.reshape(-1, 3, 2), moved.mask)


SAME = 0.1
"""Largest difference of two values of the pattern that count as the same."""

MEASURES = (
    "with UVs",
    "without outliers",
    "same picture",
    "picture error",
    "same picture, baked",
    "picture error, baked",
)


def jacobians(points, uv):
    """(F, 2) singular values of the map from triangles in space to UVs."""
    a, b, c = (points[:, k] for k in range(3))
    x = np.linalg.norm(b - a, axis=1)
    y = np.einsum("ij,ij->i", c - a, b - a) / np.maximum(x, 1e-30)
    h = np.linalg.norm(np.cross(b - a, c - a), axis=1) / np.maximum(x, 1e-30)
    flat = np.stack([np.stack([x, y], axis=1), np.stack([np.zeros_like(x), h], axis=1)], axis=1)
    edges = np.stack([uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]], axis=2)
    usable = (x > 0) & (h > 1e-4 * x)
    result = np.full((len(points), 2), np.nan)
    result[usable] = np.linalg.svd(edges[usable] @ np.linalg.inv(flat[usable]), compute_uv=False)
    return result


def look(correspondence, found, donor, new_faces, receiver, uv, mask):
    """Stretch against the donor's, and pictures against the truth: a pattern whose value is known at every point.

    A triangle is an outlier if its UVs are stretched more than twice as much as the donor's there, or less than half as
    much, in any direction. The pattern lies in [0, 1] and goes from end to end within a twentieth of the UV square; its
    value is "the same" if it is within 0.1 of the truth, so if the point read is at most a 300th of the square off
    where the pattern is steepest.

    Args:
        correspondence: the true one.
        found: the one along which all is moved.
    """
    faces = donor.faces
    images = on_surface(correspondence, donor.vertices, faces)[new_faces]
    count = len(new_faces)
    centre = transfer.locate(
        correspondence, receiver, new_faces, donor.vertices, faces, np.arange(count), np.full((count, 3), 1 / 3)
    )
    mine = jacobians(images, uv)
    theirs = jacobians(donor.vertices[faces], donor.triangle_uvs)[centre.face.clip(0)]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = mine / theirs
    usable = mask & np.isfinite(ratio).all(axis=1) & (theirs[:, 1] > 1e-3 * theirs[:, 0])
    good = (ratio[usable] > 0.5).all(axis=1) & (ratio[usable] < 2.0).all(axis=1)

    # Points of the receiver, and where they truly lie on the donor.
    random = np.random.default_rng(0)
    area = np.linalg.norm(np.cross(*(images[:, k] - images[:, 0] for k in (1, 2))), axis=1) * mask
    chosen = random.choice(len(new_faces), 20000, p=area / area.sum())
    weights = random.dirichlet([1, 1, 1], len(chosen))
    truth = transfer.locate(
        correspondence, receiver, new_faces, donor.vertices, faces, chosen.astype(np.int32), weights
    )
    true_uv = np.einsum("ij,ijk->ik", truth.barycentric, donor.triangle_uvs[truth.face])
    found_uv = np.einsum("ij,ijk->ik", weights, uv[chosen])
    size = 1024
    y, x = np.indices((size, size)) / size
    picture = (0.5 + 0.5 * np.sin(60 * x) * np.sin(60 * y)).astype(np.float32)[..., None]
    layout = islands_layout(len(new_faces))
    channel = transfer.Channel(picture)
    baked = transfer.bake(
        found, receiver, new_faces, layout, donor.vertices, faces, donor.triangle_uvs, channel, 2048, margin=2
    )
    seen = read(baked.images[0], np.einsum("ij,ijk->ik", weights, layout[chosen]))
    expected = read(picture, true_uv)
    off, off_baked = np.abs(read(picture, found_uv) - expected), np.abs(seen - expected)
    values = (mask, good, off < SAME, off, off_baked < SAME, off_baked)
    return {name: float(value.mean()) for name, value in zip(MEASURES, values, strict=True)}


def islands_layout(count):
    """A cell of its own for every two triangles."""
    columns = int(np.ceil(np.sqrt((count + 1) // 2)))
    index = np.arange(count)
    cell = np.stack(np.divmod(index // 2, columns)[::-1], axis=1)
    lower = np.array([[0.1, 0.05], [0.9, 0.05], [0.1, 0.85]])
    corner = np.where((index % 2 == 0)[:, None, None], lower, 1.0 - lower)
    return (cell[:, None] + corner) / columns


def read(image, uv):
    """Between four pixels, the image repeated."""
    height, width = image.shape[:2]
    at = uv * [width, height] - 0.5
    low = np.floor(at).astype(int)
    share = at - low
    total = 0.0
    for i in range(2):
        for j in range(2):
            weight = (share[:, 0] if i else 1 - share[:, 0]) * (share[:, 1] if j else 1 - share[:, 1])
            total = total + weight * image[(low[:, 1] + j) % height, (low[:, 0] + i) % width, 0]
    return total


SMOOTHINGS = (2, None)
"""How shape keys are carried: over two edges, as between two poses, and as it is chosen for each pair."""


def measure_expression(given: Any, own: Any, faces: Any, keys: dict[str, Any], matched: bool) -> dict[str, Any]:
    """Per key the mean error of what arrives over the mean length of the true displacement, on matched vertices.

    Args:
        given, own: (m, 3) donor and receiver, in one vertex order; the receiver is read in another tessellation.
        keys: displacements (m, 3), the donor's and the true ones, by name.

    Returns:
        The matched share, whether the two were found in one pose, and by key the errors with each of SMOOTHINGS.
    """
    new_faces, truth = other_tessellation(faces)
    points = on_surface(truth, own, faces)
    found = isograft.match((points, new_faces), (given, faces)).best if matched else truth
    surfaces = found, points, new_faces, given, faces
    frames = transfer.local_frames(*surfaces)
    result: dict[str, Any] = {"matched": float(frames.mask.mean()), "one pose": frames.one_pose}
    true = [on_surface(truth, key, faces)[frames.mask] for key in keys.values()]
    result |= {name: [] for name in keys}
    for smoothing in SMOOTHINGS:
        moved = transfer.transfer_shape_keys(*surfaces, np.stack(list(keys.values())), smoothing=smoothing)
        for name, values, wanted in zip(keys, moved.values, true, strict=True):
            off = np.linalg.norm(values[frames.mask] - wanted, axis=1).mean()
            result[name].append(float(off / np.linalg.norm(wanted, axis=1).mean()))
    return result


def expressions() -> tuple[Any, list[tuple[str, Any, Any, dict[str, Any]]]]:
    """Triangles, and expressions of a person on another expression of the same face, and on other persons' faces.

    The data adds expressions up, vertex by vertex and alike for all persons, and its persons are sums too: that is
    taken for the truth, and "between" is a person half way between the two, "beyond" one as far off on the other side.
    """
    shapes = {
        name: read_mesh(DATA / f"faces/ict_{name}.obj")
        for name in ("s101_neutral", "s101_smile", "s101_jawopen", "s102_neutral", "s102_smileopen")
    }
    first, smiling, gaping, second, other = (shape.vertices for shape in shapes.values())
    smile, jaw, both = {"smile": smiling - first}, {"jawopen": gaping - first}, {"smileopen": other - second}
    return shapes["s101_neutral"].faces, [
        ("s101 on s101, smiling", first, smiling, jaw),
        ("s101 on s101, jaw open", first, gaping, smile),
        ("s101 on s102", first, second, jaw | smile),
        ("s102 on s101", second, first, both),
        ("s101 on s102, smiling, jaw open", first, other, jaw | smile),
        ("s101 on between", first, (first + second) / 2, jaw | smile),
        ("s101 on beyond", first, 2 * first - second, jaw | smile),
    ]


def main() -> int:
    """Print both tables."""
    columns = MEASURES
    print("| donor | receiver | map | " + " | ".join(columns) + " |\n|" + " --- |" * (3 + len(columns)))
    for donor, pose in PAIRS:
        for matched in (False, True):
            measures = measure_pose(donor, pose, matched)
            row = [Path(donor).stem, Path(pose).stem, "found" if matched else "true"]
            print("| " + " | ".join([*row, *(f"{measures[name]:.4f}" for name in columns)]) + " |", flush=True)
    print("\n| keys | map | matched | one pose | over two edges | as chosen |\n|" + " --- |" * 6)
    faces, cases = expressions()
    for title, given, own, keys in cases:
        for matched in (False, True):
            measures = measure_expression(given, own, faces, keys, matched)
            row = [title, "found" if matched else "true", f"{measures['matched']:.3f}", str(measures["one pose"])]
            for number in range(len(SMOOTHINGS)):
                row.append(", ".join(f"{name} {measures[name][number]:.2f}" for name in keys))
            print("| " + " | ".join(row) + " |", flush=True)
    return 0
