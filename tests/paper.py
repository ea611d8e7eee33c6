"""The stages as the paper has them, for tests that compare with what the paper says."""

from functools import partial

import cutcell

build_graph = partial(cutcell.build_graph, method="paper")
bone_distances = partial(cutcell.bone_distances, method="paper")
skinning_weights = partial(cutcell.skinning_weights, method="paper")
