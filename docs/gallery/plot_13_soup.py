"""
A torn mesh has the same weights
================================

Every triangle of the second character has its own vertices. The graph joins them, and the weights agree.
"""

from PIL import Image

import cutcell
import cutcell_viewers
from cutcell_assets import demo_path
from cutcell_viewers.weights_scene import weights_scene

picture = Image.new("RGB", (1000, 600))
for column, name in enumerate(["biped", "biped_soup"]):
    rig = cutcell.load(demo_path(name))
    scene = weights_scene(rig, cutcell.bind(rig).weights)
    picture.paste(cutcell_viewers.show(scene, size=(500, 600)), (500 * column, 0))
