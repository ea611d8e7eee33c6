"""
Paint and export
================

Edits change weights where you know better: a stroke of the brush, a part that follows one joint, or a joint that does
not deform. They can be stored and applied again.
"""

import numpy as np

import cutcell
import cutcell_viewers
from cutcell_app.editing import Brush, paint_weights
from cutcell_assets import demo_path
from cutcell_viewers.weights_scene import weights_scene

rig = cutcell.load(demo_path("biped"))
binding = cutcell.bind(rig)

# %%
# A stroke passes vertices of the surface. Here it is one vertex at the collar, and the brush adds weight of the head
# around it, so that the collar follows the head. Rows still sum to one.

names = rig.skeleton.names
head, neck = names.index("head"), names.index("neck")
height = float(np.ptp(rig.mesh.vertices[:, 1]))
collar = np.linalg.norm(rig.mesh.vertices - rig.skeleton.joints[neck], axis=1).argmin()
brush = Brush(radius=0.08 * height, mode="add", strength=0.8)
painted = paint_weights(rig, binding.weights, head, [collar], brush, mirrored=True)
for weights in (binding.weights, painted):
    print("weight of the head at the collar:", weights[collar, head].round(2))
picture = cutcell_viewers.show(weights_scene(rig, painted, head))

# %%
# Edits describe decisions about joints and layers of weights. This one takes a joint out of the binding, and its skin
# goes to the nearest others. A layer then makes the collar follow the head, half and half with what is computed.

around = np.flatnonzero((painted != binding.weights).any(axis=1))
layer = cutcell.Layer(cutcell.Filled({"head": 1.0}), cutcell.Mask(vertices=around), opacity=0.5)
edits = cutcell.Edits(joints={"neck": cutcell.JointEdit(deform=False)}, layers=[layer])
edited = cutcell.bind(rig, edits=edits)
print("weight of the neck:", edited.weights[:, neck].sum())

# %%
# Saved with the character, the weights are ready for any program that reads glTF.

cutcell.save("painted.glb", rig.with_weights(painted))
