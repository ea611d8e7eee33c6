"""What binding must never depend on, and what it tells."""

import re
import threading
import tracemalloc

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import cutcell
from cutcell import Cancelled, ParameterError, Rig, Skeleton, SkeletonError, TriangleMesh, bind
from cutcell.binding.stages import bind_base
from cutcell.editing.layers.contents import Computed
from tests import meshes
from tests.bars import bar, side_by_side

MIXED = cutcell.Method(connectivity=26, leaf="extend", max_influences=3, threshold=0.05)


def figure():
    """Make a closed body with two limbs close to each other, of unequal sides."""
    vertices, faces = meshes.torus()
    vertices = vertices * [1.3, 1, 0.8]
    joints = np.array([[0.65, 0.17, 0.4], [1.08, 0.5, 0.4], [0.65, 0.83, 0.4], [0.22, 0.5, 0.4]])
    return Rig(TriangleMesh(vertices, faces), Skeleton(joints, [-1, 0, 1, 2]))


def moved(rig, change):
    mesh = TriangleMesh(change(rig.mesh.vertices), rig.mesh.faces)
    return Rig(mesh, Skeleton(change(rig.skeleton.joints), rig.skeleton.parents))


@pytest.mark.parametrize("connectivity", [6, 26, "any"])
@pytest.mark.parametrize("leaf", ["point", "extend"])
def test_translation_and_scale_change_nothing(connectivity, leaf):
    rig = figure()
    # Coordinates with few bits, so that the changes below are exact.
    rig = moved(rig, lambda x: np.round(x * 2**20) / 2**20)
    options = dict(connectivity=connectivity, leaf=leaf)
    weights = bind(rig, 16, **options).weights
    for change in (
        lambda x: x + np.array([3, -5, 7]),
        lambda x: x * 1024,
        lambda x: x / 64,
        lambda x: x * 8 + 2,
    ):
        result = bind(moved(rig, change), 16, **options).weights
        np.testing.assert_allclose(result, weights, atol=1e-9)


@pytest.mark.parametrize("connectivity", [6, 26, "any"])
@pytest.mark.parametrize("make", [meshes.torus, meshes.ball_with_holes, meshes.grid_soup])
def test_numbering_changes_nothing(make, connectivity):
    vertices, faces = make()
    joints = np.array([[0.2, 0.5, 0.5], [0.5, 0.5, 0.5], [0.8, 0.5, 0.5], [0.5, 0.8, 0.5]])
    skeleton = Skeleton(joints, [-1, 0, 1, 1])
    rig = Rig(TriangleMesh(vertices, faces), skeleton)
    options = dict(max_influences=2, connectivity=connectivity)
    weights = bind(rig, 16, **options).weights

    rng = np.random.default_rng(0)
    order, shuffle, swap = (rng.permutation(len(x)) for x in (vertices, faces, joints))
    place = np.argsort(order)
    turned = np.stack([np.roll(f, rng.integers(3)) for f in place[faces[shuffle]]])
    parents = np.array([np.argsort(swap)[p] if p >= 0 else -1 for p in skeleton.parents[swap]])
    other = Rig(TriangleMesh(vertices[order], turned), Skeleton(joints[swap], parents))
    result = bind(other, 16, **options).weights
    np.testing.assert_allclose(result, weights[order][:, swap], atol=1e-9)


def test_split_vertices_get_equal_weights():
    rig = figure()
    corners = rig.mesh.faces.ravel()
    split = TriangleMesh(rig.mesh.vertices[corners], np.arange(len(corners)).reshape(-1, 3))
    result = bind(Rig(split, rig.skeleton), 16).weights
    np.testing.assert_allclose(result, bind(rig, 16).weights[corners], atol=1e-12)


