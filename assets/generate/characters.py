"""Characters made from a number: bodies, hands, beasts, octopuses and robots, all different."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_choice, check_flag, check_integer
from cutcell.errors import MissingLibraryError
from cutcell.rig import Rig, TriangleMesh

from .shapes import Limbs, boxed, melted

Kind = Literal["body", "hand", "beast", "octopus", "robot", "person"]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""What can be generated; "person" takes the package anny."""
MIN_DETAIL, MAX_DETAIL = 12, 512
HOLES, LOOSE, SOUP = 0.15, 0.15, 0.1
"""Shares of characters with holes, with loose parts, and whose triangles share no vertices."""

Random = np.random.Generator


def generate(kind: Kind, seed: int, *, detail: int = 48, clean: bool = False) -> Rig:
    """Make a character with weights; the same one for the same arguments.

    Proportions and pose are drawn. Some have holes, some loose parts, some are soups.

    Parameters
    ----------
    kind : {"body", "hand", "beast", "octopus", "robot", "person"}
        "person" is one of MakeHuman's bodies with its hand-made weights, from the package anny.
    seed : int
        0 or more.
    detail : int
        Samples of the surface along the longest side, 12 to 512; the mesh has about
        detail² vertices.
    clean : bool
        Whether to leave out holes, loose parts and soups.

    Returns
    -------
    Rig

    Raises
    ------
    ParameterError
        An argument is out of its range.
    MissingLibraryError
        scikit-image, or for a person anny, is not installed.

    Examples
    --------
    >>> rig = generate("beast", 7)  # doctest: +SKIP
    """
    kind = check_choice("kind", kind, KINDS)
    seed = check_integer("seed", seed, 0, 2**63 - 1)
    detail = check_integer("detail", detail, MIN_DETAIL, MAX_DETAIL)
    check_flag("clean", clean)
    random = np.random.default_rng([KINDS.index(kind), seed])
    if kind == "person":
        rig = _person(random)
    elif kind == "robot":
        rig = boxed(_body(random), detail)
    else:
        rig = melted(MAKERS[kind](random), detail, float(random.uniform(0.01, 0.03)))
    if not clean:
        rig = _spoilt(rig, random)
    return replace(rig, name=f"{kind}_{seed}")


def _body(random: Random) -> Limbs:
    limbs = Limbs()
    tall, stout = random.uniform(0.85, 1.2), random.uniform(0.7, 1.5)
    leg, arm = 0.48 * random.uniform(0.8, 1.15), 0.36 * random.uniform(0.8, 1.25)
    hips = np.array([0, leg + 0.05, 0])
    spine = _bent(random, hips, [0, 1, 0], 0.4 * tall, 4, 10)
    limbs.add("hips", -1, hips, spine[1], 0.09 * stout, 0.1 * stout)
    limbs.add("spine", 0, spine[1], spine[2], 0.1 * stout, 0.11 * stout)
    limbs.add("chest", 1, spine[2], spine[3], 0.11 * stout, 0.09 * stout)
    limbs.add("neck", 2, spine[3], spine[4], 0.05, 0.045)
    top = spine[4] + [0, 0.14 * random.uniform(0.8, 1.6), random.uniform(-0.03, 0.05)]
    limbs.add("head", 3, spine[4], top, 0.07 * random.uniform(0.8, 1.4), 0.08)
    lift = random.uniform(-75, 20)
    for side, name in ((1, "left"), (-1, "right")):
        shoulder = spine[3] + [side * 0.1 * stout, 0, 0]
        collar = limbs.add(f"{name}_collar", 2, spine[3], shoulder, 0.05, 0.05)
        out = [side * np.cos(np.radians(lift)), np.sin(np.radians(lift)), 0]
        line = _bent(random, shoulder + np.array(out) * 0.05, out, arm, 3, 25)
        limbs.chain(f"{name}_arm", collar, line, np.array([0.05, 0.04, 0.032, 0.03]) * stout)
        hip = np.add(hips, [side * 0.09 * stout, -0.02, 0])
        line = _bent(random, hip, [side * random.uniform(0, 0.25), -1, 0], leg, 2, 14)
        shin = limbs.chain(f"{name}_leg", 0, line, np.array([0.075, 0.055, 0.04]) * stout)
        foot = line[-1] + [side * 0.02, -0.02, 0.1]
        limbs.add(f"{name}_foot", shin, line[-1], foot, 0.04, 0.03)
    return limbs


