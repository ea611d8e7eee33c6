"""
Winding numbers on a cut
========================

About 1 inside, 0 outside, and in between near a hole.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped_cape"))
scene = describe(
    rig, Choices("distance", bone="hips", settings={"cut_axis": "z", "cut_face": "winding"})
)
picture = cutcell_viewers.show(scene)
