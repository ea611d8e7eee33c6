"""Errors of predictions, and their statistics over all rigs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..metrics import DEFINITIONS


@dataclass(frozen=True)
class RigErrors:
    """Errors of one prediction.

    Parameters
    ----------
    name : str
    predicted, reference : str
        The files.
    vertices, joints : int
        Those of the reference.
    errors : mapping
        By definition and measure, see `cutcell_lab.metrics.DEFINITIONS`. None: no number.
    warnings : tuple of str
        How vertices and joints were matched, and what was noticed while the files were read.
    """

    name: str
    predicted: str
    reference: str
    vertices: int
    joints: int
    errors: Mapping[str, Mapping[str, float | None]]
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Evaluation:
    """Errors of all predictions.

    Parameters
    ----------
    rigs : tuple of RigErrors
    failed : mapping of str to str
        Names of the rigs that could not be evaluated, and why.
    predicted_only, reference_only : tuple of str
        Names that have no counterpart.
    """

    rigs: tuple[RigErrors, ...]
    failed: Mapping[str, str]
    predicted_only: tuple[str, ...] = ()
    reference_only: tuple[str, ...] = ()

    def statistic(self, definition: str, measure: str) -> dict[str, float | None]:
        """Return the median and the mean of a measure over the rigs that have it."""
        values = [rig.errors[definition][measure] for rig in self.rigs]
        numbers = [value for value in values if value is not None]
        if not numbers:
            return {"median": None, "mean": None}
        return {"median": float(np.median(numbers)), "mean": float(np.mean(numbers))}

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain lists, dicts and numbers, for JSON."""
        return {
            "definitions": {name: definition.text for name, definition in DEFINITIONS.items()},
            "rigs": [asdict(rig) for rig in self.rigs],
            "summary": {
                name: {key: self.statistic(name, key) for key in definition.measures}
                for name, definition in DEFINITIONS.items()
            },
            "failed": dict(self.failed),
            "predicted_only": list(self.predicted_only),
            "reference_only": list(self.reference_only),
        }
