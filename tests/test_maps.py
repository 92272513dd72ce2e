# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps in files: what is written reads back the same, wholly or not at all, and damage is refused."""

from __future__ import annotations

from pathlib import Path

import isograft
import numpy as np
import pytest
import surfaces
from isograft.files import MeshFile, read_map, read_mesh, write_map


def save(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def half_matched() -> tuple[isograft.Match, surfaces.Mesh]:
    """A made-up match of the icosahedron to a ball: corners of some triangles, and rows without a match."""
    ball = surfaces.sphere(1)
    face = np.array([0, 5, -1, 7, 8, -1, 70, 79, 3, 3, 1, -1], np.int32)
    rng = np.random.default_rng(0)
    weights = rng.dirichlet(np.ones(3), len(face))
    corners = np.where(face[:, None] >= 0, ball[1][face], -1).astype(np.int32)
    heaviest = corners[np.arange(len(face)), weights.argmax(axis=1)].astype(np.int32)
    weights[face < 0] = np.nan
    best = isograft.Correspondence(
        face=face,
        barycentric=weights,
        points=np.einsum("ij,ijk->ik", weights, ball[0][corners]),
        vertex=heaviest,
        confidence=np.where(face >= 0, rng.uniform(size=len(face)), 0.0),
        stretch=np.where(face >= 0, rng.uniform(size=len(face)), np.nan),
        region=np.where(face >= 0, 0, -1).astype(np.int32),
        corners=corners,
        target_size=len(ball[0]),
    )
    return isograft.Match(best, [], isograft.Report(scale=2.0, warnings=("one",))), ball


def source_mesh(tmp_path: Path) -> MeshFile:
    vertices, faces = surfaces.icosahedron()
    text = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist())
    return read_mesh(save(tmp_path / "s.obj", text + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)))


def test_an_npz_holds_the_arrays_by_their_names(tmp_path: Path) -> None:
    match, ball = half_matched()
    write_map(tmp_path / "m.npz", match, source_mesh(tmp_path))
    with np.load(tmp_path / "m.npz") as file:
        for name in ("face", "barycentric", "points", "vertex", "confidence", "stretch", "region"):
            assert np.array_equal(file[name], getattr(match.best, name), equal_nan=True)
        assert isograft.Report.from_json(str(file["report"])) == match.report
    assert np.array_equal(read_map(tmp_path / "m.npz", isograft.Surface(*ball)).face, match.best.face)


def test_a_corr_is_one_based_and_reads_back_the_same(tmp_path: Path) -> None:
    match, ball = half_matched()
    write_map(tmp_path / "m.corr", match, source_mesh(tmp_path))
    lines = (tmp_path / "m.corr").read_text().splitlines()
    assert lines[2] == lines[5] == "-1 0 0 0"
    assert lines[0].split()[0] == "1"
    assert [float(x) for x in lines[1].split()[1:]] == pytest.approx(match.best.barycentric[1].tolist())
    again = read_map(tmp_path / "m.corr", isograft.Surface(*ball))
    for name in ("face", "vertex", "corners"):
        assert np.array_equal(getattr(again, name), getattr(match.best, name))
    for name in ("barycentric", "points"):
        assert np.allclose(getattr(again, name), getattr(match.best, name), equal_nan=True, atol=1e-11)


def test_a_ply_holds_the_source_and_the_map_as_attributes(tmp_path: Path) -> None:
    match, _ = half_matched()
    source = source_mesh(tmp_path)
    write_map(tmp_path / "m.ply", match, source)
    again = read_mesh(tmp_path / "m.ply")
    assert np.array_equal(again.vertices, source.vertices)
    assert np.array_equal(again.faces, source.faces)
    data = (tmp_path / "m.ply").read_bytes()
    head, body = data.split(b"end_header\n")
    kinds = {"double": "<f8", "float": "<f4", "int": "<i4"}
    fields = [line.split()[1:] for line in head.decode().splitlines() if line.startswith("property")][:-1]
    table = np.frombuffer(body, [(name, kinds[kind]) for kind, name in fields], len(source.vertices))
    best = match.best
    assert np.array_equal(table["isograft_face"], best.face)
    assert np.array_equal(table["isograft_vertex"], best.vertex)
    assert np.array_equal(table["isograft_region"], best.region)
    assert np.allclose(table["isograft_confidence"], best.confidence)
    assert np.array_equal(table["isograft_y"], np.nan_to_num(best.points[:, 1]))
    assert np.allclose(table["isograft_weight2"], np.nan_to_num(best.barycentric[:, 2]))
    assert (table["isograft_stretch"][~best.matched] == 0).all()


@pytest.mark.parametrize("suffix", [".npz", ".corr", ".ply"])
def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    match, _ = half_matched()
    source = source_mesh(tmp_path)
    path = save(tmp_path / f"m{suffix}", "old")
    before = sorted(tmp_path.iterdir())

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write_map(path, match, source)
    assert path.read_text() == "old"
    assert sorted(tmp_path.iterdir()) == before


def test_maps_for_another_target_or_damaged_ones_are_refused(tmp_path: Path) -> None:
    match, ball = half_matched()
    target = isograft.Surface(*ball)
    other = isograft.Surface(*surfaces.icosahedron())
    for suffix in (".npz", ".corr"):
        write_map(tmp_path / f"m{suffix}", match, source_mesh(tmp_path))
        with pytest.raises(isograft.InvalidInput, match=f"m{suffix}: "):
            read_map(tmp_path / f"m{suffix}", other)
    data = (tmp_path / "m.npz").read_bytes()
    for end in range(0, len(data), 97):
        with pytest.raises(isograft.InvalidInput, match=r"cut\.npz: "):
            read_map(save(tmp_path / "cut.npz", data[:end]), target)
    np.savez(tmp_path / "other.npz", face=np.zeros(3))
    with pytest.raises(isograft.InvalidInput, match=r"other\.npz: not a map of isograft"):
        read_map(tmp_path / "other.npz", target)
    with np.load(tmp_path / "m.npz") as file:
        arrays = dict(file)
    np.savez(tmp_path / "short.npz", **{**arrays, "points": arrays["points"][:-1]})
    with pytest.raises(isograft.InvalidInput, match=r"short\.npz: points should be float64 \(12, 3\)"):
        read_map(tmp_path / "short.npz", target)
    for line, words in (
        ("1 0.5 0.5 0.5", "sum 1"),
        ("81 1 0 0", "no triangle"),
        ("1 x 0 0", "line 2"),
        ("1 1", "line 2"),
    ):
        save(tmp_path / "bad.corr", f"-1 0 0 0\n{line}\n")
        with pytest.raises(isograft.InvalidInput, match=rf"bad\.corr: line 2.*{words if 'line' not in words else ''}"):
            read_map(tmp_path / "bad.corr", target)


def test_a_pickle_in_an_npz_is_not_opened(tmp_path: Path) -> None:
    np.savez(tmp_path / "m.npz", face=np.array([{"a": 1}], object), target_size=3)
    with pytest.raises(isograft.InvalidInput, match=r"m\.npz"):
        isograft.Correspondence.load(tmp_path / "m.npz")
