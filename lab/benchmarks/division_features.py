"""What a learned division sees of each vertex and joint: no names, no lengths, no axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from cutcell.animation.falloff.diffusion import Diffusion
from cutcell.animation.falloff.division import POWER
from cutcell.animation.falloff.pipeline import RigFalloff
from cutcell.rig.rows import least, lookup, rows_of_entries, strongest

WIDE = 3
"""Factor of the distance of the nearest joint: how far the second share spreads over the skin."""
SMALL = 3e-3
"""Added to both lengths of a ratio, in the unit cube."""
SLIGHT = 1e-4
"""Added to both areas of a ratio, of 1 in all."""


def pair_features(falloff: RigFalloff) -> dict[str, NDArray]:
    """Describe each entry of the distances, a vertex and one of its nearest joints.

    Lengths are in the unit cube, so that scale does not matter. Returns arrays (e,) by name.
    """
    distances, division = falloff.distances, falloff.division
    rows, surface = distances.rows, distances.graph.mesh
    vertex, joint, distance = rows_of_entries(rows), rows.indices, rows.data
    component, nearest = surface.component[vertex], strongest(division.weights)[vertex]
    at_least = least(rows)
    spread = falloff.diffusion.spread(division.weights)
    diffusion = Diffusion.over(surface, WIDE * at_least, distances.graph.lattice.resolution)
    wide = diffusion.spread(division.weights)
    of_joint, tree = _joints(falloff)

    def share_of(weights: csr_array) -> NDArray[np.float64]:
        share = lookup(weights, vertex, joint)
        return np.where(np.isfinite(share), share, 0)

    features = {
        "share after the skin around": share_of(spread),
        "share after the skin far around": share_of(wide),
        "distance": distance,
        "distance / nearest": _ratio(distance, at_least[vertex], SLIGHT),
        "distance / typical": _ratio(distance, of_joint["typical distance"][joint], SMALL),
        "distance / length": distance / (of_joint["length"][joint] + SMALL),
        "distance / radius": distance / division.radius[joint],
        "penalty": division.penalty[component, joint],
        **_by_shares(division.weights, vertex),
        **_by_bones(falloff, vertex),
        **_by_components(falloff, component, joint),
        "joints up": (tree.sum(axis=0) - tree.T @ tree)[nearest, joint],
        "joints down": (tree.sum(axis=0)[:, None] - tree.T @ tree)[joint, nearest],
    }
    for name, value in of_joint.items():
        features[f"joint: {name}"] = value[joint]
    for name in ("length", "area", "area below", "typical distance"):
        value = of_joint[name]
        features[f"{name} / nearest's"] = _ratio(value[joint], value[nearest], SLIGHT)
        features[f"nearest: {name}"] = value[nearest]
    return features


def _ratio(value: NDArray, other: NDArray, added: float) -> NDArray[np.float64]:
    return np.log((value + added) / (other + added))


def _by_shares(weights: csr_array, vertex: NDArray[np.intp]) -> dict[str, NDArray]:
    """Compare the shares by distance of a vertex: as ratios of lengths, as ranks."""
    share = np.maximum(weights.data, 1e-300)
    order = np.lexsort((-share, vertex))
    first = weights.indptr[vertex]
    rank = np.empty(len(order), np.intp)
    rank[order] = np.arange(len(order)) - first
    most, second = share[order[first]], share[order[np.minimum(first + 1, len(order) - 1)]]
    second = np.where(np.diff(weights.indptr)[vertex] > 1, second, 1e-300)
    return {
        "share by distance": np.log(share / most) / -POWER,
        "rank by distance": rank,
        "share of the second": np.log(second / most) / -POWER,
    }


def _by_bones(falloff: RigFalloff, vertex: NDArray[np.intp]) -> dict[str, NDArray]:
    """Locate vertices along the nearest bone of the joint, and compare directions."""
    rows, bones = falloff.distances.rows, falloff.distances.bones
    surface = falloff.distances.graph.mesh
    begin = np.searchsorted(bones.joint, np.arange(rows.shape[1] + 1))
    count = np.diff(begin)[rows.indices]
    entry = np.repeat(np.arange(len(count)), count)
    bone = np.arange(len(entry)) - np.repeat(np.cumsum(count) - count, count)
    bone += begin[rows.indices[entry]]
    along = bones.end[bone] - bones.start[bone]
    from_start = surface.points[vertex[entry]] - bones.start[bone]
    squared = np.maximum((along**2).sum(axis=1), 1e-12)
    fraction = (from_start * along).sum(axis=1) / squared
    away = from_start - np.clip(fraction, 0, 1)[:, None] * along
    length = np.linalg.norm(away, axis=1)
    order = np.lexsort((length, entry))
    chosen = order[np.cumsum(count) - count]
    normal, length = surface.normals[vertex], length[chosen]
    return {
        "place along bone": np.clip(fraction[chosen], -3, 4),
        "facing": (away[chosen] * normal).sum(axis=1) / np.maximum(length, 1e-9),
        "slope": np.abs((along[chosen] * normal).sum(axis=1)) / np.sqrt(squared[chosen]),
        "straight / distance": length / np.maximum(rows.data, 1e-6),
    }


def _by_components(
    falloff: RigFalloff, component: NDArray[np.integer], joint: NDArray[np.integer]
) -> dict[str, NDArray]:
    """Describe the connected component, and how much of it is the joint's."""
    surface, containment = falloff.distances.graph.mesh, falloff.division.containment
    entries = surface.areas, (surface.component, strongest(falloff.division.weights))
    owned = csr_array(entries, containment.shape).toarray()
    areas = owned.sum(axis=1)
    return {
        "component: components": np.full(len(joint), len(areas)),
        "component: area": (areas / areas.sum())[component],
        "component: size": surface.longest_sides[component],
        "component: most of a bone": containment.max(axis=1)[component],
        "bone in component": containment[component, joint],
        "component's area": owned[component, joint] / np.maximum(areas, 1e-12)[component],
    }


