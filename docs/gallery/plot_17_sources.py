"""
Where distances begin
=====================

Sources are the nodes of the graph nearest to sample points on the bone. Each starts at its straight distance.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(
    rig, Choices("distance", bone="thigh.L", settings={"starts": True, "cut_axis": "z"})
)
picture = cutcell_viewers.show(scene)
