# SPDX-License-Identifier: GPL-3.0-or-later
"""The creature: joints, flesh, armour and relief as one implicit shape.

Lengths are in body units (withers at about 1.4). Places are written (forward, left, up) and turned into Blender's
axes, where a character looks along -Y.
"""

from __future__ import annotations

import numpy as np

from demo.implicit import Array, Shape, curve, ellipsoid, tapered_capsule


def place(forward: float, left: float, up: float) -> tuple[float, float, float]:
    return (left, -forward, up)


SPINE = [(-0.78, 0, 1.04), (-0.35, 0, 1.1), (0.08, 0, 1.12), (0.5, 0, 1.18), (0.78, 0, 1.32)]
NECK = [(0.78, 0, 1.32), (1.02, 0, 1.56), (1.2, 0, 1.76)]
HEAD = [(1.2, 0, 1.76), (1.78, 0, 1.6)]
TAIL = [
    (-0.78, 0, 1.04), (-1.06, 0, 0.99), (-1.32, 0, 0.9), (-1.57, 0, 0.81),
    (-1.8, 0, 0.76), (-2.02, 0, 0.76), (-2.22, 0, 0.8),
]  # fmt: skip
CLUB = (-2.28, 0.02, 0.8)
FORE = [(0.56, 0.3, 1.12), (0.4, 0.4, 0.68), (0.58, 0.39, 0.3), (0.66, 0.39, 0.1), (0.86, 0.4, 0.06)]
HIND = [(-0.68, 0.24, 1.02), (-0.44, 0.36, 0.64), (-0.9, 0.33, 0.4), (-0.78, 0.33, 0.1), (-0.54, 0.34, 0.06)]

LONG_HORN = [
    (1.28, 0.13, 1.92), (1.2, 0.28, 2.06), (1.06, 0.38, 2.18), (0.91, 0.42, 2.28), (0.79, 0.39, 2.38),
    (0.72, 0.33, 2.46),
]  # fmt: skip
SHORT_HORN = [(1.3, -0.13, 1.92), (1.3, -0.28, 2.05), (1.38, -0.38, 2.17), (1.47, -0.41, 2.26)]

# forward, height, half length, lean to the left: unlike each other and unlike their mirror images
PLATES = [
    (0.86, 0.13, 0.075, 0.2), (0.66, 0.24, 0.11, -0.25), (0.4, 0.34, 0.14, 0.22), (0.1, 0.27, 0.125, -0.3),
    (-0.18, 0.32, 0.13, 0.15), (-0.46, 0.2, 0.1, -0.28), (-0.7, 0.25, 0.11, 0.3), (-0.95, 0.15, 0.085, -0.2),
    (-1.18, 0.2, 0.09, 0.25), (-1.42, 0.1, 0.07, -0.2), (-1.66, 0.16, 0.08, 0.15),
]  # fmt: skip


def bones() -> dict[str, tuple[str | None, Array, Array]]:
    """Name -> (parent, head, tail) in Blender's axes, parents first."""
    result: dict[str, tuple[str | None, Array, Array]] = {}

    def chain(names: list[str], joints: list[tuple[float, ...]], parent: str | None, side: float = 1.0) -> None:
        for name, a, b in zip(names, joints, joints[1:], strict=False):
            head, tail = (np.array(place(f, side * s, u)) for f, s, u in (a, b))
            result[name] = (parent, head, tail)
            parent = name

    chain([f"spine.{i}" for i in range(1, 5)], SPINE, None)
    chain(["neck.1", "neck.2"], NECK, "spine.4")
    chain(["head"], HEAD, "neck.2")
    chain([f"tail.{i}" for i in range(1, 7)], TAIL, "spine.1")
    for side, suffix in ((1.0, "L"), (-1.0, "R")):
        fore = [f"{n}.{suffix}" for n in ("upper_arm", "forearm", "wrist", "paw")]
        hind = [f"{n}.{suffix}" for n in ("thigh", "shin", "hock", "foot")]
        chain(fore, FORE, "spine.4", side)
        chain(hind, HIND, "spine.1", side)
    return result


