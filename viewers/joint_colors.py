"""The colours that a rig's joints have in every scene."""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from cutcell.rig import Rig, TriangleMesh

from .palette import joint_colors

_of_mesh: WeakKeyDictionary[TriangleMesh, Any] = WeakKeyDictionary()


def colors_of(rig: Rig) -> NDArray[np.float64]:
    """Return a colour for each joint of a rig, shape (j, 3); see `palette.joint_colors`.

    The file's weights say whose skin touches, so that colours stay while new weights change.
    """
    given: NDArray[np.float64] | None = getattr(rig, "colors", None)
    if given is not None:  # a few vertices of a rig are drawn in the colours of all
        return given
    parents, weights, deform = rig.skeleton.parents, rig.weights, rig.skeleton.deform
    tree = parents.tobytes(), deform.tobytes() if weights is None else b""
    cached = _of_mesh.get(rig.mesh)
    if cached is None or cached[0] is not weights or cached[1] != tree:
        idle, touching = np.flatnonzero(~deform), np.empty((0, 2), int)
        if weights is not None:
            strongest = np.asarray(weights.argmax(axis=1)).ravel()
            idle = np.setdiff1d(np.arange(len(parents)), strongest)
            faces = strongest[rig.mesh.faces]
            pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
            touching = np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1), axis=0)
        cached = _of_mesh[rig.mesh] = weights, tree, joint_colors(parents, touching, idle)
    colors: NDArray[np.float64] = cached[2]
    return colors
