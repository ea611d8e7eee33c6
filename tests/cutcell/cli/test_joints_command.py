"""`cutcell joints`, and the options that choose which joints carry weight."""

import json

import numpy as np

import cutcell
from tests.cutcell.cli.files import refused, write_obj


def test_lists_joints_with_reasons(run, demo_paths):
    path = next(path for path in demo_paths if path.stem == "biped")
    words = run("joints", path).stdout
    assert "52 of 52 joints deform" in words
    assert "in or near the body" in words
    rows = json.loads(run("joints", path, "--json").stdout)["joints"]
    rig = cutcell.load(path)
    assert [row["name"] for row in rows] == list(rig.skeleton.names)
    assert [row["deform"] for row in rows] == rig.skeleton.deform.tolist()
    assert [row["parent"] for row in rows] == rig.skeleton.parents.tolist()


def test_says_what_was_chosen(run, demo_paths):
    path = next(path for path in demo_paths if path.stem == "biped")
    chosen = run("joints", path, "--no-deform", "hand.*", "--json").stdout
    hands = [row for row in json.loads(chosen)["joints"] if row["name"].startswith("hand.")]
    assert len(hands) == 2
    assert all(row == {**row, "deform": False, "reason": "chosen"} for row in hands)


def test_doubtful_joints_are_named_and_may_be_left_out(run, tmp_path):
    joints = [
        {"name": name, "position": [x, 0.1, 0.1], "parent": parent}
        for name, x, parent in (("hip", 0.1, None), ("knee", 0.5, "hip"), ("prop", 0.8, "knee"))
    ]
    path = write_obj(tmp_path / "leg.obj", joints=joints)
    assert "that may be controls or end markers get weight: prop" in run("joints", path).stderr
    rows = json.loads(run("joints", path, "--json").stdout)["joints"]
    assert [row["doubtful"] for row in rows] == [False, False, True]
    assert rows[2]["deform"]
    assert "doubtful · control or bone, by its name" in run("joints", path).stdout
    rows = json.loads(run("joints", path, "--no-deform", "prop", "--json").stdout)["joints"]
    assert [row["doubtful"] for row in rows] == [False] * 3
    bound = tmp_path / "bound.glb"
    assert "prop; exclude" in run("bind", path, bound, "--fresh", "-r", "8").stderr
    again = run("bind", bound, tmp_path / "again.glb", "--fresh", "-r", "8")
    assert "prop; exclude" in again.stderr, "its weights are forgotten, too"
    chosen = run("bind", bound, tmp_path / "again.glb", "--fresh", "--deform", "prop", "-r", "8")
    assert "prop; exclude" not in chosen.stderr, "a person chose it"


def test_bind_takes_the_choice(run, demo_paths, tmp_path):
    path = next(path for path in demo_paths if path.stem == "biped")
    out = tmp_path / "bound.glb"
    run("bind", path, out, "-r", 16, "--fresh", "--no-deform", "hand.L", "--quiet")
    bound = cutcell.load(out)
    assert not bound.weights[:, bound.skeleton.names.index("hand.L")].any()
    np.testing.assert_allclose(bound.weights.sum(axis=1), 1, atol=1e-6)
    document = json.loads(run("graph", path, "-r", 8, "--no-deform", "hand.?", "--json").stdout)
    joints = document["skeleton"]
    assert joints["deform"] == cutcell.load(path).skeleton.deform.sum() - 2


def test_a_wrong_name_is_told(run, demo_paths, tmp_path):
    path = next(path for path in demo_paths if path.stem == "biped")
    reports = refused(run("bind", path, tmp_path / "out.glb", "--no-deform", "hnad.L"))
    assert 'biped.glb: no joint is called "hnad.L"; did you mean hand.L' in reports
