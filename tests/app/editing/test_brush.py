"""Painted weights: what a stroke changes, and above all what it leaves alone."""

from dataclasses import replace

import numpy as np
import pytest

from cutcell import ParameterError, Rig, Skeleton, TriangleMesh, WeightsError
from cutcell.errors import SkeletonError
from cutcell_app.editing.compute.brush import paint_weights
from cutcell_app.editing.compute.mirror import joint_mirror
from cutcell_app.editing.compute.stroke import Brush, PaintSurface, Stroke

CELLS, WIDE = 20, 4
GAP = 0.06
"""Between the legs: much less than the radius of the brushes here."""
MODES = ("add", "subtract", "replace", "smooth")
LEFT, RIGHT, ROOT, HEM = range(4)


def trousers(random=True):
    """Return a sheet over two legs side by side, mirrored, and a patch that floats over one."""
    up = np.arange(CELLS + 1) / CELLS
    left = np.stack([np.full_like(up, GAP / 2), up], axis=1)
    line = np.concatenate([left, [[0, 1]], (left * [-1, 1])[::-1]])
    z = np.linspace(0, 0.3, WIDE + 1)
    points = np.concatenate([np.repeat(line, len(z), 0), np.tile(z, len(line))[:, None]], axis=1)
    at = np.arange(len(points)).reshape(len(line), len(z))
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    faces = np.where(  # cut along mirrored diagonals
        (a >= at[CELLS + 1].min())[:, None],
        np.stack([a, b, d, b, c, d], 1), np.stack([a, b, c, a, c, d], 1),
    ).reshape(-1, 3)  # fmt: skip
    patch = np.array([[GAP / 2 + 0.01, 0.5, 0.1], [GAP / 2 + 0.01, 0.6, 0.1],
                      [GAP / 2 + 0.01, 0.5, 0.2]])  # fmt: skip
    copies = points[at[7]]  # a seam: other vertices in the same places
    first = len(points)
    seam = np.where(np.isin(faces, at[7]) & (faces.max(axis=1, keepdims=True) > at[7].max()),
                    faces - at[7, 0] + first, faces)  # fmt: skip
    vertices = np.concatenate([points, copies, patch])
    faces = np.concatenate([seam, [len(vertices) - np.array([3, 2, 1])]])
    skeleton = Skeleton(
        [[0.2, 0.5, 0.15], [-0.2, 0.5, 0.15], [0, 1.2, 0.15], [0, -0.2, 0.15]],
        [2, 2, -1, 2],
        ("thigh.L", "thigh.R", "root", "hem"),
    )
    rng = np.random.default_rng(3)
    held = rng.random((len(vertices), 4)) * (rng.random((len(vertices), 4)) < 0.7) + 1e-3
    if not random:
        held = np.tile([0.1, 0.2, 0.3, 0.4], (len(vertices), 1))
    opposite, middle = at[::-1], at[CELLS + 1]
    held[middle, LEFT] = held[middle, RIGHT]
    held[opposite[: CELLS + 1]] = held[at[: CELLS + 1]][..., [1, 0, 2, 3]]
    held[first : first + len(copies)] = held[at[7]]
    held /= held.sum(axis=1, keepdims=True)
    return Rig(TriangleMesh(vertices, faces), skeleton, held), at


@pytest.fixture(scope="module")
def rig():
    return trousers()[0]


@pytest.fixture(scope="module")
def at():
    return trousers()[1]


def naive(rig, joint, far, brush):
    """Paint vertex by vertex, as the documentation says it; `far` is (n,)."""
    result = rig.weights.copy()
    for vertex, row in enumerate(result):
        if far[vertex] >= brush.radius:
            continue
        cover = brush.strength * (1 - (far[vertex] / brush.radius) ** 2) ** 2
        held, rest = row[joint], 1 - row[joint]
        goal = {"add": held + cover, "subtract": held - cover,
                "replace": held + cover * (brush.value - held)}[brush.mode]  # fmt: skip
        goal = min(max(goal, 0), 1)
        if rest > 0:
            row *= (1 - goal) / rest
            row[joint] = goal
    return result


