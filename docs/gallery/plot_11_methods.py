"""
Methods side by side
====================

The weights of one bone by cutcell, bone heat and straight distances.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(rig, Choices("compare", bone="thigh.L", methods=["now", "bone_heat", "euclidean"]))
picture = cutcell_viewers.show(scene, size=(1200, 675))