def _torso(shape: Shape) -> None:
    shape.add(
        ellipsoid(place(0.42, 0, 1.06), (0.36, 0.5, 0.44)),
        tapered_capsule(place(0.15, 0, 0.96), place(-0.4, 0, 1.02), 0.37, 0.3, blend=0.2),
        ellipsoid(place(-0.7, 0, 1.06), (0.29, 0.36, 0.31), blend=0.2),
        ellipsoid(place(0.5, 0, 1.4), (0.2, 0.36, 0.17), blend=0.22),
        ellipsoid(place(0.05, 0.03, 0.72), (0.2, 0.34, 0.14), blend=0.15),
        tapered_capsule(place(0.72, 0, 1.24), place(1.02, 0, 1.54), 0.29, 0.205, blend=0.25),
        tapered_capsule(place(1.02, 0, 1.54), place(1.22, 0, 1.74), 0.205, 0.18, blend=0.1),
        tapered_capsule(place(0.86, 0, 1.1), place(1.2, 0, 1.5), 0.13, 0.08, blend=0.12),
    )
    for side in (1, -1):
        shape.add(
            ellipsoid(place(0.74, 0.15 * side, 0.92), (0.14, 0.13, 0.17), blend=0.08),
            ellipsoid(place(0.5, 0.32 * side, 1.3), (0.08, 0.22, 0.16), blend=0.09),
            ellipsoid(place(-0.86, 0.14 * side, 1.16), (0.13, 0.18, 0.14), blend=0.08),
        )


def _head(shape: Shape) -> None:
    shape.add(
        ellipsoid(place(1.3, 0, 1.78), (0.2, 0.24, 0.19), blend=0.1),
        tapered_capsule(place(1.4, 0, 1.74), place(1.78, 0, 1.6), 0.165, 0.1, blend=0.1),
        tapered_capsule(place(1.3, 0, 1.6), place(1.66, 0, 1.42), 0.13, 0.075, blend=0.05),
        ellipsoid(place(1.76, 0, 1.66), (0.11, 0.1, 0.075), blend=0.05),
        tapered_capsule(place(1.68, 0, 1.74), place(1.78, 0, 1.9), 0.055, 0.022, blend=0.06, label="horn"),
    )
    for side in (1, -1):
        shape.add(
            ellipsoid(place(1.28, 0.15 * side, 1.66), (0.1, 0.13, 0.13), blend=0.06),
            tapered_capsule(
                place(1.32, 0.13 * side, 1.9), place(1.56, 0.11 * side, 1.83), 0.06, 0.035, blend=0.03
            ),
            ellipsoid(place(1.47, 0.165 * side, 1.765), (0.06, 0.09, 0.06), carve=True, blend=0.04),
            ellipsoid(place(1.465, 0.135 * side, 1.765), (0.062, 0.062, 0.062), blend=0.012, label="eye"),
            ellipsoid(place(1.83, 0.055 * side, 1.67), (0.05, 0.05, 0.045), blend=0.03),
            tapered_capsule(
                place(1.18, 0.17 * side, 1.76), place(1.0, 0.42 * side, 1.8), 0.1, 0.045,
                blend=0.05, flat=((0.0, -0.6, 1.0), 0.5), label="ear",
            ),
        )  # fmt: skip
    shape.add(ellipsoid(place(1.72, 0, 1.53), (0.22, 0.24, 0.045), carve=True, blend=0.03))
    shape.add(*curve([place(*p) for p in LONG_HORN], (0.12, 0.112, 0.1, 0.085, 0.066, 0.04), blend=0.04, label="horn"))
    shape.add(*curve([place(*p) for p in SHORT_HORN], (0.115, 0.1, 0.08, 0.045), blend=0.04, label="horn"))
    shape.add(tapered_capsule(place(1.52, 0.05, 1.41), place(1.56, 0.06, 1.27), 0.05, 0.02, blend=0.05, label="horn"))
    shape.add(tapered_capsule(place(1.4, -0.05, 1.46), place(1.4, -0.07, 1.34), 0.045, 0.022, blend=0.05, label="horn"))


