"""Choices of the transfer of weights to clothes and levels of detail."""

from __future__ import annotations

import param


class Choices(param.Parameterized):
    """Which vertices of a dropped mesh are matched; see `cutcell.transfer`."""

    transfer_distance = param.Number(
        5.0, bounds=(0, 30), step=0.5, label="Distance (% of diagonal)",
        doc="Greatest distance of a match, in percent of the diagonal of the bounding box.",
    )  # fmt: skip
    transfer_angle = param.Number(
        30.0, bounds=(0, 180), step=5, label="Angle of normals",
        doc="Greatest angle between the normals of a match, in degrees.",
    )  # fmt: skip
    transfer_flipped = param.Boolean(False, label="Match opposite normals")


TOOLS = frozenset(Choices.param) - {"name"}
"""They count when a mesh is dropped: undo takes the transfer back, not these."""
