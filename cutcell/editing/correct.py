"""Apply corrections to a rig and to its weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError, SkeletonError, WeightsError
from ..graph import CutCellGraph
from ..method import Method
from ..rig import Rig
from ..weights.adjustments import Adjustments
from ..weights.context import Context, Step
from ..weights.rig_falloff.rigid_accessories import attach
from .corrections import Corrections
from .locks import joint_index, lock_joints
from .refine import refinement_steps
from .restructure import restructured

JOINTS_FOR_GAINS = 8
"""Nearest joints of each vertex to measure if any joint has a gain: gains change which are near."""


def corrected_rig(rig: Rig, corrections: Corrections) -> Rig:
    """Apply corrections of the skeleton; check all names and vertices.

    Parameters
    ----------
    rig : Rig
    corrections : Corrections

    Returns
    -------
    Rig
        With the corrected joints, names, parents, positions and deforming joints: the rig that
        `cutcell.bind` binds and that `cutcell.save` needs. Applying the
        corrections again changes nothing.

    Raises
    ------
    ParameterError
        A joint or a vertex that the rig does not have, weights that its file cannot store, or other
        corrections of joints than those that were applied to the rig before.
    WeightsError
        A part is to keep weights that the file does not have.
    SkeletonError
        No joint would be left, or none to carry weight; two would share a name, or be each other's
        ancestors; or one is too far from the mesh.
    """
    rig = restructured(rig, corrections)
    count = len(rig.mesh.vertices)
    for vertex in (*corrections.parts, *corrections.vertices):
        if vertex >= count:
            raise ParameterError(
                f"corrections name the vertex {vertex}, but {rig.name} has only {count} "
                "(numbered from 0); are they of another character?"
            )
    index = _first_of(rig)
    for vertex, weights in corrections.vertices.items():
        for name in weights:
            if name not in index:
                joint_index(rig.skeleton, name)  # raises, with similar names
            joint = index[name]
            if rig.allowed is not None and not rig.allowed[vertex, joint]:
                raise ParameterError(f'the file cannot store weight of "{name}" at vertex {vertex}')
    for part in corrections.parts.values():
        if part.joint is not None:
            joint_index(rig.skeleton, part.joint)
        if part.how == "file" and rig.weights is None:
            raise WeightsError(f"{rig.name} has no weights for its parts to keep")
    deform, joints = rig.skeleton.deform.copy(), rig.skeleton.joints.copy()
    for name, one in corrections.joints.items():
        joint = joint_index(rig.skeleton, name)
        deform[joint] = deform[joint] if one.deform is None else one.deform
        joints[joint] = joints[joint] if one.position is None else one.position
    if rig.skeleton.deform.any() and not deform.any():
        raise SkeletonError("by the corrections no joint of the skeleton may carry weight")
    if not np.array_equal(deform, rig.skeleton.deform):
        rig = replace(rig, skeleton=replace(rig.skeleton, deform=deform))
    return rig.with_joints(joints)


def locked_by(corrections: Corrections) -> list[int | str]:
    """List the joints that keep the file's weights."""
    return [name for name, one in corrections.joints.items() if one.locked]


def joints_measured(corrections: Corrections, method: Method) -> tuple[int | None, float]:
    """Return from how many nearest joints, and how far beyond the nearest, distances are needed."""
    gains = [1.0, *(one.gain for one in corrections.joints.values())]
    needed, within = method.joints_needed, method.reach_needed
    if set(gains) == {1.0} or needed is None:
        return needed, within
    return max(needed, JOINTS_FOR_GAINS), within * max(gains) / min(gains)


