"""`cutcell bind`: the options reach the library, what it computes reaches the file."""

import json

import numpy as np
import pytest

import cutcell
from cutcell.io import SAVED
from cutcell.skinning.weights import DEFAULT_LEAF
from tests.cutcell.cli.files import BAR, JOINTS, bar_faces, refused, write_obj


def test_saves_what_the_library_computes(run, bar, tmp_path):
    out = tmp_path / "bound.glb"
    result = run("bind", bar, out, "-r", 16)
    assert result.exit_code == 0
    assert "12 vertices" in result.stdout
    expected = cutcell.bind(cutcell.load(bar), resolution=16).weights
    found = cutcell.load(out)
    assert found.skeleton.names == ("root", "tip")
    np.testing.assert_allclose(found.weights, expected, atol=1e-6)


def test_options_reach_the_library(run, bar, tmp_path):
    options = {
        "resolution": 12,
        "connectivity": 26,
        "winding_threshold": 0.25,
        "samples": 2,
        "leaf": "extend",
        "falloff": "paper",
        "alpha": 0.75,
        "max_influences": 1,
        "threshold": 0.125,
        "smoothing": 3,
    }
    words = [w for k, v in options.items() for w in (f"--{k.replace('_', '-')}", v)]
    result = run("bind", bar, tmp_path / "bound.glb", *words, "--no-orient", "--json")
    document = json.loads(result.stdout)
    assert document["parameters"] == {
        **options,
        "orient": False,
        "symmetric": False,
        "locked": [],
    }
    assert document["influences"] == {"mean": 1.0, "most": 1}
    assert set(document["seconds"]) == {"graph", "distances", "weights"}


def test_defaults_are_those_of_the_library(run, bar, tmp_path):
    document = json.loads(run("bind", bar, tmp_path / "bound.glb", "--json").stdout)
    defaults = {**cutcell.bind.__kwdefaults__, "resolution": cutcell.bind.__defaults__[0]}
    del defaults["progress"]
    defaults["leaf"] = DEFAULT_LEAF[defaults["falloff"]]
    assert document["parameters"] == {**defaults, "locked": list(defaults["locked"])}


def test_touching_up_reaches_the_library(run, bar, tmp_path):
    result = run("bind", bar, tmp_path / "bound.glb", "--symmetric")
    assert "is not mirrored across x, y or z" in refused(result)
    result = run("bind", bar, tmp_path / "bound.glb", "--lock", "tip", "--lock", "toe")
    assert 'there is no joint "toe"' in refused(result)


def test_quiet_says_nothing(run, bar, tmp_path):
    result = run("bind", bar, tmp_path / "bound.glb", "-r", 8, "--quiet")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")


def test_takes_a_skeleton_from_elsewhere(run, tmp_path):
    mesh = write_obj(tmp_path / "bar.obj")
    skeleton = tmp_path / "bones.json"
    skeleton.write_text(json.dumps({"joints": JOINTS}))
    assert run("bind", mesh, tmp_path / "o.glb", "--skeleton", skeleton).exit_code == 0


def test_warns_of_vertices_that_no_path_reaches(run, tmp_path):
    vertices = [*BAR, [5, 5, 5], [6, 5, 5], [5, 6, 5]]
    path = write_obj(tmp_path / "two.obj", vertices, [*bar_faces(), [12, 13, 14]], JOINTS)
    result = run("bind", path, tmp_path / "o.glb", "--json")
    document = json.loads(result.stdout)
    assert document["fallback"]["vertices"] == 3
    assert document["fallback"]["share"] == pytest.approx(0.2)
    assert sum(document["fallback"]["reasons"].values()) == 3
    assert len(document["warnings"]) == 1
    assert result.stderr.startswith("warning: 3 of 15 vertices")
    assert "20.0% of the vertices" in run("bind", path, tmp_path / "o.glb").stdout


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("o.fbx", "FBX can be read, not written; save it as o.glb"),
        ("no/where/o.glb", "there is no folder"),
    ],
)
def test_a_wrong_output_is_told_before_the_work(run, bar, tmp_path, name, sentence):
    assert sentence in refused(run("bind", bar, tmp_path / name, "-r", 10_000))


@pytest.mark.parametrize("ending", SAVED)
def test_every_ending_it_lets_through_can_be_saved(run, bar, tmp_path, ending):
    result = run("bind", bar, tmp_path / f"out{ending}", "-r", 8)
    if ending == ".gltf":  # only what came from glTF
        assert "saved as .glb" in refused(result)
    else:
        assert result.exit_code == 0
        assert cutcell.load(tmp_path / f"out{ending}").weights is not None


def test_a_mesh_without_a_skeleton_is_refused_by_name(run, tmp_path):
    path = write_obj(tmp_path / "alone.obj")
    told = refused(run("bind", path, tmp_path / "out.glb"))
    assert told.startswith("error: alone.obj: the rig has no skeleton; export the mesh")
    assert not (tmp_path / "out.glb").exists()


def test_the_mesh_that_was_read_is_left_as_it_is(run, bar, tmp_path):
    textured = bar.read_text() + "vt 0 0\n"
    bar.write_text(textured)
    result = run("bind", bar, tmp_path / "bar.txt", "-r", 8, "--json")
    assert json.loads(result.stdout)["files"] == [str(tmp_path / "bar.txt")]
    assert bar.read_text() == textured


def test_a_file_that_would_be_replaced_is_told_before_the_work(run, bar, tmp_path):
    (tmp_path / "out.obj").write_text("another mesh")
    sentence = refused(run("bind", bar, tmp_path / "out.txt", "-r", 10_000))
    assert "out.txt: its mesh belongs in out.obj" in sentence
    assert (tmp_path / "out.obj").read_text() == "another mesh"


def test_all_files_that_are_written_are_told(run, bar, tmp_path):
    run("bind", bar, tmp_path / "one.glb", "-r", 8)
    (tmp_path / "two.bin").write_text("of something else")
    result = run("bind", tmp_path / "one.glb", tmp_path / "two.gltf", "-r", 8)
    assert "files         two-2.bin, two.gltf" in result.stdout
    assert (tmp_path / "two.bin").read_text() == "of something else"
