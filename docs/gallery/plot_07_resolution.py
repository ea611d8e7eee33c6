"""
Error and size over the resolution
==================================

The error of the distances to one bone against a graph of R = 128, and the interior nodes of each graph. Twice the
rays along each side make eight times as many nodes.
"""

import matplotlib.pyplot as plt
import numpy as np

import cutcell
from cutcell.graph import INTERIOR
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
joint = rig.skeleton.names.index("thigh.L")
bindings = [cutcell.bind(rig, resolution) for resolution in (8, 16, 32, 64, 128)]
*distances, fine = [binding.distances.on_mesh(joint) for binding in bindings]
errors = [np.abs(distance - fine).mean() for distance in distances]
sizes = [np.sum(binding.graph.node_kind == INTERIOR) for binding in bindings]
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
left.plot(["8", "16", "32", "64"], errors, "o-")
left.set(xlabel="resolution R", ylabel="mean error, of the longest side", yscale="log")
right.plot(["8", "16", "32", "64", "128"], sizes, "o-")
right.set(xlabel="resolution R", ylabel="interior nodes", yscale="log")
