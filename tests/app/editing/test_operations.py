"""Operations on selected vertices: what holds of all of them, and each against a loop."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell.editing.selections import Neighbours
from cutcell.editing.symmetry import Mirror, find_mirror
from cutcell.errors import ParameterError, WeightsError
from cutcell.rig import Rig, Skeleton, TriangleMesh
from cutcell_app.editing.compute import operations as ops
from cutcell_app.editing.compute.selected import Selected
from tests.app.small import small_rig
from tests.bars import bar, grid_box, legs
from tests.cutcell.diagnosis.worm import worm

JOINTS = 5


def smooth(selected, *about):
    return ops.limited(selected, ops.smoothed(selected, *about)).toarray()


def paste(selected, *about):
    return ops.limited(selected, ops.pasted(selected, *about)).toarray()


def mirrored(selected, *about):
    vertices, rows = ops.mirrored(selected, *about)
    return vertices, rows.toarray()


def random_case(seed):
    """Return a selection of a bar with random weights, locks, limits and joints not allowed."""
    random = np.random.default_rng(seed)
    rig = bar(8, JOINTS + 1)
    count, joints = len(rig.mesh.vertices), JOINTS + 1
    weights = random.random((count, joints)) ** 3 * (random.random((count, joints)) < 0.5)
    weights[:, -1] = 0.0  # it carries no weight
    weights[np.arange(count), random.integers(JOINTS, size=count)] += 0.1
    weights /= weights.sum(axis=1, keepdims=True)
    if seed % 2:
        rig = replace(rig, allowed=(random.random((count, joints)) < 0.8) | (weights > 0))
    locked = random.permutation(JOINTS)[: seed % 3].tolist()
    free = [joint for joint in range(JOINTS) if joint not in locked]
    vertices = np.flatnonzero(random.random(count) < 0.4)
    most = None if seed % 4 == 0 else max(3, int((weights > 0).sum(axis=1).max()) - seed % 2)
    locks = random.random(weights.shape) < 0.2 if seed % 5 == 0 else None
    return Selected(rig, weights, vertices, locked, most, locks), free, random


def every_operation(selected, free, random):
    """Yield vertices and rows of each operation, with random numbers."""
    rig, vertices = selected.rig, selected.vertices
    neighbours = Neighbours.of(rig.mesh)
    graph = cutcell.build_graph(rig.mesh, 8)
    joint, other = free[0], free[-1]
    swap = np.arange(JOINTS + 1)
    swap[[joint, other]] = other, joint
    mirror = Mirror(0, 0.5, np.empty(0, np.intp), swap)
    reference = random.permuted(selected.weights, axis=0)
    copied = reference[: len(vertices)]
    rows = {
        "move": ops.move_weight(selected, free[1:], joint),
        "move one": ops.move_weight(selected, [other], joint),
        "fill": ops.fill(selected, joint, random.random()),
        "fill with all": ops.fill(selected, joint, 1.0),
        "fill with none": ops.fill(selected, joint, 0.0),
        "add": ops.add(selected, joint, random.random()),
        "subtract": ops.add(selected, joint, -random.random()),
        "scale": ops.scale(selected, other, 3 * random.random()),
        "smooth": smooth(selected, neighbours, 3),
        "smooth through": smooth(selected, Neighbours.through(graph), 2),
        "prune": ops.prune(selected, 0.3 * random.random(), 2),
        "normalise": ops.normalise(selected),
        "paste": paste(selected, rig.mesh.vertices[: len(copied)], copied),
        "paste in order": paste(selected, rig.mesh.vertices[: len(copied)], copied, "order"),
        "other rows": selected.finished(reference[vertices]),
    }
    yield from ((name, selected, result) for name, result in rows.items())
    for positive in (False, True):
        changed, result = mirrored(selected, mirror, positive)
        yield "mirror", replace(selected, vertices=changed), result


def test_many_vertices_are_changed_in_chunks(monkeypatch):
    selected, free, _ = random_case(3)
    whole = ops.fill(selected, free[0], 0.3)
    smoothed = smooth(selected, Neighbours.of(selected.rig.mesh), 3)
    monkeypatch.setattr(ops, "ROWS", 7)
    monkeypatch.setattr(ops, "COLUMNS", 2)
    filled = ops.in_chunks(selected, lambda part: ops.fill(part, free[0], 0.3))
    np.testing.assert_array_equal(filled.toarray(), whole)
    again = smooth(selected, Neighbours.of(selected.rig.mesh), 3)
    np.testing.assert_allclose(again, smoothed, rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_every_result_is_a_row_of_weights_that_respects_locks_and_limits(seed):
    selected, free, random = random_case(seed)
    before = selected.weights.copy()
    for name, done, rows in every_operation(selected, free, random):
        assert rows.shape == (len(done.vertices), JOINTS + 1), name
        assert np.isfinite(rows).all(), name
        assert (rows >= 0).all(), name
        np.testing.assert_allclose(rows.sum(axis=1), 1, atol=1e-12, err_msg=name)
        np.testing.assert_array_equal(rows[done.stays], before[done.vertices][done.stays])
        if done.rig.allowed is not None:
            assert not rows[~done.rig.allowed[done.vertices]].any(), name
        changed = (rows != before[done.vertices]).any(axis=1)
        most = 2 if name == "prune" else done.max_influences
        if most is not None:
            locked = (done.stays & (before[done.vertices] > 0)).sum(axis=1)
            few = (rows > 0).sum(axis=1) <= np.maximum(most, locked + 1)
            assert few[changed].all(), name
    np.testing.assert_array_equal(selected.weights, before)


def plain_case(count=40, seed=0):
    """Return a selection without limits, and rows of which no joint has all."""
    random = np.random.default_rng(seed)
    rig = replace(bar(8, 4), skeleton=replace(bar(8, 4).skeleton, deform=np.ones(4, bool)))
    weights = random.random((len(rig.mesh.vertices), 4)) + 0.05
    weights /= weights.sum(axis=1, keepdims=True)
    return Selected(rig, weights, random.permutation(len(weights))[:count])


def test_filling_adding_and_scaling_share_the_rest_in_proportion():
    selected = plain_case()
    values = {
        (ops.fill, 0.3): lambda w: 0.3,
        (ops.add, 0.2): lambda w: min(w + 0.2, 1),
        (ops.add, -0.2): lambda w: max(w - 0.2, 0),
        (ops.scale, 0.5): lambda w: 0.5 * w,
        (ops.scale, 40.0): lambda w: min(40 * w, 1),
    }
    for (operation, number), value in values.items():
        rows = operation(selected, 1, number)
        for row, before in zip(rows, selected.rows, strict=True):
            new = value(before[1])
            expected = before * (1 - new) / (1 - before[1])
            expected[1] = new
            np.testing.assert_allclose(row, expected, atol=1e-12)


def test_weight_moves_to_one_joint_and_nothing_else_changes():
    selected = plain_case()
    rows, before = ops.move_weight(selected, [0, 2, 1], 1), selected.rows
    np.testing.assert_allclose(rows[:, 1], before[:, :3].sum(axis=1), atol=1e-12)
    np.testing.assert_allclose(rows[:, 3], before[:, 3], atol=1e-12)
    assert not rows[:, [0, 2]].any()


@pytest.mark.parametrize("seed", range(12))
def test_rows_without_weight_that_moves_stay_to_the_bit(seed):
    selected, free, _ = random_case(seed)
    rows = ops.move_weight(selected, free[1:2], free[0])
    stays = selected.rows[:, free[1]] == 0
    assert stays.any()
    np.testing.assert_array_equal(rows[stays], selected.rows[stays])
    for sources in ([], [free[0]]):
        moved = ops.move_weight(selected, sources, free[0])
        np.testing.assert_array_equal(moved, selected.rows)


def test_a_vertex_that_follows_one_joint_keeps_what_nobody_would_take():
    selected = plain_case()
    weights = np.eye(4)[np.zeros(len(selected.weights), int)]
    selected = replace(selected, weights=weights)
    for rows in (ops.fill(selected, 0, 0.2), ops.add(selected, 0, -1), ops.scale(selected, 0, 0)):
        np.testing.assert_array_equal(rows, selected.rows)
    np.testing.assert_array_equal(ops.scale(selected, 1, 5), selected.rows)
    np.testing.assert_allclose(ops.fill(selected, 1, 0.2)[:, :2], [[0.8, 0.2]] * 40)


def test_smoothing_is_the_loop_over_neighbours_and_others_stay():
    selected = plain_case(25)
    mesh, rows = selected.rig.mesh, selected.weights.copy()
    next_to = [set() for _ in mesh.vertices]
    for face in mesh.faces.tolist():
        for a in face:
            next_to[a] |= set(face) - {a}
    for _ in range(4):
        mean = np.array([rows[list(others)].mean(axis=0) for others in next_to])
        rows[selected.vertices] = (rows + (mean - rows) / 2)[selected.vertices]
    result = smooth(selected, Neighbours.of(mesh), 4)
    np.testing.assert_allclose(result, rows[selected.vertices], atol=1e-12)
    np.testing.assert_allclose(smooth(selected, Neighbours.of(mesh), 0), selected.rows)


def test_weights_pass_from_shell_to_shell_only_through_the_body():
    points, faces = grid_box(10, 4, 4, (1.0, 0.4, 0.4))
    inner = points * [0.8, 0.6, 0.6] + [0.1, 0.08, 0.08]
    mesh = TriangleMesh(
        np.concatenate([points, inner]), np.concatenate([faces, faces + len(points)])
    )
    skeleton = Skeleton([[0.1, 0.2, 0.2], [0.9, 0.2, 0.2]], [-1, 0])
    is_inner = np.arange(len(mesh.vertices)) >= len(points)
    weights = np.stack([~is_inner, is_inner], axis=1).astype(float)
    outer = np.flatnonzero(~is_inner)
    selected = Selected(Rig(mesh, skeleton), weights, outer)
    over = smooth(selected, Neighbours.of(mesh), 5)
    np.testing.assert_array_equal(over, weights[outer])
    graph = cutcell.build_graph(mesh, 16)
    through = smooth(selected, Neighbours.through(graph), 5)
    assert (through[:, 1] > 0).mean() > 0.5
    np.testing.assert_allclose(through.sum(axis=1), 1, atol=1e-12)
    alike = replace(selected, weights=np.tile([0.25, 0.75], (len(weights), 1)))
    same = smooth(alike, Neighbours.through(graph), 5)
    np.testing.assert_allclose(same, alike.rows, atol=1e-12)


def test_pruning_keeps_what_is_large_and_the_largest():
    selected = plain_case()
    rows = ops.prune(selected, 0.2)
    for row, before in zip(rows, selected.rows, strict=True):
        expected = np.where((before >= 0.2) | (before == before.max()), before, 0)
        np.testing.assert_allclose(row, expected / expected.sum(), atol=1e-12)
    assert np.array_equal(ops.prune(selected, 1.0).max(axis=1), np.ones(40))


def test_rows_are_normalised_and_empty_ones_are_as_at_the_nearest():
    selected = plain_case()
    weights = selected.weights * np.linspace(0.2, 3, len(selected.weights))[:, None]
    empty = selected.vertices[:7]
    weights[empty] = 0
    rows = ops.normalise(replace(selected, weights=weights))
    points = selected.rig.mesh.vertices
    for vertex, row in zip(selected.vertices, rows, strict=True):
        away = np.linalg.norm(points - points[vertex], axis=1)
        away[empty] = np.inf
        near = np.flatnonzero(np.isclose(away, away.min())) if vertex in empty else [vertex]
        assert any(np.allclose(row, weights[one] / weights[one].sum()) for one in near)
    with pytest.raises(WeightsError, match="no vertex"):
        ops.normalise(replace(selected, weights=0 * weights))


def test_one_side_is_taken_for_the_other():
    rig = small_rig()
    mirror, random = find_mirror(rig), np.random.default_rng(3)
    weights = random.random(rig.weights.shape)
    weights /= weights.sum(axis=1, keepdims=True)
    every = Selected(rig, weights, np.arange(len(weights)))
    side = rig.mesh.vertices[:, mirror.axis] - mirror.position
    for positive in (True, False):
        vertices, rows = mirrored(every, mirror, positive)
        result = weights.copy()
        result[vertices] = rows
        swapped = result[mirror.vertex][:, mirror.joint]
        np.testing.assert_allclose(result, swapped, atol=1e-12)
        kept = side > 1e-9 if positive else side < -1e-9
        np.testing.assert_array_equal(result[kept], weights[kept])
        # A selection on either side means both of its sides.
        some = np.flatnonzero(kept)[:5]
        changed, _ = ops.mirrored(replace(every, vertices=some), mirror, positive)
        assert set(changed) == set(mirror.vertex[some])
        changed, _ = ops.mirrored(replace(every, vertices=mirror.vertex[some]), mirror, positive)
        assert set(changed) == set(mirror.vertex[some])


@pytest.mark.parametrize("named", [True, False])
def test_no_weight_is_mirrored_onto_a_control(named):
    rig = legs()
    names = rig.skeleton.names
    if not named:
        names = [f"joint_{number}" for number in range(len(names))]
        rig = replace(rig, skeleton=replace(rig.skeleton, names=names))
    mirror = find_mirror(rig)
    weights = np.random.default_rng(6).random(rig.weights.shape) * rig.skeleton.deform
    weights /= weights.sum(axis=1, keepdims=True)
    every = Selected(rig, weights, np.arange(len(weights)))
    vertices, rows = mirrored(every, mirror, True)
    assert not rows[:, ~rig.skeleton.deform].any()
    result = weights.copy()
    result[vertices] = rows
    np.testing.assert_allclose(result, result[mirror.vertex][:, mirror.swap], atol=1e-12)
    carries = np.flatnonzero(rig.skeleton.deform[1:]) + 1
    assert {mirror.how[joint] for joint in carries} == {"name" if named else "place"}


def test_a_pair_that_was_set_counts_for_both():
    rig = legs()
    shin, other, twist = (
        rig.skeleton.names.index(n) for n in ("shin.l", "shin.r", "thigh_twist.r")
    )
    mirror = find_mirror(replace(rig, partners={"shin.l": "thigh_twist.r"}))
    assert (mirror.joint[shin], mirror.joint[twist], mirror.joint[other]) == (twist, shin, -1)
    assert (mirror.how[shin], mirror.how[twist], mirror.how[other]) == ("set", "set", "")
    alone = find_mirror(replace(rig, partners={"shin.l": ""}))
    assert alone.joint[[shin, other]].tolist() == [-1, -1]
    edits = cutcell.Edits(joints={"shin.l": cutcell.JointEdit(partner="thigh_twist.r")})
    again = cutcell.Edits.from_json(edits.to_json())
    assert find_mirror(cutcell.edited_rig(rig, again)).joint[shin] == twist
    with pytest.raises(ParameterError, match="no joint"):
        cutcell.edited_rig(rig, cutcell.Edits(joints={"shin.l": cutcell.JointEdit(partner="?")}))


def test_joints_without_a_partner_stay_as_sides_are_swapped():
    mirror = find_mirror(small_rig())
    np.testing.assert_array_equal(mirror.swap, mirror.joint)
    alone = replace(mirror, joint=np.full(len(mirror.joint), -1))
    np.testing.assert_array_equal(alone.swap, np.arange(len(mirror.joint)))


def test_pasting_takes_the_nearest_or_the_order():
    selected = plain_case(6)
    points = selected.rig.mesh.vertices[selected.vertices]
    random = np.random.default_rng(4)
    rows = random.random((6, 4))
    rows /= rows.sum(axis=1, keepdims=True)
    order = random.permutation(6)
    np.testing.assert_allclose(paste(selected, points[order], rows[order]), rows)
    np.testing.assert_allclose(paste(selected, points, rows[order], "order"), rows[order])
    np.testing.assert_allclose(paste(selected, points[:1], rows[:1]), np.tile(rows[0], (6, 1)))
    with pytest.raises(ParameterError, match="3 vertices were copied, and 6 are selected"):
        paste(selected, points[:3], rows[:3], "order")
    with pytest.raises(ParameterError, match="nothing was copied"):
        paste(selected, points[:0], rows[:0])


def test_a_coat_gets_the_weights_of_the_body_below():
    body = worm()
    points, faces, count = body.mesh.vertices, body.mesh.faces, len(body.mesh.vertices)
    coat = points + 0.01 * body.mesh.welded.normals[body.mesh.welded.index]
    mesh = TriangleMesh(np.vstack([points, coat]), np.vstack([faces, faces + count]))
    wrong = np.eye(len(body.skeleton.names))[np.zeros(count, int)]
    rig = Rig(mesh, body.skeleton, np.vstack([body.weights, wrong]))
    chosen = np.arange(count, 2 * count)
    rows = ops.transferred(Selected(rig, rig.weights, chosen, max_influences=4)).toarray()
    assert np.abs(rows - body.weights).sum(axis=1).max() < 0.1
    locked = Selected(rig, rig.weights, chosen, [0], max_influences=4)
    np.testing.assert_array_equal(ops.transferred(locked).toarray(), wrong)
    for none in (chosen[:1], np.arange(2 * count)):
        with pytest.raises(ParameterError, match="select some faces"):
            ops.transferred(Selected(rig, rig.weights, none))


def test_what_cannot_be_is_an_error_that_names_it():
    selected = replace(plain_case(), locked=[1])
    with pytest.raises(ParameterError, match="is locked; unlock"):
        ops.fill(selected, 1, 0.5)
    with pytest.raises(ParameterError, match="is locked; unlock"):
        ops.move_weight(selected, [1], 0)
    locks = np.zeros(selected.weights.shape, bool)
    locks[selected.vertices, 2] = True
    partly = replace(selected, locked_weights=locks)
    with pytest.raises(ParameterError, match="is locked there; switch off"):
        partly.check_unlocked(2)
    partly.check_unlocked(0)
    with pytest.raises(ParameterError, match="is locked; unlock"):
        partly.check_unlocked(1)
    idle = random_case(0)[0]
    with pytest.raises(ParameterError, match="carries no weight"):
        ops.add(idle, JOINTS, 0.5)
    for operation, number in ((ops.fill, 1.5), (ops.add, np.nan), (ops.scale, -1)):
        with pytest.raises(ParameterError, match="must be a number from"):
            operation(selected, 0, number)
    with pytest.raises(ParameterError, match="no joint"):
        ops.fill(selected, "nobody", 0.5)
    away = Mirror(0, 99.0, np.empty(0, np.intp), np.arange(4))
    with pytest.raises(ParameterError, match="no vertices on that side"):
        ops.mirrored(selected, away, True)
