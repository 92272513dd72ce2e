# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/benchmark --compose DIR: pairs that no one has looked at, from truths that the listed pairs imply.

Meshes of one collection that are numbered alike (gt_kind identity) match each other, not only as listed; and parts with
a known place on one whole match each other where they overlap. `scripts/benchmark --data DIR` then runs them.
"""

from __future__ import annotations

import argparse
import csv
from collections import defaultdict
from itertools import permutations
from pathlib import Path

import numpy as np
import numpy.typing as npt

from benchmarks.cases import Case, covering, read_case, true_images
from benchmarks.options import COLUMNS, listed_pairs

Row = dict[str, str]

#: Parts of which less is on both are left out: matching them is a question of luck.
LEAST_OVERLAP = 0.25


def main(arguments: list[str], root: Path) -> int:
    parser = argparse.ArgumentParser(prog="scripts/benchmark --compose", description=__doc__)
    parser.add_argument("output", metavar="DIR", type=Path, help="pairs.csv and truths go here")
    parser.add_argument("--data", metavar="DIR", type=Path, help="with pairs.csv (default: ../shared/data)")
    parser.add_argument("--most", metavar="N", type=int, default=5, help="pairs a family of shapes (default: 5)")
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of the choice among them (default: 0)")
    given = parser.parse_args(arguments)
    data, listed = listed_pairs(parser, given, root)
    data = data.resolve()
    given.output.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(given.seed)
    rows = numbered_alike(data, listed, given.most, random)
    rows += parts_of_one(data, listed, given.most, random, given.output.resolve())
    with (given.output / "pairs.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    print(f"{len(rows)} pairs in {given.output / 'pairs.csv'}; run scripts/benchmark --data {given.output} -o OUT")
    return 0


def numbered_alike(data: Path, listed: list[Row], most: int, random: np.random.Generator) -> list[Row]:
    """Up to `most` ordered pairs of every set of meshes with one numbering that are not listed."""
    families: dict[tuple[str, int], set[str]] = defaultdict(set)
    for pair in listed:
        if pair["gt_kind"] == "identity":
            case = read_case(data, pair)
            families[pair["collection"], len(case.source[0])] |= {pair["source"], pair["target"]}
    known = {(pair["source"], pair["target"]) for pair in listed}
    rows = []
    for (collection, _), shapes in sorted(families.items()):
        free = [pair for pair in permutations(sorted(shapes), 2) if pair not in known]
        rows += [_row(data, collection, *free[k], kind="identity") for k in _some(len(free), most, random)]
    return rows


def parts_of_one(data: Path, listed: list[Row], most: int, random: np.random.Generator, folder: Path) -> list[Row]:
    """Up to `most` ordered pairs of every set of parts of one whole that overlap and are not listed."""
    families: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for pair in listed:
        if pair["category"].startswith("partial") and pair["gt_bary"]:
            families[pair["collection"], pair["target"]].append(pair)
    known = {(pair["source"], pair["target"]) for pair in listed}
    rows = []
    for (collection, _), parts in sorted(families.items()):
        cases = {part["source"]: read_case(data, part) for part in parts}
        free = [pair for pair in permutations(sorted(cases), 2) if pair not in known]
        truths = {pair: composed(cases[pair[0]], cases[pair[1]]) for pair in free}
        free = [pair for pair in free if (truths[pair] >= 0).mean() >= LEAST_OVERLAP]
        for k in _some(len(free), most, random):
            row = _row(data, collection, *free[k], kind="vertex") | {"gt_minus1": "unmatched"}
            truth = folder / f"{row['id']}.txt"
            np.savetxt(truth, truths[free[k]], fmt="%d")
            rows.append(row | {"gt_file": str(truth), "category": "partial-partial"})
    return rows


def composed(first: Case, second: Case) -> npt.NDArray[np.int64]:
    """(n,) vertex of the second part under each vertex of the first; -1 where the second does not cover it.

    Args:
        first, second: two parts with true images on one whole, the target of both.
    """
    assert first.truth is not None
    assert second.truth is not None
    assert second.source[1] is not None
    whole, faces = first.target
    assert faces is not None
    known = second.truth.known
    kept = second.source[1][known[second.source[1]].all(axis=1)]
    places = true_images(second.truth, second.target)
    edge = float(np.linalg.norm(whole[faces] - np.roll(whole[faces], 1, axis=1), axis=2).mean())
    face, weights = covering(true_images(first.truth, first.target), places, kept, edge)
    vertex = kept[face, np.argmax(weights, axis=1)]
    return np.where(first.truth.known & (face >= 0), vertex, -1).astype(np.int64)


def _row(data: Path, collection: str, source: str, target: str, *, kind: str) -> Row:
    name = f"{collection}_{Path(source).stem}__{Path(target).stem}"
    paths = {"source": str(data / source), "target": str(data / target)}
    told = {"id": name, "collection": collection, "gt_kind": kind, "category": "near-isometric", "core": "0"}
    return dict.fromkeys(COLUMNS, "") | paths | told


def _some(count: int, most: int, random: np.random.Generator) -> list[int]:
    return sorted(random.choice(count, min(count, most), replace=False).tolist())