def _joints(falloff: RigFalloff) -> tuple[dict[str, NDArray], NDArray[np.float64]]:
    """Describe joints (j,); and tell which (j, j) deforming joint is above which, or the same."""
    distances, bones = falloff.distances, falloff.distances.bones
    skeleton, surface, joints = distances.skeleton, distances.graph.mesh, distances.rows.shape[1]
    assert skeleton is not None
    deform = np.zeros(joints, bool)
    deform[bones.joint] = True
    tree = skeleton.subtree & deform & deform[:, None]
    depth = tree.sum(axis=0)
    above = np.where(tree.T & ~np.eye(joints, dtype=bool), depth, 0)
    parent, is_child = above.argmax(axis=1), above.any(axis=1)
    sibling = (parent[:, None] == parent) & is_child & is_child[:, None]
    np.fill_diagonal(sibling, False)
    along = bones.end - bones.start
    by_length = np.argsort(np.linalg.norm(along, axis=1), kind="stable")
    main, place = np.zeros((2, joints, 3))
    main[bones.joint[by_length]] = along[by_length]
    place[bones.joint] = bones.start
    length = np.linalg.norm(main, axis=1)
    own = strongest(falloff.division.weights)
    area = np.bincount(own, surface.areas, joints) / surface.areas.sum()
    distance = lookup(distances.rows, np.arange(len(own)), own)
    typical, near, far = (
        np.array([np.quantile(distance[own == j], q) if area[j] else 0.0 for j in range(joints)])
        for q in (0.5, 0.0, 0.9)
    )
    to_parent = np.where(is_child[:, None], place - place[parent], 0)
    others = np.linalg.norm(place[:, None] - place, axis=2) + np.where(deform, 0, 9)
    np.fill_diagonal(others, 9)

    def cosine(one: NDArray, other: NDArray) -> NDArray:
        lengths = np.linalg.norm(one, axis=1) * np.linalg.norm(other, axis=1)
        return (one * other).sum(axis=1) / np.maximum(lengths, 1e-9)

    below = tree.sum(axis=1)
    described = {
        "deforming joints": np.full(joints, deform.sum()),
        "depth": depth,
        "joints below": below,
        "children": np.bincount(parent[is_child], minlength=joints),
        "bones": np.bincount(bones.joint, minlength=joints),
        "length": length,
        "to parent": np.linalg.norm(to_parent, axis=1),
        "to next joint": others.min(axis=1),
        "off centre": np.linalg.norm(place - place[deform].mean(axis=0), axis=1),
        "in component": falloff.division.containment.max(axis=0),
        "area": area,
        "area below": tree @ area,
        "typical distance": typical,
        "near distance": near,
        "far distance": far,
        "typical distance / length": _ratio(typical, length, SMALL),
        "length / parent's": np.where(is_child, _ratio(length, length[parent], SMALL), 0),
        "area / parent's": np.where(is_child, _ratio(area, area[parent], SLIGHT), 0),
        "turn to its bone": cosine(main, to_parent),
        "turn from parent's bone": cosine(main[parent], to_parent),
    }
    for name, value, added in (
        ("length", length, SMALL),
        ("area", area, SLIGHT),
        ("joints below", below, 0.5),
    ):
        most = np.where(sibling, value, 0).max(axis=1)
        described[f"{name} / siblings'"] = _ratio(value, most, added)
    return described, tree.astype(float)
