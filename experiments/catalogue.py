# SPDX-License-Identifier: GPL-3.0-or-later
"""The experiments by name: pairs, the paper's parameters for them, and what the paper's text says."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.cases import Case, read_case
from experiments import shapes

CLEAN: dict[str, Any] = {}
#: What preset paper has by itself, said for a pair of an experiment with the other radii.
CLEAN_RADII: dict[str, Any] = {"paper_radius_min": 0.9, "paper_radius_max": 1.7}
NOISY: dict[str, Any] = {"paper_radius_min": 1.5, "paper_radius_max": 3.4}


@dataclass(frozen=True)
class Pair:
    """One pair of an experiment; landmarks are (k, 2) vertex indices, or None for own features."""

    name: str
    case: Case
    landmarks: np.ndarray | None = None
    #: Options of preset paper in place of the experiment's.
    options: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Experiment:
    name: str
    title: str
    #: Sentences of the paper about this experiment, as they stand there.
    quotes: list[str]
    #: Called with the data folder.
    pairs: Callable[[Path], list[Pair]]
    #: Options of preset paper.
    options: dict[str, Any]
    #: Methods beside `paper` and `default`.
    peers: list[str] = field(default_factory=list)
    #: Largest mesh that preset paper works on; nu and w_C are tied to its edges. See the page.
    vertices: int = 4000
    #: Pairs that have another limit.
    other_vertices: dict[str, int] = field(default_factory=dict)
    #: Which direction is up in the pictures, and the turn about it in degrees.
    up: str = "y"
    turn: float = 0.0
    #: Pairs that are shown otherwise: direction and turn.
    other_views: dict[str, tuple[str, float]] = field(default_factory=dict)
    #: With curves and pictures, and in the table of times.
    drawn: bool = True

    def limit(self, pair: str) -> int:
        """Vertices of the largest mesh that preset paper works on."""
        return self.other_vertices.get(pair, self.vertices)

    def view(self, pair: str) -> tuple[str, float]:
        """Which direction of a pair is up in its picture, and the turn about it in degrees."""
        return self.other_views.get(pair, (self.up, self.turn))


def _planes(_data: Path) -> list[Pair]:
    case, landmarks = shapes.planes()
    return [Pair("planes", case, landmarks)]


def _symmetric(_data: Path) -> list[Pair]:
    return [Pair("symmetric", shapes.symmetric_body())]


def _listed(data: Path) -> dict[str, dict[str, str]]:
    """The rows of pairs.csv by id."""
    with (data / "pairs.csv").open(newline="", encoding="utf-8") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def _of_data(*names: str) -> Callable[[Path], list[Pair]]:
    def read(data: Path) -> list[Pair]:
        listed = _listed(data)
        return [Pair(name, read_case(data, listed[name])) for name in names]

    return read


def _contacts(data: Path) -> list[Pair]:
    """Every pair with own features, and the first again with 20 true matches, moved by noise to vertices nearby."""
    pairs = _of_data("topo_020_028")(data)
    case = pairs[0].case
    return [*pairs, Pair(f"{pairs[0].name}_given", case, noisy_matches(case, 20, 0.02, seed=0))]


def _clouds(data: Path) -> list[Pair]:
    """Three clouds with the radii for noisy surfaces, and the last again with those for clean ones."""
    pairs = _of_data("pc_faust_020_025", "pc_cat0_cat5", "pc_faust_033_037")(data)
    return [*pairs, Pair(f"{pairs[-1].name}_clean_radii", pairs[-1].case, options=CLEAN_RADII)]


#: Pairs of the data, and what their experiments set in place of the clean radii and a threshold of 1.
POSITIONED: dict[str, dict[str, Any]] = {
    "anim_samba_mesh_0000__mesh_0080": {"paper_threshold": 0.0},
    "scape_000_005": {"paper_threshold": 1.9},
    "topo_020_028": NOISY,
    "facescan_s101": {},
    "face_ict_s101_neutral_jawopen": {},
    "pc_faust_020_025": NOISY,
    "pc_cat0_cat5": NOISY,
    "pc_faust_033_037": NOISY,
}
POSITIONS = 2


def _positions(data: Path) -> list[Pair]:
    """Each in other positions of both surfaces, which change nothing but rounding."""
    listed = _listed(data)
    return [
        Pair(f"{name}_{k}", read_case(data, listed[name], rotation=k), options=options)
        for name, options in POSITIONED.items()
        for k in range(1, POSITIONS + 1)
    ]


def _full_size(data: Path) -> list[Pair]:
    """The pair of `scape` under a name of its own, which its files go by."""
    return [Pair(f"{pair.name}_10k", pair.case) for pair in _of_data("scape_000_005")(data)]


def noisy_matches(case: Case, count: int, noise: float, seed: int) -> np.ndarray:
    """`count` true matches, far from each other on S; the target's end is off by up to `noise` of T's extent."""
    random = np.random.default_rng(seed)
    truth = case.truth
    assert truth is not None
    points, target = case.source[0], case.target[0]
    known = np.flatnonzero(truth.known)
    chosen = [int(random.choice(known))]
    distance = np.full(len(known), np.inf)
    while len(chosen) < count:
        distance = np.minimum(distance, np.linalg.norm(points[known] - points[chosen[-1]], axis=1))
        chosen.append(int(known[np.argmax(distance)]))
    extent = float(np.linalg.norm(np.ptp(target, axis=0)))
    pairs, used = [], set()
    for vertex in chosen:
        step = random.normal(size=3)
        goal = target[truth.vertex[vertex]] + noise * extent * random.uniform() * step / np.linalg.norm(step)
        image = int(np.argmin(np.linalg.norm(target - goal, axis=1)))
        if image not in used:
            used.add(image)
            pairs.append((vertex, image))
    return np.array(pairs, np.int32)


EXPERIMENTS = [
    Experiment(
        "planes",
        "Plane against a plane with three peaks (Fig. 5)",
        [
            "Since HKM aims to map the shapes using a global isometry, the result maps planar parts to the "
            "peaks, while "
            "our method successfully detects the largest part of the surfaces that can be isometrically mapped.",
        ],
        _planes,
        {**CLEAN, "paper_threshold": 1.0, "paper_near": 1.5, "seed_landmarks_only": True},
        ["hkm"],
        up="z",
    ),
    Experiment(
        "samba",
        "Samba, template-fitted frames (Fig. 6 and 7)",
        [
            "Note that while HKM leads to a result with visual artifacts, the results of BIM and our method are "
            "visually "
            "pleasing.",
            "Note that our method numerically outperforms the two other methods.",
        ],
        _of_data("anim_samba_mesh_0000__mesh_0080"),
        {**CLEAN, "paper_threshold": 0.0},
        ["hkm", "nearest", "pyfm-zoomout"],
    ),
    Experiment(
        "scape",
        "SCAPE, neutral posture to others (Fig. 8)",
        [
            "For this reason it provides a different kind of near-isometric test, and poses a greater challenge "
            "for our "
            "method, which does not exploit global assumptions. This is reflected in our error curve being "
            "below that of "
            "BIM.",
        ],
        _of_data("scape_000_005"),
        {**CLEAN, "paper_threshold": 1.9},
        ["nearest", "pyfm-zoomout"],
        up="x",
    ),
    Experiment(
        "contacts",
        "Contacts: hands that merge with the body (Fig. 9)",
        [
            "Note that the results using BIM and the method by Tevs et al. match parts of the body of S to the "
            "arms and "
            "legs of T, thereby leading to visual artifacts.",
            "The method of Sharma et al., which is especially well suited to the scenario of handling contacts, "
            "leads to "
            "a result that covers the surfaces well.",
            "Note that both the result by Sharma et al. and our results detect the contacts correctly and stop the "
            "growing in these regions.",
        ],
        _contacts,
        {**NOISY, "paper_threshold": 1.0},
        ["nearest"],
    ),
    Experiment(
        "faces",
        "Faces with closed and open mouth (Fig. 10)",
        [
            "Note that our method obtains a mapping with higher visual accuracy than both BIM and the method of "
            "Tevs et "
            "al. In the case of BIM, this is to be expected, since the topological change breaks the global isometry.",
            "The method of Tevs et al. produces a much more accurate result, but with still significant overall "
            "distortion and outliers (speckle-like effect).",
        ],
        _of_data("facescan_s101", "face_ict_s101_neutral_jawopen"),
        {**CLEAN, "paper_threshold": 1.0},
        ["nearest"],
        turn=0.0,
    ),
    Experiment(
        "clouds",
        "Point clouds with holes and outliers (Fig. 11)",
        [
            "As can be seen, the method of Tevs et al. obtains better coverage, however our method has fewer "
            "outliers - islands of incorrectly mapped points within larger smoothly mapped regions.",
        ],
        _clouds,
        {**NOISY, "paper_threshold": 1.0},
        other_vertices={"pc_faust_020_025": 10000},
        other_views={"pc_cat0_cat5": ("z", 90.0)},
    ),
    Experiment(
        "symmetric",
        "A body that maps onto itself (Fig. 12)",
        [
            "However, since the legs and core of the target body are intrinsically symmetric (similar to cylindrical), "
            "many inconsistent partial mappings are found by the algorithm, and they cannot be clustered in a "
            "consistent "
            "way.",
        ],
        _symmetric,
        {**CLEAN, "paper_threshold": 1.0},
        up="z",
    ),
    Experiment(
        "size",
        "SCAPE at 10,000 vertices, the preset's own limit",
        [],
        _full_size,
        {**CLEAN, "paper_threshold": 1.9},
        vertices=10000,
        up="x",
    ),
    Experiment(
        "positions",
        "Pairs of the data in two other positions each",
        [],
        _positions,
        {**CLEAN, "paper_threshold": 1.0},
        other_vertices={f"pc_faust_020_025_{k}": 10000 for k in range(1, POSITIONS + 1)},
        drawn=False,
    ),
]
