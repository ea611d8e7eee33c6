"""Tetrahedra that fill a body: by TetGen, or by fTetWild where TetGen cannot."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

SAME = 1e-6
"""Distance, relative to the longest side, at which a node is a point of the mesh."""
FLAGS = "pq1.5YQ"
"""TetGen: keep the surface as it is, make well-shaped tetrahedra, say nothing."""
SLIM = 0.02
"""A handle is moved so far into its tetrahedron that no part of it is thinner than this."""
CANDIDATES = 32
"""Tetrahedra nearby that may hold a point."""


def by_tetgen(points, faces, handles):
    """Fill a closed surface exactly; all points and handles are nodes of the result.

    Shapes: points (k, 3), faces (m, 3), handles (h, 3).
    """
    from igl.copyleft import tetgen

    faces = faces.astype(np.int64)
    try:
        filled = tetgen.tetrahedralize(np.concatenate([points, handles]), faces, flags=FLAGS)
    except RuntimeError:
        raise RuntimeError(
            "TetGen cannot fill the surface: it is open, cuts itself, or encloses nothing"
        ) from None
    nodes, tets = compact(filled[0], filled[1])
    if len(tets) == 0:
        raise RuntimeError("TetGen found nothing inside the surface")
    away, home = cKDTree(nodes).query(points)
    if (away > SAME).any():
        raise RuntimeError(
            f"TetGen dropped {(away > SAME).sum()} of the {len(points)} places of the surface"
        )
    shares = np.tile([1.0, 0.0, 0.0, 0.0], (len(points), 1))
    return {"nodes": nodes, "tets": tets, "corners": np.tile(home, (4, 1)).T, "shares": shares}


def by_tetwild(points, faces, handles, edge):
    """Fill any surface, open or not, up to a thousandth of its diagonal."""
    from pytetwild import tetrahedralize

    filled = tetrahedralize(
        np.ascontiguousarray(points, np.float64),
        np.ascontiguousarray(faces, np.int32),
        edge_length_fac=float(edge),
        num_threads=1,
        quiet=True,
    )
    nodes, tets = compact(filled[0], filled[1].astype(np.int64))
    if len(tets) == 0:
        raise RuntimeError("fTetWild found nothing inside the surface")
    tets = upright(nodes, tets)
    corners, shares = locate(nodes, tets, points)
    nodes, tets = insert(nodes, tets, handles)
    return {"nodes": nodes, "tets": tets, "corners": corners, "shares": shares}


def compact(nodes, tets):
    """Drop nodes that no tetrahedron uses."""
    used, tets = np.unique(tets, return_inverse=True)
    return np.ascontiguousarray(nodes[used]), np.ascontiguousarray(tets.reshape(-1, 4))


def upright(nodes, tets):
    """Turn tetrahedra so that all volumes are positive, without those that have none."""
    a, b, c, d = (nodes[tets[:, k]] for k in range(4))
    volume = np.einsum("tx,tx->t", np.cross(b - a, c - a), d - a)
    tets = np.where((volume < 0)[:, None], tets[:, [0, 2, 1, 3]], tets)
    return tets[volume != 0]


def barycentric(nodes, tets, points):
    """Return the shares (p, 4) that corners of tetrahedra (p, 4) have in points (p, 3)."""
    corners = nodes[tets]
    sides = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
    three = np.linalg.solve(sides, (points - corners[:, 0])[..., None])[..., 0]
    return np.concatenate([1 - three.sum(axis=1, keepdims=True), three], axis=1)


def locate(nodes, tets, points):
    """Find the tetrahedron that holds each point, or nearly: corners and shares, (p, 4)."""
    count = min(CANDIDATES, len(tets))
    near = cKDTree(nodes[tets].mean(axis=1)).query(points, k=list(range(1, count + 1)))[1]
    best, shares = np.zeros(len(points), np.int64), np.full((len(points), 4), -np.inf)
    for one in near.T:
        coordinates = barycentric(nodes, tets[one], points)
        better = coordinates.min(axis=1) > shares.min(axis=1)
        best[better], shares[better] = one[better], coordinates[better]
    shares = np.maximum(shares, 0)
    return tets[best], shares / shares.sum(axis=1, keepdims=True)


def insert(nodes, tets, points):
    """Make points nodes: the tetrahedron around each becomes four. Points outside are left out."""
    for point in points:
        shares = barycentric(nodes, tets, np.broadcast_to(point, (len(tets), 3)))
        inside = shares.min(axis=1)
        at = inside.argmax()
        if inside[at] < -SAME:
            continue
        share = np.maximum(shares[at], SLIM)
        share /= share.sum()
        old, new = tets[at].copy(), len(nodes)
        nodes = np.concatenate([nodes, [share @ nodes[old]]])
        four = np.tile(old, (4, 1))
        np.fill_diagonal(four, new)
        tets = np.concatenate([tets[:at], tets[at + 1 :], four])
    return nodes, tets
