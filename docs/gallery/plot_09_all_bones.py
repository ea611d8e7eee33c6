"""
All bones at once
=================

Each bone has a colour, and the skin shows their mixture.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("octopus"))
scene = describe(rig, Choices("weights", shown="mix"))
picture = cutcell_viewers.show(scene)
