"""The walker's clip: two steps on the spot."""

from __future__ import annotations

from .biped_bones import FINGERS
from .character import Motion
from .motion import X, Y, Z, curve, loop, move, phase, rotate, turn, wave


def walk() -> Motion:
    """Return a walk on the spot, two steps in 1.2 seconds."""
    motion = loop("walk", 1.2, 30)
    t = phase(motion)
    move(motion, "hips", 0.012 * wave(t, 0.02), 0.014 * wave(t, 0.12, 2) - 0.014, 0)
    rotate(motion, "hips", turn(Y, 6 * wave(t, 0.25)), turn(Z, 2.5 * wave(t, 0.02)))
    rotate(motion, "spine1", turn(Y, -4 * wave(t, 0.25)), turn(X, 2))
    rotate(motion, "spine2", turn(Y, -4 * wave(t, 0.25)), turn(Z, -2.5 * wave(t, 0.02)))
    rotate(motion, "chest", turn(Y, -4 * wave(t, 0.25)), turn(X, 1.5 * wave(t, 0.3, 2)))
    rotate(motion, "head", turn(Y, 5 * wave(t, 0.25)), turn(X, -2 + 1.5 * wave(t, 0.2, 2)))
    for side, sign, late in (("L", 1, 0.0), ("R", -1, 0.5)):
        # Eight keys a cycle: heel down, flat, passing, heel up, toe off, swing, swing, reach.
        rotate(motion, f"thigh.{side}", turn(X, curve(t, [-27, -19, -5, 9, 17, 2, -20, -32], late)))
        rotate(motion, f"shin.{side}", turn(X, curve(t, [4, 14, 9, 6, 26, 50, 44, 16], late)))
        rotate(motion, f"foot.{side}", turn(X, curve(t, [-14, 1, -2, -8, 10, 14, -4, -13], late)))
        rotate(motion, f"toe.{side}", turn(X, curve(t, [-4, 0, 0, -10, -28, -4, 0, -4], late)))
        swing = wave(t, 0.25 + late)  # the arm goes with the other leg
        rotate(motion, f"clavicle.{side}", turn(Y, -3 * swing))
        rotate(motion, f"upper_arm.{side}", turn(X, -3 - 22 * swing), turn(Z, sign * 3))
        rotate(motion, f"forearm.{side}", turn(X, -18 - 13 * wave(t, 0.3 + late)))
        rotate(motion, f"hand.{side}", turn(X, -4 - 6 * wave(t, 0.38 + late)))
        for name in FINGERS:
            for k in (1, 2, 3):
                rotate(motion, f"{name}{k}.{side}", turn(Z, -sign * (9 + 3 * k)))
    return motion
