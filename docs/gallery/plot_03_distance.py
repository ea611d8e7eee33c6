"""
Distance through the body
=========================

The field of one bone on a cut, with lines of equal distance.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(rig, Choices("distance", bone="thigh.L", settings={"cut_axis": "z"}))
picture = cutcell_viewers.show(scene)
