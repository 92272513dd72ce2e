# SPDX-License-Identifier: GPL-3.0-or-later
"""The measures, on cases whose numbers are known beforehand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from isograft import InvalidInput, Surface, geodesic_distances
from isograft.evaluation import evaluate, load_truth, unfolded_distance


def strip(columns, rows, width=1.0, height=1.0, radius=None, origin=(0.0, 0.0, 0.0)):
    """A grid of columns x rows cells, flat, or bent over its columns into a prism that unfolds to the same plane."""
    across, up = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="xy")
    if radius is None:
        points = np.stack([across * width, up * height, 0.0 * across], axis=-1)
    else:
        turn = 2.0 * np.arcsin(width / (2.0 * radius))  # chords of this length
        points = np.stack([radius * np.cos(across * turn), radius * np.sin(across * turn), up * height], axis=-1)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    right, above, beyond = corner + 1, corner + columns + 1, corner + columns + 2
    faces = np.vstack([np.stack([corner, right, beyond], 1), np.stack([corner, beyond, above], 1)])
    return points.reshape(-1, 3) + np.asarray(origin), faces.astype(np.int32)


def to_vertices(target, images):
    """A correspondence that sends every source vertex to a target vertex, or nowhere (-1)."""
    vertices, faces = target
    images = np.asarray(images)
    face = np.full(len(images), -1, np.int32)
    weights = np.full((len(images), 3), np.nan)
    for row, image in enumerate(images):
        if image >= 0:
            face[row], k = np.argwhere(faces == image)[0]
            weights[row] = np.eye(3)[k]
    points = np.where((images >= 0)[:, None], vertices[images], np.nan)
    return SimpleNamespace(face=face, barycentric=weights, points=points)


def to_points(target, face, weights):
    vertices, faces = target
    face, weights = np.asarray(face), np.asarray(weights, float)
    return SimpleNamespace(
        face=face, barycentric=weights, points=np.einsum("ij,ijk->ik", weights, vertices[faces[face]])
    )


def shifted(columns, rows, by):
    """Truth and images on a grid: every vertex goes `by` columns too far; those that would leave it are unmatched."""
    index = np.arange((columns + 1) * (rows + 1))
    return index, np.where(index % (columns + 1) + by <= columns, index + by, -1)


def test_a_map_equal_to_the_truth_has_no_error():
    target = strip(8, 6, radius=3.0)
    truth = np.arange(len(target[0]))
    result = evaluate(to_vertices(target, truth), truth, target)
    assert result.error < 1e-5
    assert (result.coverage, result.false_matches, result.overlap_iou) == (1.0, 0.0, None)
    assert result.vertices == result.annotated == result.matched == result.matched_annotated == 63


@pytest.mark.parametrize("by", [1, 2, 5])
def test_the_error_of_a_shift_is_its_length_along_the_bent_surface(by):
    target = strip(12, 6, width=0.5, height=0.5, radius=1.1)
    truth, images = shifted(12, 6, by)
    result = evaluate(to_vertices(target, images), truth, target)
    # Polar marching over a surface that unfolds to the plane is exact; the chord through space is up to 30 % shorter.
    expected = by * 0.5 / np.sqrt(12 * 6 * 0.25) * 100.0
    assert result.sample_errors == pytest.approx(np.full(len(result.sample), expected), rel=1e-3)
    assert result.error == pytest.approx(expected, rel=1e-3)
    assert result.coverage == pytest.approx((13 - by) / 13)


def test_errors_below_one_edge_length_are_right():
    target = strip(2, 2)
    # True points and images at the centroids of neighbouring triangles: cell 0 has the triangles 0 and 4.
    faces = [4, 1, 5]
    truth = (np.array([0, 0, 1]), np.full((3, 3), 1.0 / 3.0))
    result = evaluate(to_points(target, faces, np.full((3, 3), 1.0 / 3.0)), truth, target)
    centroid = target[0][target[1]].mean(axis=1)
    expected = np.linalg.norm(centroid[faces] - centroid[truth[0]], axis=1) / 2.0 * 100.0
    assert result.sample_errors == pytest.approx(expected, rel=1e-5)
    assert result.sample_errors.max() < 100.0 / 2.0


def test_within_one_triangle_the_error_is_the_straight_line():
    target = strip(1, 1)
    truth = (np.array([0]), np.array([[1.0, 0.0, 0.0]]))
    result = evaluate(to_points(target, [0], [[0.9, 0.1, 0.0]]), truth, target)
    assert result.error == pytest.approx(10.0)


def test_the_interior_of_a_neighbouring_triangle_is_measured_across_a_fold():
    # Two right triangles meet at a right angle in the edge x = 0; unfolded, they are flat.
    vertices = np.array([[0, 0, 0], [0, 2, 0], [1, 1, 0], [0, 1, 1]], float)
    target = (vertices, np.array([[0, 2, 1], [0, 1, 3]], np.int32))
    truth = (np.array([0]), np.array([[0.25, 0.5, 0.25]]))
    result = evaluate(to_points(target, [1], [[0.25, 0.25, 0.5]]), truth, target)
    # Both points are half a unit away from the middle of the fold: 1 along the surface, 0.707 through space.
    assert result.error == pytest.approx(1.0 / np.sqrt(2.0) * 100.0, rel=1e-4)


def test_a_truth_by_triangles_and_one_by_vertices_agree():
    target = strip(6, 4, radius=2.0)
    truth, images = shifted(6, 4, 2)
    start = to_vertices(target, truth)
    by_vertex = evaluate(to_vertices(target, images), truth, target)
    by_face = evaluate(to_vertices(target, images), (start.face, start.barycentric), target)
    assert by_face.sample_errors == pytest.approx(by_vertex.sample_errors, rel=1e-6)


def test_distances_on_a_sphere_are_within_one_percent():
    up, around = np.meshgrid(np.linspace(0.2, np.pi - 0.2, 40), np.linspace(0, 2 * np.pi, 81)[:-1], indexing="ij")
    vertices = np.stack([np.sin(up) * np.cos(around), np.sin(up) * np.sin(around), np.cos(up)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(39), np.arange(80), indexing="ij")
    a, b, c, d = i * 80 + j, (i + 1) * 80 + j, (i + 1) * 80 + (j + 1) % 80, i * 80 + (j + 1) % 80
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3).astype(np.int32)
    band = np.flatnonzero(np.abs(vertices[:, 2]) < 0.5)
    truth = np.full(len(vertices), -1)
    truth[band] = band
    images = np.full(len(vertices), -1)
    images[band] = np.random.default_rng(3).permutation(band)
    result = evaluate(to_vertices((vertices, faces), images), truth, (vertices, faces), samples=200)
    true_points, image_points = vertices[result.sample], vertices[images[result.sample]]
    angle = np.arccos(np.clip(np.einsum("ij,ij->i", true_points, image_points), -1, 1))
    clear = (angle > 0.2) & (angle < 2.0)  # shorter than the way around the holes at the poles
    area = np.linalg.norm(np.cross(*(vertices[faces[:, k]] - vertices[faces[:, 0]] for k in (1, 2))), axis=1).sum() / 2
    ratio = result.sample_errors[clear] / (angle[clear] / np.sqrt(area) * 100.0)
    assert clear.sum() > 100
    assert abs(ratio.mean() - 1.0) < 0.005
    assert np.abs(ratio - 1.0).max() < 0.01


def test_unmatched_vertices_lower_the_coverage_and_not_the_error():
    target = strip(9, 9)
    truth, images = shifted(9, 9, 1)
    few = np.where(np.arange(100) < 50, images, -1)
    whole, half = (evaluate(to_vertices(target, m), truth, target) for m in (images, few))
    assert (whole.coverage, half.coverage) == (0.9, 0.45)
    assert half.error == pytest.approx(whole.error)


def test_vertices_without_truth_count_only_for_the_overlap():
    target = strip(9, 9)
    truth = np.where(np.arange(100) < 60, np.arange(100), -1)
    images = np.where(np.arange(100) >= 20, np.arange(100), -1)
    result = evaluate(to_vertices(target, images), truth, target, unmatched_is_truth=True)
    assert (result.annotated, result.matched, result.matched_annotated) == (60, 80, 40)
    assert result.coverage == pytest.approx(40 / 60)
    assert result.overlap_iou == pytest.approx(40 / 100)
    assert evaluate(to_vertices(target, images), truth, target).overlap_iou is None


def test_false_matches_are_the_share_with_an_error_over_ten():
    target = strip(20, 20)
    truth = np.arange(441)
    images = truth.copy()
    # sqrt(area) is 20, so 2 columns are an error of exactly 10 and 3 columns one of 15.
    images[:42] = [i + 3 if i % 21 < 18 else i - 3 for i in range(42)]
    images[42:84] = [i + 1 if i % 21 < 20 else i - 1 for i in range(42, 84)]
    result = evaluate(to_vertices(target, images), truth, target, samples=441)
    assert result.false_matches == pytest.approx(42 / 441)
    assert result.error == pytest.approx((42 * 15 + 42 * 5) / 441, rel=1e-3)


def test_the_error_does_not_depend_on_the_unit_or_the_position():
    truth, images = shifted(8, 6, 2)
    vertices, faces = strip(8, 6, radius=2.5)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    moved = (1000.0 * vertices @ turn.T + [5.0, -7.0, 1e4], faces)
    here = evaluate(to_vertices((vertices, faces), images), truth, (vertices, faces))
    there = evaluate(to_vertices(moved, images), truth, moved)
    assert there.sample_errors == pytest.approx(here.sample_errors, rel=1e-6)


def test_where_no_path_leads_the_straight_line_counts():
    left, right = strip(2, 2), strip(2, 2, origin=(3.0, 0.0, 0.0))
    target = (np.vstack([left[0], right[0]]), np.vstack([left[1], right[1] + 9]))
    truth = np.arange(18)
    images = truth.copy()
    images[0] = 9
    result = evaluate(to_vertices(target, images), truth, target)
    assert result.disconnected == 1
    assert result.sample_errors[0] == pytest.approx(3.0 / np.sqrt(8.0) * 100.0)
    assert np.isfinite(result.error)


def test_a_true_point_in_a_triangle_without_area_is_reached_from_its_neighbours():
    vertices, faces = strip(3, 3)
    target = Surface(vertices, np.vstack([[[0, 4, 4]], faces]).astype(np.int32))
    images = to_vertices((vertices, faces), [1])
    images.face += 1  # the triangles moved on by one
    result = evaluate(images, np.array([0]), target)
    assert (result.disconnected, result.error) == (0, pytest.approx(1.0 / 3.0 * 100.0, rel=1e-4))


def test_nothing_matched_is_coverage_zero_and_no_error():
    target = strip(3, 3)
    result = evaluate(to_vertices(target, [-1] * 16), np.arange(16), target, unmatched_is_truth=True)
    assert (result.coverage, result.overlap_iou, len(result.sample)) == (0.0, 0.0, 0)
    assert np.isnan(result.error)
    assert np.isnan(result.false_matches)
    assert result.to_dict()["error"] is None


def test_the_sample_is_chosen_by_the_seed():
    target = strip(29, 29)
    truth, images = shifted(29, 29, 3)
    first, again, other = (evaluate(to_vertices(target, images), truth, target, seed=s) for s in (1, 1, 2))
    assert len(first.sample) == 250
    assert np.array_equal(first.sample, again.sample)
    assert np.array_equal(first.sample_errors, again.sample_errors)
    assert not np.array_equal(first.sample, other.sample)
    assert np.isin(first.sample, np.flatnonzero(images >= 0)).all()


def test_near_and_far_errors_are_those_that_distances_over_the_whole_target_give():
    vertices, faces = target = strip(24, 24, radius=9.0)
    truth = np.arange(625)
    images = truth.copy()
    images[100:200] += 2  # near
    images[200:300] = 624 - images[200:300]  # far
    result = evaluate(to_vertices(target, images), truth, target)
    start = to_vertices(target, truth)
    expected = [
        geodesic_distances(target, int(start.face[row]), start.barycentric[row])[images[row]] for row in result.sample
    ]
    area = np.linalg.norm(np.cross(*(vertices[faces[:, k]] - vertices[faces[:, 0]] for k in (1, 2))), axis=1).sum() / 2
    assert result.sample_errors == pytest.approx(np.array(expected) / np.sqrt(area) * 100.0, rel=1e-3, abs=1e-4)
    assert result.sample_errors.max() > 50.0


def test_a_cloud_is_measured_by_straight_lines_over_its_two_largest_extents():
    cloud = np.array([[0, 0, 0], [4, 0, 0], [4, 9, 0], [0, 9, 1]], float)
    images = SimpleNamespace(
        face=np.full(3, -1, np.int32),
        barycentric=np.full((3, 3), np.nan),
        points=np.array([[0, 0, 0.6], [4, 0, 0.0], [np.nan] * 3]),
    )
    result = evaluate(images, np.array([0, 1, 2]), (cloud, None))
    assert result.sample_errors == pytest.approx([10.0, 0.0])
    assert result.coverage == pytest.approx(2 / 3)


def test_unfolding_is_exact_for_any_source_across_an_edge():
    random = np.random.default_rng(5)
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.3, 0.9, 0.0]])
    for source in ([0.5, -0.4, 0.0], [0.2, 0.02, 0.0], [-0.5, 0.4, 0.0]):
        distances = np.linalg.norm(corners - source, axis=1)
        weights = random.dirichlet([1, 1, 1])
        point = weights @ corners
        straight = np.linalg.norm(point - source)
        assert unfolded_distance(corners, distances, point) >= straight - 1e-12
        if source[1] < 0:
            assert unfolded_distance(corners, distances, point) == pytest.approx(straight)


def test_unfolding_goes_over_a_corner_where_nothing_else_is_known():
    corners = np.eye(3)
    distances = np.array([2.0, np.inf, np.inf])
    assert unfolded_distance(corners, distances, corners.mean(axis=0)) == pytest.approx(
        2.0 + np.linalg.norm(corners.mean(axis=0) - corners[0])
    )
    assert unfolded_distance(corners, np.full(3, np.inf), corners[0]) == np.inf


def test_a_truth_is_read_from_text_and_from_triangles(tmp_path):
    text = tmp_path / "truth.txt"
    text.write_text("3\n-1\n0\n\n")
    assert load_truth(text).vertex.tolist() == [3, -1, 0]
    assert load_truth(text).known.tolist() == [True, False, True]
    arrays = tmp_path / "truth.npz"
    np.savez(arrays, tri=np.array([5, -1], np.int32), w=np.array([[0.25, 0.25, 0.5], [0, 0, 0]], np.float32))
    truth = load_truth(arrays)
    assert truth.face.tolist() == [5, -1]
    assert truth.weights[0].tolist() == [0.25, 0.25, 0.5]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("1\ntwo\n3\n", r"line 2.*'two'"),
        ("1\n-3\n", "row 1 is -3"),
        ("1.5\n", r"line 1.*'1\.5'"),
        ("1\n\n2\n", "line 2"),
    ],
)
def test_a_truth_that_is_none_is_refused_with_the_place(tmp_path, content, words):
    path = tmp_path / "truth.txt"
    path.write_text(content)
    with pytest.raises(InvalidInput, match=words):
        load_truth(path)


def test_a_truth_of_triangles_is_refused_where_its_arrays_are_wrong(tmp_path):
    path = tmp_path / "truth.npz"
    np.savez(path, tri=np.array([1]))
    with pytest.raises(InvalidInput, match="tri and w"):
        load_truth(path)
    np.savez(path, tri=np.array([0, 1]), w=np.array([[1.0, 0, 0], [0.5, 0.4, 0.5]]))
    with pytest.raises(InvalidInput, match="w row 1"):
        load_truth(path)
    np.savez(path, tri=np.array([0, 1]), w=np.zeros((3, 3)))
    with pytest.raises(InvalidInput, match=r"shape \(2, 3\)"):
        load_truth(path)
    path.write_bytes(b"PK\x03\x04 not a zip")
    with pytest.raises(InvalidInput, match="cannot be read"):
        load_truth(path)
    with pytest.raises(InvalidInput, match="cannot be read"):
        load_truth(tmp_path / "absent.txt")


def test_arrays_that_do_not_fit_are_refused():
    target = strip(3, 3)
    whole = to_vertices(target, np.arange(16))
    with pytest.raises(InvalidInput, match=r"15 rows.*has 16"):
        evaluate(whole, np.arange(15), target)
    with pytest.raises(InvalidInput, match="row 15 is vertex 16, but the target has 16"):
        evaluate(whole, np.append(np.arange(15), 16), target)
    with pytest.raises(InvalidInput, match="no counterpart for any vertex"):
        evaluate(whole, np.full(16, -1), target)
    with pytest.raises(InvalidInput, match="samples"):
        evaluate(whole, np.arange(16), target, samples=0)
    whole.face[4] = 18
    with pytest.raises(InvalidInput, match="row 4 is triangle 18"):
        evaluate(whole, np.arange(16), target)