def test_mirrored_figures_have_mirrored_weights():
    vertices, faces = meshes.ball(2)
    joints = [[0.5, 0.5, 0.5], [0.3, 0.5, 0.5], [0.7, 0.5, 0.5]]
    weights = bind(Rig(TriangleMesh(vertices, faces), Skeleton(joints, [-1, 0, 0])), 16).weights
    twin = np.argmin(
        np.linalg.norm(vertices * [-1, 1, 1] + [1, 0, 0] - vertices[:, None], axis=2), axis=1
    )
    np.testing.assert_allclose(weights[twin][:, [0, 2, 1]], weights, atol=1e-9)


def test_every_stage_reports_and_each_can_be_cancelled():
    seen = []
    binding = bind(figure(), 8, progress=lambda stage, fraction: seen.append(stage))
    stages = [stage for stage in dict.fromkeys(seen) if stage != "compile"]
    assert stages == ["graph", "distances", "weights"]
    assert list(binding.seconds) == ["graph", "distances", "weights"]
    assert all(s >= 0 for s in binding.seconds.values())
    for stop in binding.seconds:

        def cancel(stage, fraction, stop=stop):
            if stage == stop:
                raise Cancelled

        with pytest.raises(Cancelled):
            bind(figure(), 8, progress=cancel)


def test_binding_is_cancelled_while_a_step_is_silent(monkeypatch):
    begun, free = threading.Event(), threading.Event()

    def endless(faces):
        begun.set()
        assert free.wait(60)
        raise Cancelled

    def cancel(stage, fraction):
        if begun.is_set() and not free.is_set():
            raise Cancelled("asked while the step went on")

    monkeypatch.setattr("cutcell.graph.surface.find_reversed", endless)
    try:
        with pytest.raises(Cancelled, match="asked"):
            bind(figure(), 8, progress=cancel)
    finally:
        free.set()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"resolution": 10**30}, "resolution must be a whole number from 2 to 1,024, not 10000000"),
        ({"samples": "many"}, "samples must be a whole number from 1 to 1,000, not 'many'"),
        ({"leaf": 0}, "leaf must be one of 'point', 'extend', 'fit', not 0"),
        ({"falloff": []}, "falloff must be one of 'rig', 'paper', not \\[\\]"),
        ({"alpha": 1j}, "alpha must be a number from 0 to 1, not 1j"),
        ({"alpha": 0.5}, "alpha shapes the paper's falloff and has no effect with falloff='rig'"),
        ({"method": "papers"}, "method must be one of 'animation', 'paper', not 'papers'"),
        ({"threshold": np.nan}, "threshold must be a number from 0 to 1, not nan"),
        ({"max_influences": 0}, "max_influences must be a whole number from 1 to 1,024, not 0"),
        ({"locked": 5}, "locked must be a list of joints"),
    ],
)
def test_absurd_parameters_are_refused_before_anything_is_computed(options, sentence):
    with pytest.raises(ParameterError, match=sentence):
        bind(figure(), **options, progress=lambda stage, done: pytest.fail("it has begun"))


def test_joints_too_far_out_are_refused():
    joints, parents = [[0.5, 0.5, 0.5], [0, 1e200, 0]], [-1, 0]
    rig = Rig(figure().mesh, Skeleton(joints, parents, deform=[True, False]))
    with pytest.raises(SkeletonError, match=r"joint 1 lies at .*, too far out to compute with"):
        bind(rig, 8)
    with pytest.raises(SkeletonError, match="joint 1 lies at"):
        cutcell.bone_distances(cutcell.build_graph(rig.mesh, 8), rig.skeleton)


def test_warnings_say_what_happened():
    vertices, faces = meshes.ball()
    extra, extra_faces = meshes.box(1.2, 1.3)
    mesh = TriangleMesh(
        np.concatenate([vertices, extra]), np.concatenate([faces, extra_faces + len(vertices)])
    )
    binding = bind(Rig(mesh, Skeleton([[0.5, 0.5, 0.5]], [-1])), 16)
    assert "8 of 170 vertices follow their nearest bones" in binding.warnings[0]
    inside_out = TriangleMesh(vertices, faces[:, ::-1])
    binding = bind(Rig(inside_out, Skeleton([[0.5, 0.5, 0.5]], [-1])), 16)
    assert "inside out" in binding.warnings[0]
    np.testing.assert_allclose(binding.weights.sum(axis=1), 1)


