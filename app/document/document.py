"""The document: a character, its repairs, its edits and its choices; and the history of documents.

Everything that a person makes of a character is a value. The rig that is shown follows from it, and
only `put` sets it; only `document.opening` exchanges the character.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import Any

import numpy as np

from cutcell.editing import Edits, edited_rig
from cutcell.rig import Rig

TOGETHER = 0.7
"""Changes of the same things that follow each other within this many seconds are one."""

STEPS = 200

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
        changed |= changed_only(state, {"rig": _rig_of(state, changed, *parts)})
    rig, edits = changed.get("rig", state.rig), parts[-1]
    if state.rig is not None and not same_structure(state.rig, rig):
        changed = {**_following(state, rig), **changed, "moved": None}
    layer = changed.get("layer", state.layer)
    if layer is not None and layer >= len(edits.layers):
        changed["layer"] = None
    state.param.update(**changed)


def _rig_of(
    state: Any, changed: Mapping[str, Any], own: Rig, repair: Repair | None, edits: Edits
) -> Rig:
    of_skeleton = attrgetter("joints", "removed")
    if not changed.keys() & {"own", "repair"} and of_skeleton(edits) == of_skeleton(state.edits):
        return edited_rig(state.rig, edits)  # only layers change: the rig stays the same object
    return applied(own, repair, edits)


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


class History:
    """The documents that a person can return to, across characters.

    Only a new document drops those that were undone.
    """

    def __init__(self, first: Document | None = None) -> None:
        self._documents = [] if first is None else [first]
        self._place = 0
        self._last: tuple[frozenset[str], float] = (frozenset(), -1e9)
        self.is_restoring = False

    def __len__(self) -> int:
        """Return the number of documents up to the present one."""
        return self._place + 1

    @property
    def now(self) -> Document | None:
        """The present document; None before any."""
        return self._documents[self._place] if self._documents else None

    @property
    def can_undo(self) -> bool:
        """Whether there is anything to go back to."""
        return self._place > 0

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return self._place + 1 < len(self._documents)

    @contextmanager
    def restoring(self) -> Iterator[None]:
        """Note no choices for a while: those of the past are restored."""
        before, self.is_restoring = self.is_restoring, True
        try:
            yield
        finally:
            self.is_restoring = before

    def peek(self, by: int) -> Document | None:
        """Return the document some steps away, backwards if negative; None if there is none."""
        place = self._place + by
        return self._documents[place] if 0 <= place < len(self._documents) else None

    def go(self, by: int, now: Document) -> None:
        """Go some steps; the document there is open now as given."""
        self._place += by
        self._replace(now)
        self.part()

    def note(self, now: Document, time: float) -> None:
        """Note what is chosen now. Going to another panel by itself is no step."""
        if self.is_restoring or self.now is None:
            return
        changed = now.differences(self.now)
        if not changed - {"panel"}:
            self._replace(now)
            return
        names, when = self._last
        if changed <= names and time - when < TOGETHER and self.can_undo:
            del self._documents[self._place + 1 :]
            self._replace(now)
        else:
            self._append(now)
        self._last = (changed, time)

    def open(self, now: Document) -> None:
        """Note a character that was opened; without keys of both, nobody can go back."""
        if self.now is None or not self.now.source or not now.source:
            self._documents, self._place = [now], 0
        else:
            self._append(now)
            self._replace(now)
        self.part()

    def replace_current(self, now: Document) -> None:
        """Replace the present document; where it is the one before again, there is no step."""
        self._replace(now)
        before = self.peek(-1)
        if before is not None and not now.differences(before):
            del self._documents[self._place]
            self._place -= 1

    def put_away(self) -> History:
        """Return a history of the same steps, whose documents are put away."""
        history = History()
        history._documents = [one.put_away() for one in self._documents]
        history._place = self._place
        return history

    def shorten(self) -> bool:
        """Drop half of the documents, the present one's past last; return whether any went."""
        half = len(self._documents) // 2
        if not half:
            return False
        start = max(self._place + 1 - half, 0)
        self._documents = self._documents[start : start + half]
        self._place -= start
        return True

    def part(self) -> None:
        """Make the next change a separate step, however soon it follows."""
        self._last = (frozenset(), -1e9)

    def _append(self, now: Document) -> None:
        self._documents = [*self._documents[: self._place + 1], now][-STEPS - 1 :]
        self._place = len(self._documents) - 1

    def _replace(self, now: Document) -> None:
        """Replace the present document; put those of other characters away."""
        if self._documents[self._place].own is not now.own:
            self._documents = [
                one if one.own is None or one.own is now.own else one.put_away()
                for one in self._documents
            ]
        self._documents[self._place] = now