@pytest.mark.parametrize("mode", ["add", "subtract", "replace"])
def test_weights_are_those_of_a_plain_loop(rig, at, mode):
    brush = Brush(0.23, mode, 0.6, 0.3)
    stroke = at[4:9, 2]
    surface = PaintSurface(rig.mesh)
    far = surface.reach.distances(surface.reach.index[stroke], np.zeros(5), 9)[surface.reach.index]
    painted = paint_weights(rig, rig.weights, "thigh.L", stroke, brush)
    np.testing.assert_allclose(painted, naive(rig, LEFT, far, brush), atol=1e-12)
    assert (painted != rig.weights).any()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("most", [None, 2])
def test_rows_sum_to_one_and_nothing_else_is_touched(rig, at, mode, mirrored, most):
    brush = Brush(0.3, mode, 0.8)
    painted = paint_weights(
        rig, rig.weights, LEFT, [at[8, 1]], brush, mirrored=mirrored, max_influences=most
    )
    changed = np.flatnonzero((painted != rig.weights).any(axis=1))
    np.testing.assert_allclose(painted.sum(axis=1), 1, rtol=0, atol=1e-12)
    assert (painted >= 0).all()
    assert len(changed) > 10
    places = rig.mesh.vertices
    centres = [places[at[8, 1]]] + [places[at[8, 1]] * [-1, 1, 1]] * mirrored
    apart = np.min([np.linalg.norm(places[changed] - c, axis=1) for c in centres], axis=0)
    assert apart.max() < 0.3
    if not mirrored:  # the other leg and the patch are far nearer than the radius
        assert (places[changed, 0] > 0).all()
    assert changed.max() < len(places) - 3
    if most:
        assert (painted[changed] > 0).sum(axis=1).max() <= most


@pytest.mark.parametrize("mode", MODES)
def test_vertices_in_one_place_stay_alike(rig, at, mode):
    painted = paint_weights(rig, rig.weights, LEFT, [at[6, 2]], Brush(0.2, mode, 0.5))
    first = at.max() + 1
    copies = np.arange(first, first + WIDE + 1)
    assert np.array_equal(painted[copies], painted[at[7]])
    assert (painted[copies] != rig.weights[copies]).any()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("joint", [LEFT, ROOT])
def test_what_is_mirrored_is_equal_on_both_sides(rig, at, mode, joint):
    stroke = at[5:20, 2]  # up to the top, so that both brushes meet
    painted = paint_weights(rig, rig.weights, joint, stroke, Brush(0.2, mode, 0.4), mirrored=True)
    swapped = painted[at[::-1]][..., [1, 0, 2, 3]]
    np.testing.assert_allclose(swapped, painted[at], rtol=0, atol=1e-9)
    assert (painted != rig.weights).any()


@pytest.mark.parametrize("mode", MODES)
def test_locked_joints_keep_their_weights(rig, at, mode):
    locked = ["root", HEM]
    painted = paint_weights(
        rig, rig.weights, LEFT, [at[8, 1]], Brush(0.3, mode), locked=locked, max_influences=3
    )
    assert np.array_equal(painted[:, [ROOT, HEM]], rig.weights[:, [ROOT, HEM]])
    assert (painted[:, LEFT] != rig.weights[:, LEFT]).any()
    np.testing.assert_allclose(painted.sum(axis=1), 1, rtol=0, atol=1e-12)


