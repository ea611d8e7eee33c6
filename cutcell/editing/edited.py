"""Rigs with the edits of their skeletons, and what else edits say of a rig."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..animation.falloff.adjustments import Adjustments
from ..checks import one_line
from ..errors import ParameterError, SkeletonError, WeightsError
from ..graph import CutCellGraph
from ..method import Method
from ..rig import Rig
from .edits import Edits
from .layers.contents import Computed, FromFile, Locked
from .layers.layer import Layer
from .layers.packing import naming
from .layers.painted import Painted
from .locks import joint_index
from .restructure import restructured

JOINTS_FOR_GAINS = 8
"""Nearest joints of each vertex to measure if any joint has a gain: gains change which are near."""


def edited_rig(rig: Rig, edits: Edits) -> Rig:
    """Apply edits of the skeleton; check all names and vertices, those of the layers, too.

    Parameters
    ----------
    rig : Rig
    edits : Edits

    Returns
    -------
    Rig
        With the edited joints, names, parents, positions and deforming joints: the rig that
        `cutcell.bind` binds and that `cutcell.save` needs. Applying the edits again changes
        nothing.

    Raises
    ------
    ParameterError
        There is no such joint or vertex, the file cannot store such a weight, or the edits are
        other than those that were applied to the rig before.
    WeightsError
        A layer, or the base, needs weights that the file does not have.
    SkeletonError
        No joint would be left, or none to carry weight; two would share a name, or be each other's
        ancestors; or one is too far from the mesh.
    """
    rig = restructured(rig, edits)
    if edits.base == "file" and rig.weights is None:
        raise WeightsError(f"{rig.name} has no weights in its file to begin from")
    for number, layer in enumerate(edits.layers, start=1):
        _check_layer(rig, layer, f'layer {number}, "{layer.title}",')
    for name, mask in edits.selections.items():
        _check_vertices(rig, f'the selection "{one_line(name)}"', mask.part, mask.vertices)
    deform, joints = rig.skeleton.deform.copy(), rig.skeleton.joints.copy()
    for name, one in edits.joints.items():
        joint = joint_index(rig.skeleton, name)
        if one.partner:
            joint_index(rig.skeleton, one.partner)
        deform[joint] = deform[joint] if one.deform is None else one.deform
        joints[joint] = joints[joint] if one.position is None else one.position
    if rig.skeleton.deform.any() and not deform.any():
        raise SkeletonError("by the edits no joint of the skeleton may carry weight")
    if not np.array_equal(deform, rig.skeleton.deform):
        rig = replace(rig, skeleton=replace(rig.skeleton, deform=deform))
    if rig.partners != edits.partners:
        rig = replace(rig, partners=edits.partners)
    return rig.with_joints(joints)


def _check_layer(rig: Rig, layer: Layer, what: str) -> None:
    """Raise an error if a layer does not fit a rig."""
    content, mask = layer.content, layer.mask
    painted = content.vertices if isinstance(content, Painted) else None
    _check_vertices(rig, what, mask.part, mask.vertices, painted)
    with naming(f"{what} does not fit {rig.name}"):
        columns = [joint_index(rig.skeleton, name) for name in content.joints_named()]
    if isinstance(content, FromFile | Locked) and rig.weights is None:
        raise WeightsError(f"{rig.name} has no weights of its own, which {what} needs")
    if isinstance(content, Painted) and rig.allowed is not None:
        rows = content.rows.tocoo()
        bad = ~rig.allowed[content.vertices[rows.row], np.array(columns)[rows.col]]
        if bad.any():
            name, vertex = content.joints[rows.col[bad][0]], content.vertices[rows.row[bad][0]]
            raise ParameterError(f'the file cannot store weight of "{name}" at vertex {vertex}')


def _check_vertices(
    rig: Rig, what: str, part: int | None, *lists: NDArray[np.int32] | None
) -> None:
    """Raise an error if a part, or ascending lists of vertices, are not of a rig."""
    count, last = len(rig.mesh.vertices), [-1 if part is None else part]
    last += [int(one[-1]) for one in lists if one is not None and len(one)]
    if max(last) >= count:
        raise ParameterError(
            f"{what} names the vertex {max(last)}, but {rig.name} has only {count} (numbered from "
            "0); is it of another character?"
        )


def joints_measured(content: Computed, method: Method) -> tuple[int | None, float]:
    """Return from how many nearest joints, and how far beyond the nearest, distances are needed."""
    gains = [1.0, *content.gain.values()]
    needed, within = method.joints_needed, method.reach_needed
    if set(gains) == {1.0} or needed is None:
        return needed, within
    return max(needed, JOINTS_FOR_GAINS), within * max(gains) / min(gains)


def adjustments_of(
    rig: Rig, graph: CutCellGraph, content: Computed, vertices: NDArray[np.intp] | None = None
) -> Adjustments | None:
    """Return gains, radii and unrigid components as arrays; None if all are as they are anyway.

    With `as_skin`, the components of some vertices (k,), None for all, are bound as skin.
    """
    gain, radius = np.ones(len(rig.skeleton.joints)), np.full(len(rig.skeleton.joints), np.nan)
    for name, factor in content.gain.items():
        gain[joint_index(rig.skeleton, name)] = factor
    for name, far in content.radius.items():
        radius[joint_index(rig.skeleton, name)] = far / graph.lattice.size
    independent = np.zeros(0, np.intp)
    if content.as_skin:
        node = graph.vertex_node if vertices is None else graph.vertex_node[vertices]
        independent = np.unique(node)
    if not len(independent) and (gain == 1).all() and np.isnan(radius).all():
        return None
    return Adjustments(gain, radius, independent)
