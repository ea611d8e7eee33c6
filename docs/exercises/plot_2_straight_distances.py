"""
Exercise 2: weights from straight distances
===========================================

**Task.** Compute the straight distance from every vertex to every bone, a segment from a joint to its child. Turn
distances into weights by one over the square, and make rows sum to one. Draw the weights of the hand.

**Question.** Which vertices outside the arm follow the hand, and why?

The solution follows.
"""

import numpy as np

import cutcell
import cutcell_viewers
from cutcell_assets import demo_path
from cutcell_viewers.weights_scene import weights_scene

rig = cutcell.load(demo_path("biped"))
bones = cutcell.bone_segments(rig.skeleton)


def distance_to_segment(points, start, end):
    """Return the distance of points (n, 3) to a segment."""
    along = end - start
    t = np.clip((points - start) @ along / max(along @ along, 1e-12), 0, 1)
    return np.linalg.norm(points - (start + t[:, None] * along), axis=1)


# %%
# A joint may own several bones; the nearest one counts.

distances = np.full((len(rig.mesh.vertices), len(rig.skeleton.names)), np.inf)
for a, b, joint in zip(bones.start, bones.end, bones.joint, strict=True):
    near = distance_to_segment(rig.mesh.vertices, a, b)
    distances[:, joint] = np.minimum(distances[:, joint], near)
weights = 1 / np.maximum(distances, 1e-6) ** 2
weights /= weights.sum(axis=1, keepdims=True)
np.save("straight_weights.npy", weights)

hand = rig.skeleton.names.index("hand.L")
picture = cutcell_viewers.show(weights_scene(rig, weights, hand))

# %%
# **Answer.** The hip and the thigh beside the hand: they are close in space, although the way through the body leads
# up the arm and down again.
