"""Count for each rule of the rig falloff on how many characters and makers it makes a difference.

    python -m cutcell_lab.benchmarks.rules [SET...] [--resolution 64] [--out docs/falloff.md]

Each rule is switched off by itself, and all characters of the sets (rigs, wild, more) are bound
with the joints of their makers, without the rule and with it.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from cutcell import Rig
from cutcell.animation.bone_extents import chains, fit, probe
from cutcell.animation.falloff import containment, division, pipeline
from cutcell.binding.stages import bind_base
from cutcell.editing.edits import Edits
from cutcell.geodesics import BoneDistances
from cutcell.method import ANIMATION, method_of

from .document import fill
from .makers import maker_of
from .tables import Table
from .weight_changes import NOTABLE
from .wild import characters, score_of

SETS = ("rigs", "wild", "more")


@dataclass(frozen=True)
class Off:
    """How a rule is switched off: names in a module, and what they become."""

    module: Any
    values: dict[str, Any]
    of_bones: bool = True
    """Whether the distances change."""


def _unchanged(*arguments: Any, at: int) -> Any:
    return arguments[at]


def _no_faces(skeleton: Any) -> tuple[np.ndarray, np.ndarray]:
    return np.zeros(len(skeleton.joints), bool), np.zeros(len(skeleton.joints), bool)


RULES: dict[str, Sequence[Off]] = {
    "rest axis": [Off(chains, {"rest_directions": lambda skeleton, joints: None})],
    "leaf bone beside a fork": [Off(chains, {"ONWARD": -2.0})],
    "no far side branches": [Off(chains, {"SIDE_BRANCH": np.inf})],
    "no bone past another child": [Off(chains, {"PASSES": 0.0})],
    "bones run through the body": [Off(chains, {"MIN_BONE_IN_BODY": 0.0})],
    "inferred bones": [Off(chains, {"LENGTH": 0.0})],
    "faces": [Off(chains, {"face_parts": _no_faces})],
    "garment without a body": [Off(chains, {"MIN_BODY_JOINTS": 0.0})],
    "twists in their chain": [
        Off(chains, {"with_twists_in_chain": lambda skeleton, joints: (skeleton, joints)})
    ],
    "at most three times as long": [
        Off(chains, {"MAX_LENGTH_RATIO": 1e9}),
        Off(fit, {"MAX_LENGTH_RATIO": 1e9}),
    ],
    "at least two cells": [Off(fit, {"MIN_BONE_CELLS": 0.0})],
    "ends where another is nearer": [
        Off(probe.BodyProbe, {"distance_to_others": partial(_unchanged, at=2)})
    ],
    "inferred tree": [Off(chains, {"_has_bones": lambda skeleton: True})],
    "radius": [Off(division, {"RADIUS_FACTOR": np.inf}, False)],
    "penalty across components": [
        Off(division, {"cross_component_penalty": lambda share, owned: np.ones(share.shape)}, False)
    ],
    "joints that own a component": [
        Off(containment, {"_owned": lambda s, k, share, starts: np.zeros_like(starts)}, False)
    ],
    "rigid components": [Off(pipeline, {"make_rigid": partial(_unchanged, at=1)}, False)],
    "rigid accessories": [Off(pipeline, {"attach_accessories": partial(_unchanged, at=2)}, False)],
    "garments": [Off(pipeline, {"drape": partial(_unchanged, at=3)}, False)],
}
"""By what docs/falloff.md says of them."""


def bound(rig: Rig, offs: Sequence[Off], method: Any, before: BoneDistances | None) -> Any:
    """Bind a rig without a rule; distances are taken from before where it is not about bones."""
    patches = [patch.multiple(off.module, **off.values) for off in offs]
    for one in patches:
        one.start()
    try:
        reuse: dict[str, Any] = {}
        if before is not None:
            whole = not any(off.of_bones for off in offs)
            reuse = {"distances": before} if whole else {"graph": before.graph}
        return bind_base(rig, method, Edits().reach, **reuse)
    finally:
        for one in patches:
            one.stop()


def differences(
    groups: Sequence[str], resolution: int, load: Callable = characters
) -> dict[str, list[tuple[str, float]]]:
    """Return for each rule the characters it changes, with their error over that without it."""
    method = method_of(ANIMATION, resolution)
    changed: dict[str, list[tuple[str, float]]] = {rule: [] for rule in RULES}
    for group in groups:
        for name, rig in load(group):
            binding = bound(rig, (), method, None)
            weights, error = binding.weights, None
            for rule, offs in RULES.items():
                other = bound(rig, offs, method, binding.distances).weights
                if np.array_equal(weights, other):
                    continue
                error = error or score_of(rig, weights).deformation
                changed[rule].append((name, error / score_of(rig, other).deformation))
            print(group, name, flush=True)
    return changed


def table(changed: dict[str, list[tuple[str, float]]]) -> Table:
    """List what the rules change: better and worse by `NOTABLE`, and of how many makers."""
    columns = ["rule", "characters changed", "better : worse", "makers", "geometric mean of ratios"]
    note = f"Better and worse: characters whose cm² differ by over {NOTABLE:.0%} from those without"
    rows = Table("What each rule changes", columns, f"{note} the rule; makers are of these.")
    for rule, listed in changed.items():
        ratio = np.array([value for _, value in listed])
        moved = [name for name, value in listed if abs(value - 1) > NOTABLE]
        rows.add(
            rule,
            len(listed),
            f"{(ratio < 1 - NOTABLE).sum()} : {(ratio > 1 + NOTABLE).sum()}",
            len({maker_of(name) for name in moved}),
            f"{np.exp(np.log(ratio).mean()):.3f}" if len(listed) else "-",
        )
    return rows


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sets", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--out", type=Path, help="a document whose table to replace")
    options = parser.parse_args(arguments)
    text = table(differences(options.sets or SETS, options.resolution)).markdown()
    print(text)
    if options.out:
        fill(options.out, {"rules": text})


if __name__ == "__main__":
    main()