def adjustments_of(rig: Rig, graph: CutCellGraph, corrections: Corrections) -> Adjustments | None:
    """Return gains, radii and unrigid components as arrays; None if all are as they are anyway."""
    gain, radius = np.ones(len(rig.skeleton.joints)), np.full(len(rig.skeleton.joints), np.nan)
    for name, one in corrections.joints.items():
        joint = joint_index(rig.skeleton, name)
        gain[joint] = one.gain
        if one.radius is not None:
            radius[joint] = one.radius / graph.lattice.size
    itself = [v for v, part in corrections.parts.items() if part.how == "itself"]
    if not len(itself) and (gain == 1).all() and np.isnan(radius).all():
        return None
    return Adjustments(gain, radius, graph.vertex_node[np.array(itself, np.intp)])


def correction_steps(
    rig: Rig,
    corrections: Corrections,
    smoothing: int = 0,
    symmetric: bool = False,
    locked: Sequence[int | str] = (),
) -> list[Step]:
    """List the steps that correct and refine computed weights; check their options.

    See `refine_weights` for the options; joints locked by the corrections are added.
    """
    if corrections.joints:
        locked = [*locked, *locked_by(corrections)]
    ways = {part.how for part in corrections.parts.values()}
    steps = refinement_steps(rig, smoothing, symmetric, locked)
    if ways & {"glued", "touching"}:
        steps.insert(0, Step("parts", lambda context: bind_parts(rig, context, corrections)))
    if corrections.vertices or "file" in ways:
        override = Step("override", lambda context: _override(rig, context, corrections, locked))
        steps.append(override)
    return steps


def bind_parts(rig: Rig, context: Context, corrections: Corrections) -> NDArray[np.float64]:
    """Glue components to joints, or let them follow the body where they touch it."""
    surface, graph = context.operators(), context.graph
    node, weights = graph.vertex_node, context.weights.copy()
    component = surface.component[node]
    touching = np.zeros(component.max() + 1, np.bool_)
    for vertex, part in corrections.parts.items():
        in_part = component == component[vertex]
        if part.joint is not None:
            joint = joint_index(rig.skeleton, part.joint)
            if rig.allowed is not None and not rig.allowed[in_part, joint].all():
                raise ParameterError(
                    f'the file cannot store weight of "{part.joint}" for the part of '
                    f"vertex {vertex}"
                )
            weights[in_part] = np.eye(weights.shape[1])[joint]
        touching[component[vertex]] = part.how == "touching"
    if touching.all():
        raise ParameterError("every component is to follow where it touches, and none is left")
    if touching.any():
        first = np.unique(node, return_index=True)[1]
        attached = attach(graph, surface, touching, weights[first])
        in_part = touching[component]
        rows = attached[node[in_part]]
        if rig.allowed is not None:
            rows = np.where(rig.allowed[in_part], rows, 0.0)
        total = rows.sum(axis=1, keepdims=True)
        weights[in_part] = np.divide(rows, total, out=weights[in_part], where=total > 0)
    return weights


def _override(
    rig: Rig, context: Context, corrections: Corrections, locked: Sequence[int | str]
) -> NDArray[np.float64]:
    """Put in the file's weights of parts that keep them, then what was set by hand.

    Locked joints keep the file's weights all the same.
    """
    weights, overrides = context.weights.copy(), corrections.vertices
    in_file = [v for v, part in corrections.parts.items() if part.how == "file"]
    if in_file and rig.weights is not None:
        component = context.operators().component[context.graph.vertex_node]
        from_file = np.isin(component, component[in_file]) & rig.weights.any(axis=1)
        weights[from_file] = rig.weights[from_file]
    if not overrides:
        return weights
    index, rows = _first_of(rig), list(overrides)
    weights[rows] = 0
    row = [vertex for vertex, joints in overrides.items() for _ in joints]
    column = [index[name] for joints in overrides.values() for name in joints]
    weights[row, column] = [value for joints in overrides.values() for value in joints.values()]
    weights[rows] = lock_joints(rig, weights, locked)[rows]
    return weights


def _first_of(rig: Rig) -> dict[str, int]:
    """Return the first joint of each name: a brush may override most vertices."""
    names = rig.skeleton.names
    return dict(zip(reversed(names), reversed(range(len(names))), strict=True))
