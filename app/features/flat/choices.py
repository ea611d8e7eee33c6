"""Choices of the flat scene: one plane of the lattice, drawn and searched in the browser."""

from typing import Any

import param

MODES = {"Off": "", "Rays": "rays", "Winding": "winding", "Graph": "graph", "Search": "search"}


class Choices(param.Parameterized):
    """Mode and data of the flat scene. Its plane is the slice of the panel Graph."""

    flat: param.Selector[str] = param.Selector(default="", objects=MODES, label="Flat scene")
    flat_data: Any = param.Parameter(None, doc="`FlatSection.data` as JSON, or None so far.")
