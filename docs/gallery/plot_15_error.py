"""
How far from the artist's weights
=================================

The same pose with the weights of the file and with computed ones: colours show the distance.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(rig, Choices("pose", bone="upper_arm.L", turn=("z", 60), error=True))
picture = cutcell_viewers.show(scene)
