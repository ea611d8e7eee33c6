"""Layers: what `bind` makes of them, and what holds of any stack."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import cutcell
from cutcell import (
    Attached,
    Computed,
    Edits,
    Filled,
    FromFile,
    JointEdit,
    Layer,
    Locked,
    Mask,
    Mirrored,
    Painted,
    ParameterError,
    Remapped,
    Smoothed,
    TriangleMesh,
)
from cutcell.editing.layers import apply_layers, blended
from cutcell.editing.layers.sources import RigSources
from cutcell.errors import SkeletonError, WeightsError
from tests.cutcell.diagnosis.test_leaks import soldier
from tests.cutcell.diagnosis.worm import worm

WORM = worm()
COUNT, JOINTS = WORM.weights.shape
HEAD, CHEST, TAIL = (WORM.skeleton.names.index(name) for name in ("head", "chest", "tail"))
NAMES = WORM.skeleton.names


def with_button(**more):
    button = trimesh.creation.icosphere(subdivisions=1, radius=0.03)
    vertices = np.concatenate([WORM.mesh.vertices, np.array([0.55, 0.12, 0]) + button.vertices])
    faces = np.concatenate([WORM.mesh.faces, button.faces + len(WORM.mesh.vertices)])
    return cutcell.Rig(TriangleMesh(vertices, faces), WORM.skeleton), len(WORM.mesh.vertices)


def bound(rig, *layers, **edits):
    return cutcell.bind(rig, 24, edits=Edits(layers=layers, **edits)).weights


@pytest.fixture(scope="module")
def plain():
    return cutcell.bind(WORM, 24).weights


@pytest.mark.parametrize(
    ("edits", "error", "sentence"),
    [
        ({"joints": {"haed": JointEdit()}}, ParameterError, 'no joint "haed".*"head"'),
        (
            {"layers": [Layer(Filled({"hed": 1}), Mask(part=0))]},
            ParameterError,
            'layer 1, "Filled", does not fit worm.*no joint "hed"',
        ),
        ({"layers": [Layer(Painted([0], ["hed"], [[1]]))]}, ParameterError, 'no joint "hed"'),
        (
            {"selections": {"a": Mask(vertices=[10**6])}},
            ParameterError,
            'the selection "a" names the vertex 1000000',
        ),
        ({"layers": [Layer(Remapped({"head": "hed"}))]}, ParameterError, 'no joint "hed"'),
        ({"layers": [Layer(Locked(["hed"]))]}, ParameterError, 'no joint "hed"'),
        ({"layers": [Layer(Computed(gain={"hed": 2}))]}, ParameterError, 'no joint "hed"'),
        (
            {"layers": [Layer(Painted([10**6], ["head"], [[1]]), name="mine")]},
            ParameterError,
            '"mine", names the vertex 1000000, but worm has only',
        ),
        (
            {"layers": [Layer(Smoothed(1), Mask(vertices=[10**6]))]},
            ParameterError,
            "names the vertex 1000000",
        ),
        ({"layers": [Layer(Attached())]}, ParameterError, "none is left"),
        (
            {"joints": {name: JointEdit(deform=False) for name in NAMES}},
            SkeletonError,
            "no joint of the skeleton may carry weight",
        ),
        (
            {"joints": {"head": JointEdit(position=(1e6, 0, 0))}},
            SkeletonError,
            'joint "head" at .* times the mesh.s size away',
        ),
    ],
)
def test_what_the_rig_does_not_have_is_refused(edits, error, sentence):
    with pytest.raises(error, match=sentence):
        cutcell.bind(WORM, 24, edits=Edits(**edits))


@pytest.mark.parametrize(
    "edits",
    [Edits(base="file"), *(Edits(layers=[Layer(one)]) for one in (FromFile(), Locked(["head"])))],
)
def test_what_begins_from_the_file_needs_its_weights(edits):
    with pytest.raises(WeightsError, match="has no weights"):
        cutcell.bind(replace(WORM, weights=None), 24, edits=edits)


def test_no_edits_change_nothing(plain):
    assert np.array_equal(bound(WORM), plain)
    assert np.array_equal(bound(WORM, joints={"head": JointEdit()}), plain)
    assert np.array_equal(bound(WORM, base="file"), WORM.weights)


def test_joints_lose_weight_keep_the_files_and_reach_farther(plain):
    off = bound(WORM, joints={"head": JointEdit(deform=False)})
    assert off[:, HEAD].max() == 0
    locked = bound(WORM, Layer(Locked(["head"])))
    np.testing.assert_allclose(locked[:, HEAD], WORM.weights[:, HEAD], atol=1e-12)
    for method in ("animation", "paper"):
        held = [
            cutcell.bind(
                WORM, 24, method=method, edits=Edits(layers=[Layer(Computed(gain={"chest": g}))])
            )
            .weights[:, CHEST]
            .sum()
            for g in (0.5, 1.0, 2.0)
        ]
        assert held[0] < held[1] < held[2]
    small = bound(WORM, Layer(Computed(radius={"chest": 0.05})))
    assert small[:, CHEST].sum() < plain[:, CHEST].sum()


def test_the_reach_of_joints_hides_what_lies_below_it():
    reach = Layer(Computed(gain={"chest": 2.0}))
    whole = bound(WORM, reach)
    np.testing.assert_array_equal(bound(WORM, reach, base="file"), whole)
    above = bound(WORM, Layer(FromFile()), reach)
    np.testing.assert_array_equal(above, whole)


def test_a_region_is_computed_with_other_options(plain):
    some = np.arange(10, 60)
    paper = cutcell.bind(WORM, 24, falloff="paper", leaf="fit").weights
    mask = Mask(vertices=some)
    mixed = bound(WORM, Layer(Computed({"falloff": "paper", "leaf": "fit"}), mask))
    np.testing.assert_array_equal(mixed[some], paper[some])
    rest = np.delete(np.arange(COUNT), some)
    np.testing.assert_array_equal(mixed[rest], plain[rest])
    finer = bound(WORM, Layer(Computed({"resolution": 32}), mask), base="file")
    np.testing.assert_array_equal(finer[some], cutcell.bind(WORM, 32).weights[some])
    np.testing.assert_array_equal(finer[rest], WORM.weights[rest])


@pytest.mark.parametrize("content", [Filled({"tail": 1}), Attached()])
def test_a_lock_above_a_part_overrules_it_and_a_warning_names_both(content):
    rig, first = with_button()
    artist = np.zeros((len(rig.mesh.vertices), JOINTS))
    artist[:, CHEST] = 1
    artist[first:, [HEAD, CHEST]] = 0.5
    rig = rig.with_weights(artist)
    part, lock = Layer(content, Mask(part=first)), Layer(Locked(["head"]))
    binding = cutcell.bind(rig, 24, edits=Edits(layers=[part, lock]))
    np.testing.assert_array_equal(binding.weights[:, HEAD], artist[:, HEAD])
    (warning,) = [text for text in binding.warnings if f"vertex {first}" in text]
    assert "head" in warning
    assert all(name in warning for name in content.joints_named())
    for harmless in ([lock, part], [part, Layer(Locked(["neck"]))], [part]):
        found = cutcell.bind(rig, 24, edits=Edits(layers=harmless)).warnings
        assert not any(f"vertex {first}" in text for text in found)


def test_locked_joints_keep_the_files_weights_at_painted_vertices():
    own = WORM.weights[:1]
    for row, changes in ((np.eye(JOINTS)[[HEAD]], True), (own, False)):
        layers = [Layer(Painted([0], NAMES, row)), Layer(Locked(["head"]))]
        binding = cutcell.bind(WORM, 24, edits=Edits(layers=layers))
        assert any("head" in text for text in binding.warnings) == changes
        np.testing.assert_array_equal(binding.weights[:, HEAD], WORM.weights[:, HEAD])
        np.testing.assert_allclose(binding.weights.sum(axis=1), 1)


def test_parts_are_rigid_follow_or_are_bound_as_skin():
    rig, first = with_button()
    mask, whole = Mask(part=first + 2), cutcell.bind(rig, 24).weights
    assert np.ptp(whole[first:], axis=0).max() < 1e-9, "rigid by itself"
    rigid = bound(rig, Layer(Filled({"tail": 1}), mask))
    assert (rigid[first:, TAIL] == 1).all()
    np.testing.assert_array_equal(rigid[:first], whole[:first])
    touching = bound(rig, Layer(Attached(), mask))
    np.testing.assert_allclose(touching[first:], whole[first:], atol=0.05)
    skin = bound(rig, Layer(Computed(as_skin=True), mask))
    np.testing.assert_allclose(skin.sum(axis=1), 1)
    assert not np.allclose(skin[first:], whole[first:])
    np.testing.assert_array_equal(skin[:first], whole[:first])


def test_a_part_from_the_file_has_exactly_its_weights():
    rig, first = with_button()
    rig = rig.with_weights(np.full((len(rig.mesh.vertices), JOINTS), 1 / JOINTS))
    layer = Layer(FromFile(), Mask(part=first))
    weights = cutcell.bind(rig, 24, smoothing=1, edits=Edits(layers=[layer])).weights
    np.testing.assert_array_equal(weights[first:], rig.weights[first:])
    assert not np.allclose(weights[:first], rig.weights[:first])


def test_vertices_without_weights_in_the_file_are_computed(plain):
    weights = WORM.weights.copy()
    weights[:5] = 0
    rig = WORM.with_weights(weights)
    found = bound(rig, base="file")
    np.testing.assert_array_equal(found[5:], WORM.weights[5:])
    np.testing.assert_array_equal(found[:5], plain[:5])


def test_layers_lie_above_smoothing():
    painted = Layer(Painted([7], ["head", "tail"], [[3, 1]]))
    weights = cutcell.bind(WORM, 24, smoothing=2, edits=Edits(layers=[painted])).weights
    assert weights[7, HEAD] == 0.75
    assert weights[7].sum() == 1


def test_the_soldier_is_mended_by_one_edit():
    rig = soldier()
    mended = bound(rig, joints={"Root": JointEdit(deform=False)})
    assert mended[:, -1].max() == 0


@pytest.mark.parametrize("method", ["animation", "paper"])
def test_a_moved_joint_is_bound_as_in_a_rig_that_has_it_there(method):
    place = WORM.skeleton.joints[HEAD] + [0.03, 0.02, 0]
    edits = Edits({"head": JointEdit(position=place)})
    joints = WORM.skeleton.joints.copy()
    joints[HEAD] = place
    changed = replace(WORM, skeleton=replace(WORM.skeleton, joints=joints))
    wanted = cutcell.bind(changed, 24, method=method)
    graph = cutcell.bind(WORM, 24, method=method).graph
    found = cutcell.bind(WORM, 24, method=method, edits=edits, graph=graph)
    np.testing.assert_allclose(found.weights, wanted.weights, rtol=0, atol=1e-9)
    assert not np.allclose(found.weights, cutcell.bind(WORM, 24, method=method).weights)
    assert np.array_equal(cutcell.edited_rig(WORM, edits).skeleton.joints, joints)
    # One that has it there already stays as it is.
    assert cutcell.edited_rig(changed, edits) is changed


# What holds of any stack


RNG = np.random.default_rng(3)
OTHER = RNG.dirichlet(np.ones(JOINTS), COUNT)
RIG = WORM.with_weights(RNG.dirichlet(np.ones(JOINTS), COUNT))
GRAPH = cutcell.build_graph(RIG.mesh, 16)
SOURCES = RigSources(RIG, cutcell.ANIMATION, GRAPH, computed=lambda layer: OTHER)
START = cutcell.weights.skinning_weights(cutcell.bone_distances(GRAPH, RIG.skeleton))

vertices = st.lists(st.integers(0, COUNT - 1), max_size=20, unique=True).map(sorted)
contents = st.one_of(
    st.just(Computed()),
    st.just(FromFile()),
    st.sampled_from(NAMES).map(lambda name: Filled({name: 1, NAMES[0]: 0.5})),
    st.integers(1, 3).map(Smoothed),
    st.just(Locked(NAMES[:2])),
    st.just(Remapped({NAMES[0]: NAMES[1], NAMES[1]: NAMES[0], NAMES[2]: NAMES[3]})),
    vertices.filter(len).map(lambda which: Painted(which, NAMES, OTHER[which])),
)
opacities = st.one_of(st.sampled_from([0.0, 0.5, 1.0]), st.floats(0, 1))
layers = st.builds(
    Layer,
    contents,
    st.one_of(st.just(Mask()), vertices.map(lambda which: Mask(vertices=which))),
    opacity=opacities,
    on=st.booleans(),
    mode=st.sampled_from(["replace", "add", "scale"]),
)
stacks = st.lists(layers, max_size=5)
quick = settings(max_examples=60, deadline=None)


def stacked(stack, weights=START):
    return apply_layers(weights, stack, SOURCES)


@given(stacks)
@quick
def test_rows_sum_to_one_and_the_weights_below_stay(stack):
    before = START.copy()
    weights = stacked(stack)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-9)
    assert np.isfinite(weights).all()
    assert (weights >= 0).all()
    np.testing.assert_array_equal(before, START)


@given(stacks, layers)
@quick
def test_layers_without_strength_change_no_bit(stack, layer):
    expected = stacked(stack)
    silent = (replace(layer, opacity=0.0), replace(layer, on=False),
              replace(layer, mask=Mask(vertices=[])))  # fmt: skip
    for one in silent:
        for place in range(len(stack) + 1):
            found = stacked([*stack[:place], one, *stack[place:]])
            np.testing.assert_array_equal(found, expected)


@given(stacks, contents)
@quick
def test_opaque_layers_are_their_content_and_no_row_outside_a_mask_changes(stack, content):
    below = stacked(stack)
    whole = apply_layers(below, [Layer(content)], SOURCES)
    every = Layer(content, Mask(vertices=np.arange(COUNT)))
    np.testing.assert_array_equal(apply_layers(below, [every], SOURCES), whole)
    some = np.arange(0, COUNT, 3)
    part = stacked([*stack, Layer(content, Mask(vertices=some))])
    rest = np.delete(np.arange(COUNT), some)
    np.testing.assert_array_equal(part[rest], below[rest])
    if not isinstance(content, Smoothed):
        np.testing.assert_array_equal(part[some], whole[some])


@given(layers, layers)
@quick
def test_layers_with_disjoint_masks_commute(one, other):
    local = (Smoothed,)
    if isinstance(one.content, local) or isinstance(other.content, local):
        return  # they look at their surroundings
    one = replace(one, mask=Mask(vertices=np.arange(0, COUNT, 2)))
    other = replace(other, mask=Mask(vertices=np.arange(1, COUNT, 2)))
    np.testing.assert_array_equal(stacked([one, other]), stacked([other, one]))


@given(st.floats(0, 1), st.sampled_from([1, 2, 4, None]))
@quick
def test_blended_rows_have_few_influences_and_sum_to_one(share, most):
    order = np.arange(JOINTS)
    rows = blended(START[:9], OTHER[:9], np.full(9, share), most, order)
    if 0 < share < 1:
        np.testing.assert_allclose(rows.sum(axis=1), 1, atol=1e-12)
        assert most is None or ((rows > 0).sum(axis=1) <= most).all()
        if most is None:
            np.testing.assert_allclose(rows, (1 - share) * START[:9] + share * OTHER[:9])
    else:
        np.testing.assert_array_equal(rows, OTHER[:9] if share else START[:9])


def test_strengths_of_a_mask_are_shares():
    strengths = np.array([0.25, 1.0])
    layer = Layer(FromFile(), Mask(vertices=[3, 8], strengths=strengths), opacity=0.5)
    sources = RigSources(RIG, cutcell.ANIMATION.with_options(max_influences=None), GRAPH)
    found = apply_layers(START, [layer], sources)
    share = strengths[:, None] / 2
    expected = (1 - share) * START[[3, 8]] + share * RIG.weights[[3, 8]]
    np.testing.assert_allclose(found[[3, 8]], expected, atol=1e-12)


def test_a_side_that_is_taken_needs_a_mirrored_mesh():
    with pytest.raises(cutcell.MeshError, match="is not mirrored"):
        bound(WORM, Layer(Mirrored("left")))


@pytest.mark.parametrize("others", [[0, 1], [0]])
def test_a_mask_of_all_differs_from_one_of_some(others):
    some = Mask(vertices=others)
    assert some != Mask()
    assert Mask() != some
    assert Layer(Locked(["head"]), some) != Layer(Locked(["head"]))
    assert Layer(Locked(["head"])) != Layer(Locked(["head"]), some)


def test_two_joints_exchange_their_weights_and_others_keep_every_bit():
    swap = Layer(Remapped({"head": "tail", "tail": "head"}))
    once = bound(WORM, swap, base="file")
    order = np.arange(JOINTS)
    order[[HEAD, TAIL]] = TAIL, HEAD
    np.testing.assert_array_equal(once, WORM.weights[:, order])
    np.testing.assert_array_equal(bound(WORM, swap, swap, base="file"), WORM.weights)
    some = np.flatnonzero(WORM.weights[:, HEAD] > 0)[:5]
    there = bound(WORM, replace(swap, mask=Mask(vertices=some)), base="file")
    np.testing.assert_array_equal(there[some], once[some])
    rest = np.delete(np.arange(COUNT), some)
    np.testing.assert_array_equal(there[rest], WORM.weights[rest])


def test_a_replaced_joint_adds_its_weight_where_the_file_can_store_it():
    layer = Layer(Remapped({"neck": "head"}))
    neck = NAMES.index("neck")
    weights = bound(WORM, layer, base="file")
    assert weights[:, neck].max() == 0
    np.testing.assert_allclose(weights[:, HEAD], WORM.weights[:, [neck, HEAD]].sum(axis=1))
    allowed = np.ones((COUNT, JOINTS), bool)
    allowed[::2, HEAD] = WORM.weights[::2, HEAD] > 0
    partly = bound(replace(WORM, allowed=allowed), layer, base="file")
    assert (partly[~allowed] == 0).all()
    np.testing.assert_allclose(partly.sum(axis=1), 1)


def test_a_swap_follows_the_names_of_its_joints():
    content = Remapped({"head": "tail", "tail": "head"})
    assert content.renamed({"head": "skull"}.get) is None
    now = content.renamed(lambda name: "skull" if name == "head" else name)
    assert now == Remapped({"skull": "tail", "tail": "skull"})


def test_weights_are_added_and_scaled_and_no_row_is_left_empty():
    sources = RigSources(RIG, cutcell.ANIMATION.with_options(max_influences=None), GRAPH)
    head = np.eye(JOINTS)[HEAD]
    for opacity in (0.25, 1.0):
        layer = Layer(Filled({"head": 1}), opacity=opacity, mode="add")
        found = apply_layers(START, [layer], sources)
        np.testing.assert_allclose(found, (START + opacity * head) / (1 + opacity), atol=1e-12)
    scaled = apply_layers(START, [Layer(Filled({"head": 1}), mode="scale")], sources)
    follows = START[:, HEAD] > 0
    assert follows.any()
    assert not follows.all()
    np.testing.assert_allclose(scaled[follows], np.tile(head, (follows.sum(), 1)), atol=1e-12)
    np.testing.assert_array_equal(scaled[~follows], START[~follows])
