"""State of the panel Check: findings, and repairs."""

from dataclasses import dataclass
from typing import Any

import param

from cutcell.rig import Rig


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
    """

    before: Rig
    after: Rig
    counts: dict[str, int]
    done: tuple[str, ...]


class DiagnosisChoices(param.Parameterized):
    """The findings, and which of them is looked at."""

    diagnosis: Any = param.Parameter(None, doc="The cutcell.Diagnosis, or None so far.")
    finding: Any = param.String("", doc="Code of the finding that is looked at; else empty.")
    repair: Any = param.Parameter(None, doc="A `Repair` of this character, or None.")

    @property
    def selected_finding(self) -> Any:
        """The finding that is looked at, or None."""
        if self.diagnosis is None or self.finding not in self.diagnosis:
            return None
        return self.diagnosis[self.finding]
