"""What the panel Check shows: what is wrong with the character, and what was repaired."""

from dataclasses import dataclass
from typing import Any

import param

from cutcell.rig import Rig


@dataclass(frozen=True, eq=False)
class Repair:
    """What was repaired of the character that stands there.

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
    def found(self) -> Any:
        """The finding that is looked at, or None."""
        if self.diagnosis is None or self.finding not in self.diagnosis:
            return None
        return self.diagnosis[self.finding]
