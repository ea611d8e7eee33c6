"""Choices of the laboratory: which option is swept, and over which values."""

from __future__ import annotations

from typing import Any

import param

from cutcell.errors import ParameterError
from cutcell_lab.sweeps import parsed_values, value_text

from ....document.common import MOMENT

OPTIONS = {
    "Resolution R": "resolution",
    "Winding threshold τ": "winding_threshold",
    "Connectivity": "connectivity",
    "Bone ends": "leaf",
    "Inverted faces flipped": "orient",
    "Falloff": "falloff",
    "Smoothness α": "alpha",
    "Max influences": "max_influences",
    "Ignored weights": "threshold",
}
"""Options that can be swept: those that the page can choose."""

VALUES = {
    "resolution": "16,32,48,64,96,128",
    "winding_threshold": "0.1,0.3,0.5,0.7,0.9",
    "connectivity": "6,26,any",
    "leaf": "point,extend,fit",
    "orient": "yes,no",
    "falloff": "rig,paper",
    "alpha": "0,0.25,0.5,0.75,1",
    "max_influences": "1,2,3,4,6,8",
    "threshold": "0,0.01,0.02,0.05,0.1",
}
"""Values that are offered for each."""

MAX_VALUES = 20

MEASURES = {
    "L1 of the weights": "l1",
    "Precision": "precision",
    "Recall": "recall",
    "Deformation error in mm": "deformation",
    "Unreachable vertices in %": "unreachable",
    "Seconds": "seconds",
}


class Choices(param.Parameterized):
    """Which option is swept, over which values, and which curve is shown."""

    sweep_of: param.Selector[str] = param.Selector(
        default="weights", objects={"Weights": "weights", "Distance": "distance"}
    )
    sweep_option: param.Selector[str] = param.Selector(default="resolution", objects=OPTIONS)
    sweep_values = param.String("", doc="Values with commas; empty for those of `VALUES`.")
    sweep_measure: param.Selector[str] = param.Selector(default="l1", objects=MEASURES)
    sweeping = param.Boolean(False, doc="Whether a sweep is being computed.", precedence=MOMENT)
    swept = param.Dict({}, doc="By the text of each value: its `SweepPoint`.")
    sweep_reference: Any = param.Parameter(
        None, doc="Weights that errors are against where the file has none, (n, j); or None."
    )
    error_curves: Any = param.Parameter(None, doc="`ErrorPoint`s of the chosen bone, or None.")
    measuring_errors = param.Boolean(
        False, doc="Whether errors are being measured.", precedence=MOMENT
    )

    @property
    def sweep_texts(self) -> list[str]:
        """The values of the sweep as texts; none where there is no value."""
        try:
            values = parsed_values(self.sweep_values or VALUES[self.sweep_option])
        except ParameterError:
            return []
        return list(dict.fromkeys(map(value_text, values)))[:MAX_VALUES]
