"""The mask of the chosen layer: how strongly it acts at each vertex."""

import numpy as np
from numpy.typing import NDArray

from cutcell.editing import Layer, Mask, Painted
from cutcell.editing.layers import vertices_of
from cutcell.rig import TriangleMesh

from ..document.state import State


def chosen_layer(state: State) -> Layer | None:
    """Return the chosen layer."""
    layers = state.edits.layers
    return layers[state.layer] if state.layer is not None and state.layer < len(layers) else None


def masked(mask: Mask, mesh: TriangleMesh) -> NDArray[np.intp] | None:
    """Return the vertices of a mask, shape (k,); None for all."""
    return vertices_of(mask, lambda: mesh.welded.component[mesh.welded.index])


def mask_strengths(state: State) -> NDArray[np.float64] | None:
    """Return the strength of the chosen layer's mask, shape (n,); None without a layer.

    A painted layer without a mask acts where it is painted.
    """
    layer, rig = chosen_layer(state), state.rig
    if layer is None or rig is None:
        return None
    mask, content = layer.mask, layer.content
    which = masked(mask, rig.mesh)
    if which is None and isinstance(content, Painted):
        which = content.vertices.astype(np.intp)
    strengths = np.zeros(len(rig.mesh.vertices))
    strengths[slice(None) if which is None else which] = 1.0
    if mask.strengths is not None:
        strengths[which] = mask.strengths
    return strengths
