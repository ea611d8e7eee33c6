"""The rabbit: on all fours, its long ears lying on its back with air under them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .body import Body
from .build import closed_character
from .character import Bones, Character, Material, Motion
from .motion import X, Y, Z, curve, loop, move, phase, rotate, turn
from .sdf import (
    Shape,
    ball,
    common,
    ellipsoid,
    flattened,
    half_space,
    round_cone,
    shell,
    shifted,
    union,
    unit,
)

MATERIALS = {
    "fur": Material("fur", "#c99a6e", roughness=0.95),
    "cream": Material("cream", "#f6e7d0", roughness=0.95),
    "pink": Material("pink", "#e79a95", roughness=0.7),
    "eye": Material("eye", "#2b1d1a", roughness=0.2),
    "light": Material("glint", "#ffffff", roughness=0.3),
}

GAP = 0.02
"""Air between the ears and the back, metres."""

EAR = {
    # how far back, sideways, half width; the first two points rise out of the head
    "z": (0.36, 0.27, 0.15, 0.03, -0.09, -0.21, -0.32),
    "x": (0.060, 0.072, 0.088, 0.100, 0.108, 0.112, 0.112),
    "width": (0.050, 0.056, 0.066, 0.071, 0.067, 0.053, 0.028),
}
FLAT = 2.5


def make() -> Character:
    """Return the rabbit."""
    body = Body()
    _trunk(body)
    ear = _ear_line(body)
    bones = _skeleton(ear)
    _head(body)
    _front_leg(body, bones)
    _hind_leg(body, bones)
    _ear(body, ear)
    box = [[-0.36, -0.02, -0.78], [0.36, 1.02, 0.78]]
    return closed_character("Rabbit", bones, body, box, 0.006, MATERIALS, _hop(), smoothing=24)


def _skeleton(ear: NDArray) -> Bones:
    bones = Bones()
    bones.add("hips", None, [0, 0.48, -0.28])
    bones.add("spine", "hips", [0, 0.50, -0.08])
    bones.add("chest", "spine", [0, 0.49, 0.12])
    bones.add("neck", "chest", [0, 0.57, 0.27])
    bones.add("head", "neck", [0, 0.70, 0.38])
    bones.add_chain("ear.L", "head", ear[[0, 4, 6, 10]], both=True)
    bones.add("tail", "hips", [0, 0.50, -0.52])
    bones.add("upper_arm.L", "chest", [0.115, 0.42, 0.23], both=True)
    bones.add("forearm.L", "upper_arm.L", [0.135, 0.27, 0.18], both=True)
    bones.add("paw.L", "forearm.L", [0.135, 0.09, 0.26], both=True)
    bones.add("thigh.L", "hips", [0.15, 0.44, -0.31], both=True)
    bones.add("shin.L", "thigh.L", [0.222, 0.272, -0.09], both=True)
    bones.add("foot.L", "shin.L", [0.215, 0.11, -0.44], both=True)
    bones.add("toe.L", "foot.L", [0.218, 0.05, -0.18], both=True)
    return bones


def _trunk(body: Body) -> None:
    body.add(ellipsoid([0, 0.465, -0.30], [0.212, 0.265, 0.29]), "hips", edge=0.031, colour="fur")
    fur = {"edge": 0.03, "colour": "fur"}
    body.add(ellipsoid([0, 0.475, -0.04], [0.2, 0.25, 0.28]), "spine", blend=0.1, **fur)
    body.add(ellipsoid([0, 0.475, 0.17], [0.178, 0.23, 0.2]), "chest", blend=0.1, **fur)
    neck = round_cone([0, 0.55, 0.22], [0, 0.70, 0.36], 0.155, 0.12)
    body.add(neck, "neck", blend=0.08, edge=0.028, colour="fur")
    body.add(
        ellipsoid([0, 0.768, 0.47], [0.168, 0.152, 0.185]),
        "head",
        blend=0.05,
        edge=0.024,
        colour="fur",
    )
    body.colour(ellipsoid([0, 0.42, 0.335], [0.098, 0.165, 0.1]), "cream", 0.024)
    tail = [
        ([0, 0.50, -0.615], 0.075),
        ([0, 0.56, -0.62], 0.06),
        ([0.045, 0.51, -0.645], 0.055),
        ([-0.045, 0.51, -0.645], 0.055),
        ([0, 0.46, -0.635], 0.055),
    ]
    for centre, radius in tail:
        at = {"at": np.array([0, 0.5, -0.66]), "reach": 0.25}
        body.add(ball(centre, radius), "tail", blend=0.02, edge=0.018, colour="cream", **at)


def _head(body: Body) -> None:
    fur = {"joint": "head", "colour": "fur"}
    body.add(
        ellipsoid([0.085, 0.705, 0.535], [0.078, 0.07, 0.08]),
        both=True,
        blend=0.04,
        edge=0.02,
        **fur,
    )
    muzzle = ellipsoid([0, 0.715, 0.615], [0.078, 0.062, 0.07])
    body.add(muzzle, "head", blend=0.035, edge=0.015, colour="cream")
    for side in (1, -1):
        lip = ellipsoid([0.032 * side, 0.698, 0.655], [0.036, 0.032, 0.034])
        body.add(lip, "head", blend=0.012, edge=0.012, colour="cream")
    chin = ellipsoid([0, 0.66, 0.625], [0.035, 0.025, 0.035])
    body.add(chin, "head", blend=0.012, edge=0.012, colour="cream")
    nose = ellipsoid([0, 0.742, 0.678], [0.028, 0.019, 0.018])
    body.add(nose, "head", blend=0.006, edge=0.009, colour="pink")
    eye = np.array([0.125, 0.797, 0.562])
    out = unit([0.75, 0.12, 0.62])
    body.add(
        ellipsoid(eye, [0.036, 0.047, 0.037]),
        "head",
        both=True,
        blend=0.004,
        edge=0.011,
        colour="eye",
    )
    for side in (1, -1):
        glint = shifted((eye + out * 0.032) * [side, 1, 1], 0.004, 0.014, 0.004)
        body.colour(ball(glint, 0.0105), "light", 0.0055)


def _ear_line(trunk: Body) -> NDArray:
    """Return the middle line of the left ear, laid on the trunk with a gap: (13, 3)."""
    line = np.column_stack([EAR["x"], np.zeros(7), EAR["z"]])
    clear = GAP + np.array(EAR["width"]) / FLAT
    low, high = np.full(7, 0.5), np.full(7, 1.3)
    for _ in range(40):
        line[:, 1] = (low + high) / 2
        inside = np.array([trunk.distance(p[None])[0] for p in line]) < clear
        low, high = np.where(inside, line[:, 1], low), np.where(inside, high, line[:, 1])
    line[0] = [0.058, 0.855, 0.40]
    line[1, 1] = max(line[1, 1], 0.885)
    line[2, 1] = max(line[2, 1], (line[1, 1] + line[3, 1]) / 2 - 0.012)
    return np.round(_refined(line), 4)


def _ear(body: Body, line: NDArray) -> None:
    widths = _refined(np.array(EAR["width"])[:, None])[:, 0]
    ear = {"both": True, "edge": 0.0135, "colour": "fur"}
    for k in range(len(line) - 1):
        joint = 1 if k < 4 else 2 if k < 6 else 3 if k < 10 else 4
        shape = _slab(line[k], line[k + 1], widths[k], widths[k + 1], FLAT)
        reach, blend = (0.09, 0.03) if k < 2 else (0.06, 0.006)
        body.add(shape, f"ear{joint}.L", at=line[k], reach=reach, blend=blend, **ear)
    ups = np.array([_up(d) for d in np.gradient(line, axis=0)])
    top = line + ups * widths[:, None] / FLAT * 1.1
    thin = 0.62 * widths
    hollow = union([_slab(top[k], top[k + 1], thin[k], thin[k + 1], 3.2) for k in range(2, 10)])
    body.add(hollow, "ear1.L", both=True, blend=0.006, edge=0.013, carve=True)
    body.colour(shell(hollow, 0.0015), "pink", 0.013, both=True)


def _slab(a: NDArray, b: NDArray, wide_a: float, wide_b: float, flat: float) -> Shape:
    """Return a round cone from a to b, pressed flat."""
    return flattened(round_cone(a, b, wide_a, wide_b), (a + b) / 2, _up(b - a), flat)


def _refined(rows: NDArray) -> NDArray:
    """Put a point between each two of a smooth curve (n, k), by cubic interpolation."""
    padded = np.concatenate([2 * rows[:1] - rows[1:2], rows, 2 * rows[-1:] - rows[-2:-1]])
    between = (9 * (rows[:-1] + rows[1:]) - padded[:-3] - padded[3:]) / 16
    result = np.empty((2 * len(rows) - 1, rows.shape[1]))
    result[::2], result[1::2] = rows, between
    return result


def _up(along: NDArray) -> NDArray:
    """Return the unit vector that is square to a direction and closest to up and outward."""
    up, along = unit([0.4, 1, 0]), unit(along)
    return unit(up - along * float((up * along).sum()))


def _front_leg(body: Body, bones: Bones) -> None:
    shoulder, elbow, paw = (bones[f"{n}.L"] for n in ("upper_arm", "forearm", "paw"))
    fur = {"both": True, "colour": "fur", "edge": 0.023}
    upper = round_cone(shoulder, elbow, 0.088, 0.063)
    body.add(upper, "upper_arm.L", at=shoulder, reach=0.2, blend=0.06, **fur)
    lower = round_cone(elbow, paw, 0.063, 0.047)
    body.add(lower, "forearm.L", at=elbow, reach=0.12, blend=0.012, **fur)
    _toes(body, "paw.L", paw + Z * 0.035 - Y * 0.045, 0.05)


def _hind_leg(body: Body, bones: Bones) -> None:
    hip, knee, heel, toe = (bones[f"{n}.L"] for n in ("thigh", "shin", "foot", "toe"))
    fur = {"both": True, "colour": "fur"}
    thigh = ellipsoid([0.188, 0.40, -0.245], [0.098, 0.18, 0.19])
    body.add(thigh, "thigh.L", at=hip, reach=0.4, blend=0.05, edge=0.028, **fur)
    # The knee stands clear of the belly, which is not the thigh's neighbour.
    front = round_cone([0.188, 0.38, -0.23], knee, 0.1, 0.064)
    body.add(front, "thigh.L", at=hip, reach=0.3, blend=0.03, edge=0.026, **fur)
    shin = round_cone(knee, heel, 0.062, 0.046)
    body.add(shin, "shin.L", at=knee, reach=0.1, blend=0.008, edge=0.022, **fur)
    ground = half_space([0, 0, 0], [0, -1, 0])
    foot = round_cone(heel - Y * 0.055, toe, 0.056, 0.054)
    body.add(
        common(foot, ground, 0.02), "foot.L", at=heel, reach=0.12, blend=0.03, edge=0.022, **fur
    )
    _toes(body, "toe.L", toe + Z * 0.03 - Y * 0.005, 0.056)


def _toes(body: Body, joint: str, centre: NDArray, size: float) -> None:
    """Add a paw with three toes."""
    ground = half_space([0, 0, 0], [0, -1, 0])
    place = {"both": True, "colour": "cream", "at": centre, "reach": 0.2}
    pad = ellipsoid(centre + Y * 0.002, [size, 0.9 * size, 1.25 * size])
    body.add(common(pad, ground, 0.02), joint, blend=0.025, edge=0.018, **place)
    for side in (-1, 0, 1):
        front = centre + X * side * 0.62 * size + Z * size * (1.2 - 0.2 * side * side) - Y * 0.014
        toe = ellipsoid(front, [0.4 * size, 0.52 * size, 0.52 * size])
        body.add(common(toe, ground, 0.015), joint, blend=0.008, edge=0.013, **place)


def _hop() -> Motion:
    """Return one hop on the spot: crouch, leap, land, and ears that lag behind."""
    motion = loop("hop", 1.0, 30)
    t = phase(motion)
    # Eight keys: rest, crouch, push, rise, top, fall, land, settle.
    up = np.maximum(curve(t, [0, -0.05, 0.04, 0.2, 0.27, 0.17, -0.02, -0.03]), -0.06)
    pitch = curve(t, [0, 2, -16, -20, -4, 14, 10, 2])
    move(motion, "hips", 0, up, curve(t, [0, -0.03, 0.02, 0.05, 0.04, 0.02, 0.01, 0]))
    rotate(motion, "hips", turn(X, pitch))
    rotate(motion, "spine", turn(X, curve(t, [0, 5, -6, -8, 0, 8, 6, 2])))
    rotate(motion, "chest", turn(X, curve(t, [0, 3, -4, -6, 0, 6, 4, 1])))
    rotate(motion, "neck", turn(X, curve(t, [0, -4, 8, 12, 2, -12, -8, -2])))
    rotate(motion, "head", turn(X, curve(t, [0, -4, 10, 12, 2, -10, -8, -2])))
    rotate(motion, "tail", turn(X, curve(t, [0, 10, -20, -14, 0, 22, 18, 4])))
    for side, sign in (("L", 1), ("R", -1)):
        flap = curve(t, [2, 0, 2, 8, 24, 50, 44, 14])
        lag = curve(t, [2, 0, 0, -2, 6, 22, 26, 10], 0.06)
        rotate(motion, f"ear1.{side}", turn(X, flap), turn(Y, -sign * flap / 5))
        for k, share in ((2, 0.6), (3, 0.8), (4, 0.9)):
            rotate(motion, f"ear{k}.{side}", turn(X, lag * share))
        rotate(motion, f"upper_arm.{side}", turn(X, curve(t, [0, 6, -6, 24, 10, -34, -14, -2])))
        rotate(motion, f"forearm.{side}", turn(X, curve(t, [0, -16, -14, -40, -40, -6, -6, -3])))
        rotate(motion, f"paw.{side}", turn(X, curve(t, [0, 6, 30, 40, 30, 10, 0, 0])))
        rotate(motion, f"thigh.{side}", turn(X, curve(t, [0, -10, 24, 36, 14, -12, -10, -4])))
        rotate(motion, f"shin.{side}", turn(X, curve(t, [0, 14, -26, -38, -10, 8, 8, 4])))
        rotate(motion, f"foot.{side}", turn(X, curve(t, [0, -8, 40, 64, 30, -4, -8, -2])))
        rotate(motion, f"toe.{side}", turn(X, curve(t, [0, 0, -30, 10, 6, 0, 0, 0])))
    return motion
