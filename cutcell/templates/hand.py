"""Template of a hand: fingers are named by the position of the thumb."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import SkeletonError
from .frame import Joints
from .interior import Interior, along, cut

FINGER_NAMES = {
    2: ("index", "pinky"),
    3: ("index", "middle", "pinky"),
    4: ("index", "middle", "ring", "pinky"),
}
"""Names of the fingers other than the thumb, by their number."""
MIN_FINGER = 0.3
"""Least length of a finger, in lengths of the longest one."""
MAX_ENDS = 16
CLIMB = 5
"""Search radius for the next point along a finger, in lattice cells."""
BACK = -0.3
"""Cosine of the angle between a finger and all of them: what is less points to the wrist."""
MIN_OF_HAND = 0.25
"""Least length of the longest finger, as a share of the path from the wrist to its tip."""
KNUCKLES = np.array([1.0, 0.58, 0.28])
"""Shares of the path from the tip of a finger to the palm."""


def place(body: Interior) -> Joints:
    """Return where the joints are: the hand, and three of each finger, the thumb first."""
    wrist, tips = _ends(body)
    lengths = {  # from the tip to where the finger parts from the nearest other one
        tip: min((body.branch(tip, other, wrist) for other in tips if other != tip), default=0.0)
        for tip in tips
    }
    longest = max(lengths.values(), default=0.0)
    if longest < MIN_OF_HAND * body.distances(wrist).max():
        tips = []
    tips = [tip for tip in tips if lengths[tip] > MIN_FINGER * longest]
    if len(tips) < 3:
        raise SkeletonError(
            "no three fingers were found in the mesh; choose another template, such as chain"
        )
    tips = _in_order(body, wrist, sorted(tips, key=lambda tip: -lengths[tip])[:5])
    palm = body.deepest(body.distances(wrist) < 0.6 * min(body.distances(wrist)[tips]))
    joints: Joints = {"hand": along(body.middle_path(wrist, palm), np.array([0.15]))[0]}
    for name, tip in zip(("thumb", *FINGER_NAMES[len(tips) - 1]), tips, strict=True):
        path = cut(body, tip, palm, lengths[tip])
        for number, at in enumerate(along(path, KNUCKLES), start=1):
            joints[f"{name}.{number}"] = at
    return joints


def names() -> list[tuple[str, ...]]:
    """Return the names of the joints of hands with three, four and five fingers."""
    numbers = range(1, len(KNUCKLES) + 1)
    return [
        ("hand", *(f"{finger}.{n}" for finger in ("thumb", *fingers) for n in numbers))
        for fingers in FINGER_NAMES.values()
    ]


def parents_of(joints: Joints) -> dict[str, str]:
    """Return the parent of each joint, "" for none."""
    before = {"": "", "1": "hand"}
    split = {name: name.partition(".") for name in joints}
    return {
        name: before[number] if number in before else f"{finger}.{int(number) - 1}"
        for name, (finger, _, number) in split.items()
    }


def _ends(body: Interior) -> tuple[int, list[int]]:
    """Return the node at the wrist, and the ends of what may be fingers."""
    away = np.linalg.norm(body.points - body.points.mean(axis=0), axis=1)
    centre = body.deepest(away <= away.min() + 0.25 * np.ptp(away))
    far = body.distances(centre)
    tips: list[int] = []
    nearest = far.copy()
    for _ in range(MAX_ENDS):
        tip = int(nearest.argmax())
        nearest = np.minimum(nearest, body.distances(tip))
        tip = _climbed(body, far, tip)
        if (body.distances(tip)[tips] > CLIMB * body.cell).all():
            tips.append(tip)
    fingers: list[int] = []
    for tip in sorted(tips, key=lambda tip: -far[tip]):
        if all(body.branch(tip, other, centre) > MIN_OF_HAND / 2 * far.max() for other in fingers):
            fingers.append(tip)  # none of a finger whose tip is known
    from_centre = body.points - body.points[centre]
    ways = from_centre / np.maximum(np.linalg.norm(from_centre, axis=1, keepdims=True), 1e-9)
    for _ in range(2):  # without what is on the wrist's side
        out = np.median(ways[fingers], axis=0)  # whatever the thumb does
        fingers = [tip for tip in fingers if ways[tip] @ out > BACK * np.linalg.norm(out)]
    along_out = from_centre @ out
    end = np.flatnonzero(along_out < along_out.min() + 2 * body.cell)
    return body.nearest(body.points[end].mean(axis=0)), fingers


def _climbed(body: Interior, far: NDArray[np.float64], node: int) -> int:
    """Return the node that is reached by always going to where it is farthest nearby."""
    while True:
        near = np.flatnonzero(body.distances(node) < CLIMB * body.cell)
        best = int(near[far[near].argmax()])
        if far[best] <= far[node]:
            return node
        node = best


def _in_order(body: Interior, wrist: int, tips: list[int]) -> list[int]:
    """Return the tips from the thumb to the little finger."""
    ways = body.points[tips] - body.points[wrist]
    out = ways.mean(axis=0)
    out /= np.linalg.norm(out)
    flat = ways - np.outer(ways @ out, out)
    across = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)[2][0]
    order = [tips[k] for k in np.argsort(flat @ across)]
    far = body.distances(wrist)

    # The thumb is the outer one that parts from its neighbour nearer to the wrist.
    first, last = (
        far[tip] - body.branch(tip, neighbour, wrist)
        for tip, neighbour in ((order[0], order[1]), (order[-1], order[-2]))
    )
    return order if first <= last else order[::-1]
