"""
Why weights fail
================

Most failures have one of three causes: distance is measured through the air, a part of the mesh is cut off from
every bone, or faces are inside out. Each can be seen and measured.
"""

import cutcell
import cutcell_lab
import cutcell_viewers
from cutcell.graph import INTERIOR
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

# %%
# **Through the air.** With straight distances the trousers follow the hand that hangs beside them.

rig = cutcell.load(demo_path("biped"))
scene = describe(rig, Choices("compare", bone="hand.L", methods=["euclidean", "cutcell_any"]))
picture = cutcell_viewers.show(scene, size=(1200, 675))

# %%
# **Cut off.** The cape of this character does not touch the body. No path leads to it, so its vertices follow
# their nearest bones in a straight line, and `diagnose` reports them.

cape = cutcell.load(demo_path("biped_cape"))
diagnosis = cutcell.diagnose(cape)
for finding in diagnosis.findings:
    print(finding.severity, finding.code, "-", finding.message)

# %%
# The scene marks the vertices of a finding.

scene = describe(cape, Choices("check", finding="unreachable-vertices"))
picture = cutcell_viewers.show(scene)

# %%
# **Inside out.** The faces of one arm point inward. cutcell treats them as flipped while it binds. Without this, the
# arm is classified as outside and loses its interior nodes. Distances then lead along its surface, and weights are farther
# from those of the file.

flipped = cutcell.load(demo_path("biped_flipped_arm"))
for orient in (True, False):
    binding = cutcell.bind(flipped, orient=orient)
    interior = (binding.graph.node_kind == INTERIOR).sum()
    difference = cutcell_lab.metrics.weight_l1(flipped.weights, binding.weights)
    print(f"orient={orient}: {interior} interior nodes, L1 to the file {difference:.2f}")
