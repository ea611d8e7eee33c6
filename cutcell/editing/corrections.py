"""Corrections of a binding, as data that is stored and applied at every binding."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from ..errors import FileError, ParameterError
from ..rig.checks import check_choice, check_flag, check_integer, check_number, one_line, shown
from ..runtime.writing import write_all

How = Literal["glued", "touching", "itself", "file"]
MIN_GAIN, MAX_GAIN = 0.05, 20.0
MAX_VERTEX = 2**31 - 2
FARTHEST = 1e30
ROUNDING = 1e-9
"""Tolerance for sums of weights."""


@dataclass(frozen=True)
class JointCorrection:
    """Corrections of a joint.

    Parameters
    ----------
    deform : bool, optional
        The joint may carry weight; by default as in the rig.
    locked : bool
        The joint keeps the file's weights.
    gain : float
        Factor that its distances are divided by, 0.05 to 20.
    radius : float, optional
        In the file's units: beyond it, distances grow by their square. Measured from the body when
        left out. The paper's falloff has none.
    position : sequence of 3 float, optional
        Its rest position, in the file's units; see `Rig.with_joints`. As in the file when
        left out.
    parent : str, optional
        The parent joint, "" for none; as in the file when left out.
    added : bool
        The file does not have this joint. It needs a position and a parent.
    was : str, optional
        Name of the joint in the file, if it was renamed.
    """

    deform: bool | None = None
    locked: bool = False
    gain: float = 1.0
    radius: float | None = None
    position: tuple[float, float, float] | None = None
    parent: str | None = None
    added: bool = False
    was: str | None = None

    def __post_init__(self) -> None:
        if self.deform is not None:
            check_flag("deform", self.deform)
        check_flag("locked", self.locked)
        object.__setattr__(self, "gain", check_number("gain", self.gain, MIN_GAIN, MAX_GAIN))
        if self.radius is not None:
            radius = check_number("radius", self.radius, 0, 1e30)
            if radius == 0:
                raise ParameterError("radius must be more than 0; leave it out to have it measured")
            object.__setattr__(self, "radius", radius)
        if self.position is not None:
            object.__setattr__(self, "position", _position(self.position))
        check_flag("added", self.added)
        for what in ("parent", "was"):
            name = getattr(self, what)
            if name is not None and not isinstance(name, str):
                raise ParameterError(f"{what} must be the name of a joint, not {shown(name)}")
        if self.added and (self.position is None or self.parent is None or self.was is not None):
            raise ParameterError(
                'a joint that is added needs a position and a parent, "" for none, and no name '
                "that it had before"
            )

    @property
    def structural(self) -> bool:
        """True if it changes the joints, names or parents of the skeleton."""
        return self.added or self.parent is not None or self.was is not None


@dataclass(frozen=True)
class PartCorrection:
    """Binding of a connected component of the mesh.

    Parameters
    ----------
    how : {"glued", "touching", "itself", "file"}
        Glued to a joint; rigid, as the body is bound where it touches; as any other skin, even
        if it is small or holds bones of one joint only; or with the file's weights.
    joint : str, optional
        Joint that the part is glued to.
    """

    how: How
    joint: str | None = None

    def __post_init__(self) -> None:
        check_choice("how", self.how, get_args(How))
        if (self.how == "glued") != (self.joint is not None):
            raise ParameterError(
                "a part that is glued needs the joint that it is glued to"
                if self.joint is None
                else f"a part has a joint only if it is glued, this one is {self.how!r}"
            )
        if self.joint is not None and not isinstance(self.joint, str):
            raise ParameterError(f"joint must be a name, not {shown(self.joint)}")


@dataclass(frozen=True)
class Corrections:
    """Corrections of one character's binding. Joints go by their names, their new ones if any.

    Parameters
    ----------
    joints : mapping of str to JointCorrection
    parts : mapping of int to PartCorrection
        Keys are any vertex of the connected component.
    vertices : mapping of int to mappings of str to float
        Weights that override the computed ones of a vertex; they are scaled to sum to one.
    removed : sequence of str
        Joints of the file that are taken out, by the file's names. Their children go to their
        parents.

    Raises
    ------
    ParameterError
        A value is out of its range; the message says which and where.

    Examples
    --------
    >>> off = cutcell.Corrections(joints={"Root": cutcell.JointCorrection(deform=False)})
    >>> binding = cutcell.bind(rig, corrections=off)  # doctest: +SKIP

    Joints that are moved are saved where they are, by the rig that has them there:

    >>> up = cutcell.Corrections(joints={"Neck": cutcell.JointCorrection(position=(0, 1.5, 0))})
    >>> binding = cutcell.bind(rig, corrections=up)  # doctest: +SKIP
    >>> moved = cutcell.corrected_rig(rig, up)  # doctest: +SKIP
    >>> cutcell.save("bound.glb", moved.with_weights(binding.weights))  # doctest: +SKIP
    """

    joints: Mapping[str, JointCorrection] = field(default_factory=dict)
    parts: Mapping[int, PartCorrection] = field(default_factory=dict)
    vertices: Mapping[int, Mapping[str, float]] = field(default_factory=dict)
    removed: Sequence[str] = ()

    def __post_init__(self) -> None:
        for name, kind in (("joints", JointCorrection), ("parts", PartCorrection)):
            entries = _mapping(name, getattr(self, name))
            for key, value in entries.items():
                if not isinstance(value, kind):
                    raise ParameterError(
                        f"{name}: {shown(key)} must be a {kind.__name__}, not {shown(value)}"
                    )
            object.__setattr__(self, name, entries)
        for joint in self.joints:
            if not isinstance(joint, str):
                raise ParameterError(f"joints go by their names, not by {shown(joint)}")
        for vertex in self.parts:
            check_integer("the vertex of a part", vertex, 0, MAX_VERTEX)
        vertices = _mapping("vertices", self.vertices)
        object.__setattr__(self, "vertices", {v: _weights(v, w) for v, w in vertices.items()})
        object.__setattr__(self, "removed", _names("removed", self.removed))

    def __bool__(self) -> bool:
        """Return whether there are any corrections."""
        return bool(self.joints or self.parts or self.vertices or self.removed)

    @property
    def structural(self) -> bool:
        """True if they change the joints, names or parents of the skeleton."""
        return bool(self.removed) or any(one.structural for one in self.joints.values())

    def to_json(self, indent: int | None = 2) -> str:
        """Return them as a JSON document.

        Parameters
        ----------
        indent : int or None
            As of `json.dumps`; None for a single line, which for many vertices takes far less time.
        """
        data = {
            "joints": {name: _changed_fields(one) for name, one in self.joints.items()},
            "parts": [{"vertex": v, **_changed_fields(part)} for v, part in self.parts.items()],
            "vertices": {str(v): dict(weights) for v, weights in self.vertices.items()},
            "removed": list(self.removed),
        }
        return json.dumps({k: v for k, v in data.items() if v}, indent=indent, ensure_ascii=False)

    @classmethod
    def from_json(cls, text: str) -> Corrections:
        """Read them from what `to_json` returns.

        Raises
        ------
        ParameterError
            It is not JSON, or not of this form; the message says where.
        """
        try:
            data = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise ParameterError(f"corrections are no JSON: {one_line(error)}") from None
        data = _checked_keys("corrections", data, [f.name for f in fields(cls)])
        joints = {
            name: _made(JointCorrection, f'the joint "{one_line(name)}"', value)
            for name, value in _mapping("joints", data.get("joints", {})).items()
        }
        listed = data.get("parts", [])
        if not isinstance(listed, list):
            raise ParameterError(f"parts must be a list, not {shown(listed)}")
        parts = {}
        for number, value in enumerate(listed):
            where = f"part {number}"
            value = _checked_keys(
                where, value, ["vertex", *(f.name for f in fields(PartCorrection))]
            )
            if "vertex" not in value or "how" not in value:
                raise ParameterError(f'{where} needs "vertex" and "how"')
            vertex = check_integer(f"vertex of {where}", value.pop("vertex"), 0, MAX_VERTEX)
            parts[vertex] = _made(PartCorrection, where, value)
        vertices = {}
        for key, weights in _mapping("vertices", data.get("vertices", {})).items():
            if not (isinstance(key, str) and key.isascii() and key.isdigit()):
                raise ParameterError(f"vertices go by their numbers, not by {shown(key)}")
            vertices[int(key)] = weights
        return cls(joints, parts, vertices, data.get("removed", ()))

    @classmethod
    def load(cls, path: str | Path) -> Corrections:
        """Read them from a file.

        Raises
        ------
        FileError
            It cannot be read.
        ParameterError
            It is not of the form that `to_json` returns.
        """
        try:
            text = Path(path).read_text(encoding="utf-8")
        except OSError as error:
            raise FileError(f"{path} cannot be read: {error.strerror or error}") from None
        except UnicodeDecodeError:
            raise FileError(f"{path} is no text in UTF-8") from None
        try:
            return cls.from_json(text)
        except ParameterError as error:
            raise ParameterError(f"{Path(path).name}: {error}") from None

    def save(self, path: str | Path) -> None:
        """Write them to a file as JSON."""
        write_all({Path(path): (self.to_json() + "\n").encode()})


def _changed_fields(correction: JointCorrection | PartCorrection) -> dict[str, Any]:
    """Return the fields that differ from their defaults."""
    standard = {f.name: f.default for f in fields(correction)}
    return {k: v for k, v in asdict(correction).items() if v != standard[k]}


def _made(kind: Any, where: str, value: Any) -> Any:
    try:
        return kind(**_checked_keys(where, value, [f.name for f in fields(kind)]))
    except ParameterError as error:
        text = str(error)
        raise ParameterError(text if text.startswith(where) else f"{where}: {text}") from None


def _checked_keys(where: str, value: Any, names: list[str]) -> dict[str, Any]:
    """Return a copy of a mapping whose keys are all known."""
    entries = _mapping(where, value)
    for key in entries:
        if key not in names:
            close = get_close_matches(str(key), names, n=1)
            instead = f'did you mean "{close[0]}"?' if close else f"there is {', '.join(names)}"
            raise ParameterError(f"{where} has no {shown(key)}; {instead}")
    return entries


def _mapping(where: str, value: Any) -> dict[Any, Any]:
    if not isinstance(value, Mapping):
        raise ParameterError(f"{where} must be a mapping of names to values, not {shown(value)}")
    return dict(value)


def _names(where: str, value: Any) -> tuple[str, ...]:
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise ParameterError(f"{where} must be a list of names, not {shown(value)}")
    for name in value:
        if not isinstance(name, str):
            raise ParameterError(f"{where} must hold names of joints, not {shown(name)}")
    return tuple(dict.fromkeys(value))


def _position(value: Any) -> tuple[float, ...]:
    if isinstance(value, str) or not isinstance(value, Sequence | np.ndarray) or len(value) != 3:
        raise ParameterError(f"position must be three numbers, not {shown(value)}")
    places = zip("xyz", value, strict=True)
    return tuple(check_number(f"{axis} of position", x, -FARTHEST, FARTHEST) for axis, x in places)


class _Weights(dict[str, float]):
    """Weights that are checked: corrections that follow each other share them."""


def _weights(vertex: Any, weights: Any) -> dict[str, float]:
    check_integer("a vertex", vertex, 0, MAX_VERTEX)
    if isinstance(weights, _Weights):
        return weights
    where = f"vertex {vertex}"
    for joint in _mapping(where, weights):
        if not isinstance(joint, str):
            raise ParameterError(f"joints of {where} go by their names, not by {shown(joint)}")
    checked = {
        joint: check_number(f"the weight of {where} for {shown(joint)}", value, 0, 1e9)
        for joint, value in weights.items()
    }
    total = sum(checked.values())
    if not total > 0:
        raise ParameterError(f"{where} needs a weight above 0 for at least one joint")
    if abs(total - 1) < ROUNDING:
        return _Weights(checked)  # as they were written
    return _Weights({joint: value / total for joint, value in checked.items()})
