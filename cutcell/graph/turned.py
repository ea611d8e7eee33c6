"""Faces of a mesh that run against most of those they hang together with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def find_turned(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Tell which faces must be turned round for neighbours to run alike.

    Two faces that alone share an edge run alike if they use it in opposite directions. Each face
    is a node twice, as it is and turned round; links join what runs alike. A surface with two
    sides is then found twice, once from each: of these the one with more area as it is stays.
    One with a single side (Moebius) hangs together with itself turned round, and is left alone.

    Parameters
    ----------
    vertices : array, shape (n, 3)
    faces : array, shape (m, 3), int32
        Welded.

    Returns
    -------
    array, shape (m,), bool
    """
    count = len(faces)
    a, b = faces.T.ravel().astype(np.int64), np.roll(faces, -1, axis=1).T.ravel()
    key = np.minimum(a, b) * len(vertices) + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    key, is_up, face = key[order], (a < b)[order], order % count
    starts = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    pair = starts[np.diff(np.append(starts, len(key))) == 2]
    one, other = face[pair], face[pair + 1]
    alike = is_up[pair] != is_up[pair + 1]
    as_one, as_other = other + count * ~alike, other + count * alike
    ends = np.concatenate([one, one + count]), np.concatenate([as_one, as_other])
    links = coo_array((np.ones(len(ends[0]), bool), ends), shape=(2 * count, 2 * count))
    _, side = connected_components(links, directed=False)

    corner, second, third = (vertices[faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(second - corner, third - corner), axis=1)
    as_is = np.bincount(side[:count], area, minlength=side.max() + 1)
    here, turned = side[:count], side[count:]
    return (as_is[here] < as_is[turned]) | ((as_is[here] == as_is[turned]) & (here > turned))
