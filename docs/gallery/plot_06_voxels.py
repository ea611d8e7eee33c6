"""
Compared with voxels and straight lines
=======================================

Voxels join parts that nearly touch; straight lines leave the body.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(
    rig,
    Choices(
        "distance",
        bone="hand.L",
        settings={"beside_straight": True, "beside_voxel": True, "beside_any": True},
    ),
)
picture = cutcell_viewers.show(scene, size=(1200, 675))
