"""State of the panel Check: findings, and repairs."""

from dataclasses import dataclass
from typing import Any

import param

from cutcell.rig import Rig

from ..panel import Panel

EXPORT = "export:"
"""Before the code of a finding about the weights that an export contains."""


@dataclass(frozen=True, eq=False)
class Repair:
    """Repairs of the current character.

    Parameters
    ----------
    before, after : Rig
    counts : dict of str to int
        How many findings of each severity there were before.
    done : tuple of str
        What was done, in sentences.
    in_vain : frozenset of str
        Codes of findings whose last repair did not help.
    """

    before: Rig
    after: Rig
    counts: dict[str, int]
    done: tuple[str, ...]
    in_vain: frozenset[str] = frozenset()


PANEL = Panel(
    "Check",
    '<path d="M2.5 12.5h4l2.5-6 4 12 3-9 1.5 3h4"/>',
    works_without_skeleton=True,
)


class Choices(param.Parameterized):
    """The findings, and which of them is looked at."""

    diagnosis: Any = param.Parameter(None, doc="The cutcell.Diagnosis, or None so far.")
    export_diagnosis: Any = param.Parameter(
        None, doc="The cutcell.Diagnosis of the weights that an export contains, or None so far."
    )
    finding = param.String(
        "", doc="Code of the selected finding, after `EXPORT` one of the export; else empty."
    )
    repair: Any = param.Parameter(None, doc="A `Repair` of this character, or None.")

    @property
    def selected_finding(self) -> Any:
        """The finding that is looked at, or None."""
        code = self.finding.removeprefix(EXPORT)
        diagnosis = self.diagnosis if code == self.finding else self.export_diagnosis
        return diagnosis[code] if diagnosis is not None and code in diagnosis else None
