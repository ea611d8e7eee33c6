"""The octopus: eight arms, each curling in its own way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .build import closed_character
from .character import Bones, Character, Material, Motion
from .motion import X, Y, Z, loop, move, phase, rotate, turn, wave
from .sdf import Body, ball, chain, ellipsoid, shell, unit

MATERIALS = {
    "skin": Material("skin", "#d9627a", roughness=0.45),
    "under": Material("underside", "#f6c7b6", roughness=0.55),
    "spot": Material("spots", "#b8456a", roughness=0.45),
    "white": Material("eye white", "#fdfaf2", roughness=0.3),
    "eye": Material("pupil", "#26202b", roughness=0.2),
    "light": Material("glint", "#ffffff", roughness=0.3),
}

JOINTS, STEPS = 6, 18
"""Joints an arm, and the straight pieces that it is built of."""

CURLS = (
    # how far the arm turns up (degrees a metre), where its curl starts, sideways bend
    (400, 0.42, 24),
    (520, 0.50, 40),
    (440, 0.40, 30),
    (380, 0.45, 18),
    (540, 0.52, 38),
    (430, 0.44, 28),
    (500, 0.48, 36),
    (390, 0.41, 20),
)

LENGTH = 0.92


def make() -> Character:
    """Return the octopus."""
    bones, body = Bones(), Body()
    bones.add("body", None, [0, 0.27, 0])
    bones.add("mantle", "body", [0, 0.52, -0.03])
    bones.add("crown", "mantle", [0, 0.80, -0.09])
    _head(body)
    for k in range(len(CURLS)):
        line, _, _ = _arm_line(k)
        bones.add_chain(f"arm{'ABCDEFGH'[k]}", "body", line[:: STEPS // JOINTS][:JOINTS])
        _arm(body, k)
    box = [[-0.95, -0.03, -0.95], [0.95, 1.1, 0.95]]
    return closed_character("Octopus", bones, body, box, 0.0065, MATERIALS, _sway())


def _head(body: Body) -> None:
    body.add(ellipsoid([0, 0.27, 0], [0.19, 0.15, 0.18]), "body", edge=0.026)
    body.add(ball([0, 0.5, -0.01], 0.185), "mantle", blend=0.12, edge=0.028)
    tilt = np.array([[1, 0, 0], [0, *unit([1, -0.3])], [0, *unit([0.3, 1])]])
    body.add(ellipsoid([0, 0.74, -0.07], [0.255, 0.27, 0.25], tilt), "crown", blend=0.16, edge=0.03)
    lid = ball([0.12, 0.46, 0.135], 0.082)
    body.add(lid, "mantle", both=True, blend=0.05, edge=0.016)
    look = unit([0.35, 0.12, 1])
    white = ball([0.125, 0.462, 0.16], 0.071)
    body.add(white, "mantle", both=True, blend=0.004, edge=0.012, colour="white")
    pupil = np.array([0.125, 0.462, 0.16]) + look * 0.066
    body.colour(ellipsoid(pupil, [0.03, 0.038, 0.03]), "eye", 0.01, both=True)
    for x in (1, -1):
        spot = pupil * [x, 1, 1] + [0.008, 0.018, 0.012]
        body.colour(ball(spot, 0.012), "light", 0.006)
    smile = chain(
        [
            [-0.06, 0.375, 0.166],
            [-0.03, 0.358, 0.178],
            [0, 0.353, 0.182],
            [0.03, 0.358, 0.178],
            [0.06, 0.375, 0.166],
        ],
        [0.004, 0.009, 0.010, 0.009, 0.004],
    )
    body.add(smile, "mantle", blend=0.012, edge=0.009, carve=True)
    body.colour(shell(smile, 0.002), "spot", 0.009)
    for place, size in (
        ([0.14, 0.86, 0.1], 0.055),
        ([0.06, 0.94, 0.06], 0.035),
        ([-0.17, 0.8, 0.1], 0.042),
        ([0.2, 0.75, -0.13], 0.05),
        ([-0.1, 0.93, -0.15], 0.06),
        ([-0.24, 0.72, -0.08], 0.035),
        ([0.08, 0.8, -0.31], 0.055),
        ([-0.1, 0.68, -0.31], 0.04),
    ):
        body.colour(ball(place, size), "spot", 0.016)


def _direction(k: int) -> tuple[NDArray, NDArray]:
    """Return where an arm leaves to, and what lies to its left; arm A is front left."""
    angle = np.pi / 8 + k * np.pi / 4
    out = np.round([np.sin(angle), 0, np.cos(angle)], 9)
    return out, np.cross(Y, out)


def _arm_line(k: int) -> tuple[NDArray, NDArray, NDArray]:
    """Return the arm's middle line, its radii, and where its underside is: down, along, up.

    Shapes (STEPS + 1, 3), (STEPS + 1,) and (STEPS + 1, 3).
    """
    out, side = _direction(k)
    upward, start, sideways = CURLS[k]
    step = LENGTH / STEPS
    pitch, heading = -38.0, 0.0
    line, under = [out * 0.12 + Y * 0.19], []
    for i in range(STEPS + 1):
        s = i / STEPS
        if s < 0.28:
            pitch = min(0.0, pitch + 38 / (0.28 * STEPS))  # reach the ground and lie on it
        elif s > start:
            pitch += upward * step * 2 * (s - start) / (1 - start)
        heading += sideways * step * (1.6 if s > 0.15 else 0.0)
        p, h = np.radians([pitch, heading])
        ahead = np.cos(h) * out + np.sin(h) * side
        line.append(line[-1] + step * (np.cos(p) * ahead + np.sin(p) * Y))
        under.append(np.sin(p) * ahead - np.cos(p) * Y)
    s = np.linspace(0, 1, STEPS + 1)
    radii = 0.076 * (1 - s) + 0.017 * s
    places = np.array(line[:-1])
    places[:, 1] += radii - radii[0]
    places[:, 1] -= (places[:, 1] - radii).min() - 0.004
    return np.round(places, 6), np.round(radii, 6), np.round(under, 6)


def _arm(body: Body, k: int) -> None:
    name = f"arm{'ABCDEFGH'[k]}"
    line, radii, under = _arm_line(k)
    per = STEPS // JOINTS
    for j in range(JOINTS):
        piece = slice(j * per, (j + 1) * per + 1)
        at, reach, blend = (line[0], 0.2, 0.07) if j == 0 else (line[j * per], 0.06, 0.003)
        edge = float(0.27 * radii[piece].mean() + 0.005)
        shape = chain(line[piece], radii[piece])
        body.add(shape, f"{name}{j + 1}", at=at, reach=reach, blend=blend, edge=edge)
    belly = line + under * radii[:, None]
    body.colour(chain(belly[5:], 0.72 * radii[5:]), "under", 0.02)
    for i in range(7, STEPS, 1):
        sucker = ellipsoid(belly[i], np.full(3, 0.42 * radii[i]))
        edge = float(0.16 * radii[i] + 0.003)
        body.add(
            sucker,
            f"{name}{i // per + 1}",
            at=belly[i],
            reach=0.05,
            blend=0.004,
            colour="under",
            edge=edge,
        )


def _sway() -> Motion:
    """Return arms that wave one after the other, and a breathing mantle."""
    motion = loop("wave", 3.0, 60)
    t = phase(motion)
    move(motion, "body", 0, 0.015 * wave(t, 0, 2) + 0.015, 0)
    rotate(motion, "mantle", turn(X, 3 * wave(t, 0.1)), turn(Z, 4 * wave(t, 0.3)))
    rotate(motion, "crown", turn(X, -5 * wave(t, 0.0)), turn(Z, 5 * wave(t, 0.2)))
    for k in range(len(CURLS)):
        out, side = _direction(k)
        for j in range(JOINTS):
            late = 0.09 * j + 0.375 * k
            lift = (4 + 2.2 * j) * wave(t, late) - (2 if j else 4)
            swing = (3 + 1.6 * j) * wave(t, late + 0.25)
            rotate(motion, f"arm{'ABCDEFGH'[k]}{j + 1}", turn(Y, swing), turn(-side, lift))
    return motion
