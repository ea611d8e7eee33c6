"""Everything that a person can choose on the page, and what was computed for it.

One object a browser session, made of one class a panel. It knows no widget and no layout.
"""

from __future__ import annotations

from .common import PANELS, UNSEEN, Common
from .compare import CompareChoices
from .geodesics import GeodesicsChoices
from .graph import LAYERS, GraphChoices
from .pose import PoseChoices
from .weights import WeightsChoices

__all__ = ["LAYERS", "MAX_UPLOAD", "PANELS", "UNSEEN", "State"]

MAX_UPLOAD = 200 * 1024 * 1024
"""The largest file that the page takes, in bytes."""


class State(GraphChoices, GeodesicsChoices, WeightsChoices, PoseChoices, CompareChoices, Common):
    """What the page shows."""
