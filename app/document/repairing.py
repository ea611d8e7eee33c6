"""Repairs of a character as its file has it, for the findings of the character as it is shown."""

from collections.abc import Collection, Iterable

from cutcell.diagnosis import Diagnosis, diagnose
from cutcell.editing import Edits
from cutcell.errors import CutcellError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress

from .document import Repair, applied


def repaired(
    own: Rig, earlier: Repair | None, diagnosis: Diagnosis, codes: Collection[str]
) -> Repair:
    """Return earlier repairs of a character and those of some findings.

    Repairs change faces and weights of vertices, whose numbers edits of the skeleton leave as they
    are: so the character itself is repaired, and all edits stay.
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
