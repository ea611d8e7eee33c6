"""RigNet's distance against straight lines, a slow loop over triangles, and another Dijkstra."""

import networkx
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cutcell import ParameterError, Rig, Skeleton, TriangleMesh
from cutcell.geometry.edges import find_edges
from cutcell_lab.baselines import METHODS
from cutcell_lab.baselines.body import Body
from cutcell_lab.baselines.visibility import Blockers
from cutcell_lab.baselines.visible_geodesics import APART, over_surface, visible
from tests import meshes
from tests.bars import bar, check_weights, fork, grid_box


def boxes(*offsets, size=(0.4, 0.2, 0.2)):
    """Make boxes of one size that do not touch."""
    vertices, faces = grid_box(4, size=size)
    return (
        np.concatenate([vertices + np.array(offset) for offset in offsets]),
        np.concatenate([faces + k * len(vertices) for k in range(len(offsets))]),
    )


def slow_distances(body, reach):
    """Measure as RigNet's code is described: loops over rays, triangles and vertices."""
    graph = networkx.Graph()
    for face in body.faces:
        for a, b in zip(face, np.roll(face, 1), strict=True):
            graph.add_edge(a, b, length=np.linalg.norm(body.points[a] - body.points[b]))
    corners = body.points[body.faces]
    result = np.empty((len(body.bones.joint), len(body.points)))
    for row, start, end in zip(result, body.bones.start, body.bones.end, strict=True):
        straight, seen = np.empty(len(row)), []
        for v, point in enumerate(body.points):
            along = end - start
            part = np.clip((point - start) @ along / max(along @ along, 1e-300), 0, 1)
            way = start + part * along - point
            straight[v] = np.linalg.norm(way)
            others = corners[~(body.faces == v).any(axis=1)]
            matrix = np.stack(
                [
                    others[:, 1] - others[:, 0],
                    others[:, 2] - others[:, 0],
                    np.broadcast_to(-way, (len(others), 3)),
                ],
                axis=2,
            )
            crosses = np.abs(np.linalg.det(matrix)) > 1e-15
            u, w, t = np.linalg.solve(matrix[crosses], (point - others[crosses, 0])[..., None])[
                ..., 0
            ].T
            if not ((u >= 0) & (w >= 0) & (u + w <= 1) & (t > 1e-9) & (t < 1 - 1e-9)).any():
                seen.append(v)
        near = np.inf if reach is None else reach * np.percentile(straight[seen], 15)
        seen = [v for v in seen if straight[v] <= near]
        for v in range(len(row)):
            away = networkx.single_source_dijkstra_path_length(graph, v, weight="length")
            # Of equally near vertices any may be the one.
            least = min(away[s] for s in seen)
            last = min(straight[s] for s in seen if away[s] <= least + 1e-12)
            row[v] = straight[v] if v in seen else least + last
    return result


def turned(vertices, seed):
    """Rotate a mesh at random."""
    return vertices @ Rotation.random(rng=seed).as_matrix().T


@pytest.mark.parametrize("seed", [None, 0, 1])
@pytest.mark.parametrize("make", [lambda: grid_box(6), meshes.ball])
def test_no_segment_passes_between_triangles(make, seed):
    """Aim from outside into a closed body: through its vertices, middles and points of edges."""
    vertices, faces = make()
    vertices = vertices - vertices.mean(axis=0)
    if seed is not None:
        vertices = turned(vertices, seed)
    rng = np.random.default_rng(0)
    a, b = vertices[find_edges(faces).edges.T]
    share = rng.random((len(a), 1))
    through = np.concatenate([vertices, (a + b) / 2, a + share * (b - a)])
    inside = 0.3 * vertices[rng.integers(0, len(vertices), len(through))]
    outside = through + (through - inside) * rng.choice([0.5, 1.0, 3.0], (len(through), 1))
    blockers = Blockers(np.concatenate([vertices, outside]), faces)
    first = len(vertices) + np.arange(len(outside))
    assert blockers.blocked(first, inside).all()