def test_a_stroke_in_steps_is_the_stroke_in_one(rig, at):
    points = at[3:12, 1]
    surface, brush = PaintSurface(rig.mesh), Brush(0.15, "add", 0.3)
    for mode in MODES:
        stroke = Stroke(surface, rig, rig.weights, LEFT, replace(brush, mode=mode))
        for point in points:
            stroke.pass_over(np.array([[point]]), np.ones((1, 1)))
        for _ in range(3):  # back and forth changes nothing more
            stroke.pass_over(points[::-1, None], np.ones((len(points), 1)))
        vertices, rows = stroke.painted()
        whole = paint_weights(rig, rig.weights, LEFT, points, replace(brush, mode=mode))
        assert np.array_equal(rows, whole[vertices])
        assert np.array_equal(np.delete(whole, vertices, 0), np.delete(rig.weights, vertices, 0))


def test_a_brush_between_vertices_is_as_far_from_each_as_the_surface(rig, at):
    corners = np.array([[at[5, 1], at[6, 1], at[6, 2]]])
    shares = np.array([[0.2, 0.3, 0.5]])
    stroke = Stroke(PaintSurface(rig.mesh), rig, rig.weights, LEFT, Brush(0.06, "replace"))
    stroke.pass_over(corners, shares)
    vertices, rows = stroke.painted()
    middle = shares @ rig.mesh.vertices[corners[0]]
    far = np.linalg.norm(rig.mesh.vertices[vertices] - middle, axis=1)
    assert set(corners[0]) & set(vertices)
    before = rig.weights[vertices, LEFT]
    expected = before + (1 - (far / 0.06) ** 2) ** 2 * (1 - before)
    mine = np.isin(vertices, corners[0])
    np.testing.assert_allclose(rows[mine, LEFT], expected[mine], atol=1e-12)


def test_smoothing_keeps_what_is_smooth_and_flattens_what_is_not(at):
    even = trousers(random=False)[0]
    same = np.tile([0.1, 0.2, 0.3, 0.4], (len(even.mesh.vertices), 1))
    brush = Brush(0.3, "smooth")
    painted = paint_weights(even, same, LEFT, [at[8, 1]], brush)
    np.testing.assert_allclose(painted, same, atol=1e-12)
    spike = same.copy()
    spike[at[8, 2]] = [1, 0, 0, 0]
    painted = paint_weights(even, spike, LEFT, [at[8, 2]], brush)
    assert 0.1 < painted[at[8, 2], LEFT] < 0.3
    near = at[[7, 9], 2]
    assert (painted[near, LEFT] > 0.1).all()
    # No vertex gets more or less than what was around it.
    assert (painted[:, LEFT] <= 1).all()
    assert painted[:, LEFT].min() >= 0.1 - 1e-12
    rough = trousers()[0]
    smoothed = paint_weights(rough, rough.weights, LEFT, at[2:16, 2], Brush(0.4, "smooth"))
    inner = at[6:12, 1:4].ravel()
    assert smoothed[inner].std(axis=0).max() < 0.4 * rough.weights[inner].std(axis=0).max()


def test_only_what_the_file_can_store_is_painted(rig, at):
    allowed = np.ones(rig.weights.shape, bool)
    allowed[at[8], LEFT] = False
    held = np.where(allowed, rig.weights, 0)
    held /= held.sum(axis=1, keepdims=True)
    few = Rig(rig.mesh, rig.skeleton, held, allowed=allowed)
    for mode in MODES:
        painted = paint_weights(few, held, LEFT, [at[8, 1]], Brush(0.3, mode, 0.5))
        assert not painted[~allowed].any()
        np.testing.assert_allclose(painted.sum(axis=1), 1, rtol=0, atol=1e-12)


def test_painted_joints_come_before_stronger_ones(rig, at):
    held = np.tile([0.0, 0.4, 0.3, 0.3], (len(rig.weights), 1))
    painted = paint_weights(rig, held, LEFT, [at[8, 1]], Brush(0.1, "add", 0.1), max_influences=3)
    row = painted[at[8, 1]]
    assert row[LEFT] == pytest.approx(0.1)
    assert (row > 0).sum() == 3
    assert row[RIGHT] > row[ROOT] > 0