def _hand(random: Random) -> Limbs:
    limbs = Limbs()
    palm = 0.3 * random.uniform(0.8, 1.2)
    limbs.add("wrist", -1, [0, -0.2, 0], [0, 0, 0], 0.1, 0.1)
    middle = limbs.add("palm", 0, [0, 0, 0], [0, palm * 0.7, 0], 0.13, 0.14)
    curl = random.uniform(0, 55)
    for k, name in enumerate(("index", "middle", "ring", "little")):
        x = (k - 1.5) * 0.1
        start = np.array([x, palm, 0])
        length = (0.34, 0.38, 0.35, 0.27)[k] * random.uniform(0.8, 1.25)
        joints = [start]
        for j in range(3):
            bend = np.radians(curl * (0.3 + 0.5 * j) + random.uniform(-8, 8))
            step = np.array([x * 0.3, np.cos(bend), np.sin(bend)])
            joints.append(joints[-1] + step * length / 3)
        limbs.chain(name, middle, joints, np.array([0.042, 0.037, 0.033, 0.028]))
    line = _bent(random, [-0.14, 0.05, 0.02], [-0.75, 0.6, 0.25], 0.32, 3, 18)
    limbs.chain("thumb", middle, line, np.array([0.055, 0.048, 0.042, 0.032]))
    return limbs


def _beast(random: Random) -> Limbs:
    limbs = Limbs()
    long, stout = random.uniform(0.5, 0.95), random.uniform(0.7, 1.4)
    leg = random.uniform(0.25, 0.55)
    back = _bent(random, [0, leg, -long / 2], [0, random.uniform(-0.1, 0.2), 1], long, 3, 8)
    widths = np.array([0.11, 0.12, 0.13, 0.1]) * stout
    last = limbs.chain("back", -1, back, widths)
    neck = _bent(random, back[-1], [0, random.uniform(0.2, 1.2), 1],
                 random.uniform(0.12, 0.4), 2, 18)  # fmt: skip
    last = limbs.chain("neck", last, neck, np.array([0.08, 0.065, 0.055]) * stout)
    muzzle = neck[-1] + [0, random.uniform(-0.08, 0.02), random.uniform(0.12, 0.25)]
    head = limbs.add("head", last, neck[-1], muzzle, 0.075 * stout, 0.04)
    for side, name in ((1, "left"), (-1, "right")):
        ear = neck[-1] + [side * 0.05, 0.05, 0]
        tip = np.add(ear, [side * 0.03, random.uniform(0.04, 0.18), 0])
        limbs.add(f"{name}_ear", head, ear, tip, 0.025, 0.015)
        for place, parent, end in ((back[0], 0, "hind"), (back[-1], 2, "fore")):
            start = np.add(place, [side * 0.07 * stout, -0.03, 0])
            line = _bent(random, start, [side * 0.05, -1, 0], leg, 3, 16)
            limbs.chain(
                f"{end}_{name}", parent, line, np.array([0.06, 0.045, 0.034, 0.035]) * stout
            )
    tail = _bent(random, back[0], [0, random.uniform(-0.4, 0.6), -1],
                 random.uniform(0.15, 0.6), 4, 20)  # fmt: skip
    limbs.chain("tail", 0, tail, np.array([0.045, 0.038, 0.03, 0.024, 0.018]))
    return limbs


