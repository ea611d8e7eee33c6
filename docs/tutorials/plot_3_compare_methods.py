"""
Compare methods
===============

`cutcell_lab.compare` binds a character by several methods and measures each against the weights of the file.
"""

import cutcell
import cutcell_lab
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))

# %%
# L1 is the mean over vertices of the summed absolute differences of weights, from 0 to 2. The deformation error
# is the mean squared distance of vertices in random poses, in cm² on a character of one metre.

comparison = cutcell_lab.compare([rig], ["cutcell_rig", "cutcell", "bone_heat", "euclidean"])
for method in comparison.methods:
    l1, error = (comparison.statistic(method, name).median for name in ("l1", "deformation"))
    print(f"{method:12} L1 {l1:.2f}  deformation error {error:.2f} cm²")
