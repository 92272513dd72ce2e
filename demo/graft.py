# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender script: graft the donor's texture onto the scan with the installed add-on, judge it, take the pictures.

    blender -b PAIR.blend --python-exit-code 1 -P demo/graft.py -- OUT ZIP [TRUTH.npz]

PAIR.blend holds the donor and the receiver; the scene's properties `donor` and `receiver` name them. Writes
demo.blend, before_after.png, checker.png, confidence.png and measures.json into OUT.
"""

import json
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import bpy
import numpy as np

from demo import addon, pictures
from demo.creature import posed_vertices, triangles_of


def evaluated_triangles(item: bpy.types.Object) -> np.ndarray:
    """Loop triangles (m, 3) of the evaluated mesh, which `isograft_face` counts."""
    evaluated = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    triangles = triangles_of(evaluated.to_mesh())
    evaluated.to_mesh_clear()
    return triangles


def measures(donor: bpy.types.Object, receiver: bpy.types.Object, truth_path: Path | None) -> dict[str, float]:
    """Share of matched vertices; with a truth also error, coverage of the vertices with a truth, and false matches."""
    face = addon.read_attribute(receiver, "isograft_face")
    found = {"matched": float((face >= 0).mean())}
    if truth_path is None:
        return found
    from isograft.correspondence import Correspondence
    from isograft.evaluation import evaluate, load_truth

    vertices, triangles = posed_vertices(donor), evaluated_triangles(donor)
    weights = addon.read_attribute(receiver, "isograft_weights", 3).astype(float)
    unmatched = face < 0
    safe = np.where(unmatched, 0, face)
    corners = triangles[safe]
    points = np.einsum("nc,ncd->nd", weights, vertices[corners])
    weights[unmatched] = points[unmatched] = np.nan
    correspondence = Correspondence(
        face=face,
        barycentric=weights,
        points=points,
        vertex=np.where(unmatched, -1, addon.read_attribute(receiver, "isograft_vertex")).astype(np.int32),
        confidence=addon.read_attribute(receiver, "isograft_confidence").astype(float),
        stretch=np.where(unmatched, np.nan, addon.read_attribute(receiver, "isograft_stretch")).astype(float),
        region=np.where(unmatched, -1, addon.read_attribute(receiver, "isograft_region")).astype(np.int32),
        corners=np.where(unmatched[:, None], -1, corners).astype(np.int32),
        target_size=len(vertices),
    )
    result = evaluate(correspondence, load_truth(truth_path), (vertices, triangles), samples=1000)
    return found | {"error": result.error, "coverage": result.coverage, "false_matches": result.false_matches}


def turn_like(donor: bpy.types.Object, receiver: bpy.types.Object, items: list[bpy.types.Object]) -> None:
    """Turn the items, which have the receiver's vertices, as their points on the donor lie."""
    matched = addon.read_attribute(receiver, "isograft_face") >= 0
    if np.count_nonzero(matched) < 3:
        return
    flat = np.empty(3 * len(receiver.data.vertices), np.float32)
    receiver.data.vertices.foreach_get("co", flat)
    to_scene = np.array(donor.matrix_world)
    points = addon.read_attribute(receiver, "isograft_position", 3)[matched] @ to_scene[:3, :3].T
    pictures.align(items, flat.reshape(-1, 3)[matched].astype(float), points.astype(float))


def main(out: Path, zip_path: Path, truth_path: Path | None) -> None:
    addon.install(zip_path)
    scene = bpy.context.scene
    donor, receiver = bpy.data.objects[scene["donor"]], bpy.data.objects[scene["receiver"]]
    before = receiver.copy()
    before.data = receiver.data.copy()
    before.name = f"{receiver.name} before"
    scene.collection.objects.link(before)

    start = time.perf_counter()
    seconds = addon.match_and_transfer(donor, receiver, pictures.carried(donor))
    spent_all = time.perf_counter() - start
    result = measures(donor, receiver, truth_path) | {"seconds_match": seconds}
    spent = f"{seconds:.1f} s for the match, {spent_all - seconds:.1f} s for the transfer"
    print(f"demo: {result['matched']:.1%} of the receiver's vertices matched, {spent}", flush=True)
    if "error" in result:
        print(
            f"demo: error {result['error']:.2f} (x100, over the root of the donor's area), coverage "
            f"{result['coverage']:.1%}, false matches {result['false_matches']:.1%}",
            flush=True,
        )
    (out / "measures.json").write_text(json.dumps(result, indent=1) + "\n")
    if not (addon.read_attribute(receiver, "isograft_face") >= 0).any():
        raise RuntimeError("nothing was matched: the two shapes have no part in common that the engine could find")
    if "upright" not in receiver:
        turn_like(donor, receiver, [before, receiver])
    pictures.take(donor, before, receiver, out)
    bpy.ops.wm.save_as_mainfile(filepath=str(out / "demo.blend"), check_existing=False)


if __name__ == "__main__":
    arguments = [Path(text).resolve() for text in sys.argv[sys.argv.index("--") + 1 :]]
    main(arguments[0], arguments[1], arguments[2] if len(arguments) > 2 else None)