def _forelimb(shape: Shape, side: int) -> None:
    def at(f: float, s: float, u: float) -> tuple[float, float, float]:
        return place(f, side * s, u)

    shape.add(
        ellipsoid(at(0.55, 0.31, 1.08), (0.17, 0.22, 0.28), blend=0.12),
        tapered_capsule(at(0.54, 0.34, 1.02), at(0.4, 0.4, 0.68), 0.185, 0.135, blend=0.1),
        ellipsoid(at(0.32, 0.4, 0.86), (0.1, 0.11, 0.18), blend=0.07),
        ellipsoid(at(0.6, 0.41, 0.84), (0.09, 0.09, 0.15), blend=0.06),
        tapered_capsule(at(0.4, 0.4, 0.68), at(0.58, 0.39, 0.3), 0.15, 0.12, blend=0.06),
        ellipsoid(at(0.48, 0.47, 0.53), (0.11, 0.12, 0.17), blend=0.05),
        tapered_capsule(at(0.58, 0.39, 0.3), at(0.66, 0.39, 0.14), 0.125, 0.14, blend=0.06),
        ellipsoid(at(0.7, 0.39, 0.11), (0.19, 0.19, 0.115), blend=0.06),
        tapered_capsule(at(0.33, 0.4, 0.7), at(0.18, 0.42, 0.76), 0.07, 0.025, blend=0.05, label="claw"),
    )
    for toe, (s, f) in enumerate(((0.27, 0.86), (0.39, 0.92), (0.51, 0.85))):
        shape.add(
            tapered_capsule(at(0.72, 0.39 + 0.6 * (s - 0.39), 0.09), at(f, s, 0.08), 0.085, 0.075, blend=0.035),
            tapered_capsule(at(f + 0.03, s, 0.1), at(f + 0.17 - 0.02 * toe, s, 0.03), 0.05, 0.022, blend=0.03,
                            label="claw"),
        )  # fmt: skip


def _hindlimb(shape: Shape, side: int) -> None:
    def at(f: float, s: float, u: float) -> tuple[float, float, float]:
        return place(f, side * s, u)

    shape.add(
        ellipsoid(at(-0.66, 0.26, 0.98), (0.17, 0.27, 0.3), blend=0.12),
        tapered_capsule(at(-0.66, 0.28, 0.94), at(-0.44, 0.36, 0.64), 0.21, 0.13, blend=0.1),
        ellipsoid(at(-0.8, 0.32, 0.78), (0.1, 0.13, 0.16), blend=0.08),
        ellipsoid(at(-0.4, 0.37, 0.66), (0.09, 0.08, 0.1), blend=0.05),
        tapered_capsule(at(-0.44, 0.36, 0.64), at(-0.9, 0.33, 0.4), 0.155, 0.105, blend=0.05),
        ellipsoid(at(-0.64, 0.39, 0.49), (0.12, 0.16, 0.1), blend=0.06),
        tapered_capsule(at(-0.98, 0.33, 0.5), at(-0.89, 0.33, 0.36), 0.06, 0.11, blend=0.05),
        tapered_capsule(at(-0.9, 0.33, 0.4), at(-0.78, 0.33, 0.14), 0.11, 0.11, blend=0.05),
        tapered_capsule(at(-0.78, 0.33, 0.12), at(-0.56, 0.34, 0.1), 0.12, 0.11, blend=0.06),
    )
    shape.add(ellipsoid(at(-0.57, 0.335, 0.11), (0.19, 0.17, 0.115), blend=0.06))
    for s, f in ((0.24, 0.41), (0.43, 0.45)):
        shape.add(
            tapered_capsule(at(-0.62, 0.34, 0.1), at(-f, s, 0.09), 0.1, 0.09, blend=0.045),
            tapered_capsule(
                at(-f + 0.02, s, 0.11), at(-f + 0.22, s + 0.01, 0.035), 0.07, 0.026, blend=0.03, label="claw"
            ),
        )
    shape.add(tapered_capsule(at(-0.84, 0.33, 0.17), at(-1.05, 0.33, 0.06), 0.065, 0.026, blend=0.04, label="claw"))


