"""Parts that the graph does not reach, fill or tie to a bone, and parts that follow a far joint."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..animation.falloff.components import MAX_RIGID_SIZE, bone_containment
from ..animation.falloff.rigid_accessories import CONTACT_CELLS, nearest_on_body
from ..geodesics.fallback import NOT_ALLOWED, UNREACHED
from ..graph import INTERIOR, CutCellGraph
from ..graph.winding.exact import winding_numbers_of
from ..rig.deform_joints.conventions import kinds_by_name
from ..rig.names import words
from ..runtime.display import count, share
from .finding import Finding, finding_of
from .subject import Subject, bones_distance

BARE_CELLS = 1.5
"""Cells: skin that is farther from every lattice point inside has none below it."""
DEPTHS = np.array([0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.65, 0.9, 1.2])
"""Cells below the skin at which it is looked for the inside."""
THIN_AREA, THIN_VERTICES = 0.005, 0.02
"""Parts of the surface and of its vertices: less than both may be thin."""
THICKNESS_SAMPLES = 600
"""Vertices at which thickness is measured."""
ENOUGH = 1.2
"""Cells that a part must be thick to hold lattice points nearly everywhere."""
RIGID_WEIGHT = 0.99
"""A part whose vertices all give more than this to one joint follows it rigidly."""
MIN_AWAY = 0.05
"""Minimum distance of the part's vertices from that joint's bones, as part of the longest side."""
BEYOND = 0.1
"""Minimum excess over the nearest joint's distance, in the median, as part of the longest side."""
ROOM = 0.05
"""Around the box of a part, as part of its longest side, where a joint still lies in it."""
MOVES_WITH_BODY = 0.1
"""A part moves with the body that it touches if that gives more weight to the part's joint."""


def check_parts(subject: Subject) -> Iterator[Finding]:
    """Look for parts of the body that the graph leaves out."""
    if (subject.graph.node_kind == INTERIOR).any():
        yield from _thin(subject)
    else:
        used, resolution = np.flatnonzero(subject.is_used), subject.graph.lattice.resolution
        yield from finding_of("no-interior", vertices=used, resolution=resolution)
    if len(subject.rig.skeleton.joints):
        yield from _unreachable(subject)
        yield from _loose(subject)


def _thin(subject: Subject) -> Iterator[Finding]:
    graph, mesh = subject.graph, subject.mesh
    resolution = graph.lattice.resolution
    inside = graph.nodes[graph.node_kind == INTERIOR]
    used = np.zeros(len(mesh.points), bool)
    used[subject.faces] = True
    far = used & (cKDTree(inside).query(mesh.points)[0] * resolution > BARE_CELLS)
    if not far.any():
        return
    areas = mesh.areas
    depth = _depths(graph, np.flatnonzero(far))
    thin = np.zeros(len(mesh.points), bool)
    thin[np.flatnonzero(far)[depth > 0]] = True
    start, end = subject.mesh.edges.edges.T
    neighbours = np.union1d(start[thin[end]], end[thin[start]])  # at sharp rims nothing is below
    thin[neighbours] |= far[neighbours]
    part, total = areas[thin].sum(), areas.sum()
    if part < THIN_AREA * total and thin.sum() < THIN_VERTICES * used.sum():
        return
    deep = depth > 0
    ascending = np.argsort(depth[deep], kind="stable")  # numpy 1.26 has no weighted median
    below = np.cumsum(areas[far][deep][ascending])
    typical = depth[deep][ascending][np.searchsorted(below, below[-1] / 2)]
    needed = ENOUGH * resolution / typical
    enough = int(np.ceil(needed / 16) * 16)
    advice = "Paths run over their skin, which is nearly equivalent."
    if enough > resolution:
        advice = f"A resolution of {enough} would fill most of them."
    vertices, covered = subject.vertices_at(thin), share(part, total)
    yield from finding_of(
        "thin-parts", vertices=vertices, part=covered, resolution=resolution, advice=advice
    )


