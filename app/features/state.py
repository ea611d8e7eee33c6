"""State of the page: the choices of all packages, and the panels."""

from typing import Any

import param

from ..document.state import Panel, State
from . import modules

_CHOICES = modules("choices")

PANELS: dict[str, Panel] = {
    name: module.PANEL for name, module in _CHOICES.items() if hasattr(module, "PANEL")
}
"""By the name in the state, in the address and on the command line, in their order."""

_CLASSES: Any = tuple(module.Choices for module in _CHOICES.values())


class PageState(*_CLASSES, State):  # type: ignore[misc]
    """Choices and results of one session of the page."""

    panels = PANELS
    tools = frozenset[str]().union(*(getattr(m, "TOOLS", ()) for m in _CHOICES.values()))

    panel: param.Selector[str] = param.Selector(default="weights", objects=list(PANELS))