def _tail(shape: Shape) -> None:
    radii = (0.28, 0.25, 0.22, 0.2, 0.18, 0.165, 0.17)
    for i in range(len(TAIL) - 1):
        shape.add(tapered_capsule(place(*TAIL[i]), place(*TAIL[i + 1]), radii[i], radii[i + 1], blend=0.1))
    shape.add(ellipsoid(place(*CLUB), (0.26, 0.24, 0.2), blend=0.08))
    for f, s, u, size in (
        (-2.14, 0.44, 0.93, 0.1), (-2.44, -0.4, 0.69, 0.13), (-2.34, 0.06, 1.21, 0.11),
        (-2.68, 0.14, 0.85, 0.115), (-2.12, -0.34, 1.07, 0.08), (-2.2, 0.34, 0.57, 0.075),
    ):  # fmt: skip
        base = 0.45 * np.array((f, s, u)) + 0.55 * np.array(CLUB)
        shape.add(tapered_capsule(place(*base), place(f, s, u), size, 0.026, blend=0.05, label="horn"))

    for f, s, u, length, size in (
        (-1.12, 0.2, 1.02, 0.3, 0.105), (-1.36, -0.17, 0.92, 0.24, 0.09),
        (-1.66, 0.15, 0.8, 0.17, 0.07), (-0.98, -0.22, 0.98, 0.13, 0.08),
    ):  # fmt: skip
        side = np.sign(s)
        shape.add(
            tapered_capsule(
                place(f, s, u),
                place(f - 0.5 * length, s + side * length, u + 0.1),
                size,
                0.028,
                blend=0.06,
                label="horn",
            )
        )


def _top(shape: Shape, forward: float) -> float:
    """Height of the back at a place along the body: the highest zero crossing."""
    ups = np.linspace(2.0, 0.4, 800)
    column = np.array([place(forward, 0.0, u) for u in ups])
    return float(ups[np.argmax(shape.value(column) < 0)])


def _plates(shape: Shape) -> None:
    bare = Shape(list(shape.parts))
    for forward, height, half, lean in PLATES:
        up = _top(bare, forward)
        root = (forward, -0.1 * lean * height, up - 0.05)
        middle = (forward - 0.12 * height, 0.35 * lean * height, up + 0.38 * height)
        tip = (forward - 0.5 * half - 0.3 * height, lean * height, up + 1.08 * height)
        thin = ((1.0, 0.0, -lean), 0.36)
        shape.add(
            tapered_capsule(place(*root), place(*middle), half, 1.2 * half, blend=0.05, flat=thin, label="plate"),
            tapered_capsule(place(*middle), place(*tip), 1.2 * half, 0.05, blend=0.02, flat=thin, label="plate"),
        )


def _armour(shape: Shape) -> None:
    """Keeled bony knobs in rows along flanks and tail, growing and shrinking, unlike left and right."""
    rng = np.random.default_rng(7)
    bare = Shape(list(shape.parts))
    for angle, first, last in ((0.62, -1.8, 0.6), (1.12, -1.65, 0.75), (1.62, -1.4, 0.1)):
        for side in (1, -1):
            forward = first + rng.uniform(0.0, 0.15)
            while forward < last:
                size = rng.uniform(0.05, 0.1) * (1.0 if forward > -1.2 else 0.65)
                turn = side * (angle + rng.uniform(-0.12, 0.12))
                point, normal = _on_flank(bare, forward, turn)
                across = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.7 else (0.0, 0.0, 1.0)
                along = np.cross(normal, across)
                along /= np.linalg.norm(along)
                axes = np.stack([along, np.cross(normal, along), normal], axis=1)
                shape.add(
                    ellipsoid(point, (1.1 * size, 0.75 * size, 0.55 * size), rotation=axes, blend=0.03, label="knob"),
                    ellipsoid(point + 0.35 * size * normal - 0.2 * size * along,
                              (0.7 * size, 0.25 * size, 0.55 * size), rotation=axes, blend=0.03, label="knob"),
                )  # fmt: skip
                forward += 1.9 * size + rng.uniform(0.05, 0.16)


