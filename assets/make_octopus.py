"""The octopus: eight arms, each curling in its own way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .body import Body
from .build import closed_character
from .character import Bones, Character, Material, Motion
from .motion import X, Y, Z, loop, move, phase, rotate, turn, wave
from .sdf import ball, chain, common, ellipsoid, half_space, shell, shifted, unit

MATERIALS = {
    "skin": Material("skin", "#d9627a", roughness=0.45),
    "under": Material("underside", "#f6c7b6", roughness=0.55),
    "spot": Material("spots", "#b8456a", roughness=0.45),
    "white": Material("eye white", "#fdfaf2", roughness=0.3),
    "eye": Material("pupil", "#26202b", roughness=0.2),
    "light": Material("glint", "#ffffff", roughness=0.3),
}

JOINTS, STEPS = 6, 36
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

LENGTH = 1.0


def make() -> Character:
    """Return the octopus."""
    bones, body = Bones(), Body()
    bones.add("body", None, [0, 0.25, 0])
    bones.add("mantle", "body", [0, 0.38, -0.01])
    bones.add("crown", "mantle", [0, 0.57, -0.09])
    _head(body)
    for k in range(len(CURLS)):
        line, _, _ = _arm_line(k)
        bones.add_chain(f"arm{'ABCDEFGH'[k]}", "body", line[:: STEPS // JOINTS][:JOINTS])
        _arm(body, k)
    box = [[-1.0, -0.03, -1.0], [1.0, 1.0, 1.0]]
    return closed_character("Octopus", bones, body, box, 0.006, MATERIALS, _sway())


def _head(body: Body) -> None:
    body.add(ellipsoid([0, 0.25, 0], [0.205, 0.14, 0.195]), "body", edge=0.026)
    body.add(ellipsoid([0, 0.41, 0], [0.215, 0.17, 0.2]), "mantle", blend=0.1, edge=0.028)
    back = unit([0, 1, -0.55])
    tilt = np.array([[1, 0, 0], back, np.cross([1, 0, 0], back)])
    body.add(ellipsoid([0, 0.63, -0.13], [0.29, 0.31, 0.265], tilt), "crown", blend=0.12, edge=0.03)
    _face(body)
    for place, size in (
        ([0.15, 0.83, 0.02], 0.06),
        ([0.055, 0.89, -0.06], 0.04),
        ([-0.19, 0.78, 0.02], 0.05),
        ([0.26, 0.68, -0.16], 0.055),
        ([-0.1, 0.91, -0.24], 0.065),
        ([-0.28, 0.68, -0.12], 0.04),
        ([0.09, 0.75, -0.41], 0.06),
        ([-0.12, 0.62, -0.38], 0.045),
    ):
        body.colour(ball(place, size), "spot", 0.016)


def _face(body: Body) -> None:
    centre = np.array([0.128, 0.455, 0.148])
    body.add(ball([0.122, 0.455, 0.125], 0.092), "mantle", both=True, blend=0.05, edge=0.016)
    body.add(ball(centre, 0.083), "mantle", both=True, blend=0.003, edge=0.012, colour="white")
    # A lid, lowered a little: it makes the look a friendly one.
    down = unit([0.12, -1, 0.55])
    lid = common(ball(centre, 0.092), half_space(centre - down * 0.028, down), 0.008)
    body.add(lid, "mantle", both=True, blend=0.004, edge=0.012)
    pupil = centre + unit([0.06, 0.02, 1]) * 0.078
    body.colour(ellipsoid(pupil, [0.031, 0.04, 0.035]), "eye", 0.01, both=True)
    for side in (1, -1):
        glint = shifted(pupil * [side, 1, 1], 0.005, 0.014, 0.006)
        body.colour(ball(glint, 0.0115), "light", 0.006)
    smile = [[-0.075, 0.345], [-0.04, 0.318], [0, 0.309], [0.04, 0.318], [0.075, 0.345]]
    line = [[x, y, _front(body, x, y)] for x, y in smile]
    mouth = chain(line, [0.005, 0.011, 0.013, 0.011, 0.005])
    body.add(mouth, "mantle", blend=0.01, edge=0.009, carve=True)
    body.colour(shell(mouth, 0.002), "spot", 0.009)


def _front(body: Body, x: float, y: float) -> float:
    """Return where the surface is, coming from the front, by halving."""
    near, far = 0.4, 0.0
    for _ in range(40):
        middle = (near + far) / 2
        inside = body.distance(np.array([[x, y, middle]]))[0] < 0
        near, far = (near, middle) if inside else (middle, far)
    return near


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
            pitch += upward * step * 2.3 * (s - start) / (1 - start)
        heading += sideways * step * (1.6 if s > 0.15 else 0.0)
        p, h = np.radians([pitch, heading])
        ahead = np.cos(h) * out + np.sin(h) * side
        line.append(line[-1] + step * (np.cos(p) * ahead + np.sin(p) * Y))
        under.append(np.sin(p) * ahead - np.cos(p) * Y)
    along = np.linspace(0, 1, STEPS + 1)
    radii = 0.076 * (1 - along) + 0.013 * along
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
    body.colour(chain(belly[10:], 0.72 * radii[10:]), "under", 0.02)
    for i in range(14, STEPS, 2):
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
        _, side = _direction(k)
        for j in range(JOINTS):
            late = 0.09 * j + 0.375 * k
            lift = (4 + 2.2 * j) * wave(t, late) - (2 if j else 4)
            swing = (3 + 1.6 * j) * wave(t, late + 0.25)
            rotate(motion, f"arm{'ABCDEFGH'[k]}{j + 1}", turn(Y, swing), turn(-side, lift))
    return motion