def _octopus(random: Random) -> Limbs:
    limbs = Limbs()
    count = int(random.integers(5, 10))
    size = random.uniform(0.14, 0.24)
    limbs.add("body", -1, [0, 0, 0], [0, size, 0], size, size * 0.9)
    top = [0, size + random.uniform(0.1, 0.35), random.uniform(-0.2, 0.05)]
    limbs.add("mantle", 0, [0, size, 0], top, size, size * 0.8)
    for k in range(count):
        angle = 2 * np.pi * k / count
        out = np.array([np.cos(angle), random.uniform(-0.5, 0.2), np.sin(angle)])
        line = _bent(random, out * size * 0.8, out, random.uniform(0.5, 0.9), 5, 28)
        limbs.chain(f"arm_{k + 1}", 0, line, np.linspace(0.07, 0.02, 6))
    return limbs


MAKERS: dict[str, Callable[[Random], Limbs]] = {
    "body": _body,
    "hand": _hand,
    "beast": _beast,
    "octopus": _octopus,
}


def _bent(
    random: Random, start: object, way: object, length: float, pieces: int, degrees: float
) -> NDArray:
    """Return a line of straight pieces, each turned from the last; shape (pieces + 1, 3)."""
    place, ahead = np.asarray(start, float), np.asarray(way, float)
    ahead = ahead / np.linalg.norm(ahead)
    line = [place]
    for _ in range(pieces):
        ahead = ahead + np.tan(np.radians(random.uniform(0, degrees))) * _across(random, ahead)
        ahead /= np.linalg.norm(ahead)
        place = place + ahead * length / pieces
        line.append(place)
    return np.array(line)


def _across(random: Random, ahead: NDArray) -> NDArray:
    other = random.normal(size=3)
    other -= ahead * (other @ ahead)
    return other / np.linalg.norm(other)


def _spoilt(rig: Rig, random: Random) -> Rig:
    """Return a character with what is wrong with those on the web, some of the time."""
    if rig.weights is None:
        return rig
    holes, loose, soup = random.random(3) < (HOLES, LOOSE, SOUP)
    vertices, weights = rig.mesh.vertices, rig.weights
    faces = rig.mesh.faces.astype(np.int64)
    if holes:
        size = np.ptp(vertices, axis=0).max()
        for _ in range(int(random.integers(1, 4))):
            centre = vertices[random.integers(len(vertices))]
            away = np.linalg.norm(vertices[faces].mean(axis=1) - centre, axis=1)
            rest = faces[away > 0.04 * size]
            faces = rest if len(rest) > 100 else faces
    if loose:
        count = int(random.integers(1, 6))
        vertices, faces, weights = _with_buttons(vertices, faces, weights, count, random)
    if soup:
        weights, vertices = weights[faces.ravel()], vertices[faces.ravel()]
        faces = np.arange(len(vertices)).reshape(-1, 3)
    return replace(rig, mesh=TriangleMesh(vertices, faces), weights=weights, parts=())


def _with_buttons(
    vertices: NDArray, faces: NDArray, weights: NDArray, count: int, random: Random
) -> tuple[NDArray, NDArray, NDArray]:
    """Put small octahedra on the surface, each held by the vertex that it sits on."""
    size = np.ptp(vertices, axis=0).max()
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    sides = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2],
                      [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])  # fmt: skip
    for _ in range(count):
        on = int(random.integers(len(vertices)))
        faces = np.concatenate([faces, sides + len(vertices)])
        button = vertices[on] + corners * size * random.uniform(0.008, 0.025)
        vertices = np.concatenate([vertices, button])
        weights = np.concatenate([weights, np.repeat(weights[on][None], 6, axis=0)])
    return vertices, faces, weights


def _person(random: Random) -> Rig:
    try:
        import anny  # noqa: F401
    except ImportError:
        raise MissingLibraryError(
            "people are made by anny, which is not installed; try: pip install anny"
        ) from None
    from .people import person

    return person(random)
