"""
Bind your first character
=========================

A rigged character has a mesh, a skeleton, and weights that say how much each vertex follows each joint. cutcell
computes such weights. This tutorial loads a character, binds it, looks at the result and saves it.
"""

import cutcell
import cutcell_viewers
from cutcell_assets import demo_path
from cutcell_viewers.weights_scene import weights_scene

# %%
# `cutcell.load` reads GLB, glTF, VRM, FBX, USD, OBJ and more. Here it reads one of the demo characters.

rig = cutcell.load(demo_path("biped"))
print(len(rig.mesh.vertices), "vertices,", len(rig.skeleton.names), "joints")

# %%
# `cutcell.bind` builds the graph, measures distances from every bone and turns them into weights: a matrix with a
# row for each vertex and a column for each joint. The first binding on a machine compiles for a minute.

binding = cutcell.bind(rig)
print(binding.weights.shape, "largest row sum:", binding.weights.sum(axis=1).max())
print(binding.seconds)

# %%
# Warnings name what did not work, such as parts that no bone reaches. An empty list is a good sign.

print(binding.warnings)

# %%
# A picture of one joint's weights.

joint = rig.skeleton.names.index("upper_arm.L")
picture = cutcell_viewers.show(weights_scene(rig, binding.weights, joint))

# %%
# `cutcell.save` writes a copy of the file. Meshes, materials and motions stay as they are.

cutcell.save("bound.glb", rig.with_weights(binding.weights))

# %%
# The same from a terminal: ``cutcell bind character.glb bound.glb``. To look at it in the browser:
# ``cutcell app character.glb``.
