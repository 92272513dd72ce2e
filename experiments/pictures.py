# SPDX-License-Identifier: GPL-3.0-or-later
"""The checkerboard pictures, rendered by Blender, and the cumulative curves."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import isograft
import numpy as np

from experiments.catalogue import Experiment, Pair
from experiments.colours import carried_colours, refined, source_colours
from experiments.run import LEVELS

NAMES = {"paper": "paper", "default": "default", "hkm": "HKM (ours)", "nearest": "nearest", "pyfm-zoomout": "pyFM"}
COLOURS = {"paper": "#c0392b", "default": "#1f77b4", "hkm": "#7f7f7f", "nearest": "#c9a227", "pyfm-zoomout": "#2ca02c"}


def checker_picture(experiment: Experiment, pair: Pair, methods: list[str], folder: Path, out: Path) -> None:
    """S with its texture, and T with it under every method's map, side by side."""
    source, target = pair.case.source, pair.case.target
    seen = shown_mesh(target)
    arrays: dict[str, Any] = {}
    shown: list[tuple[str, Any, Any]] = [("S", shown_mesh(source), None)]
    for method in methods:
        path = folder / f"{pair.name}.{method}.npz"
        if path.exists():
            with np.load(path) as file:
                shown.append((NAMES[method], seen, dict(file)))
    for i, (_, (vertices, faces), found) in enumerate(shown):
        fine, cut = refined(vertices, faces)
        if found is None:
            low, high = source[0].min(axis=0), source[0].max(axis=0)
            colours = source_colours(fine, low, float((high - low).max()))
        else:
            colours = carried_colours(source, fine, found)
        arrays |= {f"vertices{i}": fine, f"faces{i}": cut, f"colours{i}": colours}
    up, turn = experiment.view(pair.name)
    told = {
        "names": [name for name, _, _ in shown],
        "up": up,
        "turn": turn,
        "elevation": 40.0 if experiment.name == "planes" else 8.0,
        "pixels": 1000,
        "samples": 12,
    }
    with tempfile.TemporaryDirectory() as place:
        meshes = Path(place) / "meshes.npz"
        np.savez(meshes, told=json.dumps(told), **arrays)
        script = Path(__file__).with_name("blender_picture.py")
        command = ["blender", "-b", "--factory-startup", "--python-use-system-env", "--python-exit-code", "1"]
        command += ["-P", str(script), "--", str(meshes), str(out)]
        subprocess.run(command, check=True, capture_output=True, timeout=1800)


def shown_mesh(surface: Any) -> tuple[np.ndarray, np.ndarray]:
    """A mesh as it is, a cloud as the surface that was laid over it."""
    vertices, faces = surface[0], surface[1]
    if faces is None:
        vertices, faces = isograft.Surface(vertices).working_mesh
    return vertices, faces


def can_render() -> bool:
    return shutil.which("blender") is not None


def curves(title: str, rows: list[dict[str, Any]], out: Path) -> None:
    """Share of all vertices with a truth whose error is below, as in Fig. 7 and 8; one line per method and pair."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(5.2, 3.2), dpi=110)
    for row in rows:
        axes.plot(LEVELS / 100.0, np.array(row["curve"]) * 100.0, color=COLOURS[row["method"]], lw=1.6)
    for method in dict.fromkeys(row["method"] for row in rows):
        axes.plot([], [], color=COLOURS[method], label=NAMES[method])
    axes.set(
        xlim=(0.0, 0.25),
        ylim=(0.0, 100.0),
        xlabel="geodesic error / sqrt(area of T)",
        ylabel="vertices in %",
        title=title,
    )
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right")
    figure.tight_layout()
    figure.savefig(out)
    plt.close(figure)
