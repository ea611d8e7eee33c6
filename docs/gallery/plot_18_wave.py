"""
The shortest-path search step by step
=====================================

All points up to a part of the greatest distance are coloured.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("rabbit"))
scene = describe(rig, Choices("distance", bone="hips", settings={"wave": True, "front": 0.4}))
picture = cutcell_viewers.show(scene)
