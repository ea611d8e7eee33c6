"""Corrections of the binding, and their form in an address."""

import base64
import binascii
import zlib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import param

from cutcell.binding import Binding
from cutcell.editing.corrections import Corrections, JointCorrection
from cutcell.editing.restructure import restructured, restructured_skeleton
from cutcell.errors import CutcellError
from cutcell.rig import Rig

MAX_IN_ADDRESS = 1500
"""Letters: longer addresses are cut by some programs that pass them on."""
MAX_VERTICES = 300
"""Largest number of overruled vertices that are written into an address."""
MAX_BYTES = 4 * 2**20
"""Longest corrections as JSON in an address: some characters are overruled vertex by vertex."""


class CorrectionsChoices(param.Parameterized):
    """Corrections of the current character."""

    corrections: Any = param.Parameter(Corrections(), doc="A cutcell.Corrections.")
    own: Any = param.Parameter(None, doc="The character where nothing is corrected: a cutcell.Rig.")
    joint_handle = param.Boolean(False, label="Show move handle")
    mirrored = param.Boolean(True, label="Mirror")
    dragged: Any = param.Parameter(
        None, doc="A `Dragged` while joints are on their way, which the corrections do not tell."
    )
    part = param.Integer(
        None, allow_None=True, doc="A vertex of the connected component that is looked at."
    )

    @property
    def own_skeleton(self) -> Any:
        """The skeleton where nothing is corrected of it but which joints there are."""
        if self.own is None:
            return None
        return restructured_skeleton(self.own.skeleton, self.corrections)[0]


@dataclass(frozen=True, eq=False)
class Dragged:
    """Preview while joints are dragged.

    Parameters
    ----------
    rig : Rig
        With the joints where the pointer has them.
    binding : Binding
        The newest that there is; of joints where they were a moment ago.
    """

    rig: Rig
    binding: Binding


def applied(own: Rig, corrections: Corrections) -> Rig:
    """Return a rig with the joints that corrections tell of, where they put them.

    Parameters
    ----------
    own : Rig
        As it is where nothing is corrected.
    corrections : Corrections

    Raises
    ------
    SkeletonError
        No joint that may carry weight would be left, or one stands too far from the mesh.
    """
    rig = restructured(own, corrections)
    deform, joints = rig.skeleton.deform.copy(), rig.skeleton.joints.copy()
    for joint, name in enumerate(rig.skeleton.names):
        one = corrections.joints.get(name)
        if one is not None and one.deform is not None:
            deform[joint] = one.deform
        if one is not None and one.position is not None:
            joints[joint] = one.position
    if not np.array_equal(deform, rig.skeleton.deform):
        rig = replace(rig, skeleton=replace(rig.skeleton, deform=deform))
    return rig.with_joints(joints)


def changes(state: Any, rig: Rig, corrections: Corrections) -> dict[str, Any]:
    """Return what of a state changes with corrections and the rig that they make.

    Where the skeleton has other joints, nothing that was computed holds any more, and what was
    chosen of joints follows them.
    """
    changed = {"corrections": corrections, "rig": rig}
    if same_structure(state.rig, rig):
        return changed_only(state, changed)
    number = _numbers(state.rig, rig)
    turns = {number[j]: turn for j, turn in state.turns.items() if j in number}
    joint = number.get(state.joint, 0)
    computed = dict.fromkeys(("binding", "bare_graph", "field", "dragged"))
    return changed_only(state, {**changed, **computed, "turns": turns, "joint": joint})


def same_structure(one: Rig, other: Rig) -> bool:
    """Whether two rigs have the same joints by name, each with the same parent."""
    a, b = one.skeleton, other.skeleton
    return a.names == b.names and np.array_equal(a.parents, b.parents)


def _numbers(before: Rig, after: Rig) -> dict[int, int]:
    """Return the index after of each joint before that stays, by its index."""

    def keys(rig: Rig) -> list[Any]:
        names, origin = rig.skeleton.names, rig.origin
        if origin is None:
            return list(range(len(names)))
        return [int(o) if o >= 0 else name for o, name in zip(origin, names, strict=True)]

    a, b = before.skeleton, after.skeleton
    if np.array_equal(a.parents, b.parents) and np.array_equal(a.joints, b.joints):
        return {j: j for j in range(len(a.names))}  # some are called otherwise
    index_of = {key: j for j, key in enumerate(keys(after))}
    return {j: index_of[key] for j, key in enumerate(keys(before)) if key in index_of}


def measured(corrections: Corrections) -> Corrections:
    """Return the part of corrections that distances, or weights of many joints, depend on.

    Locks, glue and overruled vertices are applied to the weights that come of it.
    """
    joints = {name: replace(one, locked=False) for name, one in corrections.joints.items()}
    parts = {v: part for v, part in corrections.parts.items() if part.how == "itself"}
    return tidy(Corrections(joints, parts, removed=corrections.removed))


def renamed(corrections: Corrections, name: str, new: str) -> Corrections:
    """Return corrections with a joint called otherwise, wherever they name it."""

    def now(joint: Any) -> Any:
        return new if joint == name else joint

    one = corrections.joints.get(name, JointCorrection())
    was = None if one.added else one.was or name
    one = replace(one, was=None if was == new else was)
    corrected = {now(key): other for key, other in {**corrections.joints, name: one}.items()}
    return replace(
        corrections,
        joints={key: replace(other, parent=now(other.parent)) for key, other in corrected.items()},
        parts={v: replace(part, joint=now(part.joint)) for v, part in corrections.parts.items()},
        vertices={
            v: {now(joint): weight for joint, weight in weights.items()}
            for v, weights in corrections.vertices.items()
        },
    )


def tidy(corrections: Corrections) -> Corrections:
    """Return corrections without those of joints that correct nothing."""
    nothing = JointCorrection()
    joints = {name: one for name, one in corrections.joints.items() if one != nothing}
    return replace(corrections, joints=joints)


def changed_only(state: Any, choices: dict[str, Any]) -> dict[str, Any]:
    """Return what of some choices the state does not hold; param takes the same for new."""
    large = {name: getattr(state, name) for name in ("rig", "own", "corrections", "binding")}
    return {
        name: value
        for name, value in choices.items()
        if name not in large or not (value is large[name] or value == large[name])
    }


def to_text(corrections: Corrections) -> str:
    """Return corrections in letters that an address may hold."""
    packed = zlib.compress(corrections.to_json(indent=None).encode(), 9)
    return base64.urlsafe_b64encode(packed).decode().rstrip("=")


def from_text(text: str) -> Corrections:
    """Read what `to_text` returns.

    Raises
    ------
    ValueError
        It is something else.
    """
    try:
        packed = base64.urlsafe_b64decode(text + "=" * (-len(text) % 4))
        plain = zlib.decompressobj().decompress(packed, MAX_BYTES)
        return Corrections.from_json(plain.decode())
    except (binascii.Error, zlib.error, UnicodeDecodeError, CutcellError) as error:
        raise ValueError(str(error)) from None
