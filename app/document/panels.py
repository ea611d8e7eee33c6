"""The choices and the panels of all features."""

from importlib import import_module
from typing import Any

from ..features import FEATURES
from ..features.panel import Panel

MODULES: dict[str, Any] = {
    name: import_module(f"cutcell_app.features.{name}.choices") for name in FEATURES
}

PANELS: dict[str, Panel] = {
    name: module.PANEL for name, module in MODULES.items() if hasattr(module, "PANEL")
}
"""By the name in the state, in the address and on the command line, in their order."""
