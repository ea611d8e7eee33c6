"""
Paths along 6 axes, 26 diagonals, and any angle
===============================================

Along the axes a path goes round corners. At any angle it runs straight, as long as it stays inside.
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
        bone="thigh.L",
        settings={"beside_6": True, "beside_26": True, "beside_any": True, "cut_axis": "z"},
    ),
)
picture = cutcell_viewers.show(scene, size=(1200, 675))
