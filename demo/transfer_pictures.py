# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of docs/transfer.md: each kind of data on the donor, and the receiver before and after.

    python demo/transfer_pictures.py -- PAIR.blend FOLDER ZIP [NAME...]

The Python is one that has bpy 4.2 or later: older Blenders hide the face sets. PAIR.blend is that of demo/make_pair.py.
Writes transfer_<NAME>.jpg into FOLDER, all or the named ones.
"""

import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import bpy
import numpy as np

from demo import addon, creature, pictures, scene
from demo.implicit import Array

PIXELS, SAMPLES = 1400, 48
SWOLLEN = "spine.4"
"""The bone whose part of the surface the shape key swells."""
FACE_SETS = ".sculpt_face_set"
MARK = (0.85, 0.12, 0.05)


def coloured(item: bpy.types.Object, name: str, colours: Array) -> None:
    """Show linear colours (n, 4) of the points."""
    layer = item.data.color_attributes.get(name) or item.data.color_attributes.new(name, "FLOAT_COLOR", "POINT")
    layer.data.foreach_set("color", colours.astype(np.float32).ravel())
    item.data.materials.clear()
    item.data.materials.append(scene.attribute_material(name, name))


def copy_of(item: bpy.types.Object) -> bpy.types.Object:
    """The object with a mesh of its own."""
    twin = item.copy()
    twin.data = item.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    return twin


def bare(item: bpy.types.Object) -> bpy.types.Object:
    """A copy that shows nothing but its shape."""
    twin = copy_of(item)
    twin.data.materials.clear()
    twin.data.materials.append(scene.plain_material("Bare", scene.BARE))
    return twin


def bone_of_faces(item: bpy.types.Object) -> Array:
    """(f,): the number of the bone that weighs most at each face's first corner."""
    weights = creature.read_weights(item, list(item.vertex_groups.keys()))
    return weights.argmax(axis=1)[[polygon.vertices[0] for polygon in item.data.polygons]].astype(np.int32)


def colours_of(numbers: Array) -> Array:
    """(n, 3) linear colours, those of neighbouring numbers far from each other."""
    return 0.5 + 0.4 * np.cos(2 * np.pi * (0.618 * numbers[:, None] + (0.0, 0.33, 0.67)))


