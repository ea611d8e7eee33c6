"""Corrections: as data, in JSON, and in what `bind` makes of them."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

import cutcell
from cutcell import Corrections, JointCorrection, ParameterError, PartCorrection, TriangleMesh
from cutcell.errors import FileError, SkeletonError, WeightsError
from tests.cutcell.diagnosis.test_leaks import soldier
from tests.cutcell.diagnosis.worm import worm

WORM = worm()
HEAD, CHEST = (WORM.skeleton.names.index(name) for name in ("head", "chest"))
ALL = Corrections(
    joints={
        "neck": JointCorrection(deform=False),
        "head": JointCorrection(locked=True, gain=1.5, radius=0.25, position=(0.5, 0.25, 0)),
    },
    parts={3: PartCorrection("glued", "head"), 4: PartCorrection("touching")},
    vertices={7: {"head": 3.0, "tail": 1.0}},
)


def with_button():
    button = trimesh.creation.icosphere(subdivisions=1, radius=0.03)
    vertices = np.concatenate([WORM.mesh.vertices, np.array([0.55, 0.12, 0]) + button.vertices])
    faces = np.concatenate([WORM.mesh.faces, button.faces + len(WORM.mesh.vertices)])
    return cutcell.Rig(TriangleMesh(vertices, faces), WORM.skeleton), len(WORM.mesh.vertices)


def bound(rig, **parts):
    return cutcell.bind(rig, 24, corrections=Corrections(**parts)).weights


def test_json_and_back_is_the_same(tmp_path):
    assert Corrections.from_json(ALL.to_json()) == ALL
    assert Corrections.from_json(ALL.to_json(indent=None)) == ALL
    assert "\n" not in ALL.to_json(indent=None)
    assert ALL.vertices[7] == {"head": 0.75, "tail": 0.25}
    ALL.save(tmp_path / "c.json")
    assert Corrections.load(tmp_path / "c.json") == ALL
    assert not Corrections.from_json(Corrections().to_json())


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[", "corrections are no JSON"),
        ("[]", "corrections must be a mapping"),
        ('{"joint": {}}', 'corrections has no .joint.; did you mean "joints"'),
        (
            '{"joints": {"Head": {"gian": 2}}}',
            '"Head" has no .gian.; did you mean "gain"',
        ),
        ('{"joints": {"Head": {"gain": 0}}}', 'the joint "Head": gain must be'),
        ('{"joints": {"Head": {"radius": 0}}}', "radius must be more than 0"),
        ('{"joints": {"Head": {"locked": 1}}}', "locked must be"),
        ('{"joints": {"Head": {"position": [1, 2]}}}', 'the joint "Head": position must be three'),
        ('{"joints": {"Head": {"position": "abc"}}}', "position must be three numbers"),
        ('{"joints": {"Head": {"position": [0, NaN, 0]}}}', "y of position must be a number"),
        ('{"joints": {"Head": {"position": [0, 0, 1e99]}}}', "z of position must be a number"),
        ('{"parts": {}}', "parts must be a list"),
        ('{"parts": [{"how": "glued"}]}', 'part 0 needs "vertex"'),
        ('{"parts": [{"vertex": 1, "how": "glued"}]}', "part 0: a part that is glued needs"),
        ('{"parts": [{"vertex": 1, "how": "itself", "joint": "a"}]}', "only if it is glued"),
        ('{"parts": [{"vertex": -1, "how": "itself"}]}', "vertex of part 0 must be"),
        ('{"vertices": {"x": {}}}', "vertices go by their numbers"),
        ('{"vertices": {"1": {"a": 0}}}', "vertex 1 needs a weight above 0"),
        ('{"vertices": {"1": {"a": -1}}}', "the weight of vertex 1 for"),
    ],
)
def test_what_is_wrong_is_named(text, sentence):
    with pytest.raises(ParameterError, match=sentence):
        Corrections.from_json(text)


def test_joints_of_a_vertex_go_by_names():
    with pytest.raises(ParameterError, match="joints of vertex 3 go by their names, not by 0"):
        Corrections(vertices={3: {0: 1.0}})


def test_weights_that_were_checked_are_shared_and_stay_as_written():
    written = {"head": 0.1, "neck": 0.2, "tail": 0.7}
    first = Corrections(vertices={1: written})
    written["head"] = 9.0
    again = replace(first, vertices={**first.vertices, 2: {"head": 2.0, "tail": 2.0}})
    assert again.vertices[1] is first.vertices[1]
    assert again.vertices == {
        1: {"head": 0.1, "neck": 0.2, "tail": 0.7},
        2: {"head": 0.5, "tail": 0.5},
    }


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(FileError, match=r"absent\.json cannot be read"):
        Corrections.load(tmp_path / "absent.json")
    (tmp_path / "bad.json").write_text('{"joints": 1}')
    with pytest.raises(ParameterError, match=r"bad\.json: joints must be"):
        Corrections.load(tmp_path / "bad.json")


@pytest.mark.parametrize(
    ("corrections", "error", "sentence"),
    [
        ({"joints": {"haed": JointCorrection()}}, ParameterError, 'no joint "haed".*"head"'),
        ({"parts": {0: PartCorrection("glued", "hed")}}, ParameterError, 'no joint "hed"'),
        ({"vertices": {0: {"hed": 1}}}, ParameterError, 'no joint "hed"'),
        ({"vertices": {10**6: {"head": 1}}}, ParameterError, "name the vertex 1000000"),
        (
            {"joints": {name: JointCorrection(deform=False) for name in WORM.skeleton.names}},
            SkeletonError,
            "no joint of the skeleton may carry weight",
        ),
        ({"parts": {0: PartCorrection("touching")}}, ParameterError, "none is left"),
        (
            {"joints": {"head": JointCorrection(position=(1e6, 0, 0))}},
            SkeletonError,
            'joint "head" at .* times the mesh.s size away',
        ),
    ],
)
def test_what_the_rig_does_not_have_is_refused(corrections, error, sentence):
    with pytest.raises(error, match=sentence):
        bound(WORM, **corrections)
    with pytest.raises(WeightsError, match="no weights of its own"):
        bound(replace(WORM, weights=None), joints={"head": JointCorrection(locked=True)})


def test_nothing_corrected_changes_nothing():
    plain = cutcell.bind(WORM, 24).weights
    assert np.array_equal(bound(WORM), plain)
    assert np.array_equal(bound(WORM, joints={"head": JointCorrection()}), plain)


def test_joints_lose_weight_keep_the_files_and_reach_farther():
    plain = cutcell.bind(WORM, 24).weights
    off = bound(WORM, joints={"head": JointCorrection(deform=False)})
    assert off[:, HEAD].max() == 0
    locked = bound(WORM, joints={"head": JointCorrection(locked=True)})
    np.testing.assert_allclose(locked[:, HEAD], WORM.weights[:, HEAD], atol=1e-12)
    for method in ("animation", "paper"):
        held = [
            cutcell.bind(
                WORM, 24, method=method, corrections=Corrections({"chest": JointCorrection(gain=g)})
            )
            .weights[:, CHEST]
            .sum()
            for g in (0.5, 1.0, 2.0)
        ]
        assert held[0] < held[1] < held[2]
    small = bound(WORM, joints={"chest": JointCorrection(radius=0.05)})
    assert small[:, CHEST].sum() < plain[:, CHEST].sum()


@pytest.mark.parametrize("how", [PartCorrection("glued", "tail"), PartCorrection("touching")])
def test_a_lock_overrules_a_part_and_a_warning_names_both(how):
    rig, first = with_button()
    artist = np.zeros((len(rig.mesh.vertices), len(rig.skeleton.names)))
    artist[:, CHEST] = 1
    artist[first:, [HEAD, CHEST]] = 0.5
    rig = rig.with_weights(artist)
    corrections = Corrections(joints={"head": JointCorrection(locked=True)}, parts={first: how})
    binding = cutcell.bind(rig, 24, corrections=corrections)
    np.testing.assert_array_equal(binding.weights[:, HEAD], artist[:, HEAD])
    (warning,) = [text for text in binding.warnings if f"vertex {first}" in text]
    assert "head" in warning
    assert how.joint is None or how.joint in warning
    for harmless in (
        replace(corrections, parts={}),
        replace(corrections, joints={"neck": JointCorrection(locked=True)}),
        replace(corrections, joints={}),
    ):
        found = cutcell.bind(rig, 24, corrections=harmless).warnings
        assert not any(f"vertex {first}" in text for text in found)


def test_locked_joints_keep_the_files_weights_at_vertices_set_by_hand():
    locked = {"head": JointCorrection(locked=True)}
    own = {name: w for name, w in zip(WORM.skeleton.names, WORM.weights[0], strict=True) if w}
    for weights, changes in (({"head": 1.0}, True), (own, False)):
        corrections = Corrections(joints=locked, vertices={0: weights})
        binding = cutcell.bind(WORM, 24, corrections=corrections)
        assert any("head" in text for text in binding.warnings) == changes
        np.testing.assert_array_equal(binding.weights[:, HEAD], WORM.weights[:, HEAD])
        np.testing.assert_allclose(binding.weights.sum(axis=1), 1)


def test_parts_are_glued_follow_or_are_bound_by_themselves():
    rig, first = with_button()
    plain = cutcell.bind(rig, 24).weights[first:]
    assert np.ptp(plain, axis=0).max() < 1e-9, "rigid by itself"
    glued = bound(rig, parts={first + 2: PartCorrection("glued", "tail")})
    assert (glued[first:, WORM.skeleton.names.index("tail")] == 1).all()
    np.testing.assert_allclose(glued[:first], cutcell.bind(rig, 24).weights[:first], atol=1e-12)
    touching = bound(rig, parts={first: PartCorrection("touching")})
    np.testing.assert_allclose(touching[first:], plain, atol=0.05)
    itself = bound(rig, parts={first: PartCorrection("itself")})
    np.testing.assert_allclose(itself.sum(axis=1), 1)
    assert not np.allclose(itself[first:], plain)


def test_a_part_as_in_the_file_has_exactly_the_files_weights():
    rig, first = with_button()
    joints = len(rig.skeleton.names)
    rig = rig.with_weights(np.full((len(rig.mesh.vertices), joints), 1 / joints))
    corrections = Corrections(
        joints={"head": JointCorrection(locked=True)}, parts={first: PartCorrection("file")}
    )
    assert Corrections.from_json(corrections.to_json()) == corrections
    weights = cutcell.bind(rig, 24, smoothing=1, corrections=corrections).weights
    np.testing.assert_array_equal(weights[first:], rig.weights[first:])
    assert not np.allclose(weights[:first], rig.weights[:first])
    with pytest.raises(WeightsError):
        bound(rig.with_weights(None), parts={first: PartCorrection("file")})


def test_a_vertex_is_overruled_after_all_else():
    weights = cutcell.bind(
        WORM, 24, smoothing=2, corrections=Corrections(vertices={7: {"head": 3, "tail": 1}})
    ).weights
    assert weights[7, HEAD] == 0.75
    assert weights[7].sum() == 1


def test_the_soldier_is_mended_by_one_correction():
    rig = soldier()
    mended = bound(rig, joints={"Root": JointCorrection(deform=False)})
    assert mended[:, -1].max() == 0


@pytest.mark.parametrize("method", ["animation", "paper"])
def test_a_moved_joint_is_bound_as_in_a_rig_that_has_it_there(method):
    place = WORM.skeleton.joints[HEAD] + [0.03, 0.02, 0]
    corrections = Corrections({"head": JointCorrection(position=place)})
    joints = WORM.skeleton.joints.copy()
    joints[HEAD] = place
    changed = replace(WORM, skeleton=replace(WORM.skeleton, joints=joints))
    wanted = cutcell.bind(changed, 24, method=method)
    graph = cutcell.bind(WORM, 24, method=method).graph
    found = cutcell.bind(WORM, 24, method=method, corrections=corrections, graph=graph)
    np.testing.assert_allclose(found.weights, wanted.weights, rtol=0, atol=1e-9)
    assert not np.allclose(found.weights, cutcell.bind(WORM, 24, method=method).weights)
    assert np.array_equal(cutcell.corrected_rig(WORM, corrections).skeleton.joints, joints)
    # One that has it there already stays as it is.
    assert cutcell.corrected_rig(changed, corrections) is changed
