"""Refine weights: smoothing, symmetry, and joints whose weights an artist has painted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from ..checks import check_flag, check_integer
from ..errors import WeightsError
from ..method import ANIMATION, Method, MethodName, method_of
from ..rig import Rig
from .layers import RigSources, apply_layers
from .layers.contents import MAX_STEPS, Locked, Mirrored, Smoothed
from .layers.layer import Layer
from .locks import joint_index, locked_joints
from .symmetry import find_mirror


class RefineOptions(TypedDict, total=False):
    """Options of `refine_weights`."""

    smoothing: int
    symmetric: bool
    locked: Sequence[int | str]


class Pruning(TypedDict, total=False):
    """Options of a `Method` that `refine_weights` follows."""

    max_influences: int | None
    threshold: float


def refine_weights(
    rig: Rig,
    weights: NDArray[np.float64],
    *,
    method: Method | MethodName = ANIMATION,
    smoothing: int = 0,
    symmetric: bool = False,
    locked: Sequence[int | str] = (),
    **options: Unpack[Pruning],
) -> NDArray[np.float64]:
    """Smooth weights, mirror them, and put back those of locked joints: in this order.

    Parameters
    ----------
    rig : Rig
    weights : array, shape (n, j)
        Rows sum to one.
    method : Method, "animation" or "paper"
        Its greatest number of influences and threshold hold again after smoothing and mirroring.
    smoothing : int
        Passes over the mesh, each half the vertex and half the mean of its neighbours.
    symmetric : bool
        Left and right get the same; see `find_mirror`.
    locked : sequence of int or str
        Joints that keep the rig's own weights; see `lock_joints`.
    **options
        Single options of the method: `max_influences`, `threshold`.

    Returns
    -------
    array, shape (n, j)
        Rows sum to one; `weights` itself if all options are off.

    Raises
    ------
    ParameterError, MeshError, WeightsError
        An option is out of range, the rig does not allow it, or the weights have another shape.
    """
    layers = refinement(rig, smoothing, symmetric, locked)
    if np.shape(weights) != (shape := (len(rig.mesh.vertices), len(rig.skeleton.joints))):
        raise WeightsError(f"weights has the shape {np.shape(weights)}, expected {shape}")
    return apply_layers(weights, layers, RigSources(rig, method_of(method, **options)))


def refinement(
    rig: Rig, smoothing: int = 0, symmetric: bool = False, locked: Sequence[int | str] = ()
) -> list[Layer]:
    """Return the options of `refine_weights` as layers; check them."""
    layers = []
    if check_integer("smoothing", smoothing, 0, MAX_STEPS):
        layers.append(Layer(Smoothed(smoothing)))
    if check_flag("symmetric", symmetric):
        find_mirror(rig)  # raises an error before anything is computed
        layers.append(Layer(Mirrored()))
    if locked_joints(rig, locked).any():
        names = rig.skeleton.names
        layers.append(Layer(Locked([names[joint_index(rig.skeleton, one)] for one in locked])))
    return layers
