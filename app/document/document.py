"""The document: a character, its repairs, its edits, and the choices that go with them.

Everything that a person makes of a character is a value. The rig that is shown follows from it, and
only `put` sets it; only `document.opening` exchanges the character.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cutcell.editing import Edits, edited_rig
from cutcell.rig import Rig

LARGE = ("rig", "own", "repair", "edits", "binding")
"""Values that are compared before they are set: param takes the same one for a new one."""


@dataclass(frozen=True)
class Repair:
    """Repairs of a character.

    Parameters
    ----------
    codes : tuple of tuple of str
        Codes of the findings that were repaired, of one repair after the other.
    after : Rig or None
        The repaired character without edits; None where it has to be computed again.
    counts : dict of str to int
        How many findings of each severity there were before.
    done : tuple of str
        What was done, in sentences.
    in_vain : frozenset of str
        Codes of findings whose last repair did not help.
    """

    codes: tuple[tuple[str, ...], ...]
    after: Rig | None = field(compare=False, repr=False)
    counts: Mapping[str, int] = field(compare=False)
    done: tuple[str, ...] = field(compare=False)
    in_vain: frozenset[str] = frozenset()


@dataclass(frozen=True, eq=False)
class Document:
    """All that is open at one time.

    Parameters
    ----------
    source : str
        Key that opens the character: "demo" and its id, or "~" and the key of uploaded files ("~"
        alone for those of this machine); empty where nothing opens it again.
    own : Rig or None
        The character as its file has it; None while another one is open.
    rig : Rig or None
        The character as it is shown; see `applied`.
    repair : Repair or None
    edits : Edits
    choices : dict
        Values of the state's parameters; see `address.snapshot`.
    """

    source: str
    own: Rig | None
    rig: Rig | None
    repair: Repair | None
    edits: Edits
    choices: Mapping[str, Any]

    def differences(self, other: Document) -> frozenset[str]:
        """Return the names of what differs, also of choices."""
        names = {n for n in self.choices if self.choices[n] != other.choices.get(n)}
        fields = ("source", "repair", "edits")
        return frozenset(names | {n for n in fields if getattr(self, n) != getattr(other, n)})

    def put_away(self) -> Document:
        """Return the document without what its file and its repairs bring back."""
        repair = self.repair and replace(self.repair, after=None)
        return replace(self, own=None, rig=None, repair=repair)


def applied(own: Rig, repair: Repair | None, edits: Edits) -> Rig:
    """Return a character with repairs, then edits; raise a `CutcellError` if they do not fit."""
    base = own if repair is None or repair.after is None else repair.after
    return edited_rig(base, edits)


def put(state: Any, **values: Any) -> None:
    """Set values of a state, and the rig that follows from "own", "repair" and "edits".

    Where the skeleton has other joints, what was chosen of joints follows them, unless the values
    say otherwise. Raises a `CutcellError`, and changes nothing, if the edits do not fit.
    """
    changed = changed_only(state, values)
    parts = [changed.get(name, getattr(state, name)) for name in ("own", "repair", "edits")]
    if changed.keys() & {"own", "repair", "edits"} and "rig" not in values:
        changed |= changed_only(state, {"rig": applied(*parts)})
    rig, edits = changed.get("rig", state.rig), parts[-1]
    if state.rig is not None and not same_structure(state.rig, rig):
        changed = {**_following(state, rig), **changed, "moved": None}
    if state.layer is not None and state.layer >= len(edits.layers):
        changed = {"layer": None, **changed}
    state.param.update(**changed)


def changed_only(state: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that a state does not hold."""
    return {
        name: value
        for name, value in values.items()
        if name not in LARGE or not (value is getattr(state, name) or value == getattr(state, name))
    }


def same_structure(one: Rig, other: Rig) -> bool:
    """Whether two rigs have the same joints by name, each with the same parent."""
    a, b = one.skeleton, other.skeleton
    return a.names == b.names and np.array_equal(a.parents, b.parents)


def _following(state: Any, rig: Rig) -> dict[str, Any]:
    """Return what is chosen of joints, by their numbers in another rig."""
    number = _numbers(state.rig, rig)
    turns = {number[j]: turn for j, turn in state.turns.items() if j in number}
    return {"turns": turns, "joint": number.get(state.joint, 0)}


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
