"""The walker's joints: 52 of them, fifteen in each hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .character import Bones
from .motion import X, Z
from .sdf import unit

DOWN = unit([-0.06, -1.0, 0.08])
"""Where the hanging hand points."""

FINGERS = {
    # place at the knuckle (sideways, down), fan, lengths, radius at the root
    "index": (0.0355, 0.085, 0.13, (0.036, 0.026, 0.021), 0.0108),
    "middle": (0.0118, 0.090, 0.04, (0.040, 0.029, 0.022), 0.0112),
    "ring": (-0.0118, 0.087, -0.05, (0.036, 0.026, 0.021), 0.0108),
    "pinky": (-0.0345, 0.078, -0.15, (0.029, 0.021, 0.018), 0.0097),
}


def skeleton() -> Bones:
    """Return the walker's joints."""
    bones = Bones()
    bones.add("hips", None, [0, 0.80, 0])
    bones.add("spine1", "hips", [0, 0.885, -0.005])
    bones.add("spine2", "spine1", [0, 0.975, -0.008])
    bones.add("chest", "spine2", [0, 1.06, -0.008])
    bones.add("neck", "chest", [0, 1.18, -0.01])
    bones.add("head", "neck", [0, 1.25, 0.0])
    bones.add("clavicle.L", "chest", [0.03, 1.12, -0.005], both=True)
    bones.add("upper_arm.L", "clavicle.L", [0.138, 1.105, -0.008], both=True)
    bones.add("forearm.L", "upper_arm.L", [0.196, 0.905, -0.018], both=True)
    bones.add("hand.L", "forearm.L", [0.224, 0.72, 0.006], both=True)
    for name, places in finger_places(bones["hand.L"]).items():
        bones.add_chain(f"{name}.L", "hand.L", places[:3], both=True)
    bones.add("thigh.L", "hips", [0.078, 0.765, 0], both=True)
    bones.add("shin.L", "thigh.L", [0.086, 0.425, 0.012], both=True)
    bones.add("foot.L", "shin.L", [0.09, 0.095, -0.022], both=True)
    bones.add("toe.L", "foot.L", [0.1, 0.03, 0.085], both=True)
    return bones


def finger_places(wrist: NDArray) -> dict[str, NDArray]:
    """Return the three joints and the tip of each left finger, shape (4, 3) each."""
    result = {}
    bend = np.array([-0.1, 0, 0])  # each segment leans a bit more to the palm
    for name, (side, reach, fan, lengths, _) in FINGERS.items():
        places = [wrist + DOWN * reach + Z * side]
        for k, length in enumerate(lengths):
            places.append(places[-1] + length * unit(DOWN + fan * Z + bend * (k + 0.3)))
        result[name] = np.array(places)
    thumb = [wrist + DOWN * 0.02 + Z * 0.026 - X * 0.004]
    for direction, length in zip(
        ([-0.12, -0.72, 0.72], [-0.12, -0.9, 0.5], [-0.12, -1, 0.25]),
        (0.041, 0.032, 0.026),
        strict=True,
    ):
        thumb.append(thumb[-1] + length * unit(direction))
    result["thumb"] = np.array(thumb)
    return result
