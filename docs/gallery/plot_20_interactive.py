"""
An interactive page
===================

Weights, distances, motion and graph of a character in one file, which needs no server.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless.interactive import interactive_page
from cutcell_assets import demo_path
from cutcell_viewers.weights_scene import weights_scene

rig = cutcell.load(demo_path("robot"))
binding = cutcell.bind(rig)
picture = cutcell_viewers.show(weights_scene(rig, binding.weights))

# %%
# The same in the browser; ``save("robot.html")`` would write the file.
cutcell.Page(interactive_page(rig, binding))
