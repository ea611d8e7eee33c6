"""State of the page: the choices of all packages, and the panels."""

from typing import Any

import param

from ..document.state import Panel, State
from . import FEATURES

PANELS: dict[str, Panel] = {n: one.panel for n, one in FEATURES.items() if one.panel is not None}
"""By the name in the state, in the address and on the command line, in their order."""

_CLASSES: Any = tuple(one.choices for one in FEATURES.values() if one.choices is not None)


class PageState(*_CLASSES, State):  # type: ignore[misc]
    """Choices and results of one session of the page."""

    panels = PANELS
    tools = frozenset[str]().union(*(one.tools for one in FEATURES.values()))

    panel: param.Selector[str] = param.Selector(default="weights", objects=list(PANELS))