@pytest.mark.parametrize("method", [cutcell.ANIMATION, cutcell.PAPER, "paper", MIXED])
def test_the_stages_one_after_the_other_are_bind(demo_paths, method):
    rig = cutcell.load(next(path for path in demo_paths if path.stem == "rabbit"))
    graph = cutcell.build_graph(rig.mesh, 32, method=method)
    distances = cutcell.bone_distances(graph, rig.skeleton, method=method, allowed=rig.allowed)
    weights = cutcell.skinning_weights(distances, method=method, allowed=rig.allowed)
    weights = cutcell.refine_weights(rig, weights, method=method, smoothing=1)
    expected = bind(rig, 32, method=method, smoothing=1)
    np.testing.assert_array_equal(graph.edges, expected.graph.edges)
    np.testing.assert_allclose(weights, expected.weights, atol=1e-12)


def test_the_paper_keeps_all_influences_and_nothing_else_differs():
    rig = figure()
    result = bind(rig, 16, method="paper")
    assert (result.weights > 0).all()
    options = dict(connectivity=6, leaf="point", falloff="paper", max_influences=None)
    np.testing.assert_array_equal(result.weights, bind(rig, 16, **options).weights)
    few = bind(rig, 16, method="paper", max_influences=2).weights
    np.testing.assert_array_equal((few > 0).sum(axis=1), 2)


def test_arrays_and_other_libraries_meshes_are_bound_as_rigs_are():
    rig = figure()
    vertices, faces = rig.mesh.vertices, rig.mesh.faces
    joints, parents = rig.skeleton.joints, rig.skeleton.parents
    expected = bind(rig, 12).weights
    other = trimesh.Trimesh(vertices, faces, process=False)
    for given in ((vertices, faces, joints, parents), (other, (joints, parents))):
        np.testing.assert_array_equal(bind(given, 12).weights, expected)


def test_all_real_rigs_can_be_bound(rigs):
    for path in rigs:
        rig = cutcell.load(path)
        weights = bind(rig, 32).weights
        assert weights.shape == rig.weights.shape, path
        assert np.isfinite(weights).all(), path
        assert (weights >= 0).all(), path
        np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-6, err_msg=str(path))
        assert (weights[:, ~rig.skeleton.deform] == 0).all(), path


def rotation_change(resolution, connectivity):
    """Measure how far weights move, summed over joints, when the figure is rotated."""
    turn = Rotation.from_rotvec(0.5 * np.array([1, 2, 3]) / 14**0.5).as_matrix()
    rig = figure()
    # The paper's falloff is soft: it shows small changes of the distances.
    options = dict(connectivity=connectivity, falloff="paper", max_influences=None)
    once = bind(rig, resolution, **options).weights
    again = bind(moved(rig, lambda x: x @ turn.T), resolution, **options).weights
    return np.abs(again - once).sum(axis=1).mean()


@pytest.mark.parametrize("connectivity", [6, 26, "any"])
def test_rotation_changes_less_on_a_finer_lattice(connectivity):
    coarse, middle, fine = (rotation_change(r, connectivity) for r in (8, 24, 72))
    assert coarse > middle > fine
    # Along lattice edges something remains at every resolution: their paths are too long.
    assert fine < {6: 0.1, 26: 0.05, "any": 0.01}[connectivity]


def test_joints_that_get_no_weight_are_named():
    rig = figure()
    joints = np.concatenate([rig.skeleton.joints, rig.skeleton.joints[-1:]])
    names = ["first", "second", "third", "fourth", "twin"]
    twins = Rig(rig.mesh, Skeleton(joints, [-1, 0, 1, 2, 2], names))
    for skeleton, is_named in (
        (twins.skeleton, True),
        (Skeleton(joints, [-1, 0, 1, 2, 2], names, [True] * 4 + [False]), False),
    ):
        result = bind(Rig(rig.mesh, skeleton), 16, max_influences=1)
        assert not result.weights[:, 4].any()
        assert any("twin" in warning for warning in result.warnings) == is_named


