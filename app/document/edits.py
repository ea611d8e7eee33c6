"""Edits of the character."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import param

from cutcell.binding import Binding
from cutcell.editing import Edits, JointEdit, edited_rig
from cutcell.editing.restructure import restructured_skeleton
from cutcell.rig import Rig


class Choices(param.Parameterized):
    """Edits of the current character."""

    if TYPE_CHECKING:
        binding: Any

    edits: Any = param.Parameter(Edits(), doc="A cutcell.Edits.")
    opening: Any = param.Parameter(Edits(), doc="The edits that the character was opened with.")
    layer = param.Integer(None, allow_None=True, doc="The place of the chosen layer; 0 is lowest.")
    own: Any = param.Parameter(None, doc="The character without edits: a cutcell.Rig.")
    joint_handle = param.Boolean(False, label="Show move handle")
    mirrored = param.Boolean(True, label="Mirror")
    moved: Any = param.Parameter(
        None, doc="The rig and its edits while joints are dragged; else None."
    )
    previewer: Any = param.Parameter(None, doc="A `Preview` of the open character, or None.")
    preview: Any = param.Parameter(None, doc="About the binding of the moved rig, or None.")
    exact_preview: Any = param.Parameter(None, doc="The binding of the moved rig, or None so far.")
    part = param.Integer(
        None, allow_None=True, doc="A vertex of the connected component that is looked at."
    )

    @property
    def first_edits(self) -> Edits:
        """The edits that the character was opened with; choices hold their method."""
        return replace(self.opening, method={})

    @property
    def dragged(self) -> Any:
        """Preview while joints are dragged, before the edits follow; else None."""
        if self.moved is None:
            return None
        binding: Any = self.exact_preview or self.preview
        return Dragged(self.moved[0], binding or self.binding)

    @property
    def own_skeleton(self) -> Any:
        """The skeleton where nothing is edited of it but which joints there are."""
        if self.own is None:
            return None
        return restructured_skeleton(self.own.skeleton, self.edits)[0]


@dataclass(frozen=True, eq=False)
class Dragged:
    """Preview while joints are dragged: the rig as the pointer has it, and the newest binding."""

    rig: Rig
    binding: Binding


def edited_state(state: Any, edits: Edits) -> dict[str, Any]:
    """Return the values of the state that edits of the open character change."""
    return changes(state, edited_rig(state.own, edits), edits)


def changes(state: Any, rig: Rig, edits: Edits) -> dict[str, Any]:
    """Return what of a state changes with edits and the rig that they make.

    Where the skeleton has other joints, nothing that was computed holds any more, and what was
    chosen of joints follows them.
    """
    changed = {"edits": edits, "rig": rig}
    if same_structure(state.rig, rig):
        return changed_only(state, changed)
    number = _numbers(state.rig, rig)
    turns = {number[j]: turn for j, turn in state.turns.items() if j in number}
    joint = number.get(state.joint, 0)
    return changed_only(state, {**changed, "turns": turns, "joint": joint, "moved": None})


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


def renamed(edits: Edits, name: str, new: str) -> Edits:
    """Return edits with a joint called otherwise, wherever they name it."""

    def now(joint: Any) -> Any:
        return new if joint == name else joint

    one = edits.joints.get(name, JointEdit())
    was = None if one.added else one.was or name
    one = replace(one, was=None if was == new else was)
    edited = {now(key): other for key, other in {**edits.joints, name: one}.items()}
    joints = {
        key: replace(other, parent=now(other.parent), partner=now(other.partner))
        for key, other in edited.items()
    }
    return replace(edits.renamed(now), joints=joints)


def tidy(edits: Edits) -> Edits:
    """Return edits without those of joints that change nothing."""
    nothing = JointEdit()
    joints = {name: one for name, one in edits.joints.items() if one != nothing}
    return edits if len(joints) == len(edits.joints) else replace(edits, joints=joints)


def changed_only(state: Any, choices: dict[str, Any]) -> dict[str, Any]:
    """Return what of some choices the state does not hold; param takes the same for new."""
    large = {name: getattr(state, name) for name in ("rig", "own", "edits", "binding")}
    return {
        name: value
        for name, value in choices.items()
        if name not in large or not (value is large[name] or value == large[name])
    }