def _depths(graph: CutCellGraph, places: NDArray[np.intp]) -> NDArray[np.float64]:
    """Measure how thick the body is below vertices, in cells; 0 where nothing is inside.

    Large sets are sampled; other vertices take the value of the nearest sample.
    """
    step = -(-len(places) // THICKNESS_SAMPLES)
    chosen = places[::step]
    points, normals = graph.mesh.points, graph.mesh.normals[chosen]
    below = points[chosen, None] - DEPTHS[:, None] / graph.lattice.resolution * normals[:, None]
    numbers = winding_numbers_of(graph.mesh, below.reshape(-1, 3))
    inside = numbers.reshape(len(chosen), -1) >= 0.5
    deep = np.cumprod(inside, axis=1).sum(axis=1)
    depth = np.concatenate([[0], DEPTHS])[deep]
    return depth if step == 1 else depth[cKDTree(points[chosen]).query(points[places])[1]]


def _unreachable(subject: Subject) -> Iterator[Finding]:
    lost = np.flatnonzero((subject.distances.fallback == UNREACHED) & subject.is_used)
    pieces = np.unique(subject.mesh.component[subject.welded[lost]])
    is_large = (subject.mesh.longest_sides[pieces] > MAX_RIGID_SIZE).any()
    follows = "small components follow what they sit on"
    if is_large:
        follows = "they follow their nearest bones in a straight line"
    yield from finding_of(
        "unreachable-vertices",
        severity="warning" if is_large else "note",
        vertices=lost,
        details=_lines(subject, pieces),
        why=f"No path through the body leads from a bone to {count(len(lost), 'vertex')} in "
        f"{count(len(pieces), 'component')}: {follows}.",
        advice="Let the component touch the body, or put a joint into it.",
    )
    barred = np.flatnonzero(subject.distances.fallback == NOT_ALLOWED)
    yield from finding_of(
        "unreachable-vertices",
        vertices=barred,
        why=f"{count(len(barred), 'vertex')} cannot follow the joints that come near: the skin of "
        "their mesh in the file does not have these.",
        advice="Give all meshes one skin.",
    )


def _loose(subject: Subject) -> Iterator[Finding]:
    used = np.unique(subject.mesh.component[subject.welded[subject.is_used]])
    if len(used) < 2:
        return
    containment = bone_containment(subject.mesh, subject.distances.bones)
    loose = np.setdiff1d(used, np.flatnonzero(containment.max(axis=1, initial=0) > 0))
    yield from finding_of(
        "boneless-components",
        vertices=subject.vertices_at(np.isin(subject.mesh.component, loose)),
        details=_lines(subject, loose),
        loose=len(loose),
        total=len(used),
        contain="contains" if len(loose) == 1 else "contain",
    )


def _lines(subject: Subject, pieces: NDArray[np.integer]) -> list[str]:
    """Describe components, the largest first: vertex count, and the joint that they follow."""
    piece = np.where(subject.is_used, subject.mesh.component[subject.welded], -1)
    sizes = np.bincount(piece[piece >= 0], minlength=len(subject.mesh.longest_sides))
    return [
        f"{count(int(sizes[p]), 'vertex', 'follow')} "
        f"{subject.name(_holder(subject, np.flatnonzero(piece == p)))}"
        for p in pieces[np.argsort(-sizes[pieces], kind="stable")]
    ]


def _holder(subject: Subject, vertices: NDArray[np.intp]) -> int:
    """Return the joint that some vertices follow most: by weights, else the nearest."""
    weights = subject.rig.weights
    if weights is not None and weights[vertices].any():
        return int(weights[vertices].sum(axis=0).argmax())
    return int(np.bincount(subject.distances.nearest_joint[vertices]).argmax())


def check_far_parts(subject: Subject) -> Iterator[Finding]:
    """Look for connected components that rigidly follow a joint far from them.

    One that follows the same joint as the body that it touches is sound, however far its bones are.
    """
    weights = subject.weights
    component = np.where(subject.is_used, subject.mesh.component[subject.welded], -1)
    joint = np.where(weights.max(axis=1) > RIGID_WEIGHT, weights.argmax(axis=1), -1)
    order = np.argsort(component, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(component[order])) + 1)
    far = [
        (part, int(joint[part[0]]), nearest)
        for part in parts
        if component[part[0]] >= 0 and joint[part[0]] >= 0 and (joint[part] == joint[part[0]]).all()
        if (nearest := _much_nearer(subject, part, int(joint[part[0]]))) >= 0
    ]
    far = [one for one in far if not _moves_with_the_body(subject, far, *one[:2])]
    if not far:
        return
    far.sort(key=lambda one: -len(one[0]))
    vertices = np.sort(np.concatenate([part for part, _, _ in far]))
    yield from finding_of(
        "far-parts",
        vertices=vertices,
        change=subject.weight_share(vertices),
        joints=np.unique([j for _, j, _ in far]),
        details=[
            f"Part {component[part[0]] + 1} ({count(len(part), 'vertex')}) follows "
            f"{subject.name(j)}; {subject.name(nearest)} is nearest"
            for part, j, nearest in far
        ],
        parts=tuple((int(part.min()), nearest) for part, _, nearest in far),
        empty=tuple(_empty_joint(subject, part) for part, _, _ in far),
    )


