"""Stacks of layers as the page changes them: edits in, edits out."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from cutcell.editing import (
    Attached,
    Computed,
    Edits,
    Filled,
    FromFile,
    JointEdit,
    Layer,
    Locked,
    Mask,
    Painted,
)
from cutcell.editing.layers import strength_of
from cutcell.editing.layers import vertices_of as masked_by
from cutcell.editing.layers.contents import Content
from cutcell.editing.locks import locked_joints
from cutcell.graph import CutCellGraph
from cutcell.rig import Rig, Skeleton
from cutcell.weights.prune import prune


def put_layer(edits: Edits, layer: Layer) -> tuple[Edits, int]:
    """Return edits with a layer on top, but below joints that are locked; and its place.

    A lock that is not opaque stays below: it would change what was made over it.
    """
    layers = list(edits.layers)
    place = len(layers)
    while place and isinstance(layers[place - 1].content, Locked) and layers[place - 1].is_opaque:
        place -= 1
    layers.insert(place, layer)
    return replace(edits, layers=layers), place


def replaced(edits: Edits, place: int, layer: Layer | None) -> Edits:
    """Return edits with another layer at a place; with None without the one there."""
    layers = list(edits.layers)
    layers[place : place + 1] = [] if layer is None else [layer]
    return replace(edits, layers=layers)


def moved(edits: Edits, place: int, by: int) -> tuple[Edits, int]:
    """Return edits with a layer some places higher, and its new place."""
    layers = list(edits.layers)
    layers.insert(place + by, layers.pop(place))
    return replace(edits, layers=layers), place + by


def vertices_of(layers: Iterable[Layer], graph: CutCellGraph, count: int) -> NDArray[np.intp]:
    """Return the vertices, of `count`, that some layers can change."""
    component = partial(components_of, graph)
    return np.flatnonzero(sum(strength_of(layer, component, count) for layer in layers))


def components_of(graph: CutCellGraph) -> NDArray[np.integer]:
    """Return the connected component of each vertex, shape (n,)."""
    return graph.mesh.component[graph.vertex_node]


def changed(edits: Edits, content: Callable[[Content], Content | None]) -> Edits:
    """Return edits with the contents of all layers changed; a layer whose content is None goes."""
    pairs = [(layer, content(layer.content)) for layer in edits.layers]
    layers = [layer if new is layer.content else replace(layer, content=new)
              for layer, new in pairs if new is not None]  # fmt: skip
    return replace(edits, layers=layers)


# Vertices that are painted


def painted_layer(edits: Edits, place: int | None) -> Layer | None:
    """Return the layer at a place if strokes go into it: it is painted, on, and replaces."""
    layer = edits.layers[place] if place is not None and 0 <= place < len(edits.layers) else None
    if layer is None or not isinstance(layer.content, Painted):
        return None
    return layer if layer.is_active and layer.mode == "replace" else None


def rows_within(
    layer: Layer,
    names: Sequence[str],
    vertices: NDArray[np.intp],
    seen: NDArray[np.float64],
    rows: NDArray[np.float64],
    max_influences: int | None,
) -> NDArray[np.float64]:
    """Return rows for a painted layer that change what is seen as far as its mask lets them.

    Its rows at vertices (k,) change by as much as those that are seen would without a mask, from
    `seen` to `rows`, (k, j) for the joints' names: so a stroke is multiplied by the mask.
    """
    content = layer.content
    assert isinstance(content, Painted)
    at = np.searchsorted(content.vertices, vertices).clip(max=len(content.vertices) - 1)
    again = np.flatnonzero(content.vertices[at] == vertices)
    changed = rows[again] - seen[again]
    changed[:, [names.index(name) for name in content.joints]] += content.rows[at[again]].toarray()
    changed = csr_array(np.maximum(changed, 0))
    result = rows.copy()
    result[again] = prune(changed, max_influences, 0.0, np.arange(len(names))).toarray()
    return result


def painted(edits: Edits, painting: Painted, place: int | None, name: str) -> tuple[Edits, int]:
    """Return edits with painted rows, and the place of their layer.

    They go into the `painted_layer` at a place, or else into a new one on top.
    """
    layer = painted_layer(edits, place)
    if layer is None or place is None:
        return put_layer(edits, Layer(painting, name=name))
    assert isinstance(layer.content, Painted)
    return replaced(edits, place, replace(layer, content=layer.content.merged(painting))), place


def painted_vertices(edits: Edits) -> NDArray[np.int32]:
    """Return the vertices with painted rows in some layer that is on."""
    lists = [
        layer.content.vertices
        for layer in edits.layers
        if isinstance(layer.content, Painted) and layer.is_active
    ]
    return np.unique(np.concatenate(lists)) if lists else np.zeros(0, np.int32)


def without_painted(edits: Edits, vertices: NDArray[Any]) -> Edits:
    """Return edits in which some vertices are painted nowhere."""
    return changed(edits, lambda one: one.without(vertices) if isinstance(one, Painted) else one)


# Joints


def with_deform(edits: Edits, skeleton: Skeleton, names: Iterable[str]) -> Edits:
    """Return edits in which some joints of a skeleton may carry weight."""
    joints = dict(edits.joints)
    for name in names:
        if not skeleton.deform[skeleton.names.index(name)]:
            joints[name] = replace(joints.get(name, JointEdit()), deform=True)
    return replace(edits, joints=joints)


def locked_names(edits: Edits) -> list[str]:
    """List the joints that keep the file's weights in the whole mesh."""
    return [
        name
        for layer in edits.layers
        if isinstance(layer.content, Locked) and layer.is_active and layer.mask.is_all
        for name in layer.content.joints
    ]


