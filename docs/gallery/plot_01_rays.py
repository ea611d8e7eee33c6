"""
Rays cut by a mesh
==================

One slice of the lattice. Winding numbers classify the pieces between two crossings: orange pieces are
inside.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(
    rig, Choices("graph", settings={"slicing": True, "slice_axis": "z", "body": False})
)
picture = cutcell_viewers.show(scene)
