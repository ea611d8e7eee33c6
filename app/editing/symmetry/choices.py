"""State of the map of symmetry, a choice of colours on the panel Weights."""

from typing import Any

import param


class Choices(param.Parameterized):
    """The mirror image of the character, and how far its weights are from theirs."""

    mirror_image: Any = param.Parameter(
        None, doc="The cutcell.diagnosis.asymmetry.MirrorImage, a text why there is none, or None."
    )
    asymmetry: Any = param.Parameter(
        None, doc="An `Asymmetry` of the weights that are seen, or None so far."
    )
