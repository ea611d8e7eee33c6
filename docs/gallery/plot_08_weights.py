"""
The weights of one bone
=======================

Where the skin is bright it follows this bone alone.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(rig, Choices("weights", bone="upper_arm.L"))
picture = cutcell_viewers.show(scene)
