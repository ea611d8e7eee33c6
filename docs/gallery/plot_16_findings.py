"""
Findings of a check
===================

The cape has no path to any bone. `cutcell diagnose` reports it, and the scene marks it.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped_cape"))
scene = describe(rig, Choices("check", finding="unreachable-vertices"))
picture = cutcell_viewers.show(scene)
