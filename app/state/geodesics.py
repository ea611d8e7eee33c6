"""What a person can choose on the panel Geodesics."""

from __future__ import annotations

from typing import Any

import param


class GeodesicsChoices(param.Parameterized):
    """Which distances are seen."""

    field: Any = param.Parameter(None, doc="(binding, joint, distance at every graph node).")