def locked_weights(edits: Edits, rig: Rig, graph: CutCellGraph) -> NDArray[np.bool_] | None:
    """Return which weights are locked by layers over some vertices, shape (n, j); None for none."""
    locks = [
        (masked_by(layer.mask, partial(components_of, graph)), layer.content.joints)
        for layer in edits.layers
        if isinstance(layer.content, Locked) and layer.is_active and not layer.mask.is_all
    ]
    if not locks:
        return None
    result = np.zeros((len(rig.mesh.vertices), len(rig.skeleton.names)), np.bool_)
    for which, joints in locks:
        result[which] |= locked_joints(rig, joints)
    return result


def with_locks(edits: Edits, names: Iterable[str], on: bool = True) -> Edits:
    """Return edits with joints locked by the topmost layer, or unlocked in all."""
    names = list(names)
    if not on:
        rest: Callable[[str], str | None] = lambda name: None if name in names else name  # noqa: E731
        return changed(edits, lambda one: one.renamed(rest) if isinstance(one, Locked) else one)
    top = edits.layers[-1] if edits.layers else None
    if top is None or not isinstance(top.content, Locked) or not top.mask.is_all or not top.on:
        return replace(edits, layers=[*edits.layers, Layer(Locked(names))])
    both = Locked(list(dict.fromkeys([*top.content.joints, *names])))
    return replaced(edits, len(edits.layers) - 1, replace(top, content=both))


def with_reach(edits: Edits, name: str, gain: float, radius: Any) -> Edits:
    """Return edits with another reach of a joint: a layer below all others."""
    now = edits.reach
    gains = {joint: value for joint, value in {**now.gain, name: gain}.items() if value != 1}
    radii = {**now.radius, name: radius}
    if radius is None:
        del radii[name]
    rest = edits.layers[1:] if now != Computed() else edits.layers
    reach = Computed(gain=gains, radius=radii)
    lowest = [] if reach == Computed() else [Layer(reach, name="Reach of joints")]
    return replace(edits, layers=[*lowest, *rest])


def with_base(edits: Edits, from_file: bool) -> Edits:
    """Return edits over the file's weights, or over computed ones."""
    layers = list(edits.layers)
    if layers and layers[0].is_reach and layers[0].content != Computed():
        layers[0] = replace(layers[0], on=not from_file)  # it would hide the file's weights
    return replace(edits, base="file" if from_file else "computed", layers=layers)


# Parts of the mesh

WAYS = (Filled, Attached, FromFile, Computed)


def part_layers(edits: Edits) -> dict[int, Layer]:
    """Return the layers that bind a whole part separately, by the vertex of each mask."""
    return {
        layer.mask.part: layer
        for layer in edits.layers
        if layer.mask.part is not None and layer.is_active and isinstance(layer.content, WAYS)
    }


def with_part(edits: Edits, vertices: Collection[int], content: Content | None) -> Edits:
    """Return edits with a part, all of its vertices, bound in another way; None as below."""
    layers = [
        layer
        for layer in edits.layers
        if layer.mask.part not in vertices or not isinstance(layer.content, WAYS)
    ]
    edits = replace(edits, layers=layers)
    if content is None:
        return edits
    return put_layer(edits, Layer(content, Mask(part=int(min(vertices)))))[0]
