"""
A pose with the new weights
===========================

The arm turns by 60 degrees, and the skin follows by linear blend skinning.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(rig, Choices("pose", bone="upper_arm.L", turn=("z", 60)))
picture = cutcell_viewers.show(scene)
