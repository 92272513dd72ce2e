# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfers on scanned and modelled surfaces whose truth is known; data as for test_accuracy.py."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from isograft import transfer
from isograft.files import read_mesh
from seamed_shapes import identity_map

ROOT = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("ISOGRAFT_DATA") or ROOT.parent / "shared" / "data")
TURN, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
TURN *= np.linalg.det(TURN)

if not DATA.is_dir():
    pytest.skip(f"no pairs with a known truth in {DATA}", allow_module_level=True)


def test_face_expressions_arrive_on_another_persons_face():
    """In this data an expression moves every person's vertices alike: the truth, but for how the shapes differ."""
    person, other = (read_mesh(DATA / f"faces/ict_{name}_neutral.obj") for name in ("s101", "s102"))
    keys = np.stack(
        [read_mesh(DATA / f"faces/ict_s101_{name}.obj").vertices - person.vertices for name in ("smile", "jawopen")]
    )
    correspondence = identity_map(person.vertices, person.faces)
    moved = transfer.transfer_shape_keys(
        correspondence, other.vertices, other.faces, person.vertices, person.faces, keys
    )
    assert moved.mask.all()
    off = np.linalg.norm(moved.values - keys, axis=2).mean(axis=1) / np.linalg.norm(keys, axis=2).mean(axis=1)
    assert (off < 0.25).all()
    # On a face that is only turned and scaled there is no such difference.
    turned = transfer.transfer_shape_keys(
        correspondence, 0.01 * person.vertices @ TURN.T, person.faces, person.vertices, person.faces, keys
    )
    np.testing.assert_allclose(turned.values, 0.01 * keys @ TURN.T, rtol=0, atol=1e-6)


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


@pytest.mark.parametrize("name", ["jawopen", "smile"])
def test_an_expression_arrives_on_another_expression_of_the_face(name):
    """The data adds expressions up, vertex by vertex: that is the truth where the other one does not turn the skin."""
    neutral = read_mesh(DATA / "faces/ict_s101_neutral.obj")
    faces, key = neutral.faces, read_mesh(DATA / f"faces/ict_s101_{name}.obj").vertices - neutral.vertices
    pose = read_mesh(DATA / f"faces/ict_s101_{'smile' if name == 'jawopen' else 'jawopen'}.obj").vertices
    new_faces, correspondence = other_tessellation(faces)
    receiver, truth = (on_surface(correspondence, points, faces) for points in (pose, key))
    moved = transfer.transfer_shape_keys(correspondence, receiver, new_faces, neutral.vertices, faces, key[None])
    assert moved.mask.all()
    off = np.linalg.norm(moved.values[0] - truth, axis=1).mean() / np.linalg.norm(truth, axis=1).mean()
    # An open jaw turns the lower lip, and with it the smile there: the sum of the data does not.
    assert off < (0.2 if name == "jawopen" else 0.4)


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


PAIRS = [
    ("faces/ict_s101_neutral.obj", "faces/ict_s101_smile.obj"),
    ("faces/ict_s102_neutral.obj", "faces/ict_s102_smileopen.obj"),
    ("textured/CesiumMan_t010.obj", "textured/CesiumMan_t080.obj"),
]


@pytest.mark.parametrize(("donor_name", "pose_name"), PAIRS, ids=[pose for _, pose in PAIRS])
def test_a_pose_of_another_tessellation_looks_like_the_donor(donor_name, pose_name):
    donor, pose = read_mesh(DATA / donor_name), read_mesh(DATA / pose_name)
    faces, uv = donor.faces, donor.triangle_uvs
    new_faces, correspondence = other_tessellation(faces)
    receiver = on_surface(correspondence, pose.vertices, faces)
    moved = transfer.transfer_corner_uv(correspondence, receiver, new_faces, donor.vertices, faces, uv)
    measures = look(correspondence, donor, new_faces, receiver, moved.uv.reshape(-1, 3, 2), moved.mask)
    print(pose_name, measures)
    assert measures["with UVs"] > 0.97
    assert measures["without outliers"] > 0.97
    assert measures["same picture"] > 0.97
    assert measures["same picture, baked"] > 0.98


def look(correspondence, donor, new_faces, receiver, uv, mask):
    """Stretch against the donor's, and pictures against the truth: a checker whose colours are known at every point."""
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
        correspondence, receiver, new_faces, layout, donor.vertices, faces, donor.triangle_uvs, channel, 2048, margin=2
    )
    seen = read(baked.images[0], np.einsum("ij,ijk->ik", weights, layout[chosen]))
    expected = read(picture, true_uv)
    return {
        "with UVs": float(mask.mean()),
        "without outliers": float(good.mean()),
        "same picture": float((np.abs(read(picture, found_uv) - expected) < 0.1).mean()),
        "picture error": float(np.abs(read(picture, found_uv) - expected).mean()),
        "same picture, baked": float((np.abs(seen - expected) < 0.1).mean()),
        "picture error, baked": float(np.abs(seen - expected).mean()),
    }


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