@pytest.mark.parametrize("make", [meshes.ball, lambda: grid_box(12)])
def test_in_a_convex_body_all_distances_are_straight(make):
    vertices, faces = make()
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    joints = low + np.array([[0.3], [0.5], [0.7]]) * (high - low)
    rig = Rig(TriangleMesh(vertices, faces), Skeleton(joints, [-1, 0, 1]))
    result = METHODS["visibility"](rig, reach=None)
    check_weights(rig, result)
    assert result.warnings == ()
    np.testing.assert_allclose(result.weights, METHODS["euclidean"](rig).weights, atol=1e-9)


@pytest.mark.parametrize("reach", [None, 1.3])
def test_between_the_prongs_of_a_fork_the_way_is_over_the_surface(reach):
    rig = fork()
    body = Body.of(rig)
    straight, seen = body.straight(), visible(body)
    if reach is not None:
        limits = [reach * np.percentile(s[v], 15) for s, v in zip(straight, seen, strict=True)]
        seen &= straight <= np.array(limits)[:, None]
    result = over_surface(body, straight, seen)
    expected = slow_distances(body, reach)
    # Where two vertices are equally near, either may be the one that is gone through.
    ties = np.abs(result - expected) > 1e-9
    assert ties.mean() < 0.05
    assert (result >= expected - 1e-9).all()
    tips = (rig.mesh.vertices[:, 0] > 0.95) & (rig.mesh.vertices[:, 1] > 0.105)
    lower = np.flatnonzero(body.bones.end[:, 1] == body.bones.end[:, 1].min())[-1]
    size = np.ptp(rig.mesh.vertices, axis=0).max() / np.ptp(body.points, axis=0).max()
    way = size * result[lower, body.index[tips]]
    assert (way > 0.4).all(), "there and back again"
    assert (size * straight[lower, body.index[tips]] < 0.3).all()
    check_weights(rig, METHODS["visibility"](rig, reach=reach))


def test_parts_that_no_path_joins_are_far_from_each_others_bones():
    vertices, faces = boxes((0, 0, 0), (0, 0.25, 0))
    rig = Rig(
        TriangleMesh(vertices, faces),
        Skeleton([[x, y, 0.1] for y in (0.1, 0.35) for x in (0.1, 0.3)], [-1, 0, -1, 2]),
    )
    body = Body.of(rig)
    straight = body.straight()
    result = over_surface(body, straight, visible(body))
    first = body.points[:, 1] < body.points[:, 1].mean()
    for b, joint in enumerate(body.bones.joint):
        other = first if joint >= 2 else ~first
        np.testing.assert_allclose(result[b, other], straight[b, other] + APART)
        np.testing.assert_allclose(result[b, ~other], straight[b, ~other])


def test_what_no_bone_reaches_follows_its_nearest():
    vertices, faces = boxes((0, 0, 0), (0, 0.25, 0))
    rig = Rig(
        TriangleMesh(vertices, faces),
        Skeleton([[0.1, 0.1, 0.1], [0.3, 0.1, 0.1]], [-1, 0]),
    )
    result = METHODS["visibility"](rig)
    check_weights(rig, result)
    half = len(vertices) // 2
    assert len(result.warnings) == 1
    assert result.warnings[0].startswith(f"{half} of {2 * half} welded vertices follow their near")
    np.testing.assert_allclose(
        result.weights[half:], METHODS["euclidean"](rig).weights[half:], atol=1e-9
    )


def test_a_bone_that_nothing_sees_is_straight_from_all():
    rig = bar(12)
    body = Body.of(rig)
    straight, seen = body.straight(), visible(body)
    assert seen.all()
    seen[1] = False
    np.testing.assert_array_equal(over_surface(body, straight, seen), straight)


def test_its_reach_is_checked():
    with pytest.raises(ParameterError, match="reach must be a number from 1"):
        METHODS["visibility"](bar(4), reach=0.5)