def thin_hand():
    """Make a palm with four thin fingers, whose first bones are short and below its skin."""
    palm = trimesh.creation.box(bounds=[[-0.1, -0.1, -0.02], [0, 0.1, 0.02]])
    parts = [palm.subdivide().subdivide().subdivide().subdivide()]
    joints, parents = [[-0.08, 0, 0], [-0.05, 0, 0]], [-1, 0]
    for y in (-0.06, -0.02, 0.02, 0.06):
        finger = trimesh.creation.box(
            bounds=[[-0.01, y - 0.004, -0.004], [0.009, y + 0.004, 0.004]]
        )
        parts.append(finger.subdivide().subdivide().subdivide())
        for k, x in enumerate((-0.01, 0, 0.003, 0.006)):
            parents.append(1 if k == 0 else len(joints) - 1)
            joints.append([x, y, 0])
    mesh = trimesh.util.concatenate(parts)
    return Rig(TriangleMesh(mesh.vertices, mesh.faces), Skeleton(joints, parents))


def test_a_lattice_too_coarse_for_a_joint_names_a_resolution_that_is_not():
    rig = thin_hand()
    coarse = bind(rig, 8)
    lost = np.flatnonzero(~coarse.weights.any(axis=0))
    assert len(lost)
    (warning,) = (text for text in coarse.warnings if "get no weight" in text)
    resolution = int(re.search(r"choose a resolution of (\d+)", warning)[1])
    assert 8 < resolution < 128
    fine = bind(rig, resolution)
    assert fine.weights.any(axis=0).all()
    assert not any("get no weight" in text for text in fine.warnings)


def test_characters_side_by_side_are_bound_as_if_alone():
    small, alone = cutcell.Method(resolution=20), bar(12)
    count, joints = len(alone.mesh.vertices), len(alone.skeleton.joints)
    both = side_by_side(alone)
    one, two = cutcell.bind(alone, method=small), cutcell.bind(both, method=small)
    assert two.method.resolution == round(2.2 * small.resolution)
    np.testing.assert_allclose(two.weights[:count, :joints], one.weights, atol=0.05)
    assert not two.weights[:count, joints:].any()
    assert cutcell.bind(both, 16).method.resolution == 16, "an R that is given stays"
    share = cutcell.explain(both, 0, method=small, distances=two.distances).joints[0]
    assert share.name in both.skeleton.names[:joints]
    again = cutcell.bind(both, method=small, graph=two.graph)
    assert again.graph is two.graph
    np.testing.assert_array_equal(again.weights, two.weights)


def test_few_influences_follow_the_distances_of_many(demo_paths):
    """A path leads through nodes that are nearer to other joints; there it must not be dropped."""
    rig = cutcell.load(next(path for path in demo_paths if path.stem == "biped"))
    method = cutcell.PAPER.with_options(resolution=16, connectivity="any", max_influences=8)
    many = bind(rig, 16, method=method)
    for most in (1, 2):
        few = bind(rig, 16, method=method, max_influences=most, graph=many.graph)
        pruned = cutcell.weights.keep_strongest(many.distances, many.rows, most, 0.0)
        np.testing.assert_allclose(few.weights, pruned.toarray(), atol=1e-12)


def test_many_joints_take_no_memory_of_matrices_of_vertices_and_joints():
    vertices, faces = meshes.ball(5)
    joints = np.linspace([0.2, 0.5, 0.5], [0.8, 0.5, 0.5], 400)
    rig = Rig(TriangleMesh(vertices, faces), Skeleton(joints, np.arange(400) - 1))
    distances = bind(rig, 16).distances
    tracemalloc.start()
    rows = bind_base(rig, cutcell.ANIMATION, Computed(), distances=distances).rows
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < len(vertices) * len(joints) * 8
    assert distances.rows.nnz < 20 * len(vertices)
    assert rows.nnz <= 4 * len(vertices)
