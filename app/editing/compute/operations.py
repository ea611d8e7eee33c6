"""Operations on the weights of selected vertices.

Each returns rows, shape (v, j), that are finite and not negative and sum to one. Locked joints keep
their weight, no vertex gets a joint that it may not follow (`Rig.allowed`), and a row for which
that leaves nobody stays as it is.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, hstack, vstack
from scipy.spatial import cKDTree

from cutcell.checks import check_choice, check_integer, check_number
from cutcell.editing.layers.contents import MAX_STEPS
from cutcell.editing.selections.neighbours import SMOOTHING_STEP, Neighbours
from cutcell.editing.symmetry import Mirror, reflected
from cutcell.editing.transfer import transfer
from cutcell.errors import ParameterError, WeightsError
from cutcell.rig import TriangleMesh

from .selected import Selected

INNER_SWEEPS = 4
"""Sweeps over the nodes inside the body to one over its vertices: a path from one shell to another
has as many nodes between them."""
ROWS, COLUMNS = 1000, 8
"""Vertices, and joints that are smoothed, at a time: all may not fit into memory."""
LARGEST = 1e3
"""Largest factor of weights."""


def in_chunks(
    selected: Selected, operation: Callable[[Selected], NDArray[np.float64]]
) -> csr_array:
    """Return the rows (v, j) of an operation that is applied to some vertices at a time.

    Dense rows of all vertices may not fit into memory.
    """
    rows = [csr_array(operation(part)) for _, part in _chunks(selected)]
    return csr_array(vstack(rows, format="csr"))


def limited(selected: Selected, rows: csr_array) -> csr_array:
    """Return rows (v, j) that respect the limits."""
    parts = [csr_array(part.finished(rows[which].toarray())) for which, part in _chunks(selected)]
    return csr_array(vstack(parts, format="csr"))


def _chunks(selected: Selected) -> Iterator[tuple[slice, Selected]]:
    for start in range(0, max(len(selected.vertices), 1), ROWS):
        which = slice(start, start + ROWS)
        yield which, replace(selected, vertices=selected.vertices[which])


def move_weight(
    selected: Selected, joints: Sequence[int | str], to: int | str
) -> NDArray[np.float64]:
    """Move all weight of some joints to one joint; weights of others, and other rows, stay."""
    target = selected.joint(to)
    sources = np.array(sorted({*map(selected.joint, joints)} - {target}), np.intp)
    rows, moves = selected.rows.copy(), np.zeros_like(selected.rows)
    moves[:, sources] = np.where(selected.stays[:, sources], 0.0, rows[:, sources])
    rows -= moves
    rows[:, target] += moves.sum(axis=1)
    can = selected.takes(target) & moves.any(axis=1)
    return np.where(can[:, None], selected.finished(rows), selected.rows)


def fill(selected: Selected, joint: int | str, value: float) -> NDArray[np.float64]:
    """Give a joint the same weight at all vertices, 0 to 1."""
    value = check_number("value", value, 0, 1)
    return selected.with_weight(selected.joint(joint), np.full(len(selected.vertices), value))


def add(selected: Selected, joint: int | str, change: float) -> NDArray[np.float64]:
    """Add to the weight of a joint, -1 to 1."""
    index, change = selected.joint(joint), check_number("change", change, -1, 1)
    return selected.with_weight(index, selected.rows[:, index] + change)


def scale(selected: Selected, joint: int | str, factor: float) -> NDArray[np.float64]:
    """Multiply the weight of a joint, by 0 or more."""
    index, factor = selected.joint(joint), check_number("factor", factor, 0, LARGEST)
    return selected.with_weight(index, selected.rows[:, index] * factor)


def smoothed(selected: Selected, neighbours: Neighbours, passes: int) -> csr_array:
    """Average weights with those of neighbours, again and again; other vertices stay.

    Neighbours over the surface keep shells apart. Through the body (`Neighbours.through`) weights
    pass from one shell to another. The rows, (v, j), are not `limited` yet.
    """
    passes = check_integer("passes", passes, 0, MAX_STEPS)
    moving, welded = np.unique(neighbours.welded[selected.vertices], return_inverse=True)
    links = neighbours.links
    first = np.full(links.shape[0], -1, np.intp)  # vertex of each node, -1 inside the body
    first[neighbours.welded[::-1]] = np.arange(len(neighbours.welded))[::-1]
    near, passed = np.zeros(len(first), np.bool_), first < 0
    near[moving] = passed[moving] = True
    for _ in range(INNER_SWEEPS + 1):  # nodes inside, as far as weights pass through them
        near |= links @ (near & passed) > 0
    nodes = np.flatnonzero(near)
    links = csr_array(links[nodes][:, nodes])
    vertex = first[nodes]
    sums = np.where(vertex >= 0, selected.weights.sum(axis=1)[vertex], 0.0)
    inside, at = np.flatnonzero(vertex < 0), np.searchsorted(nodes, moving)
    to_inside, to_moving = links[inside], links[at]
    columns = []
    for start in range(0, selected.weights.shape[1], COLUMNS):
        some = selected.weights[:, start : start + COLUMNS][vertex]
        some[vertex < 0] = 0.0
        rows = np.column_stack([some, sums])  # means are divided by the sums of all joints
        for _ in range(passes if some.any() else 0):
            for _ in range(INNER_SWEEPS if len(inside) else 0):
                rows[inside] = _means(to_inside @ rows, rows[inside])
            rows[at] += SMOOTHING_STEP * (_means(to_moving @ rows, rows[at]) - rows[at])
        columns.append(csr_array(rows[at[welded], :-1]))
    return csr_array(hstack(columns, format="csr"))


def transferred(selected: Selected) -> csr_array:
    """Return the weights that a transfer from all other vertices gives, sparse."""
    rig, faces = selected.rig, selected.rig.mesh.faces
    chosen = np.zeros(len(selected.weights), np.bool_)
    chosen[selected.vertices] = True
    within = faces[chosen[faces].all(axis=1)]
    if chosen.all() or not len(within):
        raise ParameterError(
            "no weights can be transferred; select some faces, but not all of the mesh"
        )
    source = rig.with_weights(np.where(chosen[:, None], 0.0, selected.weights))
    target = TriangleMesh(rig.mesh.vertices[chosen], (np.cumsum(chosen) - 1)[within])
    rows = transfer(source, target, max_influences=selected.max_influences).weights
    return limited(selected, csr_array(rows))


def prune(
    selected: Selected, limit: float, max_influences: int | None = None
) -> NDArray[np.float64]:
    """Remove weights below a limit, 0 to 1, and all but the strongest; one always stays."""
    limit = check_number("limit", limit, 0, 1)
    rows = selected.rows
    largest = np.where(selected.stays, 0.0, rows).max(axis=1, keepdims=True)
    most = selected.max_influences if max_influences is None else max_influences
    pruned = replace(selected, max_influences=most)
    return pruned.finished(np.where((rows < limit) & (rows < largest), 0.0, rows))


def normalise(selected: Selected) -> NDArray[np.float64]:
    """Scale rows to a sum of one; those without weight become as at the nearest weighted vertex."""
    points, rows = selected.rig.mesh.vertices, selected.rows.copy()
    empty = np.flatnonzero(~rows.any(axis=1))
    if not len(empty):
        return selected.finished(rows)
    weighted = np.flatnonzero(selected.weights.any(axis=1))
    if not len(weighted):
        raise WeightsError(f"no vertex of {selected.rig.name} has weight")
    near = cKDTree(points[weighted]).query(points[selected.vertices[empty]])[1]
    rows[empty] = selected.weights[weighted[near]]
    return selected.finished(rows)


def mirrored(
    selected: Selected, mirror: Mirror, positive: bool
) -> tuple[NDArray[np.intp], csr_array]:
    """Give one side of selected vertices, and their images on it, the other side's weights.

    The weights come from the side with larger coordinates, if `positive`. Joints without a partner
    keep their place. A vertex without a mirror image follows the vertex nearest to it, and one on
    the plane the average of itself and its image. Returns vertices (u,) and rows (u, j).
    """
    points, count = selected.rig.mesh.vertices, len(selected.rig.mesh.vertices)
    side = (points[:, mirror.axis] - mirror.position) * (1 if positive else -1)
    pairs = mirror.vertex if len(mirror.vertex) else np.full(count, -1, np.intp)
    is_middle = pairs == np.arange(count)
    source = np.flatnonzero((side >= 0) | is_middle)
    if not len(source):
        raise ParameterError(f"{selected.rig.name} has no vertices on that side")
    image = reflected(points, mirror.axis, mirror.position)
    partner = np.where(pairs >= 0, pairs, source[cKDTree(points[source]).query(image)[1]])
    chosen = np.zeros(count, np.bool_)
    chosen[selected.vertices] = True
    changed = np.flatnonzero(((side < 0) | is_middle) & (chosen | chosen[partner]))

    def image_rows(part: Selected) -> NDArray[np.float64]:
        rows = selected.weights[partner[part.vertices]][:, mirror.swap]
        middle = is_middle[part.vertices]
        rows[middle] = (rows[middle] + part.rows[middle]) / 2
        return part.finished(rows)

    return changed, in_chunks(replace(selected, vertices=changed), image_rows)


def pasted(
    selected: Selected, points: NDArray[np.float64], rows: csr_array, by: str = "nearest"
) -> csr_array:
    """Return rows (s, j) copied at points (s, 3), not `limited`: of the nearest, or in order."""
    by = check_choice("by", by, ("nearest", "order"))
    if not len(points):
        raise ParameterError("nothing was copied; copy the weights of a selection first")
    if by == "nearest":
        places = selected.rig.mesh.vertices[selected.vertices]
        return csr_array(rows[cKDTree(points).query(places)[1]])
    if len(points) != len(selected.vertices):
        raise ParameterError(
            f"weights of {len(points):,} vertices were copied, and {len(selected.vertices):,} are "
            "selected; paste by the nearest point, or select as many"
        )
    return csr_array(rows)


def _means(sums: NDArray[np.float64], before: NDArray[np.float64]) -> NDArray[np.float64]:
    """Divide by the last column; where no neighbour has weight, rows stay."""
    total = sums[:, -1:]
    return np.divide(sums, total, out=before.copy(), where=total > 0)
