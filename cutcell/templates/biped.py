"""Template of a biped with two arms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .frame import TRUNK, Joints, mirrored, sided
from .interior import Interior, along, cut

BIPED_PARENTS = {
    **dict(zip(TRUNK, ("", *TRUNK), strict=False)),
    **sided(
        shoulder="chest", upper_arm="shoulder", forearm="upper_arm", hand="forearm",
        thigh="hips", shin="thigh", foot="shin", toe="foot",
    ),
}  # fmt: skip

BIPED_SOLE = 0.06
"""Height below which points belong to the feet, in body heights."""
LEGS = (0.36, 0.6)
"""Range in which hips are sought, in heights of the neck; a robe hides them."""
ROBE_HIPS = 0.5
ELBOW, WRIST = 0.56, 0.24
"""Shares of the path from the fingers to the shoulder, after adults' proportions."""
NECK = 0.05
"""Height above the shoulders at which the neck may begin, in body heights."""
KNEE = 0.54
"""Share of the height of the hips."""
ANKLE = 0.08
THIN_CELLS = 0.75
"""Depth of thin parts, in lattice cells."""
HAND = 0.1
"""Reach of fingers beyond thick parts, in body heights."""
ARM_OUT = 0.6
"""Share of the farthest point to a side within which there is no hand."""


def place(body: Interior) -> Joints:
    """Return where the joints of `BIPED_PARENTS` are in a body."""
    points, tall, floor = body.points, body.height, body.floor
    x, y = points[:, 0], points[:, 1] - floor
    middle = np.abs(x) < 0.1 * np.abs(x).max()
    head = int(np.flatnonzero(middle)[y[middle].argmax()])
    belly = body.deepest(middle & (y > 0.3 * tall) & (y < 0.6 * tall))
    feet = {side: _sole(body, sign) for side, sign in (("L", 1), ("R", -1))}
    hands = {side: _hand(body, head, belly, sign) for side, sign in (("L", 1), ("R", -1))}
    arms = {side: _arm(body, hands[side], feet[side], head, belly) for side in "LR"}
    # Paths to both hands part below the head where the neck begins; in a wide head, too early.
    base = cut(body, head, belly, body.branch(head, hands["L"], hands["R"]))[-1].copy()
    shoulders = np.mean([arm[-1][1] for arm in arms.values()])
    if not shoulders <= base[1] <= shoulders + NECK * tall:
        base = _middle_at(body, float(np.clip(base[1], shoulders, shoulders + NECK * tall)) - floor)
    neck_height = base[1] - floor
    reach = float(np.mean([body.branch(feet[a], feet[b], head) for a, b in ("LR", "RL")]))
    low, high = (share * neck_height for share in LEGS)
    robe = reach < low
    hip_height = ROBE_HIPS * neck_height if robe else min(1.1 * reach, high)
    joints: Joints = {}
    hips = _middle_at(body, hip_height + 0.03 * neck_height)
    trunk = body.middle_path(body.nearest(hips), body.nearest(base))
    joints["hips"] = hips
    joints["spine"], joints["chest"] = along(trunk, np.array([0.3, 0.6]))
    joints["neck"] = base
    top = points[head]
    joints["head"] = base + 0.25 * (top - base)
    for side in "LR":
        joints[f"hand.{side}"], joints[f"forearm.{side}"], shoulder = arms[side]
        joints[f"upper_arm.{side}"] = shoulder
        inner = 0.35 * joints["chest"] + 0.65 * base
        joints[f"shoulder.{side}"] = inner + 0.25 * (shoulder - inner)
        leg = _leg(body, feet[side], hips, hip_height, robe, 1 if side == "L" else -1)
        joints |= {f"{name}.{side}": at for name, at in leg.items()}
    return mirrored(joints, body.height)


def _sole(body: Interior, sign: int) -> int:
    """Return the node in the middle of what one foot stands on."""
    low = body.points[:, 1] - body.floor < BIPED_SOLE * body.height
    is_foot = low & (sign * body.points[:, 0] > 0)
    return body.central(is_foot if is_foot.any() else low)


def _hand(body: Interior, head: int, belly: int, sign: int) -> int:
    """Return the end of the longest limb to one side: a node far from both head and belly."""
    x, y = sign * body.points[:, 0], body.points[:, 1] - body.floor
    side = (y > 0.2 * body.height) & (y < 0.95 * body.height)
    thick = body.depth > THIN_CELLS * body.cell  # no corner of a cape
    side = side & thick if (side & thick).any() else side
    candidates = np.flatnonzero(side & (x > ARM_OUT * x[side].max()))
    away = body.distances(head)[candidates] + body.distances(belly)[candidates]
    thick_end = int(candidates[away.argmax()])
    # Fingers are thin.
    near = np.flatnonzero(body.distances(thick_end) < HAND * body.height)
    return int(near[body.distances(belly)[near].argmax()])


def _arm(body: Interior, hand: int, foot: int, head: int, belly: int) -> NDArray[np.float64]:
    """Return where wrist, elbow and shoulder are: paths to head and foot part at the shoulder."""
    path = cut(body, hand, belly, body.branch(hand, head, foot))
    return along(path, np.array([WRIST, ELBOW, 1.0]))


def _leg(
    body: Interior, sole: int, hips: NDArray[np.float64], height: float, robe: bool, sign: int
) -> Joints:
    points, y = body.points, body.points[:, 1] - body.floor
    low = (y < BIPED_SOLE * body.height) & (sign * points[:, 0] > 0)
    ground = points[sole]
    toes = points[low] if low.any() else ground[None]
    heel, toe_tip = np.quantile(toes[:, 2], [0.02, 0.98])
    ankle_height = max(ANKLE * height, 0.02 * body.height)
    ankle = np.array([ground[0], body.floor + ankle_height, ground[2]])
    top = np.array([0.8 * ground[0], body.floor + height, hips[2]])
    if robe:
        knee = ankle + (KNEE - ANKLE) / (1 - ANKLE) * (top - ankle)
    else:
        path = body.middle_path(sole, body.nearest(hips))
        level = path[:, 1] - body.floor
        knee = path[np.abs(level - KNEE * height).argmin()]
        ankle = path[np.abs(level - (ankle[1] - body.floor)).argmin()].copy()
        thigh = path[np.abs(level - 0.75 * height).argmin()]
        # On the line of the thigh: the path itself turns to the middle early.
        rise = (height - (knee[1] - body.floor)) / max(thigh[1] - knee[1], 1e-9)
        top = knee + (thigh - knee) * rise
        outer = abs(ground[0]) + 0.05 * body.height
        top[0] = sign * np.clip(sign * top[0], 0.03 * body.height, outer)
    ankle[2] = min(ankle[2], heel + 0.5 * (toe_tip - heel))
    toe_height = body.floor + 0.3 * (ankle[1] - body.floor)
    toe = np.array([ground[0], toe_height, heel + 0.72 * (toe_tip - heel)])
    return {"thigh": top, "shin": knee, "foot": ankle, "toe": toe}


def _middle_at(body: Interior, height: float) -> NDArray[np.float64]:
    """Return the middle of the trunk at a height above the ground."""
    points = body.points
    level = points[:, 1] - body.floor
    near = np.abs(level - height) < 1.5 * body.cell
    middle = near & (np.abs(points[:, 0]) < 0.1 * np.abs(points[:, 0]).max() + body.cell)
    if not middle.any():
        middle = near if near.any() else np.ones(len(points), np.bool_)
    return np.array([0.0, height + body.floor, points[body.deepest(middle), 2]])
