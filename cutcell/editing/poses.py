"""Poses that a person saved, as data: joints that are turned, or a frame of a clip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

import numpy as np

from ..checks import assign, check_number, one_line, shown
from ..errors import ParameterError
from .layers.contents import Rename
from .layers.packing import joint_names, mapping, naming, with_keys

FARTHEST = 1e30


@dataclass(frozen=True)
class SavedPose:
    """A pose of a character: joints that are turned, or a frame of a clip of its file.

    Parameters
    ----------
    turns : mapping of str to sequence of 3 float
        By names of joints: degrees about x, y, then z of a scene in which y is up. A rig may lack
        some of the joints.
    clip : str, optional
        Name of the clip.
    seconds : float
        Time in the clip.

    Raises
    ------
    ParameterError
        A value is out of its range, or there are both turns and a clip.
    """

    turns: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    clip: str | None = None
    seconds: float = 0.0

    def __post_init__(self) -> None:
        turns = mapping("turns", self.turns)
        joint_names("turns", list(turns))
        turns = {name: three(f'"{one_line(name)}"', turn) for name, turn in turns.items()}
        if self.clip is not None and not isinstance(self.clip, str):
            raise ParameterError(f"clip must be the name of a clip, not {shown(self.clip)}")
        if turns and self.clip is not None:
            raise ParameterError("a pose has turns or a clip, not both")
        seconds = check_number("seconds", self.seconds, 0, FARTHEST)
        assign(self, turns=turns, seconds=seconds)

    def renamed(self, now: Rename) -> SavedPose:
        """Return it for joints that are called otherwise."""
        turns = {new: t for name, t in self.turns.items() if (new := now(name)) is not None}
        return replace(self, turns=turns)

    def to_data(self) -> dict[str, Any]:
        """Return it as JSON."""
        return {name: value for name, value in asdict(self).items() if value not in ({}, None, 0)}

    @classmethod
    def from_data(cls, where: str, value: Any) -> SavedPose:
        """Read what `to_data` returns."""
        entries = with_keys(where, value, [one.name for one in fields(cls)])
        with naming(where):
            return cls(**entries)


def three(what: str, value: Any) -> tuple[float, ...]:
    """Return three numbers, of x, y and z."""
    if isinstance(value, str) or not isinstance(value, Sequence | np.ndarray) or len(value) != 3:
        raise ParameterError(f"{what} must be three numbers, not {shown(value)}")
    places = zip("xyz", value, strict=True)
    return tuple(check_number(f"{axis} of {what}", x, -FARTHEST, FARTHEST) for axis, x in places)
