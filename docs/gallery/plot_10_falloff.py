"""
The paper's falloff
===================

The parameter alpha of the paper says how fast weights decrease with distance. From left to right it is 0, 0.5 and
1.
"""

from PIL import Image

import cutcell
import cutcell_viewers
from cutcell_assets import demo_path
from cutcell_viewers.weights_scene import weights_scene

rig = cutcell.load(demo_path("biped"))
joint = rig.skeleton.names.index("chest")
picture = Image.new("RGB", (1200, 500))
for column, alpha in enumerate([0.0, 0.5, 1.0]):
    weights = cutcell.bind(rig, method=cutcell.PAPER.with_options(alpha=alpha)).weights
    one = cutcell_viewers.show(weights_scene(rig, weights, joint), size=(400, 500), legend=False)
    picture.paste(one, (400 * column, 0))
