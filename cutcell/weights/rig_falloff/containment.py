"""Effects of the components that contain bones: a penalty across them, and rigid parts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...geodesics import Bones
from .components import bone_containment
from .surface_operators import SurfaceOperators

PENALTY = 2.0
"""Added to the factor 1 of a bone's distance, for the surface of a component that the bone is
outside of while it is inside another one."""
RIGID = 0.9, 0.92
"""A component is rigid if one joint is the strongest on the second part of its area; less and less
rigid down to the first."""


def joint_containment(surface: SurfaceOperators, bones: Bones, joints: int) -> NDArray[np.float64]:
    """Measure which part of each joint's bones lies inside each component.

    Of several bones of a joint, the one that is inside a component most counts there.

    Returns shapes (components, j).
    """
    if not surface.component.any():  # a lone component: no bone belongs more to another
        return np.ones((1, joints))
    of_bone = bone_containment(surface.points, surface.faces, surface.component, bones)
    containment = np.zeros((len(of_bone), joints))
    np.maximum.at(containment.T, bones.joint, of_bone.T)
    return containment


def cross_component_penalty(containment: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the factor by which each joint's distance grows on each component.

    An arm whose mesh is a separate component reaches into the shoulder, and its bone with it;
    the surface of the chest there is not the arm's. No factor is on the component that contains
    most of a joint's bone, nor on one that contains more of this bone than of any other.

    Shapes: containment (components, j); returns (components, j).
    """
    of_joint, of_component = containment.max(axis=0), containment.max(axis=1, keepdims=True)
    belongs = containment / np.maximum(np.minimum(of_joint, of_component), 1e-300)
    belongs[:, of_joint == 0] = 1
    penalty = 1 + PENALTY * (1 - np.minimum(belongs, 1))
    penalty[of_component[:, 0] == 0] = 1
    return penalty


def make_rigid(
    surface: SurfaceOperators, weights: NDArray[np.float64], independent: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Let each component follow a joint that nearly all of its area follows: plates, wheels.

    Shapes: weights (k, j), independent (components,); returns (k, j).
    """
    component, strongest = surface.component, weights.argmax(axis=1)
    entries = surface.areas, (component, strongest)
    votes = csr_array(entries, (len(independent), weights.shape[1]))
    share = votes.max(axis=1).toarray().ravel() / np.maximum(votes.sum(axis=1), 1e-300)
    rigidity = np.where(independent, 0.0, ramp(share, *RIGID))[component]
    chosen = np.flatnonzero(rigidity)
    if not len(chosen):
        return weights
    result = weights.copy()
    result[chosen] *= 1 - rigidity[chosen, None]
    result[chosen, votes.argmax(axis=1)[component[chosen]]] += rigidity[chosen]
    return result


def ramp(share: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    """Rise from 0 up to `low` to 1 from `high` on, so that no small change decides."""
    return np.clip((share - low) / (high - low), 0, 1)
