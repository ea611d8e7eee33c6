"""Edits and repairs of the character."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import param

from cutcell.binding import Binding
from cutcell.diagnosis import Diagnosis, diagnose
from cutcell.editing import Edits, JointEdit
from cutcell.editing.restructure import restructured_skeleton
from cutcell.editing.stored import stored_edits
from cutcell.errors import CutcellError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress

from .common import MOMENT
from .document import Repair, applied


class Choices(param.Parameterized):
    """Edits of the current character."""

    if TYPE_CHECKING:
        binding: Any

    edits: Any = param.Parameter(Edits(), doc="A cutcell.Edits.")
    opening: Any = param.Parameter(Edits(), doc="The edits that the character was opened with.")
    layer = param.Integer(
        None, allow_None=True, doc="The place of the chosen layer; 0 is lowest.", precedence=MOMENT
    )
    own: Any = param.Parameter(None, doc="The character without edits: a cutcell.Rig.")
    joint_handle = param.Boolean(False, label="Show move handle", precedence=MOMENT)
    mirrored = param.Boolean(True, label="Mirror")
    moved: Any = param.Parameter(
        None, doc="The rig and its edits while joints are dragged; else None."
    )
    previewer: Any = param.Parameter(None, doc="A `Preview` of the open character, or None.")
    preview: Any = param.Parameter(None, doc="About the binding of the moved rig, or None.")
    exact_preview: Any = param.Parameter(None, doc="The binding of the moved rig, or None so far.")
    part = param.Integer(
        None,
        allow_None=True,
        doc="A vertex of the connected component that is looked at.",
        precedence=MOMENT,
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


def edits_in(rig: Rig) -> tuple[Edits, str]:
    """Return the edits that a character's file holds, and why they are not applied, if so."""
    try:
        edits = stored_edits(rig) or Edits()
        applied(rig, None, edits)
    except CutcellError as error:
        return Edits(), f"The layers of the file were not applied: {error}"
    return edits, ""


def repaired(
    own: Rig, earlier: Repair | None, diagnosis: Diagnosis, codes: Collection[str]
) -> Repair:
    """Return earlier repairs of a character and those of some findings.

    The findings are of the character as it is shown, and the character is repaired as its file has
    it: repairs change faces and weights of vertices, whose numbers all edits leave as they are.
    """
    base = own if earlier is None or earlier.after is None else earlier.after
    result = Diagnosis(base, diagnosis.findings).repaired(codes)
    in_vain = frozenset(finding.code for finding in result.in_vain)
    done = tuple(finding.code for finding in result.repaired)
    if earlier is None:
        earlier = Repair((), base, diagnosis.counts, ())
    if not done:  # nothing changed, and what did not help before does not now
        in_vain |= earlier.in_vain
    return Repair(
        (*earlier.codes, done) if done else earlier.codes,
        result.rig if done else base,
        earlier.counts,
        (*earlier.done, *result.done),
        in_vain,
    )


def repaired_again(
    own: Rig,
    codes: Iterable[Collection[str]],
    edits: Edits,
    resolution: int,
    progress: Progress,
) -> tuple[Repair | None, str]:
    """Return the repairs of an address or of a document, and what could not be repeated."""
    repair, missing = None, []
    for some in codes:
        try:
            rig = applied(own, repair, edits)
        except CutcellError:
            rig = applied(own, repair, Edits())  # the edits are reported when they are applied
        diagnosis = diagnose(rig, resolution, progress=progress)
        able = [code for code in some if code in diagnosis and diagnosis[code].repair]
        missing += [code for code in some if code not in able]
        if able:
            repair = repaired(own, repair, diagnosis, able)
    text = f"There was nothing to repair of {', '.join(missing)}." if missing else ""
    return repair, text


def uses_weights(before: Repair | None, after: Repair, own: Rig) -> bool:
    """Return whether a repair changed the file's weights."""
    first = own if before is None or before.after is None else before.after
    return after.after is not None and after.after.weights is not first.weights
