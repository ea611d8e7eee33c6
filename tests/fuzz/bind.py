"""Fuzz `bind`: whatever mesh, skeleton and options it is given, weights come out, or a sentence.

python -m tests.fuzz.bind --count 2000
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.random import Generator

import cutcell
from cutcell.weights import warm_up as compilation

from .harness import main
from .shapes import KINDS, mesh_of

SEEDS = 17, 20, 36, 52, 86, 112, 184, 250, 305, 338, 748, 1244, 1378, 1512, 1712, 1758, 1919, 3381
"""Cases that failed once. How cases are made of numbers must not change, or these are others."""
EXACT = 1e-9
LONGEST_SENTENCE = 2000

OPTIONS: dict[str, list[Any]] = {
    "resolution": [2, 3, 4, 7, 8, 12, 16, 16, 24, 33],
    "connectivity": ["any", "any", "any", 6, 26],
    "winding_threshold": [0.5, 0.5, 0.5, 0, 1, 0.1, 0.9],
    "samples": [5, 1, 2, 17],
    "leaf": [None, "fit", "point", "extend"],
    "falloff": ["rig", "rig", "paper"],
    "alpha": [0.5, 0, 1],
    "max_influences": [4, 4, 1, 2, 8, None],
    "threshold": [0.0, 0.01, 0.3, 1],
    "smoothing": [0, 0, 1, 20],
    "symmetric": [False, False, True],
    "locked": [(), (), (0,), ("joint 0",)],
}
NUMBERS = (np.int8, np.uint64, np.float32, np.float64)
ODD: list[Any] = [
    None,
    -1,
    0,
    1.5,
    True,
    10**30,
    -(10**30),
    1e308,
    np.nan,
    np.inf,
    "",
    "many",
    "64",
    b"64",
    3 + 4j,
    [],
    [[1]],
    {},
    object(),
    np.array([1, 2]),
    np.datetime64("NaT", "s"),
]
"""What no option can be, or hardly."""


def skeleton_of(rng: Generator, points: np.ndarray) -> dict[str, Any]:
    """Choose joints in and around a mesh, and who hangs on whom."""
    count = int(
        rng.choice([1, 2, 3, 5, 8, 20, 60, 200], p=[0.1, 0.15, 0.15, 0.2, 0.2, 0.1, 0.07, 0.03])
    )
    low, high = points.min(axis=0), points.max(axis=0)
    with np.errstate(all="ignore"):
        joints = low + (high - low) * rng.random((count, 3))
        place = rng.integers(5)
        if place == 0:  # on vertices
            joints = points[rng.integers(0, len(points), count)]
        elif place == 1:  # some at one place
            joints[rng.random(count) < 0.5] = joints[0]
        elif place == 2:  # around
            joints = joints + (high - low) * rng.normal(0, 2, (count, 3))
    ways = [
        np.arange(-1, count - 1),
        np.array([-1] + [rng.integers(0, k) for k in range(1, count)]),
        np.where(np.arange(count) == 0, -1, 0),
        np.full(count, -1),
        np.array([rng.integers(-1, k) for k in range(count)]),
    ]
    parents = ways[rng.integers(len(ways))]
    skeleton: dict[str, Any] = {"joints": joints, "parents": parents}
    if rng.random() < 0.3:
        skeleton["deform"] = rng.random(count) < rng.choice([0.05, 0.5, 0.9])
    if rng.random() < 0.05:
        key = str(rng.choice(["joints", "parents", "names", "deform"]))
        wrong = wrong_parts(joints, parents)[key]
        skeleton[key] = wrong[rng.integers(len(wrong))]
    return skeleton


def wrong_parts(joints: np.ndarray, parents: np.ndarray) -> dict[str, list[Any]]:
    """List what no skeleton can be made of, or hardly."""
    count = len(joints)
    far, nowhere = joints + 1e9, joints * np.nan
    loop, halves = np.arange(count), parents + 0.5
    return {
        "joints": [nowhere, far, joints[:, :2], joints[:0], joints + 1j, "joints", None],
        "parents": [parents[:-1], parents + 1, parents - 5, halves, loop, None],
        "names": [["a"], ["same"] * count, [1] * count, "x" * count, [None] * count, 5],
        "deform": [[True], "yes", np.zeros(count, bool), np.full(count, 2), np.full(count, np.nan)],
    }


def rig_extras(rng: Generator, vertices: int, joints: int) -> dict[str, Any]:
    """Give a rig weights of its own, or tell which joints a vertex may follow."""
    extras: dict[str, Any] = {}
    if rng.random() < 0.3:
        weights = rng.random((vertices, joints)) * (rng.random((vertices, joints)) < 0.5)
        if rng.random() < 0.7:
            weights /= np.maximum(weights.sum(axis=1, keepdims=True), 1e-300)
        extras["weights"] = weights * rng.choice([1, 1, 1, 1, 1e-300, 1e300, -1, np.nan])
    if rng.random() < 0.2:
        extras["allowed"] = rng.random((vertices, joints)) < rng.choice([0.3, 0.8, 0.99])
    return extras


def options_of(rng: Generator) -> dict[str, Any]:
    """Choose some options, now and then of another type, or odd."""
    options = {"resolution": OPTIONS["resolution"][rng.integers(10)]}
    for name, values in OPTIONS.items():
        if rng.random() < 0.5:
            options[name] = values[rng.integers(len(values))]
    if rng.random() < 0.1:
        name = str(rng.choice([n for n in options if isinstance(options[n], (int, float))]))
        options[name] = NUMBERS[rng.integers(len(NUMBERS))](options[name])
    if rng.random() < 0.1:
        options[str(rng.choice(list(OPTIONS)))] = ODD[rng.integers(len(ODD))]
    if str(options.get("falloff")) != "paper":
        options.pop("alpha", None)  # it has no effect, and every case that names it is refused
    return options


@np.errstate(all="ignore")
def case_of(number: int) -> dict[str, Any]:
    """Make everything that `bind` takes from a number."""
    rng = np.random.default_rng([15, number])
    points, faces = mesh_of(rng)
    skeleton = skeleton_of(rng, points)
    vertices, joints = len(points), len(np.atleast_1d(skeleton["joints"]))
    mesh: tuple[Any, Any] = points, faces
    if rng.random() < 0.06:
        mesh = KINDS[rng.integers(len(KINDS))](points, faces)
    return {
        "mesh": mesh,
        "skeleton": skeleton,
        "rig": rig_extras(rng, vertices, joints),
        "options": options_of(rng),
    }


def describe(number: int) -> str:
    """Say what a case is made of."""
    case = case_of(number)
    sizes = [np.shape(part) for part in (*case["mesh"], case["skeleton"]["joints"])]
    return f"case {number}: {sizes}, {sorted(case['rig'])}, {case['options']}"


def check(number: int) -> None:
    """Bind a case: see that weights are in order, or that an error of ours says why not."""
    case = case_of(number)
    warnings.simplefilter("error")
    try:
        rig = cutcell.Rig(
            cutcell.TriangleMesh(*case["mesh"]), cutcell.Skeleton(**case["skeleton"]), **case["rig"]
        )
        binding = cutcell.bind(rig, **case["options"], progress=_check_progress)
    except cutcell.CutcellError as error:
        sentence = str(error)
        assert 10 < len(sentence) < LONGEST_SENTENCE, sentence
        assert "\n" not in sentence, sentence
        return
    weights = binding.weights
    assert weights.shape == (len(rig.mesh.vertices), len(rig.skeleton.joints))
    assert np.isfinite(weights).all()
    assert (weights >= 0).all()
    assert np.abs(weights.sum(axis=1) - 1).max() < EXACT
    locked = len(case["options"].get("locked", ())) > 0
    assert locked or not weights[:, ~rig.skeleton.deform].any()
    if rig.allowed is not None and not locked:
        assert not weights[~rig.allowed].any()
    most = case["options"].get("max_influences", 4)
    if most is not None and not locked:
        assert (weights > 0).sum(axis=1).max() <= most
    assert all(isinstance(warning, str) for warning in binding.warnings)


def _check_progress(stage: str, done: float) -> None:
    assert stage in ("compile", "graph", "distances", "weights")
    assert 0 <= done <= 1


def warm_up() -> None:
    """Load what is compiled: a case is not to be blamed for that."""
    compilation.warm_up()


if __name__ == "__main__":
    main("tests.fuzz.bind")