def seam_lines(item: bpy.types.Object, width: float) -> bpy.types.Object:
    """The seams of an object as lines that go where it goes."""
    curve = bpy.data.curves.new("Seams", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.5 * width
    for edge in item.data.edges:
        if not edge.use_seam:
            continue
        line = curve.splines.new("POLY")
        line.points.add(1)
        for point, vertex in zip(line.points, edge.vertices, strict=True):
            point.co = (*item.data.vertices[vertex].co, 1.0)
    curve.materials.append(scene.plain_material("Seam", MARK))
    lines = bpy.data.objects.new("Seams", curve)
    bpy.context.scene.collection.objects.link(lines)
    lines.parent = item
    return lines


def frozen(item: bpy.types.Object) -> bpy.types.Object:
    """A copy in the shape that it is seen in, hanging on nothing."""
    seen = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    twin = bpy.data.objects.new(item.name, bpy.data.meshes.new_from_object(seen))
    twin.matrix_world = item.matrix_world
    bpy.context.scene.collection.objects.link(twin)
    return twin


class Album:
    """Donor and receiver, matched, upright side by side; one method per picture."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.donor = bpy.data.objects[bpy.context.scene["donor"]]
        self.receiver = bpy.data.objects[bpy.context.scene["receiver"]]
        self.rig = bpy.data.objects["Rig"]
        pictures.stand(self.donor)
        pictures.stand(self.receiver, pictures.SCAN_TURN)
        scene.studio(SAMPLES)
        bpy.context.scene.render.image_settings.file_format = "JPEG"
        bpy.context.scene.render.image_settings.quality = 86
        # Blender would write the path of the file into the picture.
        bpy.context.scene.render.use_stamp_filename = False
        if "isograft" not in self.receiver:
            addon.select(self.donor, self.receiver)
            bpy.ops.object.isograft_match()

    def graft(self, **settings: object) -> None:
        """Transfer to the receiver."""
        addon.select(self.donor, self.receiver)
        if bpy.ops.object.isograft_transfer(**settings) != {"FINISHED"}:
            raise RuntimeError("the transfer did not finish")

    def shoot(self, name: str, items: list[bpy.types.Object], words: list[str]) -> None:
        """One picture of the objects side by side, with words below."""
        captions = pictures.arrange(items, words, PIXELS)
        scene.render(str(self.folder / f"transfer_{name}.jpg"))
        pictures.remove(captions)

    def uv(self) -> None:
        """One checker on both UV maps, seams of the receiver drawn on it."""
        before = bare(self.receiver)
        self.graft(what={"UV"}, link_materials=False)
        checker = scene.checker_material("Checker", 40.0)
        items = [copy_of(self.donor), before, copy_of(self.receiver), bare(self.receiver)]
        for item in (items[0], items[2]):
            item.data.materials.clear()
            item.data.materials.append(checker)
        lines = seam_lines(items[3], 0.006 * max(self.receiver.dimensions))
        self.shoot("uv", items, ["donor's UV map", "receiver before", "on the receiver", "seams marked"])
        pictures.remove([lines, *items])

    def textures(self) -> None:
        """The donor's image and relief in a new unwrap of the receiver, unmatched parts left alone and filled."""
        before = bare(self.receiver)
        items = [self.donor, before]
        for fill in (False, True):
            receiver = copy_of(before)
            addon.select(self.donor, receiver)
            if bpy.ops.object.isograft_bake(size=2048, uv_source="UNWRAP", fill=fill) != {"FINISHED"}:
                raise RuntimeError("the bake did not finish")
            items.append(receiver)
        self.shoot("textures", items, ["donor", "receiver before", "baked into a new unwrap", "filled on request"])
        pictures.remove(items[1:])

    def colours(self) -> None:
        """A colour attribute, unmatched parts left black, and filled on request."""
        items = [copy_of(self.donor), bare(self.receiver)]
        items[0].data.materials.clear()
        items[0].data.materials.append(scene.attribute_material("Parts", "Parts"))
        for fill in (False, True):
            self.graft(what={"COLOR"}, fill=fill, overwrite=True)
            items.append(copy_of(self.receiver))
            items[-1].data.materials.clear()
            items[-1].data.materials.append(scene.attribute_material("Parts", "Parts"))
        words = ["donor's colours", "receiver before", "unmatched left alone", "filled on request"]
        self.shoot("colours", items, words)
        pictures.remove(items)

    def groups(self) -> None:
        """The weights of one bone, and the receiver before and after."""
        before = bare(self.receiver)
        self.graft(what={"GROUPS"}, overwrite=True, normalise=True)
        names = list(self.donor.vertex_groups.keys())
        items = [copy_of(self.donor), copy_of(self.receiver)]
        weights = [creature.read_weights(item, names) for item in items]
        bone = int(weights[0].sum(axis=0).argmax())
        for item, weight in zip(items, weights, strict=True):
            coloured(item, "Weight", pictures.heat(weight[:, bone], np.ones(len(weight), dtype=bool)))
        items.insert(1, before)
        self.shoot("groups", items, [f"donor's weights of {names[bone]}", "receiver before", "on the receiver"])
        pictures.remove(items)

    def keys(self) -> None:
        """A shape key that swells the chest, at 0 and at 1; filled, so that the rims of the scan's holes go along.

        Not the spines on its back: the scan has none of their tips.
        """
        mesh = self.donor.data
        points, normals = (np.array([tuple(getattr(v, name)) for v in mesh.vertices]) for name in ("co", "normal"))
        names = list(self.donor.vertex_groups.keys())
        chest = creature.read_weights(self.donor, names)[:, names.index(SWOLLEN)]
        size = np.ptp(points, axis=0).max()
        low, high = np.percentile(points[chest > 0.5 * chest.max(), 2], (10, 90))
        chest = chest * np.clip(1.5 - 2.0 * (points[:, 2] - low) / (high - low), 0.0, 1.0)
        self.donor.shape_key_add(name="Basis", from_mix=False)
        key = self.donor.shape_key_add(name="Swell", from_mix=False)
        shape = points + 0.15 * size * chest[:, None] * normals
        key.data.foreach_set("co", shape.astype(np.float32).ravel())
        self.graft(what={"KEYS"}, fill=True)
        items = []
        for item in (self.donor, self.receiver):
            for value in (0.0, 1.0):
                item.data.shape_keys.key_blocks["Swell"].value = value
                items.append(frozen(item))
        plain = scene.plain_material("Clay", (0.45, 0.33, 0.26))
        for item in items:
            item.data.materials.clear()
            item.data.materials.append(plain)
        self.shoot("keys", items, ["donor, key at 0", "donor, key at 1", "receiver, key at 0", "receiver, key at 1"])
        pictures.remove(items)
        for item in (self.donor, self.receiver):
            item.shape_key_clear()

    def materials(self) -> None:
        """Per-face materials: one for every bone's part of the surface."""
        twin = self.donor
        kept = list(twin.data.materials)
        twin.data.materials.clear()
        for number, colour in enumerate(colours_of(np.arange(len(twin.vertex_groups)))):
            twin.data.materials.append(scene.plain_material(f"Part {number}", tuple(colour)))
        twin.data.polygons.foreach_set("material_index", bone_of_faces(twin))
        twin.data.update()
        items = [copy_of(twin), bare(self.receiver)]
        self.graft(what={"MATERIALS"})
        items.append(copy_of(self.receiver))
        self.shoot("materials", items, ["donor's materials", "receiver before", "face by face on the receiver"])
        pictures.remove(items)
        twin.data.materials.clear()
        for material in kept:
            twin.data.materials.append(material)
        twin.data.polygons.foreach_set("material_index", np.zeros(len(twin.data.polygons), dtype=np.int32))

    def face_sets(self) -> None:
        """Face sets, one for every bone's part of the surface, in colours of their own; the receiver has none."""
        mesh = self.donor.data
        sets = mesh.attributes.new(FACE_SETS, "INT", "FACE")
        sets.data.foreach_set("value", bone_of_faces(self.donor) + 1)
        items = [copy_of(self.donor), bare(self.receiver)]
        self.graft(what={"FACE_SETS"}, fill=True)
        items.append(copy_of(self.receiver))
        for item in (items[0], items[2]):
            found = np.empty(len(item.data.polygons), np.int32)
            item.data.attributes[FACE_SETS].data.foreach_get("value", found)
            colours = np.column_stack([colours_of(found), np.ones(len(found))])
            layer = item.data.color_attributes.new("Sets", "FLOAT_COLOR", "CORNER")
            corners = np.repeat(colours, [polygon.loop_total for polygon in item.data.polygons], axis=0)
            layer.data.foreach_set("color", corners.astype(np.float32).ravel())
            item.data.materials.clear()
            item.data.materials.append(scene.attribute_material("Sets", "Sets"))
        self.shoot("face_sets", items, ["donor's face sets", "receiver before", "on the receiver, filled"])
        pictures.remove(items)
        mesh.attributes.remove(mesh.attributes[FACE_SETS])

    def attributes(self) -> None:
        """A number of every point, unmatched parts left at 0 (grey), and filled on request."""
        height = np.array([vertex.co.z for vertex in self.donor.data.vertices])
        bands = 0.5 - 0.5 * np.cos(12.0 * np.pi * (height - height.min()) / np.ptp(height))
        layer = self.donor.data.attributes.new("Bands", "FLOAT", "POINT")
        layer.data.foreach_set("value", bands.astype(np.float32))
        matched = addon.read_attribute(self.receiver, "isograft_face") >= 0
        items = [copy_of(self.donor), bare(self.receiver)]
        coloured(items[0], "Shown", pictures.heat(bands, np.ones(len(bands), dtype=bool)))
        for known in (matched, np.ones_like(matched)):
            self.graft(what={"ATTRIBUTES"}, attribute_names="Bands", fill=bool(known.all()), overwrite=True)
            items.append(copy_of(self.receiver))
            coloured(items[-1], "Shown", pictures.heat(addon.read_attribute(self.receiver, "Bands"), known))
        words = ["donor's attribute", "receiver before", "unmatched left alone", "filled on request"]
        self.shoot("attributes", items, words)
        pictures.remove(items)
        self.donor.data.attributes.remove(self.donor.data.attributes["Bands"])

    def normals(self) -> None:
        """Custom normals that shade the donor as if it were carved, and the receiver before and after."""
        kept = [(item, item.data) for item in (self.donor, self.receiver)]
        for item, own in kept:
            item.data = own.copy()
        mesh = self.donor.data
        mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))
        if hasattr(mesh, "use_auto_smooth"):
            mesh.use_auto_smooth = True
        own = np.array([tuple(vertex.normal) for vertex in mesh.vertices])
        # The nearest of 14 directions, each with all that looks its way: planes where the surface is round.
        turns = np.arange(14) + 0.5
        tilt, turn = np.arccos(1.0 - 2.0 * turns / 14), turns * np.pi * (1.0 + 5.0**0.5)
        directions = np.stack([np.cos(turn) * np.sin(tilt), np.sin(turn) * np.sin(tilt), np.cos(tilt)], axis=1)
        carved = directions[(own @ directions.T).argmax(axis=1)]
        mesh.normals_split_custom_set_from_vertices(carved.tolist())
        items = [copy_of(self.donor), copy_of(self.receiver)]
        self.graft(what={"NORMALS"})
        items.append(copy_of(self.receiver))
        plain = scene.plain_material("Clay", (0.45, 0.33, 0.26), 0.35)
        for item in items:
            item.data.materials.clear()
            item.data.materials.append(plain)
        items[1].data.polygons.foreach_set("use_smooth", np.ones(len(items[1].data.polygons), dtype=bool))
        self.shoot("normals", items, ["donor's custom normals", "receiver before", "turned with the surface"])
        pictures.remove(items)
        for item, own in kept:
            item.data = own

    def wrap(self) -> None:
        """The donor's mesh on the scan, what was completed in another colour."""
        addon.select(self.donor, self.receiver)
        if bpy.ops.object.isograft_wrap() != {"FINISHED"}:
            raise RuntimeError("the wrap did not finish")
        made = bpy.data.objects[f"{self.donor.name} on {self.receiver.name}"]
        for modifier in list(made.modifiers):
            made.modifiers.remove(modifier)
        filled = np.zeros(len(made.data.vertices), dtype=bool)
        made.data.attributes["isograft_filled"].data.foreach_get("value", filled)
        colours = np.tile([0.45, 0.5, 0.6, 1.0], (len(filled), 1))
        colours[filled] = (*MARK, 1.0)
        coloured(made, "Filled", colours)
        before = bare(self.receiver)
        self.shoot("wrap", [self.donor, before, made], ["donor", "receiver", "donor's mesh; red: completed"])
        pictures.remove([before, made])


def main(pair: Path, folder: Path, zip_path: Path, names: list[str]) -> None:
    """Take the named pictures, or all."""
    addon.install(zip_path)
    bpy.ops.wm.open_mainfile(filepath=str(pair))
    album = Album(folder)
    takes: dict[str, Callable[[], None]] = {
        "uv": album.uv,
        "colours": album.colours,
        "groups": album.groups,
        "keys": album.keys,
        "materials": album.materials,
        "face_sets": album.face_sets,
        "attributes": album.attributes,
        "normals": album.normals,
        "wrap": album.wrap,
        "textures": album.textures,
    }
    for name in names or takes:
        takes[name]()
        print(f"demo: transfer_{name}.jpg", flush=True)


if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    main(*(Path(argument).resolve() for argument in arguments[:3]), arguments[3:])
