"""The connected components of the mesh, and what each follows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from cutcell.editing import Layer
from cutcell.runtime.display import shown_name

from ...document.state import State
from ...looks.components import components_of
from ..compute.stack import part_layers

MOST = 300
"""Components that are listed, the largest first."""


@dataclass(frozen=True)
class Component:
    """A connected component.

    Parameters
    ----------
    number : int
        The largest is 0.
    first : int
        Its first vertex.
    vertices : int
        How many it has.
    name : str
        Of the file's mesh that it is a part of, where there are several; else empty.
    joint : int
        That it follows most.
    share : float
        How much of its weight that joint has.
    layer : Layer or None
        That binds this component.
    """

    number: int
    first: int
    vertices: int
    name: str
    joint: int
    share: float
    layer: Layer | None


def listed(state: State) -> list[Component]:
    """Return the components, the largest first; none until the character is bound."""
    if state.binding is None:
        return []
    which, sizes = components_of(state)
    firsts = state.memo("first vertices", (which,), lambda: np.unique(which, return_index=True)[1])
    layers = {int(which[v]): layer for v, layer in part_layers(state.edits).items()}
    rows = state.binding.rows
    mean_weights = state.memo("of parts", (which, rows), lambda: _mean(which, rows, len(sizes)))
    names = {} if len(state.rig.parts) < 2 else state.rig.parts
    starts = [part.vertices.start for part in names]
    return [
        Component(
            number=k,
            first=int(firsts[k]),
            vertices=int(sizes[k]),
            name=shown_name(names[np.searchsorted(starts, firsts[k], "right") - 1].name)
            if names
            else "",
            joint=int(mean_weights[k].argmax()),
            share=float(mean_weights[k].max()),
            layer=layers.get(k),
        )
        for k in range(min(len(sizes), MOST))
    ]


def _mean(which: NDArray[np.intp], rows: csr_array, count: int) -> NDArray[np.float64]:
    member = coo_array((np.ones(len(which)), (which, np.arange(len(which)))), (count, len(which)))
    sums: NDArray[np.float64] = (member @ rows).toarray()
    return sums / np.bincount(which, minlength=count)[:, None]
