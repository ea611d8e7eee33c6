"""What is explained is what `bind` does, step by step."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import cutcell
from cutcell import ParameterError
from cutcell.animation.falloff.division import POWER
from cutcell_assets import demo_path
from tests.bars import bar

RIG = cutcell.load(demo_path("robot"))
METHODS = {
    "animation": cutcell.ANIMATION.with_options(resolution=24),
    "paper": cutcell.PAPER.with_options(resolution=24),
    "few": cutcell.PAPER.with_options(resolution=24, max_influences=2),
}
RIGS = ["kaykit_knight", "khronos_Fox", "quaternius_deer", "quaternius_trex", "quaternius_wizard"]
VERTICES = np.linspace(0, len(RIG.mesh.vertices) - 1, 6).astype(int).tolist()


@pytest.fixture(scope="module", params=METHODS)
def bound(request):
    method = METHODS[request.param]
    return method, cutcell.bind(RIG, method=method)


def test_the_last_step_is_what_bind_computes(bound):
    method, binding = bound
    for vertex in VERTICES:
        found = cutcell.explain(RIG, vertex, method=method, distances=binding.distances)
        listed = [share.joint for share in found.joints]
        weights = [share.weight for share in found.joints]
        np.testing.assert_allclose(weights, binding.weights[vertex, listed], atol=1e-12)
        assert weights == sorted(weights, reverse=True)
        assert binding.weights[vertex].sum() - sum(weights) < 1e-3  # what is left out is small
        assert all(list(share.steps.values())[-1] == share.weight for share in found.joints)
        for share in found.joints:
            assert share.file_weight == RIG.weights[vertex, share.joint]


def test_factors_make_the_distance_that_shares_fall_with():
    method = METHODS["animation"]
    distances = cutcell.bind(RIG, method=method).distances
    for vertex in VERTICES:
        shares = cutcell.explain(RIG, vertex, method=method, distances=distances).joints
        known = [share for share in shares if np.isfinite(share.distance)]
        effective = np.array([share.effective for share in known])
        for share in known:
            product = share.distance * np.prod(list(share.factors.values()))
            assert share.effective == pytest.approx(product)
        falls = (effective.min() / effective) ** POWER
        found = [share.steps["falloff"] for share in known]
        np.testing.assert_allclose(found, falls / falls.sum(), atol=1e-3)


def test_paths_are_as_long_as_the_distances_and_no_shorter_than_through_the_air():
    method = METHODS["paper"]
    for vertex in VERTICES[:3]:
        for share in cutcell.explain(RIG, vertex, method=method).joints[:3]:
            if share.path:
                length = sum(piece.length for piece in share.path)
                assert length == pytest.approx(share.distance, rel=1e-6)
                assert length >= share.straight - 1e-9
                assert {piece.kind for piece in share.path} <= set(cutcell.geodesics.PIECES)


def test_it_is_plain_data_and_needs_no_weights_of_the_file():
    found = cutcell.explain(replace(RIG, weights=None), 0, method=METHODS["animation"])
    data = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert data["vertex"] == 0
    assert data["joints"][0]["file_weight"] is None
    assert data["joints"][0]["steps"]["normalise"] == found.joints[0].weight


def test_a_vertex_that_is_not_there_is_refused():
    with pytest.raises(ParameterError, match="vertex must be a whole number"):
        cutcell.explain(RIG, len(RIG.mesh.vertices))


def renamed(rig):
    joints = rig.skeleton
    return replace(rig, skeleton=replace(joints, names=("eye", *joints.names[1:])))


def reoriented(rig):
    axes = np.tile(np.eye(3), (len(rig.skeleton.joints), 1, 1))
    return replace(rig, skeleton=replace(rig.skeleton, orientations=axes))


@pytest.mark.parametrize("change", [renamed, reoriented])
def test_distances_of_another_skeleton_are_refused(change):
    rig = bar()
    distances = cutcell.bind(rig, 16).distances
    cutcell.explain(rig, 0, 16, distances=distances)
    with pytest.raises(ParameterError, match="distances does not fit: other Skeleton"):
        cutcell.explain(change(rig), 0, 16, distances=distances)


def test_distances_that_are_not_those_of_bind_are_refused():
    rig = bar(joints=8)
    graph = cutcell.build_graph(rig.mesh, 16)
    measure = partial(cutcell.bone_distances, graph, rig.skeleton)
    for options in ({"nearest_joints": 1}, {"within": 1.5}, {"nearest": 1}, {"samples": 2}):
        with pytest.raises(ParameterError, match=" ".join(options).replace("_", " ")):
            cutcell.explain(rig, 0, 16, distances=measure(**options))
    for options in ({"nearest_joints": 5}, {"within": 9}):
        cutcell.explain(rig, 0, 16, distances=measure(**options))


@pytest.mark.parametrize("method", ["animation", "few"])
def test_edits_are_explained_as_they_are_bound(method):
    names, method = RIG.skeleton.names, METHODS[method]
    most = [names[j] for j in np.argsort(-RIG.weights.sum(axis=0))]
    layers = [
        cutcell.Layer(cutcell.Computed(gain={most[0]: 1.5})),
        cutcell.Layer(cutcell.Painted([VERTICES[1]], [most[0]], [[1.0]])),
        cutcell.Layer(cutcell.Smoothed(1), cutcell.Mask(vertices=VERTICES[2:3]), opacity=0.5),
        cutcell.Layer(cutcell.Locked([most[2]]), name="kept"),
    ]
    edits = cutcell.Edits({most[1]: cutcell.JointEdit(deform=False)}, layers=layers)
    weights = cutcell.bind(RIG, method=method, edits=edits).weights
    for vertex in VERTICES[:4]:
        found = cutcell.explain(RIG, vertex, method=method, edits=edits)
        for share in found.joints:
            assert share.weight == pytest.approx(weights[vertex, share.joint], abs=1e-12)
            assert list(share.steps.values())[-1] == share.weight
            assert ("gain" in share.factors) == (share.name == most[0] and bool(share.factors))
            if share.factors:
                product = share.distance * np.prod(list(share.factors.values()))
                assert share.effective == pytest.approx(product)


@pytest.mark.parametrize("name", RIGS)
def test_the_last_step_of_real_characters_is_what_bind_computes(name, rigs):
    rig = cutcell.load(rigs[0].with_stem(name))
    used = np.flatnonzero(rig.skeleton.deform)
    rigid = cutcell.Filled({rig.skeleton.names[used[-1]]: 1.0})
    locked = cutcell.Locked([rig.skeleton.names[used[0]]])
    edits = cutcell.Edits(
        layers=[cutcell.Layer(rigid, cutcell.Mask(part=0)), cutcell.Layer(locked)]
    )
    for method, given in ((cutcell.ANIMATION, None), (cutcell.PAPER, edits)):
        options = {"method": method, "edits": given}
        weights = cutcell.bind(rig, 16, **options).weights
        for vertex in (0, len(rig.mesh.vertices) // 2):
            shares = cutcell.explain(rig, vertex, 16, **options).joints
            listed = [share.joint for share in shares]
            last = [list(share.steps.values())[-1] for share in shares]
            np.testing.assert_array_equal(last, weights[vertex, listed])
            assert weights[vertex].sum() - sum(last) < 1e-3  # what is left out is small


def absence(rig, vertex, joint, **options):
    """Return what is said of a joint without weight."""
    shares = cutcell.explain(rig, vertex, joint=joint, **options).joints
    (share,) = [one for one in shares if joint in (one.joint, one.name)]
    assert share.weight == 0
    return share


def at_start(rig):
    """Return the vertex that is nearest to where a bar begins."""
    return int(rig.mesh.vertices.sum(axis=1).argmin())


def test_a_joint_without_weight_says_why():
    rig = bar(joints=5)
    names = rig.skeleton.names
    far = absence(rig, at_start(rig), names[3], resolution=16)
    assert far.absence.startswith("It is too far: its distance is ")
    assert far.rank == 4
    assert far.path
    many = bar(40, joints=20)
    beyond = absence(many, at_start(many), many.skeleton.names[15], resolution=16)
    assert beyond.absence == "It is farther than the nearest joints, which share the vertex."
    assert beyond.rank > 4
    assert beyond.path
    for share in cutcell.explain(rig, 0, 16).joints:
        assert bool(share.absence) == (share.weight == 0)
    paper = absence(rig, at_start(rig), names[3], resolution=16, method="paper", max_influences=1)
    assert paper.absence == "3 joints have more weight, and 1 are kept."
    assert paper.rank == 4
    dull = absence(rig, at_start(rig), names[-1], resolution=16)
    assert dull.absence == "The joint does not deform the mesh."
    assert (dull.path, dull.rank) == ((), None)


def test_a_share_that_is_lost_at_a_step_says_at_which():
    rig = bar(joints=5)
    names, vertex = rig.skeleton.names, at_start(rig)
    low = absence(rig, vertex, names[3], resolution=16, method="paper", threshold=0.3)
    assert low.absence.startswith("Its weight was below the threshold, 30.0%")
    edits = cutcell.Edits(layers=[cutcell.Layer(cutcell.Painted([vertex], [names[3]], [[1.0]]))])
    lost = absence(rig, vertex, names[0], resolution=16, edits=edits)
    assert lost.absence == "The layer “Painted” gives it no weight."
    barred = np.ones((len(rig.mesh.vertices), 5), bool)
    barred[vertex, 1] = False
    kept_out = absence(replace(rig, allowed=barred), vertex, names[1], resolution=16)
    assert kept_out.absence == "The file cannot store weights of this joint at the vertex."


def test_a_joint_that_no_path_leads_to_says_so():
    one = bar(joints=4)
    vertices = np.concatenate([one.mesh.vertices, one.mesh.vertices + np.array([0, 0.6, 0])])
    faces = np.concatenate([one.mesh.faces, one.mesh.faces + len(one.mesh.vertices)])
    joints = np.concatenate([one.skeleton.joints, one.skeleton.joints + np.array([0, 0.6, 0])])
    skeleton = cutcell.Skeleton(joints, [-1, 0, 1, 2, 0, 4, 5, 6])
    rig = cutcell.Rig(cutcell.TriangleMesh(vertices, faces), skeleton)
    other = absence(rig, at_start(rig), 6, resolution=16)
    assert other.absence == "No path through the body leads from the vertex to the joint."
    assert other.rank is None


def test_joints_that_are_not_there_are_refused():
    with pytest.raises(ParameterError, match="nowhere"):
        cutcell.explain(RIG, 0, joint="nowhere")


@pytest.mark.parametrize("name", RIGS)
def test_every_joint_without_weight_of_real_characters_has_a_reason(name, rigs):
    rig = cutcell.load(rigs[0].with_stem(name))
    distances = cutcell.bind(rig, 16).distances
    for joint in range(len(rig.skeleton.names)):
        shares = cutcell.explain(rig, 0, 16, joint=joint, distances=distances).joints
        for share in shares:
            assert bool(share.absence) == (share.weight == 0)
