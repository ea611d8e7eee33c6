"""
Exercise 1: linear blend skinning
=================================

**Task.** A character has rest vertices, weights and one 4 x 4 matrix for each joint that moves rest points to posed
points. Write a function ``skin(vertices, weights, matrices)`` that returns the posed vertices: each vertex is the
weighted mean of where the joints would take it. Turn the arm by 60 degrees and draw the result.

**Questions.** What happens to a row of weights that sums to 0.9? Why does an elbow become thinner when it turns by
150 degrees?

The solution follows. Cover it before you hand out this page.
"""

import numpy as np

import cutcell
import cutcell_viewers
from cutcell_assets import demo_path
from cutcell_viewers.pose_scene import joint_turns, pose_scene, turn

rig = cutcell.load(demo_path("biped"))
joint = rig.skeleton.names.index("upper_arm.L")
turns = joint_turns(rig, {joint: turn("z", 60)})
matrices = cutcell.forward_kinematics(rig.skeleton, turns)


def skin(vertices, weights, matrices):
    """Return vertices (n, 3) posed by matrices (j, 4, 4) with weights (n, j)."""
    corners = np.hstack([vertices, np.ones((len(vertices), 1))])
    moved = np.einsum("jab,nb->nja", matrices, corners)[..., :3]
    return (weights[..., None] * moved).sum(axis=1)


# %%
# The function agrees with the one of the library.

posed = skin(rig.mesh.vertices, rig.weights, matrices)
expected = cutcell.linear_blend_skinning(rig.mesh.vertices, rig.weights, matrices)
print("largest difference:", np.abs(posed - expected).max())

# %%

picture = cutcell_viewers.show(pose_scene(rig, rig.weights, matrices))

# %%
# **Answers.** A row that sums to 0.9 pulls its vertex towards the origin by a tenth. The mean of two rotations is no
# rotation: it shrinks, most where both joints count equally and the angle is large.