def _much_nearer(subject: Subject, part: NDArray[np.intp], joint: int) -> int:
    """Return the joint nearest to a part, if it is much nearer than the one that it follows."""
    bones, points = subject.distances.bones, subject.mesh.points[subject.welded[part]]
    allowed = subject.rig.allowed
    nearest, least, followed = -1, np.inf, np.full(len(points), np.inf)
    if not (bones.joint == joint).any():
        return -1
    for j in np.unique(bones.joint):
        if allowed is not None and not allowed[part, j].all():
            continue
        away = bones_distance(bones, int(j), points)
        if j == joint:
            followed = away
        if np.median(away) < least:
            nearest, least = int(j), float(np.median(away))
    is_far = followed.min() > MIN_AWAY and np.median(followed) - least > BEYOND
    return nearest if is_far else -1


def _empty_joint(subject: Subject, part: NDArray[np.intp]) -> int:
    """Return the joint without weight that lies in the box of a part, nearest to it; -1 for none.

    Props have such joints. Controls, roots and ends are none by their names.
    """
    skeleton, points = subject.rig.skeleton, subject.rig.mesh.vertices[part]
    low, high = points.min(axis=0), points.max(axis=0)
    room = ROOM * (high - low).max()
    inside = ((skeleton.joints >= low - room) & (skeleton.joints <= high + room)).all(axis=1)
    kinds = np.array([kind for kind, _ in kinds_by_name(skeleton.names)])
    is_control = np.isin(kinds, ["controls", "roots", "ends"])
    is_control |= ["ik" in words(name) for name in skeleton.names]
    empty = np.flatnonzero(inside & ~is_control & ~subject.weights.any(axis=0))
    away = cKDTree(points).query(skeleton.joints[empty])[0]
    return int(empty[away.argmin()]) if len(empty) else -1


def _moves_with_the_body(
    subject: Subject,
    far: list[tuple[NDArray[np.intp], int, int]],
    part: NDArray[np.intp],
    joint: int,
) -> bool:
    """Return whether the body that a part touches follows the joint of the part."""
    on_body = np.zeros(len(subject.mesh.points), bool)
    on_body[subject.welded[subject.is_used]] = True
    for other, _, _ in far:  # several may be wrong together
        on_body[subject.welded[other]] = False
    if not on_body.any():
        return False
    points = subject.mesh.points[subject.welded[part]]
    distance, mean = nearest_on_body(subject.graph, on_body, points)
    touching = distance <= distance.min() + CONTACT_CELLS / subject.graph.lattice.resolution
    of_joint = subject.weights[subject.mesh.first, joint]
    return float((mean[touching] @ of_joint).mean()) > MOVES_WITH_BODY
