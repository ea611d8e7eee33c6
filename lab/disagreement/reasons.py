"""Reasons why weights differ, derived from the graph and the distances through it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cutcell.diagnosis.parts import RIGID_WEIGHT
from cutcell.geodesics import BoneDistances
from cutcell.geodesics.fallback import REACHED, UNREACHED
from cutcell.rig import Rig
from cutcell.runtime.display import shown_name

from .facts import MOST, Facts, Measured

REASONS = {
    "unreachable": "Not reached through the body",
    "attached": "Attached part",
    "not-deforming": "Joint that does not deform",
    "outside": "Joint outside the body",
    "leak-through-air": "Leak through air",
    "leak-through-wall": "Leak through a wall",
    "far": "Far joint",
    "same-place": "Bones in one place",
    "extent": "Extent of a bone",
    "thin": "Thinner than the lattice",
    "blend": "Length of the blend",
    "equally-far": "Two bones equally far",
    "": "No reason was recognised",
}
"""Titles of the reasons, in the order in which they are tried."""
DETOUR = 1.5
"""A path through the body this many times as long as the straight line goes around something."""
MIN_DETOUR = 0.05
"""The same as a length, as part of the longest side."""
FAR = 0.25
"""Part of the longest side: a joint as far beyond the nearest one is out of place."""
WALL = 1.5
"""Lattice cells: what parts two sides of the body by less is a wall, by more it is air."""
CLOSE = 0.5
"""Lattice cells: bones whose distances differ by less may lie in one place."""
TOGETHER = 1.0
"""Lattice cells: bones that are nearer to each other lie in one place."""
THIN = 1.5
"""Lattice cells: skin that is farther from every lattice point inside has none below it."""
EQUAL = 1.25
"""Ratio of two distances up to which neither joint is clearly the nearer one."""
NEXT = 2
"""Steps along the skeleton between joints whose weights blend into each other, at most."""
MM = 1000.0
"""Millimetres in the longest side, which counts as 1 m."""

NamedReasons = Iterator[tuple[str, str]]


class Reasons:
    """Finds the reason why two sets of weights differ in a region.

    Parameters
    ----------
    rig : Rig
    distances : BoneDistances
    first, second : arrays, shape (n, j)
    names : pair of str
        What texts call the two sets of weights, such as "the file".
    """

    def __init__(
        self,
        rig: Rig,
        distances: BoneDistances,
        first: NDArray[np.float64],
        second: NDArray[np.float64],
        names: tuple[str, str],
    ) -> None:
        self._measured = Measured(rig, distances)
        self._weights, self._names = (first, second), names

    def of(self, vertices: NDArray[np.intp], joints: tuple[int, int]) -> tuple[str, str]:
        """Return the reason of a region, a key of `REASONS`, and its text.

        Parameters
        ----------
        vertices : array of int
        joints : pair of int
            The joint of which the first weights give more, and that of the second.
        """
        for check in (self._not_reached, self._attached, self._without_distances):
            for reason in check(vertices, joints):
                return reason
        facts = self._measured.facts(vertices, joints)
        checks = (
            self._no_path, self._leak, self._far, self._same_place, self._extent, self._thin,
            self._blend, self._equally_far,
        )  # fmt: skip
        for examine in checks:
            for reason in examine(facts):
                return reason
        (a, b), (first, second) = facts.through, map(self._name, joints)
        return "", (
            f"{REASONS['']}. {first}, with more weight in {self._names[0]}, is {_mm(a)} away, and "
            f"{second}, with more in {self._names[1]}, {_mm(b)}."
        )

    def _not_reached(self, vertices: NDArray[np.intp], joints: tuple[int, int]) -> NamedReasons:
        fallback = self._measured.distances.fallback[vertices]
        if (fallback != REACHED).mean() < MOST:
            return
        why = "the file stores no weights of the joints that reach these vertices"
        if (fallback == UNREACHED).any():
            why = "no path through the body leads to this part of the mesh"
        yield "unreachable", f"Distances are those of straight lines: {why}."

    def _attached(self, vertices: NDArray[np.intp], joints: tuple[int, int]) -> NamedReasons:
        """Look for whole components that one of the weights moves as one piece."""
        measured = self._measured
        labels = np.unique(measured.component[vertices])
        members = measured.members(labels)
        if len(measured.sizes) == 1 or len(members) > measured.sizes.sum() / 2:
            return
        if len(vertices) < MOST * len(members):
            return
        rigid = [
            f"with {self._name(int(weights[members].sum(axis=0).argmax()))} in {name}"
            for weights, name in zip(self._weights, self._names, strict=True)
            if all(_is_rigid(weights[measured.members(label)]) for label in labels)
        ]
        if rigid:
            part = "This part" if len(labels) == 1 else f"These {len(labels)} parts"
            verb = "moves" if len(labels) == 1 else "move"
            yield "attached", f"{part} of the mesh {verb} as a whole {' and '.join(rigid)}."

    def _without_distances(
        self, vertices: NDArray[np.intp], joints: tuple[int, int]
    ) -> NamedReasons:
        for joint, has_weight in zip(joints, self._have_weight(joints), strict=True):
            if joint not in self._measured.distances.bones.joint:
                yield "not-deforming", f"{has_weight} does not deform, so it has no distances."
            elif not self._measured.subject.measurable[joint]:
                yield "outside", f"{has_weight} lies outside the body."

    def _no_path(self, facts: Facts) -> NamedReasons:
        for through, has_weight in zip(facts.through, self._have_weight(facts.joints), strict=True):
            if np.isinf(through):
                yield "unreachable", f"{has_weight} no path through the body leads to it."

    def _leak(self, facts: Facts) -> NamedReasons:
        for k, has_weight in enumerate(self._have_weight(facts.joints)):
            through, straight, other = facts.through[k], facts.straight[k], facts.through[1 - k]
            is_detour = through > DETOUR * straight and through - straight > MIN_DETOUR
            if through <= other or not is_detour or facts.gap[k] <= 0:
                continue
            is_air = facts.gap[k] * self._measured.cells > WALL
            yield (
                "leak-through-air" if is_air else "leak-through-wall",
                (
                    f"{has_weight} is {_mm(through)} away through the body and {_mm(straight)} "
                    f"{'through the air' if is_air else 'through a thin gap'}. "
                    f"{self._name(facts.joints[1 - k])} is {_mm(other)} away."
                ),
            )

    def _far(self, facts: Facts) -> NamedReasons:
        for through, has_weight in zip(facts.through, self._have_weight(facts.joints), strict=True):
            if through - facts.nearest > FAR:
                beyond = _mm(through - facts.nearest)
                yield "far", f"{has_weight} is {beyond} farther than the nearest joint."

    def _same_place(self, facts: Facts) -> NamedReasons:
        gaps = [abs(a - b) * self._measured.cells for a, b in (facts.through, facts.straight)]
        if max(gaps) < CLOSE and self._measured.lie_together(facts.joints, TOGETHER):
            first, second = map(self._name, facts.joints)
            yield "same-place", f"{first} and {second} lie in one place, so distances are equal."

    def _extent(self, facts: Facts) -> NamedReasons:
        for k, name in enumerate(self._names):
            joint = facts.joints[k]
            if facts.is_past_end[k] and self._measured.is_last(joint):
                yield (
                    "extent",
                    (
                        f"{self._name(joint)} has weight in {name} beyond the end of its bone. "
                        "It is the last of its chain, and the end of such a bone is estimated."
                    ),
                )

    def _thin(self, facts: Facts) -> NamedReasons:
        if facts.depth * self._measured.cells > THIN:
            yield (
                "thin",
                (
                    "No lattice point lies inside the body there, so paths run over the skin. "
                    "A finer resolution may fill it."
                ),
            )

    def _blend(self, facts: Facts) -> NamedReasons:
        measured = self._measured
        limit = 2 * facts.nearest + 2 / measured.cells + measured.bone_length(facts.joints) / 2
        if measured.steps_between(*facts.joints) <= NEXT and max(facts.through) < limit:
            first, second = map(self._name, facts.joints)
            yield (
                "blend",
                (
                    f"{first} and {second} meet there. {first} has more weight in "
                    f"{self._names[0]}, {second} in {self._names[1]}."
                ),
            )

    def _equally_far(self, facts: Facts) -> NamedReasons:
        if max(facts.through) < EQUAL * max(min(facts.through), 1 / self._measured.cells):
            (a, b), (first, second) = facts.through, map(self._name, facts.joints)
            yield (
                "equally-far",
                (f"{first} is {_mm(a)} away, {second} {_mm(b)}: neither is clearly nearer."),
            )

    def _have_weight(self, joints: tuple[int, int]) -> Iterator[str]:
        for joint, name in zip(joints, self._names, strict=True):
            yield f"{self._name(joint)} has weight in {name}, but"

    def _name(self, joint: int) -> str:
        return shown_name(self._measured.rig.skeleton.names[joint])


def _is_rigid(rows: NDArray[np.float64]) -> bool:
    """Return whether all rows are nearly equal."""
    return bool(np.abs(rows - rows.mean(axis=0)).sum(axis=1).max() < 2 * (1 - RIGID_WEIGHT))


def _mm(length: float) -> str:
    return f"{MM * length:.0f} mm"
