"""What a person can choose on the panel Weights."""

from __future__ import annotations

from typing import Any

import param


class WeightsChoices(param.Parameterized):
    """Which weights are seen."""

    weights_shown: Any = param.Selector(default="mix", objects=["mix", "bone"])
