"""Regions where two sets of weights differ: their numbers are the metric's, their reasons known."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from cutcell.errors import ParameterError, WeightsError
from cutcell_lab.disagreement import REASONS, disagreement
from cutcell_lab.metrics import deformation_error, vertex_shares
from tests.bars import bar, grid_box, surface_of
from tests.cutcell.diagnosis.worm import worm

RESOLUTION = 32


def compared(rig, change):
    """Return the disagreement of computed weights and of others, which `change` makes of them."""
    binding = cutcell.bind(rig, RESOLUTION)
    weights = binding.weights.copy()
    change(weights)
    result = disagreement(
        rig, binding.weights, weights, binding.distances, names=("the computed weights", "the file")
    )
    return binding.weights, weights, result


def all_to(joint, vertices):
    """Return a change that gives vertices to one joint."""

    def change(weights):
        weights[vertices] = 0
        weights[vertices, joint] = 1

    return change


def prongs(gap):
    """Make a handle with two prongs, some way apart, and a bone in each."""
    ticks = [
        np.linspace(0, 1, 11),
        np.array([0, 0.05, 0.1, 0.1 + gap, 0.15 + gap, 0.2 + gap]),
        np.array([0, 0.05, 0.1]),
    ]
    solid = np.ones([len(t) - 1 for t in ticks], bool)
    solid[3:, 2, :] = False
    middle = 0.1 + gap / 2
    joints = [[0.1, middle, 0.05], [0.25, middle, 0.05]]
    joints += [[x, y, 0.05] for y in (0.05, 0.15 + gap) for x in (0.35, 0.95)]
    skeleton = Skeleton(joints, [-1, 0, 1, 2, 1, 4], deform=[True, False, True, False, True, False])
    return Rig(surface_of(ticks, solid), skeleton)


def beside(rig, box):
    """Return a rig with another component."""
    vertices = np.concatenate([rig.mesh.vertices, box[0]])
    faces = np.concatenate([rig.mesh.faces, box[1] + len(rig.mesh.vertices)])
    return Rig(TriangleMesh(vertices, faces), rig.skeleton)


def small_box(at):
    vertices, faces = grid_box(2, size=(0.06, 0.06, 0.06))
    return vertices + np.array(at), faces


@pytest.fixture(scope="module")
def noisy():
    """Return a worm, and two sets of weights that differ in many ways."""
    rig = worm()
    binding = cutcell.bind(rig, RESOLUTION)
    random = np.random.default_rng(1).dirichlet(np.full(7, 0.3), len(rig.weights))
    weights = 0.6 * rig.weights + 0.4 * random
    return rig, binding, weights / weights.sum(axis=1, keepdims=True)


def test_regions_are_parts_of_the_deformation_error(noisy):
    rig, binding, weights = noisy
    result = disagreement(rig, binding.weights, weights, binding.distances)
    errors = deformation_error(rig, binding.weights, weights)
    assert len(result.regions) > 3
    assert result.errors.mean == errors.mean
    assert sum(one.error for one in result.regions) + result.rest == pytest.approx(errors.mean)
    assert [one.error for one in result.regions] == sorted(
        (one.error for one in result.regions), reverse=True
    )
    together = np.concatenate([one.vertices for one in result.regions])
    assert len(np.unique(together)) == len(together)
    for one in result.regions:
        assert (np.diff(one.vertices) > 0).all()
        assert one.largest == pytest.approx(10 * np.sqrt(errors.vertex[one.vertices].max()))
        assert one.reason in REASONS
        assert one.text


def test_taking_a_region_lowers_the_error_by_its_part(noisy):
    rig, binding, weights = noisy
    share = vertex_shares(rig.mesh)
    result = disagreement(rig, binding.weights, weights, binding.distances)
    for one in result.regions[:3]:
        mixed = binding.weights.copy()
        mixed[one.vertices] = weights[one.vertices]
        after = deformation_error(rig, mixed, weights).mean
        assert result.errors.mean - after == pytest.approx(one.error)
        alone = weights.copy()
        alone[one.vertices] = binding.weights[one.vertices]
        worst = deformation_error(rig, alone, weights).worst(1)[0]
        part = share[one.vertices].sum()
        assert (one.turn.name, one.turn.axis) == (worst.name, worst.axis)
        assert one.turn.mean * part == pytest.approx(worst.mean)
        assert one.turn.largest == pytest.approx(worst.largest)
        assert one.rms == pytest.approx(10 * np.sqrt(one.error / part))


def test_equal_weights_agree(noisy):
    rig, binding, _ = noisy
    result = disagreement(rig, binding.weights, binding.weights, binding.distances)
    assert result.regions == ()
    assert result.rest == result.errors.mean == 0


@pytest.mark.parametrize(("gap", "reason"), [(0.01, "wall"), (0.1, "air")])
def test_weight_that_jumps_a_gap_has_leaked(gap, reason):
    rig = prongs(gap)
    end = np.flatnonzero((rig.mesh.vertices[:, 0] > 0.85) & (rig.mesh.vertices[:, 1] > 0.1 + gap))
    _, _, result = compared(rig, all_to(2, end))
    (one,) = result.regions
    assert one.reason == f"leak-through-{reason}"
    assert np.isin(one.vertices, end).all()
    assert (one.first, one.second) == (4, 2)
    assert f"{rig.skeleton.names[2]} has weight in the file" in one.text


def test_a_leak_of_the_first_weights_is_seen_as_well():
    rig = prongs(0.1)
    end = np.flatnonzero((rig.mesh.vertices[:, 0] > 0.85) & (rig.mesh.vertices[:, 1] > 0.2))
    binding = cutcell.bind(rig, RESOLUTION)
    leaked = binding.weights.copy()
    all_to(2, end)(leaked)
    (one,) = disagreement(rig, leaked, binding.weights, binding.distances).regions
    assert one.reason == "leak-through-air"
    assert (one.first, one.second) == (2, 4)


def test_a_joint_at_the_other_end_is_far():
    rig = worm()
    head = np.flatnonzero(rig.mesh.vertices[:, 0] > 0.93)
    _, _, result = compared(rig, all_to(1, head))
    assert result.regions[0].reason == "far"
    assert np.isin(result.regions[0].vertices, head).all()


def test_a_part_away_from_the_body_is_not_reached():
    rig = beside(bar(), small_box([0.5, 0.6, 0.07]))
    part = np.arange(len(rig.mesh.vertices) - 26, len(rig.mesh.vertices))
    vertices = part[rig.mesh.vertices[part, 1] > 0.3]
    _, _, result = compared(rig, lambda weights: all_to(0, vertices)(weights))
    assert {one.reason for one in result.regions} <= {"unreachable"}


def test_a_joint_of_another_component_is_not_reached():
    vertices, faces = grid_box(20)
    box = vertices + np.array([0, 0.5, 0]), faces
    rig = bar(joints=4)
    joints = np.concatenate([rig.skeleton.joints, rig.skeleton.joints + np.array([0, 0.5, 0])])
    parents = [-1, 0, 1, 2, 0, 4, 5, 6]
    rig = beside(replace(rig, skeleton=Skeleton(joints, parents)), box)
    end = np.flatnonzero((rig.mesh.vertices[:, 0] > 0.8) & (rig.mesh.vertices[:, 1] < 0.3))
    _, _, result = compared(rig, all_to(6, end))
    assert {one.reason for one in result.regions} == {"unreachable"}
    assert "no path through the body" in result.regions[0].text


def test_a_part_that_moves_as_a_whole_is_attached():
    rig = beside(bar(joints=4), small_box([0.47, 0.18, 0.07]))
    part = np.arange(len(bar(joints=4).mesh.vertices), len(rig.mesh.vertices))
    _, _, result = compared(rig, all_to(0, part))
    (one,) = result.regions
    assert one.reason == "attached"
    assert np.array_equal(one.vertices, part)


def test_a_joint_that_does_not_deform_has_no_distances():
    rig = bar(joints=4)
    rig = replace(rig, skeleton=replace(rig.skeleton, deform=[True, True, False, False]))
    end = np.flatnonzero(rig.mesh.vertices[:, 0] > 0.7)
    binding = cutcell.bind(rig, RESOLUTION)
    weights = binding.weights.copy()
    all_to(0, end)(weights)
    assert disagreement(rig, binding.weights, weights, binding.distances).regions
    all_to(2, end)(weights)
    result = disagreement(rig, binding.weights, weights, binding.distances)
    assert {one.reason for one in result.regions} <= {"not-deforming"}


def test_neighbours_blend_over_different_lengths():
    rig = bar(joints=4)

    def change(weights):
        x = rig.mesh.vertices[:, :1]
        hard = np.concatenate([x < 0.35, (x >= 0.35) & (x < 0.65), x >= 0.65, x < -1], axis=1)
        weights[:] = hard

    _, _, result = compared(rig, change)
    assert {one.reason for one in result.regions} == {"blend"}


def test_a_leaf_bone_that_goes_on_differs_by_its_extent():
    vertices, faces = grid_box(20)
    joints = [[0.05, 0.1, 0.1], [0.3, 0.1, 0.1], [0.5, 0.1, 0.1]]
    rig = Rig(TriangleMesh(vertices, faces), Skeleton(joints, [-1, 0, 1]))
    binding = cutcell.bind(rig, RESOLUTION, leaf="point")
    weights = binding.weights.copy()
    all_to(1, np.flatnonzero(vertices[:, 0] > 0.7))(weights)
    (one,) = disagreement(rig, binding.weights, weights, binding.distances).regions
    assert one.reason == "extent"


def test_bones_in_one_place_cannot_be_told_apart():
    vertices, faces = grid_box(20)
    joints = [[0.05, 0.1, 0.1], [0.3, 0.1, 0.1], [0.301, 0.1, 0.1], [0.95, 0.1, 0.1]]
    joints += [[0.951, 0.1, 0.1]]
    skeleton = Skeleton(joints, [-1, 0, 0, 1, 2], deform=[True, True, True, False, False])
    rig = Rig(TriangleMesh(vertices, faces), skeleton)
    binding = cutcell.bind(rig, RESOLUTION)
    one, other = binding.weights.copy(), binding.weights.copy()
    end = np.flatnonzero(vertices[:, 0] > 0.5)
    all_to(1, end)(one)
    all_to(2, end)(other)
    reasons = {r.reason for r in disagreement(rig, one, other, binding.distances).regions}
    assert reasons == {"same-place"}


def test_skin_without_lattice_points_is_thin():
    vertices, faces = grid_box(20, size=(1.0, 0.3, 0.004))
    joints = np.array([[0.05, 0.15, 0.002], [0.5, 0.15, 0.002], [0.95, 0.15, 0.002]])
    rig = Rig(TriangleMesh(vertices, faces), Skeleton(joints, [-1, 0, 1]))
    x = vertices[:, 0]
    _, _, result = compared(rig, all_to(0, np.flatnonzero((x > 0.5) & (x < 0.7))))
    assert result.regions[0].reason == "thin"


def test_what_no_check_recognises_is_said_so(monkeypatch):
    rig = worm()
    _, _, result = compared(rig, all_to(1, np.flatnonzero(rig.mesh.vertices[:, 0] > 0.93)))
    assert result.regions
    for name in ("_far", "_blend", "_extent", "_leak"):
        monkeypatch.setattr(f"cutcell_lab.disagreement.reasons.Reasons.{name}", lambda *_: iter(()))
    _, _, result = compared(rig, all_to(1, np.flatnonzero(rig.mesh.vertices[:, 0] > 0.93)))
    assert result.regions[0].reason == ""
    assert result.regions[0].text.startswith("No reason was recognised. head, with more")


def test_bad_input_is_refused(noisy):
    rig, binding, weights = noisy
    with pytest.raises(WeightsError):
        disagreement(rig, weights[:-1], weights[:-1], binding.distances)
    with pytest.raises(ParameterError, match="noticed"):
        disagreement(rig, weights, weights, binding.distances, noticed=-1)
    with pytest.raises(ParameterError, match="distances"):
        disagreement(worm().with_joints(rig.skeleton.joints + 0.01), weights, weights,
                     binding.distances)  # fmt: skip


@pytest.mark.slow
def test_a_leak_between_the_feet_of_a_real_character_is_recognised(rigs):
    rig = cutcell.load(rigs[0].with_stem("kaykit_knight"))
    left, right = (rig.skeleton.names.index(f"foot.{side}") for side in "lr")
    inner = rig.mesh.vertices - rig.skeleton.joints[left]
    foot = np.flatnonzero(rig.weights.argmax(axis=1) == right)
    near = foot[np.argsort(np.linalg.norm(inner[foot], axis=1))[:20]]
    leaked = rig.weights.copy()
    leaked[near] *= 0.4
    leaked[near, left] += 0.6
    distances = cutcell.bind(rig, RESOLUTION).distances
    (one,) = disagreement(rig, rig.weights, leaked, distances).regions
    assert one.reason == "leak-through-air"
    assert one.second == left
    assert np.isin(one.vertices, near).all()
