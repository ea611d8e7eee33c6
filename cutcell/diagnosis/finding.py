"""Findings of a diagnosis: a code, a severity, and the elements at fault."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

SEVERITIES = ("error", "warning", "note")
"""The most severe first. Error: it breaks a binding or another program. Warning: most likely a
fault. Note: information."""

TITLES = {
    "unreadable": "Unreadable file",
    "cyclic-joints": "Cycle of joints",
    "stray-vertices": "Stray vertices",
    "no-interior": "No interior",
    "inverted-faces": "Inverted faces",
    "cracks": "Cracks",
    "holes": "Missing faces",
    "rims": "Open rims",
    "non-manifold-edges": "Non-manifold edges",
    "duplicate-faces": "Duplicate faces",
    "degenerate-faces": "Degenerate faces",
    "self-intersections": "Self-intersections",
    "unwelded-vertices": "Unwelded vertices",
    "unused-vertices": "Unused vertices",
    "unreachable-vertices": "Unreachable vertices",
    "thin-parts": "Thin parts",
    "boneless-components": "Components without a bone",
    "joints-outside": "Joints outside the body",
    "coincident-joints": "Coincident joints",
    "zero-length-bones": "Bones of zero length",
    "flat-hierarchy": "No hierarchy",
    "control-joints": "Control joints",
    "unused-joints": "Unused joints",
    "invalid-weights": "Invalid weights",
    "unweighted-vertices": "Vertices without weight",
    "unnormalised-weights": "Weights that do not sum to one",
    "leaked-weights": "Leaked weights",
    "stray-weights": "Stray weights",
    "weight-islands": "Islands of weight",
    "far-parts": "Parts that follow a far joint",
    "stretched-edges": "Edges that stretch",
    "flipped-faces": "Faces that flip",
    "lost-volume": "Volume that is lost",
    "asymmetric-weights": "Left and right differ",
    "torn-seams": "Seams that tear",
    "many-influences": "More than four influences",
}
"""Title of each code, in the order of reports."""


def _none() -> NDArray[np.intp]:
    return np.zeros(0, np.intp)


@dataclass(frozen=True)
class Pose:
    """A pose that shows a finding: one joint is turned, with all below it.

    Parameters
    ----------
    joint : int
    axis : {"x", "y", "z"}
        Of the rig's space.
    degrees : float
        See `pose.rotate_joint`.
    """

    joint: int
    axis: str
    degrees: float


@dataclass(frozen=True, eq=False)
class Finding:
    """One fault of a rig.

    Parameters
    ----------
    code : str
        A key of `TITLES`; it stays the same from version to version.
    severity : {"error", "warning", "note"}
    message : str
        The fault, with numbers.
    advice : str
        Recommended action.
    vertices, faces, joints : arrays of int
        The elements at fault, as indices into the rig's vertices, faces and joints; ascending.
    details : tuple of str
        A line for each part or joint, where needed.
    repair : str
        The action of `Diagnosis.repaired`; empty without a safe repair.
    pose : Pose, optional
        A pose that shows it, where the rest pose does not.
    parts : tuple of (int, int)
        A vertex of each connected component at fault, and the joint to make it rigid to.
    """

    code: str
    severity: str
    message: str
    advice: str
    vertices: NDArray[np.intp] = field(default_factory=_none)
    faces: NDArray[np.intp] = field(default_factory=_none)
    joints: NDArray[np.intp] = field(default_factory=_none)
    details: tuple[str, ...] = ()
    repair: str = ""
    pose: Pose | None = None
    parts: tuple[tuple[int, int], ...] = ()

    @property
    def title(self) -> str:
        """Title of the code."""
        return TITLES[self.code]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {
            "code": self.code,
            "severity": self.severity,
            "title": self.title,
            "message": self.message,
            "advice": self.advice,
            "details": list(self.details),
            "vertices": self.vertices.tolist(),
            "faces": self.faces.tolist(),
            "joints": self.joints.tolist(),
            "repair": self.repair or None,
            "parts": [list(part) for part in self.parts],
            "pose": None if self.pose is None else asdict(self.pose),
        }


def by_severity(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Sort findings: by severity, then in the order of `TITLES`."""
    order = list(TITLES)
    return tuple(
        sorted(findings, key=lambda f: (SEVERITIES.index(f.severity), order.index(f.code)))
    )


def share(part: float, whole: float) -> str:
    """Return a part of a whole in per cent: "12%", "0.3%", "under 0.1%"."""
    ratio = part / whole if whole > 0 else 0.0
    if 0 < ratio < 0.001:
        return "under 0.1%"
    return f"{ratio:.0%}" if ratio >= 0.1 else f"{ratio:.1%}"


def count(number: int, one: str, verb: str = "") -> str:
    """Return a number with its noun, and a verb if one follows: "1 face is", "3,109 faces are"."""
    noun = one if number == 1 else _MANY.get(one, one + "s")
    if verb and number == 1:
        verb = _ONE.get(verb, verb + "s")
    return f"{number:,} {noun} {verb}".rstrip()


_MANY = {"vertex": "vertices"}
_ONE = {"are": "is", "have": "has", "carry": "carries", "do": "does"}
