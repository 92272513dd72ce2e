# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and maps as files, and `isograft transfer` run on them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from isograft.cli import main
from isograft.correspondence import Correspondence
from seamed_shapes import closest_points


def save(path: Path, shape, uvs: bool = True, colors: bool = False, quads: bool = False) -> None:
    vertices, faces, uv = shape
    rows = vertices.tolist()
    shade = (0.5 + 0.5 * vertices / np.abs(vertices).max()).tolist()
    numbers = [row + (shade[i] if colors else []) for i, row in enumerate(rows)]
    lines = ["v " + " ".join(map(repr, row)) for row in numbers]
    if uvs:
        lines += [f"vt {u!r} {v!r}" for u, v in uv.reshape(-1, 2).tolist()]
    for f, face in enumerate(faces.tolist()):
        corners = [f"{v + 1}/{3 * f + c + 1}" if uvs else f"{v + 1}" for c, v in enumerate(face)]
        if quads and f % 2:
            continue
        if quads:
            other = faces[f + 1].tolist()
            corners.append(f"{other[2] + 1}/{3 * f + 6}" if uvs else f"{other[2] + 1}")
        lines.append("f " + " ".join(corners))
    path.write_text("\n".join(lines) + "\n")


def save_map(path: Path, receiver, donor) -> None:
    face, weights = closest_points(receiver[0], *donor[:2])
    corners = donor[1][face]
    Correspondence(
        face=face.astype(np.int32),
        barycentric=weights,
        points=(weights[:, :, None] * donor[0][corners]).sum(axis=1),
        vertex=corners[np.arange(len(face)), weights.argmax(axis=1)].astype(np.int32),
        confidence=np.ones(len(face)),
        stretch=np.zeros(len(face)),
        region=np.zeros(len(face), np.int32),
        corners=corners.astype(np.int32),
        target_size=len(donor[0]),
    ).save(path)


def run(
    folder: Path,
    receiver: str,
    *options: str,
    out: str = "out.obj",
    map_name: str = "map.npz",
    donor: str = "donor.obj",
) -> int:
    """The exit code."""
    names = [str(folder / name) for name in (receiver, donor, map_name)]
    return main(["transfer", *names, "-o", str(folder / out), *options])


def assert_refused(folder: Path, capsys: pytest.CaptureFixture[str], options: list[str], words: str) -> None:
    """With exit code 2 and these words, and nothing in the folder is new or gone."""
    before = sorted(folder.iterdir())
    assert run(folder, "bare.obj", *options) == 2
    assert words in capsys.readouterr().err
    assert sorted(folder.iterdir()) == before


def spoil_map(folder: Path, lost) -> None:
    arrays = dict(np.load(folder / "map.npz"))
    for array in arrays.values():
        if array.ndim and len(array) == len(arrays["face"]):
            array[lost] = np.nan if array.dtype.kind == "f" else -1
    arrays["confidence"][lost] = 0.0
    np.savez(folder / "map.npz", **arrays)
