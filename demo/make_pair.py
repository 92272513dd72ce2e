# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender script: make the creature and a scan of it in another pose.

    blender -b --factory-startup --python-exit-code 1 -P demo/make_pair.py -- FOLDER

Writes pair.blend (objects Creature, Rig, Scan), creature.png, donor.ply, scan.ply and truth.npz into FOLDER. Row i of
truth.npz says where vertex i of the scan lies on the donor: `tri`, a triangle of donor.ply or -1, and weights `w`.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import bpy
import numpy as np

from demo import creature, scan, scene, texture
from demo.creature_mesh import edges_of, write_ply
from demo.fusion import rigid_motion
from demo.implicit import Array

TURN_AXIS, TURN_DEGREES, SHIFT = np.array((1.0, 2.0, 3.0)), 140.0, np.array((2.0, 1.0, 0.5))


def colour_parts(body: bpy.types.Object) -> None:
    """A point colour attribute: every vertex in the mixed hues of the bones that move it."""
    weights = creature.read_weights(body, [group.name for group in body.vertex_groups])
    hue = (0.618034 * np.arange(weights.shape[1])) % 1.0
    bright = 0.5 + 0.5 * np.cos(2 * np.pi * (hue[:, None] + np.array((0.0, 0.33, 0.67))))
    colour = np.column_stack([weights @ bright, np.ones(len(weights))])
    layer = body.data.color_attributes.new("Parts", "FLOAT_COLOR", "POINT")
    layer.data.foreach_set("color", colour.astype(np.float32).ravel())


def median_stretch(first: Array, second: Array, triangles: Array) -> float:
    """Median over the edges of abs(length ratio - 1)."""
    a, b = edges_of(triangles).T
    lengths = [np.linalg.norm(v[a] - v[b], axis=1) for v in (first, second)]
    return float(np.median(np.abs(lengths[1] / lengths[0] - 1.0)))


def main(folder: Path) -> None:
    scene.clear()
    mesh = creature.build_mesh()
    body, rig = creature.build_rig(mesh)
    creature.unwrap(body)
    image = texture.paint_texture(mesh, str(folder / "creature.png"))
    mesh.materials.append(texture.textured_material(image))
    colour_parts(body)

    triangles = creature.triangles_of(mesh)
    creature.set_pose(rig, creature.STRIDING)
    creature.stand_on_ground(body, rig)
    striding = creature.posed_vertices(body)
    result = scan.scan_mesh(striding, triangles)
    creature.set_pose(rig, creature.STANDING)
    creature.stand_on_ground(body, rig)
    standing = creature.posed_vertices(body)
    print(f"demo: poses: median stretch of an edge {median_stretch(standing, striding, triangles):.1%}")

    moved = rigid_motion(result.vertices, TURN_AXIS, TURN_DEGREES, SHIFT)
    write_ply(folder / "donor.ply", standing, triangles)
    write_ply(folder / "scan.ply", moved, result.triangles)
    np.savez(folder / "truth.npz", tri=result.tri, w=result.w)
    scanned = scene.add_mesh("Scan", moved, result.triangles)
    scanned.data.materials.append(scene.plain_material("Bare scan", scene.BARE))
    upright = np.eye(4)
    upright[:3, :3] = rigid_motion(np.eye(3), -TURN_AXIS, TURN_DEGREES, np.zeros(3)).T
    upright[:3, 3] = -upright[:3, :3] @ SHIFT
    scanned["upright"] = upright.ravel().tolist()
    bpy.context.scene["donor"], bpy.context.scene["receiver"] = body.name, scanned.name
    print(f"demo: donor: {len(standing)} vertices; scan: {len(moved)} vertices, {len(result.triangles)} triangles")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "pair.blend"), check_existing=False)


if __name__ == "__main__":
    main(Path(sys.argv[sys.argv.index("--") + 1]).resolve())