def horn_side(points: Array) -> Array:
    """1 for points in front of the middle line of their horn, 0 behind it."""
    left, forward, up = points[:, 0], -points[:, 1], points[:, 2]
    middle = [np.interp(up, [u for _, _, u in horn], [f for f, _, _ in horn]) for horn in (LONG_HORN, SHORT_HORN)]
    return (forward > np.where(left > 0, middle[0], middle[1])).astype(int)


def _on_flank(shape: Shape, forward: float, angle: float) -> tuple[Array, Array]:
    """Point and normal where a ray from the body's axis leaves the shape; `angle` from straight up, to the left."""
    up = float(np.interp(forward, (-2.0, -0.8, 0.8), (0.76, 1.04, 1.2)))
    centre = np.array(place(forward, 0.0, up))
    steps = np.linspace(0.05, 0.9, 400)
    ray = np.array((np.sin(angle), 0.0, np.cos(angle)))
    points = centre + steps[:, None] * ray
    point = points[np.argmax(shape.value(points) > 0)]
    normal = shape.gradient(point[None])[0]
    return point, normal / np.linalg.norm(normal)


def _relief(shape: Shape) -> None:
    rng = np.random.default_rng(3)
    waves = rng.normal(size=(14, 3))
    waves *= (2 * np.pi / rng.uniform(0.28, 0.6, 14) / np.linalg.norm(waves, axis=1))[:, None]
    phases = rng.uniform(0, 2 * np.pi, 14)

    def swell(p: Array, d: Array) -> Array:
        return 0.0045 * np.sin(p @ waves.T + phases).sum(axis=1) * np.clip((p[:, 2] - 0.1) / 0.3, 0.0, 1.0)

    def ribs(p: Array, d: Array) -> Array:
        forward, up = -p[:, 1], p[:, 2]
        mask = np.exp(-(((forward - 0.08) / 0.3) ** 4) - ((up - 1.0) / 0.24) ** 4) * np.clip(
            np.abs(p[:, 0]) / 0.2, 0, 1
        )
        return 0.013 * mask * np.sin(2 * np.pi * (forward + 0.35 * (up - 1.0)) / 0.125)

    def scutes(p: Array, d: Array) -> Array:
        forward, up = -p[:, 1], p[:, 2]
        under = np.exp(-((p[:, 0] / 0.16) ** 4)) * np.clip((0.84 - up) / 0.12, 0, 1) * np.clip((up - 0.45) / 0.1, 0, 1)
        return 0.015 * under * np.sin(2 * np.pi * forward / 0.13)

    def folds(p: Array, d: Array) -> Array:
        along = (-p[:, 1] - 0.78) * 0.6 + (p[:, 2] - 1.32) * 0.8
        mask = np.exp(-(((along - 0.24) / 0.2) ** 4)) * np.clip((-p[:, 1] - 0.7) / 0.15, 0, 1)
        return 0.014 * mask * np.sin(2 * np.pi * along / 0.12)

    shape.relief += [swell, ribs, scutes, folds]


def creature() -> Shape:
    """The whole creature in its rest pose."""
    shape = Shape()
    _torso(shape)
    _tail(shape)
    for side in (1, -1):
        _forelimb(shape, side)
        _hindlimb(shape, side)
    _armour(shape)
    _plates(shape)
    _head(shape)
    _relief(shape)
    return shape


BOX = (np.array((-0.75, -2.2, -0.08)), np.array((0.75, 2.8, 2.7)))
