"""Choices of the list of disagreements, on the panel Compare."""

from typing import Any

import param


class Choices(param.Parameterized):
    """Which methods are compared, and which region is looked at."""

    first_method = param.String("", doc="The method that is compared; empty for any.")
    second_method = param.String("", doc="The method that it is compared with; empty for any.")
    disagreement: Any = param.Parameter(
        None, doc="The cutcell_lab.disagreement.Disagreement of both, or None so far."
    )
    region = param.String("", doc="Key of the region that is looked at; empty for none.")
    settled: Any = param.Parameter(
        (), doc="Keys of the regions, texts like `KEY`, that are listed no more."
    )
