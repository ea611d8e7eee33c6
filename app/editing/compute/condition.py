"""Conditions on vertices, such as `weight of hand.L > 0.1 and distance > 0.3`."""

import operator
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import MAX_SHOWN, shown
from cutcell.editing.locks import joint_index
from cutcell.errors import ParameterError, WeightsError
from cutcell.geodesics import BoneDistances
from cutcell.rig import Rig

from .mirror import side_of

MAX_LENGTH = 1000
MAX_DEPTH = 40
"""Parentheses and negations inside each other."""
EQUAL = 1e-6
"""Values that differ by no more are equal."""
OPENING, CLOSING = re.compile(r"\("), re.compile(r"\)")
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?(%?)", re.IGNORECASE)
OPERATOR = re.compile(r"<=|>=|==|!=|[<>=≤≥≠]")
QUOTED = re.compile(r"""(["'])(.*?)\1""")
NAME_END = re.compile(r"\s|[<>=!≤≥≠)]|$")
BARE_NAME = re.compile(r"(.*?)(?=\s+(?:and|or)\b|\s*[<>=!≤≥≠)]|\s*$)", re.IGNORECASE)

AXIS = re.compile(r"[xyz]\b", re.IGNORECASE)
SIDES = {"left": 1.0, "right": -1.0, "middle": 0.0}

Value = NDArray[np.float64] | float
COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
    "≤": operator.le, "≥": operator.ge,
    "=": lambda a, b: np.isclose(a, b, rtol=0, atol=EQUAL),
    "!=": lambda a, b: ~np.isclose(a, b, rtol=0, atol=EQUAL),
}  # fmt: skip
COMPARISONS |= {"==": COMPARISONS["="], "≠": COMPARISONS["!="]}


def vertices_where(
    condition: str,
    rig: Rig,
    weights: NDArray[np.float64],
    *,
    distances: BoneDistances | None = None,
) -> NDArray[np.bool_]:
    """Return which vertices a condition holds for, shape (n,).

    A condition compares values by <, <=, >, >=, = and !=, and joins comparisons by `and`, `or`,
    `not` and parentheses. Values are numbers, also in percent, and of each vertex: `weight of J`,
    `file weight of J`, `distance to J` and `distance` through the body in the file's units,
    `influences`, `part`, the number of its connected component, from 1, the largest, its position
    `x`, `y` and `z` in the file, and `side`, which is `left`, `right` or `middle`. J is the name of
    a joint, in quotes if it is ambiguous, or a pattern such as *_l: weights of all joints that fit
    are added, and the nearest of them counts. `distance` alone is that to the joint named before
    it, or else to the nearest.

    Parameters
    ----------
    condition : str
    rig : Rig
    weights : array, shape (n, j)
    distances : BoneDistances, optional
        Of the rig. Conditions on distances need them.

    Raises
    ------
    ParameterError
        The condition cannot be read, names no joint of the rig, or needs distances.
    WeightsError
        It compares weights of the file, which has none.
    """
    if len(condition) > MAX_LENGTH:
        raise ParameterError(f"a condition may have {MAX_LENGTH:,} characters at most")
    holds = _Parser(condition, rig, weights, distances).whole()
    return np.array(np.broadcast_to(holds, len(rig.mesh.vertices)))


