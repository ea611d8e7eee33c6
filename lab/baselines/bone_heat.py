"""Bone heat: bones warm the surface that sees them, and it conducts (Baran & Popović 2007)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import diags_array
from scipy.sparse.linalg import splu

from cutcell.checks import check_number
from cutcell.geometry.laplacian import cotangent_laplacian, vertex_areas, vertex_normals
from cutcell.geometry.triangles import label_components
from cutcell.method import PAPER, Leaf
from cutcell.rig import Rig

from .body import Body
from .frame import BaselineBinding, Run, bind_by
from .visibility import Blockers

TIE = 1e-4
"""Relative: bones this nearly as near as the nearest warm a vertex as well."""
MIN_DISTANCE = 1e-4
"""Smallest distance to a bone, relative to the longest side: heat is infinite on a bone."""
FACING = 1.001
"""Distance is divided by half of this plus the cosine between normal and bone: surface that
looks away from a bone, as it does around a limb, is taken for nearer than surface that faces it."""
FADE = (0.025, 0.05)
"""Weights fade out between these, as in Blender; each vertex keeps its largest."""


def bone_heat(
    rig: Rig,
    *,
    heat: float = 1.0,
    leaf: Leaf = "extend",
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by the heat equilibrium on the surface.

        (M⁻¹ L + H) w_i = H p_i

    L is the cotangent Laplacian, M the area of each vertex; H = c / d² of the nearest bone
    in the line of sight of a vertex, and p_i is 1 where that is bone i. A component of the mesh
    that no bone sees is warmed by its nearest bones straight through the surface.

    Parameters
    ----------
    rig : Rig
    heat : float
        c: larger makes weights sharper.
    leaf
        See `bone_segments`.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    BaselineBinding
        Stages "heat", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Baran & Popović 2007, "Automatic rigging and animation of 3D characters", section 4; the
    measure of nearness by normals is that of Blender's automatic weights.
    """
    heat = check_number("heat", heat, 1e-6, 1e6)
    method = PAPER.with_options(leaf=leaf, max_influences=max_influences, threshold=threshold)

    def solve(body: Body, run: Run) -> NDArray[np.float64]:
        distance, share, unseen = _warmth(body)
        if unseen:
            run.warnings.append(
                f"{unseen:,} of {len(body.points):,} welded vertices lie on components that no "
                "bone sees; their nearest bones warm them through the surface"
            )
        run.end("heat")
        screening = heat / np.maximum(distance, MIN_DISTANCE) ** 2
        return _faded(_equilibrium(body, screening, share))

    return bind_by(solve, rig, method)


def _warmth(body: Body) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Find the bones that warm each welded vertex.

    Returns the distance (k,) to them, infinite where there is none, the share of each joint
    (k, j), and how many vertices lie on components that no bone sees.
    """
    nearness, closest = _nearness(body)
    order = np.argsort(nearness, axis=0, kind="stable")
    count = len(body.points)
    distance = np.full(count, np.inf)
    sees = np.zeros(nearness.shape, bool)
    blockers = Blockers(body.points, body.faces)
    looking = np.arange(count)
    for rank in range(len(order)):
        bone = order[rank, looking]
        # Once a bone is seen, only ties with it matter.
        hopeful = nearness[bone, looking] <= distance[looking] * (1 + TIE)
        looking, bone = looking[hopeful], bone[hopeful]
        if len(looking) == 0:
            break
        free = ~blockers.blocked(looking, closest[bone, looking])
        sees[bone[free], looking[free]] = True
        distance[looking[free]] = np.minimum(
            distance[looking[free]], nearness[bone[free], looking[free]]
        )
    dark = _dark_components(body, np.isfinite(distance))
    distance[dark] = nearness[:, dark].min(axis=0)
    sees[:, dark] = nearness[:, dark] <= distance[dark] * (1 + TIE)
    share = np.zeros((count, body.joints))
    for b, joint in enumerate(body.bones.joint):
        share[:, joint] = np.maximum(share[:, joint], sees[b])
    share /= np.maximum(share.sum(axis=1, keepdims=True), 1)
    return distance, share, len(dark)


def _nearness(body: Body) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return how near each bone is to each vertex, (b, k), and its closest point, (b, k, 3)."""
    normals = vertex_normals(body.points, body.faces)
    nearness = np.empty((len(body.bones.joint), len(body.points)))
    closest = np.empty((*nearness.shape, 3))
    for b in range(len(closest)):
        closest[b] = body.closest_on(b)
        away = body.points - closest[b]
        length = np.linalg.norm(away, axis=1)
        cosine = (away * normals).sum(axis=1) / np.where(length > 0, length, 1)
        nearness[b] = length / (0.5 * (cosine + FACING))
    return nearness, closest


def _dark_components(body: Body, warm: NDArray[np.bool_]) -> NDArray[np.intp]:
    """List the vertices on components of the mesh without any warm vertex."""
    component = label_components(body.faces, len(body.points))
    return np.flatnonzero(~(np.bincount(component, warm) > 0)[component])


def _equilibrium(
    body: Body, heat: NDArray[np.float64], share: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Solve for all joints at once: (L + M H) w = M H p."""
    areas = vertex_areas(body.points, body.faces)
    # A vertex without area conducts nothing; any positive number lets it keep its own heat.
    warming = np.where(areas > 0, areas, 1e-12) * heat
    system = cotangent_laplacian(body.points, body.faces) + diags_array(warming)
    return splu(system.tocsc()).solve(warming[:, None] * share)


def _faded(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = FADE
    faded = np.clip((weights - low) / (high - low), 0, 1) * np.maximum(weights, 0)
    empty = faded.sum(axis=1) <= 0
    return np.where(empty[:, None], weights, faded)
