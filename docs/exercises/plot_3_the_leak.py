"""
Exercise 3: see the leak, and mend it
=====================================

**Task.** Count how much weight of the left hand lies on vertices that the file gives to the legs. Do it for weights
from straight distances and for weights from `cutcell.bone_distances` with the same falloff. Then lift the arm with
both and compare.

The solution follows.
"""

import numpy as np
from PIL import Image

import cutcell
import cutcell_viewers
from cutcell_assets import demo_path
from cutcell_viewers.pose_scene import joint_turns, pose_scene, turn

rig = cutcell.load(demo_path("biped"))
names = rig.skeleton.names
hand = names.index("hand.L")
legs = [k for k, name in enumerate(names) if "thigh" in name or "shin" in name]
on_legs = rig.weights[:, legs].sum(axis=1) > 0.5


def falloff(distances):
    """Return weights (n, j) from distances (n, j): one over the square, rows sum to one."""
    weights = 1 / np.maximum(distances, 1e-3) ** 2
    return weights / weights.sum(axis=1, keepdims=True)


# %%
# Distances through the body come from the graph. `all_joints` has a row for each joint.

graph = cutcell.build_graph(rig.mesh)
through = cutcell.bone_distances(graph, rig.skeleton).all_joints().T
through = np.nan_to_num(through, nan=np.inf, posinf=np.inf)

# %%
# Exercise 2 saved the straight weights: run it first.

straight = np.load("straight_weights.npy")
for name, weights in {"straight": straight, "through the body": falloff(through)}.items():
    print(f"{name}: {weights[on_legs, hand].mean():.4f} per vertex of the legs")

# %%

arm = names.index("upper_arm.L")
turns = joint_turns(rig, {arm: turn("z", 70)})
matrices = cutcell.forward_kinematics(rig.skeleton, turns)
picture = Image.new("RGB", (1000, 600))
for column, weights in enumerate([straight, falloff(through)]):
    scene = pose_scene(rig, weights, matrices, chosen=arm)
    picture.paste(cutcell_viewers.show(scene, size=(500, 600)), (500 * column, 0))
