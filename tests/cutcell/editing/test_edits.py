"""Edits: as data, in JSON, and in files together with the weights that they begin from."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
    SavedPose,
    Smoothed,
)
from cutcell.errors import FileError

RNG = np.random.default_rng(5)
MANY = np.sort(RNG.choice(10_000, 400, replace=False))
ROWS = RNG.random((400, 3))
LAYERS = (
    Layer(Computed(gain={"head": 1.5}, radius={"head": 0.25})),
    Layer(Computed({"method": "paper", "resolution": 32}, as_skin=True), Mask(part=4)),
    Layer(FromFile(), Mask(vertices=MANY, strengths=RNG.random(400) + 1e-3 - 1e-3)),
    Layer(Filled({"head": 3.0, "tail": 1.0}), Mask(vertices=[1, 5]), name="cap", opacity=0.25),
    Layer(Attached(), Mask(part=3), on=False),
    Layer(Painted(MANY, ["head", "neck", "tail"], ROWS)),
    Layer(Painted([2, 9], ["head", "tail"], [[0.25, 0.75], [1, 0]])),
    Layer(Smoothed(3, through=True)),
    Layer(Mirrored("left"), mode="scale"),
    Layer(Remapped({"head": "neck", "neck": "head"})),
    Layer(Locked(["neck"])),
)
ALL = Edits(
    joints={"head": JointEdit(deform=False, position=(0.5, 0.25, 0))},
    removed=["tip"],
    base="file",
    method={"falloff": "paper", "alpha": 0.3},
    layers=LAYERS,
    selections={"left hand": Mask(vertices=MANY), "cap": Mask(part=3)},
    poses={
        "nod": SavedPose({"head": (30, 0, -2.5)}),
        "step": SavedPose(clip="walk", seconds=0.4),
        "rest": SavedPose(),
    },
)


def test_json_and_back_is_the_same(tmp_path):
    for indent in (2, None):
        again = Edits.from_json(ALL.to_json(indent=indent))
        assert again == ALL
        assert again.to_json() == ALL.to_json()
    assert "\n" not in ALL.to_json(indent=None)
    ALL.save(tmp_path / "c.json")
    assert Edits.load(tmp_path / "c.json") == ALL
    assert not Edits.from_json(Edits().to_json())
    assert Edits(base="file")
    assert Edits(selections={"all": Mask()})
    assert Edits(poses={"rest": SavedPose()})
    assert Edits(selections={"one": Mask(part=1)}) != Edits(selections={"one": Mask(part=2)})
    assert LAYERS[3].content.weights == {"head": 0.75, "tail": 0.25}


def test_each_part_of_a_layer_counts_for_equality():
    for layer in LAYERS:
        others = (
            replace(layer, opacity=0.5),
            replace(layer, name="other"),
            replace(layer, on=not layer.on),
            replace(layer, mode="add"),
            replace(layer, mask=Mask(vertices=[0])),
        )
        assert all(other != layer for other in others)
    painted, mask = LAYERS[5].content, LAYERS[2].mask
    assert painted == Painted(MANY, ["head", "neck", "tail"], ROWS.copy())
    assert painted != Painted(MANY, ["head", "neck", "tail"], ROWS[::-1])
    assert painted != Painted(MANY + 1, ["head", "neck", "tail"], ROWS)
    assert mask != Mask(vertices=MANY)
    assert Mask(vertices=MANY, strengths=np.ones(400)) == Mask(vertices=MANY)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[", "edits are no JSON"),
        ("[]", "edits must be a mapping"),
        ('{"joint": {}}', 'edits has no .joint.; did you mean "joints"'),
        ('{"joints": {"Head": {"defrom": true}}}', '"Head" has no .defrom.; did you mean "deform"'),
        ('{"joints": {"Head": {"deform": 1}}}', 'the joint "Head": deform must be'),
        ('{"joints": {"Head": {"position": [1, 2]}}}', 'the joint "Head": position must be three'),
        ('{"joints": {"Head": {"position": "abc"}}}', "position must be three numbers"),
        ('{"joints": {"Head": {"position": [0, NaN, 0]}}}', "y of position must be a number"),
        ('{"joints": {"Head": {"position": [0, 0, 1e99]}}}', "z of position must be a number"),
        ('{"base": "mine"}', "base must be"),
        ('{"method": {"resolution": 1}}', "resolution must be"),
        ('{"method": {"resolutoin": 32}}', 'method has no .resolutoin.; did you mean "resolution"'),
        ('{"selections": {"": {}}}', "selections go by names"),
        ('{"selections": {"a": {"vertexes": 1}}}', 'the selection "a" has no .vertexes.'),
        ('{"selections": {"a": {"vertices": [2, 1]}}}', 'the selection "a": .* must ascend'),
        ('{"poses": {"": {}}}', "poses go by names"),
        ('{"poses": {"a": {"turn": {}}}}', 'the pose "a" has no .turn.; did you mean "turns"'),
        ('{"poses": {"a": {"turns": {"b": [1, 2]}}}}', 'the pose "a": "b" must be three numbers'),
        ('{"poses": {"a": {"turns": {"b": [1, 2, NaN]}}}}', 'z of "b" must be a number'),
        ('{"poses": {"a": {"clip": 1}}}', "clip must be the name of a clip"),
        ('{"poses": {"a": {"clip": "b", "seconds": -1}}}', "seconds must be a number"),
        (
            '{"poses": {"a": {"clip": "b", "turns": {"c": [1, 2, 3]}}}}',
            'the pose "a": a pose has turns or a clip, not both',
        ),
        ('{"layers": {}}', "layers must be a list"),
        ('{"layers": [{"kind": "glued"}]}', 'layer 1 must have a "kind": one of computed'),
        ('{"layers": [{"kind": "filled"}]}', "layer 1 needs weights"),
        ('{"layers": [{"kind": "filled", "weights": {"a": 0}}]}', "layer 1: weights must name"),
        ('{"layers": [{"kind": "filled", "weights": {"a": -1}}]}', 'weight of "a" must be'),
        ('{"layers": [{"kind": "remapped", "joints": {"a": "a"}}]}', "layer 1: joints must name"),
        ('{"layers": [{"kind": "remapped", "joints": {"a": 1}}]}', "must hold names of joints"),
        ('{"layers": [{"kind": "file", "weights": 1}]}', "layer 1 has no .weights."),
        ('{"layers": [{"kind": "file", "opacity": 2}]}', "layer 1: opacity must be"),
        ('{"layers": [{"kind": "file", "mode": "burn"}]}', "layer 1: mode must be"),
        ('{"layers": [{"kind": "file", "on": 1}]}', "layer 1: on must be"),
        ('{"layers": [{"kind": "file", "mask": {"part": -1}}]}', "the vertex of a part must be"),
        ('{"layers": [{"kind": "file", "mask": {"vertices": [2, 1]}}]}', "must ascend"),
        ('{"layers": [{"kind": "file", "mask": {"vertices": [0.5]}}]}', "must be whole numbers"),
        ('{"layers": [{"kind": "file", "mask": {"vertices": "%"}}]}', "or base64 of them"),
        ('{"layers": [{"kind": "file", "mask": {"strengths": [1]}}]}', "a mask has a part, or"),
        (
            '{"layers": [{"kind": "file", "mask": {"vertices": [1], "strengths": [0]}}]}',
            "strengths must be 1 numbers",
        ),
        ('{"layers": [{"kind": "computed", "gain": {"a": 0}}]}', "gain must be"),
        ('{"layers": [{"kind": "computed", "radius": {"a": 0}}]}', "radius must be more than 0"),
        ('{"layers": [{"kind": "computed", "options": {"alpha": 9}}]}', "alpha must be"),
        ('{"layers": [{"kind": "smoothed", "steps": 0}]}', "steps must be a whole number"),
        ('{"layers": [{"kind": "mirrored", "side": "top"}]}', "side must be"),
        ('{"layers": [{"kind": "locked", "joints": "a"}]}', "joints must be a list of names"),
        (
            '{"layers": [{"kind": "painted", "vertices": [7], "joints": ["a"], "rows": [[0]]}]}',
            "vertex 7 needs a weight above 0",
        ),
        (
            '{"layers": [{"kind": "painted", "vertices": [7], "joints": ["a"], "rows": [[-1]]}]}',
            "weights of vertex 7 must be",
        ),
        (
            '{"layers": [{"kind": "painted", "vertices": [7], "joints": ["a"], "rows": [[1, 2]]}]}',
            "rows must be",
        ),
        (
            '{"layers": [{"kind": "painted", "vertices": [7], "joints": ["a"], "rows":'
            ' {"data": [1], "indices": [3], "indptr": [0, 1]}}]}',
            "rows are no sparse matrix",
        ),
    ],
)
def test_what_is_wrong_is_named(text, sentence):
    with pytest.raises(ParameterError, match=sentence):
        Edits.from_json(text)


def test_painted_rows_are_merged_renamed_and_taken_out():
    below = Painted([1, 4, 6], ["a", "b"], [[1, 0], [0.5, 0.5], [0, 1]])
    both = below.merged(Painted([0, 4], ["c", "b"], [[1, 0], [0.25, 0.75]]))
    assert both.vertices.tolist() == [0, 1, 4, 6]
    assert both.joints == ("a", "b", "c")
    expected = [[0, 0, 1], [1, 0, 0], [0, 0.75, 0.25], [0, 1, 0]]
    np.testing.assert_array_equal(both.rows.toarray(), expected)
    assert both.without([0, 4]).vertices.tolist() == [1, 6]
    assert both.without([0, 1, 4, 6]) is None
    assert both.without([9]) is both
    heirs = {"a": "b", "b": "b", "c": None}
    left = both.renamed(heirs.get)
    assert (left.joints, left.vertices.tolist()) == (("b",), [1, 4, 6])
    with pytest.raises(ValueError, match="read-only"):
        both.rows.data[0] = 3.0


def test_layers_follow_their_joints():
    edits = ALL.renamed({"head": "skull", "tail": None, "neck": "neck"}.get)
    names = {name for layer in edits.layers for name in layer.content.joints_named()}
    assert names == {"skull", "neck"}
    assert edits.layers[0].content.gain == {"skull": 1.5}
    assert len(edits.layers) == len(LAYERS)
    gone = ALL.renamed(lambda name: None)
    assert [layer.content.kind for layer in gone.layers] == [
        "computed", "computed", "file", "attached", "smoothed", "mirrored",
    ]  # fmt: skip


@given(st.lists(st.sampled_from(LAYERS), max_size=6), st.sampled_from(["file", "computed"]))
@settings(max_examples=40, deadline=None)
def test_any_stack_survives_json(layers, base):
    edits = Edits(base=base, layers=layers)
    assert Edits.from_json(edits.to_json(indent=None)) == edits


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(FileError, match=r"absent\.json cannot be read"):
        Edits.load(tmp_path / "absent.json")
    (tmp_path / "bad.json").write_text('{"joints": 1}')
    with pytest.raises(ParameterError, match=r"bad\.json: joints must be"):
        Edits.load(tmp_path / "bad.json")


def test_poses_follow_joints_that_are_renamed_or_removed():
    renamed = ALL.renamed(lambda name: {"head": "skull"}.get(name, name))
    assert renamed.poses == {**ALL.poses, "nod": SavedPose({"skull": (30, 0, -2.5)})}
    assert ALL.renamed(lambda name: None).poses["nod"] == SavedPose()
