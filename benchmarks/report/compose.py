# SPDX-License-Identifier: GPL-3.0-or-later
"""A rendered scene with its titles and the scale of colours, small enough for the repository."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
from matplotlib import pyplot as plt

from benchmarks.report.worst import HEAT_AT, TITLES, heat_colour

MOST_BYTES = 290_000


def compose(rendered: Path, path: Path) -> None:
    """Write `path`, a JPEG below 300 KB."""
    image = plt.imread(rendered)
    image = image[..., :3] * image[..., 3:] + (1.0 - image[..., 3:])
    height, width = image.shape[:2]
    dpi = 100.0
    head, foot = 0.3, 0.45
    figure = plt.figure(figsize=(width / dpi, height / dpi + head + foot), dpi=dpi)
    whole = figure.get_figheight()
    axis = figure.add_axes((0.0, foot / whole, 1.0, 1.0 - (head + foot) / whole))
    axis.imshow(image, interpolation="none", aspect="auto")
    axis.axis("off")
    for k, title in enumerate(TITLES):
        figure.text((k + 0.5) / len(TITLES), 1.0 - 0.15 / whole, title, ha="center", va="center", fontsize=11)
    bar = figure.add_axes((0.77, 0.28 / whole, 0.21, 0.12 / whole))
    # Even steps from mark to mark: what matters lies below 10.
    marks = np.arange(len(HEAT_AT))
    steps = np.interp(np.linspace(0, marks[-1], 200), marks, HEAT_AT)
    bar.imshow(heat_colour(steps)[None], aspect="auto", extent=(0, marks[-1], 0, 1))
    bar.set_xticks(marks, [f"{mark:g}" for mark in HEAT_AT], fontsize=8)
    bar.set_yticks([])
    path.parent.mkdir(parents=True, exist_ok=True)
    for quality in (88, 75, 60, 40):
        figure.savefig(path, dpi=dpi, pil_kwargs={"quality": quality})
        if path.stat().st_size <= MOST_BYTES:
            break
    plt.close(figure)
