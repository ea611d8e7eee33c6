"""Edits of a character: all that a person changed, as data that is stored and applied again."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Literal

from ..checks import assign, check_choice, check_flag, check_kind, one_line, shown
from ..errors import FileError, ParameterError
from ..runtime.writing import write_all
from .layers.contents import Computed, FromFile, Rename, checked_options
from .layers.layer import Layer, Mask
from .layers.packing import joint_names, mapping, naming, with_keys
from .poses import SavedPose, three

Base = Literal["computed", "file"]


@dataclass(frozen=True)
class JointEdit:
    """Changes of a joint.

    Parameters
    ----------
    deform : bool, optional
        The joint may carry weight; by default as in the rig.
    position : sequence of 3 float, optional
        Its rest position, in the file's units; see `Rig.with_joints`. As in the file when
        left out.
    parent : str, optional
        The parent joint, "" for none; as in the file when left out.
    added : bool
        The file does not have this joint. It needs a position and a parent.
    was : str, optional
        Name of the joint in the file, if it was renamed.
    partner : str, optional
        The joint on the other side, itself for one of the middle, "" for none; by names and
        positions when left out. It is the other's partner, too.
    """

    deform: bool | None = None
    position: tuple[float, float, float] | None = None
    parent: str | None = None
    added: bool = False
    was: str | None = None
    partner: str | None = None

    def __post_init__(self) -> None:
        if self.deform is not None:
            check_flag("deform", self.deform)
        if self.position is not None:
            assign(self, position=three("position", self.position))
        check_flag("added", self.added)
        for what in ("parent", "was", "partner"):
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
class Edits:
    """Edits of one character. Joints go by their names, their new ones if any.

    Parameters
    ----------
    joints : mapping of str to JointEdit
    removed : sequence of str
        Joints of the file that are taken out, by the file's names. Their children go to their
        parents.
    base : {"computed", "file"}
        Weights below the layers: computed, or the file's where it has any.
    method : mapping of str to values
        Options of `Method` that differ from `cutcell.ANIMATION`. `cutcell bind --layers` takes
        them; `cutcell.bind` takes its own method.
    layers : sequence of Layer
        From bottom to top.
    selections : mapping of str to Mask
        Sets of vertices that a person saved, by their names. They change nothing.
    poses : mapping of str to SavedPose
        Poses that a person saved, by their names. They change nothing.

    Raises
    ------
    ParameterError
        A value is out of its range; the message says which and where.

    Examples
    --------
    >>> off = cutcell.Edits(joints={"Root": cutcell.JointEdit(deform=False)})
    >>> binding = cutcell.bind(rig, edits=off)  # doctest: +SKIP

    The artist's weights, but for a part that is rigid:

    >>> helmet = cutcell.Layer(cutcell.Filled({"Head": 1}), cutcell.Mask(part=120))
    >>> binding = cutcell.bind(rig, edits=cutcell.Edits(base="file", layers=[helmet]))
    ... # doctest: +SKIP

    Joints that are moved are saved where they are, by the rig that has them there:

    >>> up = cutcell.Edits(joints={"Neck": cutcell.JointEdit(position=(0, 1.5, 0))})
    >>> binding = cutcell.bind(rig, edits=up)  # doctest: +SKIP
    >>> moved = cutcell.edited_rig(rig, up)  # doctest: +SKIP
    >>> cutcell.save("bound.glb", moved.with_weights(binding.weights))  # doctest: +SKIP
    """

    joints: Mapping[str, JointEdit] = field(default_factory=dict)
    removed: Sequence[str] = ()
    base: Base = "computed"
    method: Mapping[str, Any] = field(default_factory=dict)
    layers: Sequence[Layer] = ()
    selections: Mapping[str, Mask] = field(default_factory=dict)
    poses: Mapping[str, SavedPose] = field(default_factory=dict)

    def __post_init__(self) -> None:
        joints = mapping("joints", self.joints)
        for name, one in joints.items():
            if not isinstance(name, str):
                raise ParameterError(f"joints go by their names, not by {shown(name)}")
            check_kind(f'the joint "{one_line(name)}"', one, JointEdit)
        if isinstance(self.layers, str) or not isinstance(self.layers, Sequence):
            raise ParameterError(f"layers must be a list, not {shown(self.layers)}")
        for number, layer in enumerate(self.layers, start=1):
            check_kind(f"layer {number}", layer, Layer)
        check_choice("base", self.base, ("computed", "file"))
        removed = joint_names("removed", self.removed)
        method = checked_options("method", self.method)
        selections = _named("selection", self.selections, Mask)
        poses = _named("pose", self.poses, SavedPose)
        assign(self, joints=joints, removed=removed, method=method, layers=tuple(self.layers),
               selections=selections, poses=poses)  # fmt: skip

    def __bool__(self) -> bool:
        """Return whether there are any edits."""
        changes = self.joints or self.removed or self.layers or self.base == "file"
        return bool(changes or self.selections or self.poses)

    @property
    def partners(self) -> dict[str, str]:
        """The joints on the other side that were set, by joint."""
        joints = self.joints.items()
        return {name: one.partner for name, one in joints if one.partner is not None}

    @property
    def structural(self) -> bool:
        """True if they change the joints, names or parents of the skeleton."""
        return bool(self.removed) or any(one.structural for one in self.joints.values())

    @property
    def reach(self) -> Computed:
        """The reach of joints that all weights are computed with, unless a layer says more."""
        lowest = self.layers[0] if self.layers else None
        if lowest is None or not lowest.on or not lowest.is_reach:
            return Computed()
        assert isinstance(lowest.content, Computed)
        return lowest.content

    def stack(self, lowest: Sequence[Layer] = ()) -> tuple[Layer, ...]:
        """Return all layers over weights that are computed with the `reach`, from bottom to top.

        Some more may lie directly over the base.
        """
        layers = self.layers_over(lowest)
        if self.reach != Computed():
            return layers[1:]
        return *([Layer(FromFile())] if self.base == "file" else []), *layers

    def layers_over(self, lowest: Sequence[Layer]) -> tuple[Layer, ...]:
        """Return all layers with more below them, but above the `reach`."""
        first = int(self.reach != Computed())
        return *self.layers[:first], *lowest, *self.layers[first:]

    def renamed(self, now: Rename) -> Edits:
        """Return them for joints that are called otherwise; layers without any go."""
        layers = [one.renamed(now) for one in self.layers]
        poses = {name: one.renamed(now) for name, one in self.poses.items()}
        return replace(self, layers=[one for one in layers if one is not None], poses=poses)

    def to_json(self, indent: int | None = 2) -> str:
        """Return them as a JSON document.

        Parameters
        ----------
        indent : int or None
            As of `json.dumps`; None for a single line.
        """
        data = {
            "base": "" if self.base == "computed" else self.base,
            "method": dict(self.method),
            "joints": {name: _changed_fields(one) for name, one in self.joints.items()},
            "removed": list(self.removed),
            "layers": [layer.to_data() for layer in self.layers],
            "selections": {name: mask.to_data() for name, mask in self.selections.items()},
            "poses": {name: pose.to_data() for name, pose in self.poses.items()},
        }
        return json.dumps({k: v for k, v in data.items() if v}, indent=indent, ensure_ascii=False)

    @classmethod
    def from_json(cls, text: str) -> Edits:
        """Read them from what `to_json` returns.

        Raises
        ------
        ParameterError
            It is not JSON, or not of this form; the message says where.
        """
        try:
            data = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise ParameterError(f"edits are no JSON: {one_line(error)}") from None
        data = with_keys("edits", data, [f.name for f in fields(cls)])
        data["joints"] = {
            name: _joint(f'the joint "{one_line(name)}"', value)
            for name, value in mapping("joints", data.get("joints", {})).items()
        }
        listed = data.get("layers", [])
        if not isinstance(listed, list):
            raise ParameterError(f"layers must be a list, not {shown(listed)}")
        data["layers"] = [Layer.from_data(f"layer {k}", one) for k, one in enumerate(listed, 1)]
        for noun, kind in (("selection", Mask), ("pose", SavedPose)):
            data[f"{noun}s"] = {
                name: kind.from_data(f'the {noun} "{one_line(name)}"', value)
                for name, value in mapping(f"{noun}s", data.get(f"{noun}s", {})).items()
            }
        return cls(**data)

    @classmethod
    def load(cls, path: str | Path) -> Edits:
        """Read them from a JSON file.

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
        with naming(Path(path).name):
            return cls.from_json(text)

    def save(self, path: str | Path) -> None:
        """Write them to a file as JSON."""
        write_all({Path(path): (self.to_json() + "\n").encode()})


def _changed_fields(edit: JointEdit) -> dict[str, Any]:
    """Return the fields that differ from their defaults."""
    standard = {f.name: f.default for f in fields(edit)}
    return {k: v for k, v in asdict(edit).items() if v != standard[k]}


def _joint(where: str, value: Any) -> JointEdit:
    entries = with_keys(where, value, [f.name for f in fields(JointEdit)])
    with naming(where):
        return JointEdit(**entries)


def _named(noun: str, value: Any, kind: type) -> dict[str, Any]:
    """Return a copy of a mapping of names that a person gave."""
    entries = mapping(f"{noun}s", value)
    for name, one in entries.items():
        if not isinstance(name, str) or not name.strip():
            raise ParameterError(f"{noun}s go by names, not by {shown(name)}")
        check_kind(f'the {noun} "{one_line(name)}"', one, kind)
    return entries
