"""What is explained is what `bind` does, step by step."""

import json
from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import ParameterError
from cutcell.weights.rig_falloff.division import POWER
from cutcell_assets import demo_path

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


@pytest.mark.parametrize("method", ["animation", "few"])
def test_corrections_are_explained_as_they_are_bound(method):
    names, method = RIG.skeleton.names, METHODS[method]
    most = [names[j] for j in np.argsort(-RIG.weights.sum(axis=0))]
    joints = {
        most[0]: cutcell.JointCorrection(gain=1.5),
        most[1]: cutcell.JointCorrection(deform=False),
        most[2]: cutcell.JointCorrection(locked=True),
    }
    overruled = {VERTICES[1]: {most[0]: 1.0}}
    corrections = cutcell.Corrections(joints, vertices=overruled)
    weights = cutcell.bind(RIG, method=method, corrections=corrections).weights
    for vertex in VERTICES[:4]:
        found = cutcell.explain(RIG, vertex, method=method, corrections=corrections)
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
    corrections = cutcell.Corrections(
        joints={rig.skeleton.names[used[0]]: cutcell.JointCorrection(locked=True)},
        parts={0: cutcell.PartCorrection("glued", rig.skeleton.names[used[-1]])},
    )
    for method, given in ((cutcell.ANIMATION, None), (cutcell.PAPER, corrections)):
        options = {"method": method, "corrections": given}
        weights = cutcell.bind(rig, 16, **options).weights
        for vertex in (0, len(rig.mesh.vertices) // 2):
            shares = cutcell.explain(rig, vertex, 16, **options).joints
            listed = [share.joint for share in shares]
            last = [list(share.steps.values())[-1] for share in shares]
            np.testing.assert_array_equal(last, weights[vertex, listed])
            assert weights[vertex].sum() - sum(last) < 1e-3  # what is left out is small
