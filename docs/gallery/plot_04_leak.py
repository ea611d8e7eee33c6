"""
Straight distance leaks, distance through the body does not
===========================================================

The hand hangs beside the hip. Weights from straight distances let the trousers follow it.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
methods = ["euclidean", "cutcell_any"]
scene = describe(rig, Choices("compare", bone="hand.L", methods=methods))
picture = cutcell_viewers.show(scene, size=(1200, 675))
