"""Effects of the components that contain bones: a penalty across them, and rigid parts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...geodesics import Bones
from ...geometry.triangles import face_edges
from ...rig import Skeleton
from ...rig.rows import scaled, single, strongest
from .components import MAX_RIGID_SIZE, bone_containment, longest_sides
from .surface_operators import SurfaceOperators

PART_OF_BODY = 0.1
"""Maximum area of a component of one joint, such as an eyeball, as part of the largest component's.
The head of a machine of many parts is larger."""
MIN_BODY_AREA = 1 / 3
"""Part of the surface: if the largest component is smaller, the mesh is a machine of many parts."""
OF_ANOTHER = 1e3
"""Factor of a bone's distance on components that another joint owns, and on all that its joint does
not own if it owns any."""
RIGID_AREA = 0.9, 0.92
"""A component is rigid if one joint is the strongest on the second part of its area; less and less
rigid down to the first."""


def joint_containment(
    surface: SurfaceOperators, bones: Bones, skeleton: Skeleton | None, joints: int
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Measure which part of each joint's bones lies inside each component, and which it owns.

    If a joint has several bones, the one that is most inside a component counts there.

    Returns shapes (components, j).
    """
    if not surface.component.any():  # a lone component: no bone belongs more to another
        return np.ones((1, joints)), np.zeros((1, joints), np.bool_)
    with_bones, first = np.unique(bones.joint, return_index=True)
    place = bones.start[first]
    segments = Bones(
        np.concatenate([bones.start, place]),
        np.concatenate([bones.end, place]),
        np.concatenate([bones.joint, with_bones]),
    )
    part = bone_containment(surface.points, surface.faces, surface.component, segments)
    of_bone, inside = part[:, : len(bones.joint)], part[:, len(bones.joint) :] > 0
    containment, starts = np.zeros((2, len(part), joints))
    np.maximum.at(containment.T, bones.joint, of_bone.T)
    starts[:, with_bones] = inside
    return containment, _owned(surface, skeleton, containment, starts > 0)


def _owned(
    surface: SurfaceOperators,
    skeleton: Skeleton | None,
    containment: NDArray[np.float64],
    starts: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Find the joints that small closed components enclose, such as an eyeball: (components, j).

    These are last joints with no other joint beside them in the component. Where their bones end is
    a guess, so that the joint itself counts, unless another such component contains more of its
    bone. The parts of a machine overlap: there no joint owns any.

    Shapes: containment, starts (components, j).
    """
    areas = np.bincount(surface.component, surface.areas, len(starts))
    chosen = (starts.sum(axis=1) == 1) & (areas <= PART_OF_BODY * areas.max())
    chosen &= longest_sides(surface.points, surface.component) <= MAX_RIGID_SIZE
    if skeleton is None or not chosen.any() or areas.max() < MIN_BODY_AREA * areas.sum():
        return np.zeros_like(starts)
    edges, uses = np.unique(face_edges(surface.faces), axis=0, return_counts=True)
    chosen[surface.component[edges[uses == 1, 0]]] = False  # open ones
    is_last = (skeleton.subtree & skeleton.deform).sum(axis=1) <= 1
    owned = starts & chosen[:, None] & is_last
    elsewhere = np.where(~starts & chosen[:, None], containment, 0).max(axis=0)
    owned &= np.where(owned, containment, 0).max(axis=0) >= elsewhere
    if not (skeleton.deform & ~owned.any(axis=0)).any():
        owned[:] = False  # no other joint can take the rest
    return owned


def cross_component_penalty(
    containment: NDArray[np.float64], owned: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return the factor by which each joint's distance grows on each component.

    An arm whose mesh is a separate component reaches into the shoulder, and its bone with it;
    the surface of the chest there is not the arm's. The factor is 1 on the component that contains
    most of a joint's bone, and up to 2 on others; it is 1 on components without bones. A joint
    that owns components keeps to them, and they to it.

    Shapes: containment, owned (components, j); returns (components, j).
    """
    of_joint = containment.max(axis=0)
    belongs = np.divide(containment, of_joint, out=np.ones_like(containment), where=of_joint > 0)
    penalty = 2 - belongs
    penalty[~containment.any(axis=1)] = 1
    penalty[~owned & (owned.any(axis=1, keepdims=True) | owned.any(axis=0))] = OF_ANOTHER
    return penalty


def make_rigid(
    surface: SurfaceOperators, weights: csr_array, independent: NDArray[np.bool_]
) -> csr_array:
    """Make components rigid to the joint that nearly all of their area follows: plates, wheels.

    Shapes: weights (k, j), independent (components,); returns (k, j).
    """
    component, joints = surface.component, weights.shape[1]
    entries = surface.areas, (component, strongest(weights))
    votes = csr_array(entries, (len(independent), joints))
    share = votes.max(axis=1).toarray() / np.maximum(votes.sum(axis=1), 1e-300)
    rigidity = np.where(independent, 0.0, ramp(share, *RIGID_AREA))
    if not rigidity.any():
        return weights
    rigid = scaled(single(strongest(votes), joints), rigidity)[component]
    return scaled(weights, 1 - rigidity[component]) + rigid


def ramp(share: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    """Rise from 0 up to `low` to 1 from `high` on, so that no small change decides."""
    return np.clip((share - low) / (high - low), 0, 1)