def test_a_vertex_that_nobody_else_holds_keeps_its_weight(rig, at):
    alone = np.tile(np.eye(4)[LEFT], (len(rig.weights), 1))
    painted = paint_weights(rig, alone, LEFT, [at[8, 1]], Brush(0.3, "subtract"))
    assert np.array_equal(painted, alone)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"joint": "thigh"}, 'there is no joint "thigh"'),
        ({"joint": 4}, "joint must be a whole number from 0 to 3"),
        ({"stroke": []}, "stroke must be a list of vertices"),
        ({"stroke": [0.5]}, "stroke must be a list of vertices"),
        ({"stroke": [-1]}, "stroke must hold vertices from 0 to"),
        ({"locked": ["thigh.L"]}, '"thigh.L" is locked'),
        ({"max_influences": 0}, "max_influences must be"),
        ({"mirrored": 1}, "mirrored must be True or False"),
    ],
)
def test_what_cannot_be_painted_is_told(rig, changes, said):
    asked = {"joint": LEFT, "stroke": [3], "brush": Brush(0.1), **changes}
    with pytest.raises(ParameterError, match=said):
        paint_weights(rig, rig.weights, asked.pop("joint"), asked.pop("stroke"),
                      asked.pop("brush"), **asked)  # fmt: skip


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"radius": 0}, "radius must be more than 0"),
        ({"radius": -1}, "radius must be a number"),
        ({"radius": 1, "mode": "blur"}, "mode must be one of"),
        ({"radius": 1, "strength": 1.5}, "strength must be a number from 0 to 1"),
        ({"radius": 1, "value": -0.5}, "value must be a number from 0 to 1"),
    ],
)
def test_a_brush_checks_itself(wrong, said):
    with pytest.raises(ParameterError, match=said):
        Brush(**wrong)


def test_weights_of_another_shape_and_idle_joints_are_refused(rig):
    with pytest.raises(WeightsError, match="one row a vertex"):
        paint_weights(rig, rig.weights[:, :2], LEFT, [3], Brush(0.1))
    idle = replace(rig.skeleton, deform=[True, True, False, True])
    still = Rig(rig.mesh, idle)
    with pytest.raises(ParameterError, match='"root" carries no weight'):
        paint_weights(still, rig.weights, "root", [3], Brush(0.1))
    lone = Rig(rig.mesh, Skeleton([[0.3, 0.1, 0], [0.3, 0.9, 0.2]], [-1, 0]))
    with pytest.raises(SkeletonError, match="not mirrored"):
        paint_weights(lone, rig.weights[:, :2], 0, [3], Brush(0.1), mirrored=True)


def test_a_mirror_of_joints_is_enough_where_the_mesh_has_no_partner(rig, at):
    mirror = joint_mirror(rig)
    half = rig.mesh.vertices[:, 0] >= 0
    faces = rig.mesh.faces[half[rig.mesh.faces].all(axis=1)]
    one = Rig(TriangleMesh(rig.mesh.vertices, faces), rig.skeleton)
    stroke = Stroke(PaintSurface(one.mesh), one, rig.weights, LEFT, Brush(0.05), mirror=mirror)
    stroke.pass_over(np.array([[at[8, 1]]]), np.ones((1, 1)))
    vertices, rows = stroke.painted()
    assert (rows[:, LEFT] >= rig.weights[vertices, LEFT]).all()


def test_only_vertices_within_a_selection_are_painted(rig):
    wide, within = Brush(0.5), rig.mesh.vertices[:, 1] > 0.5
    middle = int(np.abs(rig.mesh.vertices[:, 1] - 0.5).argmin())
    free = paint_weights(rig, rig.weights, LEFT, [middle], wide)
    result = paint_weights(rig, rig.weights, LEFT, [middle], wide, within=within)
    assert np.array_equal(result[within], free[within])
    assert np.array_equal(result[~within], rig.weights[~within])
    assert (free[~within] != rig.weights[~within]).any()
    with pytest.raises(WeightsError, match="within"):
        paint_weights(rig, rig.weights, LEFT, [middle], wide, within=[True])