@dataclass
class _Parser:
    """Reads a condition from left to right, and evaluates it on the way."""

    _text: str
    _rig: Rig
    _weights: NDArray[np.float64]
    _distances: BoneDistances | None
    _at: int = 0
    _depth: int = 0
    _joints: list[int] | None = None

    def whole(self) -> Any:
        result = self._either()
        if self._rest():
            self._fail("`and`, `or` or the end")
        return result

    def _either(self) -> Any:
        result = self._both()
        while self._word("or"):
            result = result | self._both()
        return result

    def _both(self) -> Any:
        result = self._one()
        while self._word("and"):
            result = result & self._one()
        return result

    def _one(self) -> Any:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise ParameterError(f"a condition may be nested {MAX_DEPTH} times at most")
        if self._word("not"):
            result = np.logical_not(self._one())
        elif self._match(OPENING):
            result = self._either()
            if not self._match(CLOSING):
                self._fail("a closing parenthesis")
        else:
            result = self._comparison()
        self._depth -= 1
        return result

    def _comparison(self) -> Any:
        """Compare two values, or several in a chain."""
        left, result = self._value(), None
        while sign := self._match(OPERATOR):
            right = self._value()
            holds = np.asarray(COMPARISONS[sign.group()](left, right))
            left, result = right, holds if result is None else result & holds
        if result is None:
            self._fail("<, <=, >, >=, = or !=")
        return result

    def _value(self) -> Value:
        if number := self._match(NUMBER):
            text = number.group().rstrip("%")
            return float(text) / (100 if number.group(3) else 1)
        weights = self._rig.weights if (of_file := self._word("file")) else self._weights
        if self._word("weight"):
            if not self._word("of"):
                self._fail("`of` and a joint")
            if weights is None:
                raise WeightsError(f"{self._rig.name} has no weights of its own to compare")
            return np.asarray(weights[:, self._named()].sum(axis=1))
        if of_file:
            self._fail("`weight of` and a joint")
        if self._word("distance"):
            if self._word("to"):
                self._named()
            return self._distance()
        if self._word("influences"):
            return (self._weights > 0).sum(axis=1).astype(float)
        if self._word("part"):
            mesh = self._rig.mesh.welded
            return mesh.component[mesh.index].astype(float) + 1
        if axis := self._match(AXIS):
            return np.asarray(self._rig.mesh.vertices[:, "xyz".index(axis.group().lower())])
        if self._word("side"):
            return side_of(self._rig).astype(float)
        for name, value in SIDES.items():
            if self._word(name):
                return value
        self._fail("a number, weight, file weight, distance, influences, part, side, x, y or z")

    def _distance(self) -> Value:
        if self._distances is None:
            raise ParameterError("distances are compared once the character is bound; bind it")
        size, joints = self._distances.graph.lattice.size, self._joints
        if joints is None:
            return np.asarray(self._distances.least * size, float)
        deform = [joint for joint in joints if self._rig.skeleton.deform[joint]]
        if not deform:
            name = self._rig.skeleton.names[joints[0]]
            raise ParameterError(f'"{name}" carries no weight, so there is no distance to it')
        return np.stack([self._distances.on_mesh(joint) for joint in deform]).min(axis=0) * size

    def _named(self) -> list[int]:
        """Read the name of a joint, without quotes the longest that the skeleton has; or a pattern.

        Returns the joints, at least one.
        """
        if quoted := self._match(QUOTED):
            name = quoted.group(2)
        else:
            rest = self._rest()
            fits = [one for one in self._rig.skeleton.names if one and _begins(rest, one)]
            fits = fits or BARE_NAME.findall(rest)[:1]
            name = max(fits, key=lambda one: (len(one), rest.startswith(one)))
            if not name:
                self._fail("a joint")
            self._at += len(name)
        self._joints = self._fitting(name) if "*" in name else []
        self._joints = self._joints or [joint_index(self._rig.skeleton, name)]
        return self._joints

    def _fitting(self, pattern: str) -> list[int]:
        """Return the joints whose names fit a pattern, in whatever case."""
        regex = re.compile(re.escape(pattern).replace(r"\*", ".*"), re.IGNORECASE)
        names = self._rig.skeleton.names
        return [joint for joint, name in enumerate(names) if regex.fullmatch(name)]

    def _rest(self) -> str:
        self._at += len(self._text[self._at :]) - len(self._text[self._at :].lstrip())
        return self._text[self._at :]

    def _match(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        match = pattern.match(self._rest())
        self._at += 0 if match is None else match.end()
        return match

    def _word(self, word: str) -> bool:
        return self._match(re.compile(rf"{word}\b", re.IGNORECASE)) is not None

    def _fail(self, expected: str) -> NoReturn:
        rest = self._rest()
        where = f"at character {self._at + 1}, {shown(rest[:MAX_SHOWN])}" if rest else "at its end"
        example = 'weight of "hand.L" > 0.1'
        raise ParameterError(f"the condition needs {expected} {where}; write for example {example}")


def _begins(text: str, name: str) -> bool:
    """Return whether a text begins with a name, in whatever case, and the name ends there."""
    same = text[: len(name)].lower() == name.lower()
    return same and NAME_END.match(text[len(name) :]) is not None
