"""Weights follow the character: axes, place, size, order and rounding choose among no equals."""

import itertools

import numpy as np
import pytest

from cutcell import Rig, Skeleton, TriangleMesh, bind, load
from cutcell.animation.any_angle.labels import END, SETTLED, join, no_labels, settle_equals
from cutcell.animation.any_angle.line_of_sight import _neighbour, _traverse
from cutcell.bones.bones import Bones
from cutcell.geodesics.fallback import straight_to_nearest
from cutcell.geometry.laplacian import vertex_normals
from cutcell.geometry.vectors import TIE
from cutcell.geometry.weld import weld
from cutcell.graph.interior import OUTSIDE
from cutcell_assets import demo_path
from tests.bars import bar, fork, grid_box
from tests.cutcell.binding.test_bind import figure

TURNS = [p for p in itertools.permutations(range(3)) if p != (0, 1, 2)]
LIMBS = {
    "leaf at its parent's end": ([2], [1]),
    "leaf at its parent's end, and at the middle": ([2, 1], [2, 0]),
    "leaves at the middle": ([1, 1], [0, 1]),
    "leaves at the root": ([0, 0], [0, 3]),
}


def limb(extra, parents):
    """Make a square bar with three joints, and further ones where some of these are."""
    vertices, faces = grid_box(9)
    joints = np.array([[x, 0.1, 0.1] for x in (0.1, 0.5, 0.9)])
    return Rig(
        TriangleMesh(vertices, faces), Skeleton([*joints, *joints[extra]], [-1, 0, 1, *parents])
    )


def changed(rig, change=lambda x: x, order=None, faces=None):
    mesh, skeleton = rig.mesh, rig.skeleton
    order = np.arange(len(mesh.vertices)) if order is None else order
    triangles = np.argsort(order)[mesh.faces[slice(None) if faces is None else faces]]
    unit = [change(np.eye(3)[k]) - change(np.zeros(3)) for k in range(3)]
    if np.linalg.det(unit) < 0:
        triangles = triangles[:, ::-1]
    joints = Skeleton(change(skeleton.joints), skeleton.parents, skeleton.names, skeleton.deform)
    return Rig(TriangleMesh(change(mesh.vertices[order]), triangles), joints)


def check_alike(rig, resolution=16, **options):
    """Bind a character and others that are the same, and compare all weights."""
    rig, random = changed(rig), np.random.default_rng(0)
    weights = bind(rig, resolution, **options).weights
    vertices, faces = (random.permutation(len(x)) for x in (rig.mesh.vertices, rig.mesh.faces))
    others = [changed(rig, lambda x, p=p: x[..., p]) for p in TURNS]
    others += [
        changed(rig, lambda x: x * 0.37 + 5),
        changed(rig, lambda x: x + np.array([0.3, -1.7, 2.9])),
        changed(rig, lambda x: x + 1e-13 * random.standard_normal(x.shape)),
        changed(rig, faces=faces),
    ]
    for other in others:
        np.testing.assert_allclose(bind(other, resolution, **options).weights, weights, atol=1e-6)
    result = bind(changed(rig, order=vertices), resolution, **options).weights
    np.testing.assert_allclose(result, weights[vertices], atol=1e-6)


@pytest.mark.parametrize("options", [{}, {"leaf": "point"}, {"max_influences": 1}])
@pytest.mark.parametrize("name", LIMBS)
def test_coincident_joints_share_alike(name, options):
    check_alike(limb(*LIMBS[name]), **options)


@pytest.mark.parametrize("make", [bar, figure, fork])
def test_bodies_with_many_equal_distances_are_bound_alike(make):
    check_alike(make())


@pytest.mark.parametrize("name", ["rabbit", "octopus"])
def test_demo_characters_are_bound_alike(name):
    check_alike(load(demo_path(name)), 24)


@pytest.mark.parametrize("make", [lambda: limb(*LIMBS["leaves at the middle"]), figure])
def test_the_papers_weights_do_not_depend_on_places(make):
    rig = changed(make())
    weights = bind(rig, 16, method="paper").weights
    for p in TURNS:
        result = bind(changed(rig, lambda x, p=p: x[..., p]), 16, method="paper").weights
        np.testing.assert_allclose(result, weights, atol=1e-6)


def test_the_fallback_takes_all_bones_that_are_equally_near():
    start = np.array([[0.3, 0.5, 0.5], [0.7, 0.5 + 1e-13, 0.5], [0.5, 0.9, 0.5]])
    bones = Bones(start, start, np.arange(3, dtype=np.int32))
    distance = straight_to_nearest(np.array([[0.5, 0.5, 0.5]]), bones, 1)
    np.testing.assert_array_equal(np.isfinite(distance[:, 0]), [True, True, False])


def test_a_line_of_sight_is_there_if_any_order_of_the_axes_leads_to_it():
    cells = np.array(list(itertools.product(range(2), repeat=3)))
    for path in itertools.permutations(range(3)):
        on_path = np.cumsum(np.eye(3, dtype=int)[list(path)], axis=0)
        inside = [tuple(c) for c in cells if not c.any() or (c == on_path).all(axis=1).any()]
        steps = np.full((len(inside), 6), OUTSIDE, np.int32)
        for k, axis in itertools.product(range(len(inside)), range(3)):
            ahead = tuple(np.array(inside[k]) + np.eye(3, dtype=int)[axis])
            if ahead in inside:
                steps[k, axis], steps[inside.index(ahead), 3 + axis] = inside.index(ahead), k
        assert _neighbour(steps, 0, (1, 1, 1)) == inside.index((1, 1, 1))
        assert _traverse(steps, 0, 1.0, 1.0, 1.0)
        assert _neighbour(steps, 0, (-1, 0, 0)) == OUTSIDE
        assert not _traverse(steps, 0, -1.0, 0.0, 0.0)


def test_normals_that_cancel_out_have_no_direction():
    points = np.array([[0.1, 0.2, 0.3], [0.7, 0.3, 0.1], [0.2, 0.9, 0.4]])
    normals = vertex_normals(points, np.array([[0, 1, 2], [1, 2, 0], [0, 2, 1], [2, 1, 0]]))
    np.testing.assert_array_equal(normals, np.zeros((3, 3)))


def test_merged_points_lie_in_the_middle_whichever_comes_first():
    points = np.array([[0.5, 0.5, 0.5], [0.5 + 4e-7, 0.5 - 4e-7, 0.5], [0.1, 0.9, 0.2]])
    welded, index = weld(points)
    turned, other = weld(points[:, [1, 2, 0]])
    assert index[0] == index[1] != index[2]
    np.testing.assert_array_equal(welded[index][:, [1, 2, 0]], turned[other])
    assert 0 < abs(welded[index[0], 0] - 0.5) < 4e-7
    assert TIE < 4e-7


def test_labels_at_one_distance_are_settled_together():
    labels, _ = no_labels(4, 1)
    labels["distance"] = [1 + TIE / 2, 2, 1, 1 + 3 * TIE]
    head = np.full(1, END, np.int32)
    for label in range(4):
        join(head, labels, 0, label, labels[label]["distance"])
    first = settle_equals(head, labels, 0)
    assert {first, labels[first]["before"]} == {0, 2}
    np.testing.assert_array_equal(labels["after"] == SETTLED, [True, False, True, False])
    assert head[0] == 3
