"""Findings of a diagnosis: a code, a severity, and the elements at fault."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from string import Formatter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..runtime.display import count, share
from .kinds import FINDING_KINDS, TITLES

SEVERITIES = ("error", "warning", "note")
"""The most severe first. Error: it breaks a binding or another program. Warning: most likely a
fault. Note: information."""

MAX_LINES = 40
"""Maximum number of details of a finding."""


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
    empty : tuple of int
        For each of these a joint without weight that lies in the component, -1 for none.
    exchanged : tuple of (int, int)
        Joints, each with the one that should have its weight at these vertices: see `Remapped`.
    change : float
        Of findings of weights: the part of all weight, by area, that is at fault, 0 to 1.
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
    empty: tuple[int, ...] = ()
    exchanged: tuple[tuple[int, int], ...] = ()
    change: float = 0.0

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
            "empty": list(self.empty),
            "exchanged": [list(pair) for pair in self.exchanged],
            "change": self.change,
            "pose": None if self.pose is None else asdict(self.pose),
        }


class _Texts(Formatter):
    """Format templates; an array is formatted as its length."""

    def format_field(self, value: Any, spec: str) -> str:
        number = len(value) if isinstance(value, np.ndarray | tuple) else value
        return count(int(number), *spec.split("/")) if len(spec) > 3 else format(number, spec)


def finding_of(
    code: str,
    *,
    severity: str = "",
    details: Sequence[str] = (),
    pose: Pose | None = None,
    change: float = 0.0,
    **values: Any,
) -> Iterator[Finding]:
    """Yield the finding of a code, unless no element is at fault; `values` fill its texts."""
    at = {name: values[name] for name in ("vertices", "faces", "joints") if name in values}
    if not any(map(len, at.values())):
        return
    kind, rest = FINDING_KINDS[code], len(details) - MAX_LINES
    lines = (*details[:MAX_LINES], *([f"and {rest} more"] if rest > 0 else []))
    message, advice, repair = (_Texts().format(text, **values) for text in kind[2:])
    if change:
        message += f" This is {share(change, 1)} of all weight."
    more = {name: values.get(name, ()) for name in ("parts", "empty", "exchanged")}
    yield Finding(
        code, severity or kind.severity, message, advice, **at, details=lines, repair=repair,
        pose=pose, change=change, **more,
    )  # fmt: skip


def by_severity(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Sort findings: by severity, then by how much they change, then in the order of `TITLES`."""
    order = list(TITLES)

    def rank(one: Finding) -> tuple[int, float, int]:
        return SEVERITIES.index(one.severity), -one.change, order.index(one.code)

    return tuple(sorted(findings, key=rank))
