"""`cutcell bind`: the options reach the library, what it computes reaches the file."""

import json
from dataclasses import asdict

import numpy as np
import pytest

import cutcell
from cutcell.io.formats import suffixes
from cutcell.io.materials.transfer import read_materials
from tests.bars import bar as rigged_bar
from tests.bars import side_by_side
from tests.cutcell.cli.files import BAR, JOINTS, bar_faces, refused, write_obj
from tests.cutcell.io.gltf.gltf_builder import COLUMN, column


def test_saves_what_the_library_computes(run, bar, tmp_path):
    out = tmp_path / "bound.glb"
    result = run("bind", bar, out, "-r", 16)
    assert result.exit_code == 0
    assert "12 vertices" in result.stdout
    expected = cutcell.bind(cutcell.load(bar), resolution=16).weights
    results = cutcell.load(out)
    assert results.skeleton.names == ("root", "tip")
    np.testing.assert_allclose(results.weights, expected, atol=1e-6)


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
    touches = {"smoothing": 0, "symmetric": False, "locked": []}
    assert document["parameters"] == {**asdict(cutcell.ANIMATION), **touches}
    assert document["warnings"] == []
    every = ("--max-influences", "all", "--method", "paper")
    document = json.loads(run("bind", bar, tmp_path / "bound.glb", *every, "--json").stdout)
    assert document["parameters"] == {**asdict(cutcell.PAPER), **touches}


def chain(tmp_path, joints=6):
    """Write a bar with a joint near every vertex."""
    places = [[k / (joints - 1), 0.1, 0.1] for k in range(joints)]
    parents = [None, *(f"j{k}" for k in range(joints - 1))]
    listed = [{"name": f"j{k}", "position": p, "parent": parents[k]} for k, p in enumerate(places)]
    return write_obj(tmp_path / "chain.obj", joints=listed)


def test_the_papers_influences_are_limited_in_gltf_and_the_command_says_what_it_dropped(
    run, tmp_path
):
    path = chain(tmp_path)
    every = cutcell.bind(cutcell.load(path), 8, method="paper").weights
    result = run("bind", path, tmp_path / "out.glb", "-r", 8, "--method", "paper", "--json")
    document = json.loads(result.stdout)
    assert document["influences"] == {"mean": 4.0, "most": 4}
    assert document["parameters"]["max_influences"] == 4
    expected = cutcell.bind(cutcell.load(path), 8, method="paper", max_influences=4).weights
    results = cutcell.load(tmp_path / "out.glb").weights
    np.testing.assert_allclose(results, expected, atol=1e-6)
    dropped = np.where(expected > 0, 0, every).sum(axis=1)
    (sentence,) = document["warnings"]
    assert "of up to 6 influences a vertex the 4 largest are saved" in sentence
    assert f"{dropped.mean():.1%} of the weight on average and {dropped.max():.1%}" in sentence


@pytest.mark.parametrize(
    ("out", "more"), [("out.npz", ()), ("out.glb", ("--max-influences", "all"))]
)
def test_all_of_the_papers_influences_are_saved_where_that_is_asked_for(run, tmp_path, out, more):
    path = chain(tmp_path)
    result = run("bind", path, tmp_path / out, "-r", 8, "--method", "paper", *more)
    assert result.stderr == ""
    expected = cutcell.bind(cutcell.load(path), 8, method="paper").weights
    np.testing.assert_allclose(cutcell.load(tmp_path / out).weights, expected, atol=1e-6)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--alpha", 0.5], "alpha shapes the paper's falloff and has no effect"),
        (["--method", "paper", "--falloff", "rig", "--alpha", 0.5], "has no effect"),
        (["--method", "papers"], "method must be one of 'animation', 'paper', not 'papers'"),
        (["--max-influences", "many"], "max_influences must be a whole number from 1"),
        (["--connectivity", "8"], "connectivity must be one of 6, 26, 'any', not 8"),
    ],
)
def test_options_that_do_not_go_together_are_refused(run, bar, tmp_path, words, sentence):
    assert sentence in refused(run("bind", bar, tmp_path / "out.glb", *words))


def test_touching_up_reaches_the_library(run, bar, tmp_path):
    result = run("bind", bar, tmp_path / "bound.glb", "--symmetric")
    assert "is not mirrored across x, y or z" in refused(result)
    result = run("bind", bar, tmp_path / "bound.glb", "--lock", "tip", "--lock", "toe")
    assert 'there is no joint "toe"' in refused(result)


def test_quiet_says_nothing(run, bar, tmp_path):
    result = run("bind", bar, tmp_path / "bound.glb", "-r", 8, "--quiet")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")


def test_base_colours_are_saved_and_what_is_missing_is_told(run, bar, tmp_path):
    bar.write_text(f"mtllib bar.mtl\nusemtl red\n{bar.read_text()}")
    bar.with_suffix(".mtl").write_text("newmtl red\nKd 1 0 0\nmap_Kd skin.png\n")
    done = run("bind", bar, tmp_path / "bound.glb", "-r", 16, "--json")
    (sentence,) = json.loads(done.stdout)["warnings"]
    assert 'material "red" is used without' in sentence
    assert "its mesh has no texture coordinates" in sentence
    result = read_materials(cutcell.load(tmp_path / "bound.glb"))
    assert result.names == ("red",)
    assert (result.body.tints == (255, 0, 0)).all()


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
    assert document["warnings"]  # the far tip, of little skin, gets none, too
    assert result.stderr.startswith("warning: 3 of 15 vertices")
    assert "20.0% of the vertices" in run("bind", path, tmp_path / "o.glb").stdout


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("o.fbx", 'a rig cannot be saved as ".fbx"; end the name in'),
        ("no/where/o.glb", "there is no folder"),
    ],
)
def test_a_wrong_output_is_told_before_the_work(run, bar, tmp_path, monkeypatch, name, sentence):
    monkeypatch.setattr("cutcell.binding.bind", pytest.fail)
    assert sentence in refused(run("bind", bar, tmp_path / name))


def test_what_is_bound_again_is_the_same(run, tmp_path):
    places = {"a": 0.0, "b": 2.0, "c": 2.0}  # of two joints in one place one gets no weight
    joints = [{"name": name, "position": [0.5, 0.5, z]} for name, z in places.items()]
    bar = write_obj(tmp_path / "bar.obj", joints=joints)
    bound, again = tmp_path / "bound.glb", tmp_path / "again.glb"
    for old, new in ((bar, bound), (bound, again)):
        result = run("bind", old, new, "-r", 8, "--max-influences", 1, "--json")
        assert any(warning.endswith(" c") for warning in json.loads(result.stdout)["warnings"])
    first, second = cutcell.load(bound), cutcell.load(again)
    assert first.skeleton.deform.all()
    assert second.skeleton.deform.all()
    np.testing.assert_array_equal(first.weights, second.weights)


@pytest.mark.parametrize("ending", suffixes("write"))
def test_every_ending_it_lets_through_can_be_saved(run, bar, tmp_path, ending):
    result = run("bind", bar, tmp_path / f"out{ending}", "-r", 8)
    if ending == ".vrm":  # only what came from one
        assert "no VRM" in refused(result)
    else:
        assert result.exit_code == 0
        assert cutcell.load(tmp_path / f"out{ending}").weights is not None


def test_a_mesh_without_a_skeleton_is_refused_by_name(run, tmp_path):
    path = write_obj(tmp_path / "alone.obj")
    reports = refused(run("bind", path, tmp_path / "out.glb"))
    assert reports.startswith("error: alone.obj: the rig has no skeleton; export the mesh")
    assert not (tmp_path / "out.glb").exists()


def test_the_skeleton_of_another_file_and_accessories(run, tmp_path):
    builder = column()
    sword = builder.mesh({"POSITION": builder.positions(COLUMN)})
    builder.node(1, mesh=sword, name="sword", translation=[2, 0, 0])
    path, out = builder.save(tmp_path / "in.glb"), tmp_path / "out.glb"
    result = run("bind", path, out, "-r", 8, "--accessories")
    assert result.exit_code == 0
    assert [part.name for part in cutcell.load(out).parts] == ["body", "sword"]
    assert "sword" in run("bind", path, out, "-r", 8).stderr
    assert "2 joints" in refused(run("bind", path, out, "--skeleton", path))
    alone = write_obj(tmp_path / "alone.obj")
    assert run("bind", alone, out, "-r", 8, "--skeleton", path).exit_code == 0
    assert cutcell.load(out).skeleton.names == ("root", "tip")


def test_the_mesh_that_was_read_is_left_as_it_is(run, bar, tmp_path):
    textured = bar.read_text() + "vt 0 0\n"
    bar.write_text(textured)
    result = run("bind", bar, tmp_path / "bar.txt", "-r", 8, "--json")
    assert json.loads(result.stdout)["files"] == [str(tmp_path / "bar.txt")]
    assert bar.read_text() == textured


def test_a_file_that_would_be_replaced_is_told_before_the_work(run, bar, tmp_path, monkeypatch):
    monkeypatch.setattr("cutcell.binding.bind", pytest.fail)
    (tmp_path / "out.obj").write_text("another mesh")
    sentence = refused(run("bind", bar, tmp_path / "out.txt"))
    assert "out.txt: its mesh belongs in out.obj" in sentence
    assert (tmp_path / "out.obj").read_text() == "another mesh"


def test_all_files_that_are_written_are_told(run, bar, tmp_path):
    run("bind", bar, tmp_path / "one.glb", "-r", 8)
    (tmp_path / "two.bin").write_text("of something else")
    result = run("bind", tmp_path / "one.glb", tmp_path / "two.gltf", "-r", 8)
    assert "files two-2.bin, two.gltf" in " ".join(result.stdout.split())
    assert (tmp_path / "two.bin").read_text() == "of something else"


def test_layers_of_a_file_are_applied(run, bar, tmp_path):
    rig = cutcell.load(bar)
    name = rig.skeleton.names[0]
    path = tmp_path / "edits.json"
    layer = cutcell.Layer(cutcell.Painted([0], [name], [[1.0]]))
    cutcell.Edits(layers=[layer]).save(path)
    out = tmp_path / "out.npz"
    run("bind", bar, out, "-r", 16, "--layers", path)
    assert cutcell.load(out).weights[0].tolist() == [1.0] + [0.0] * (len(rig.skeleton.names) - 1)
    place = (rig.skeleton.joints[0] + 0.125).tolist()
    moved = cutcell.JointEdit(position=place)
    cutcell.Edits(joints={name: moved}).save(path)
    run("bind", bar, tmp_path / "out.glb", "-r", 16, "--layers", path)
    moved = cutcell.load(tmp_path / "out.glb").skeleton.joints
    assert moved[0].tolist() == pytest.approx(place, abs=1e-6)
    assert moved[1:].tolist() == pytest.approx(rig.skeleton.joints[1:], abs=1e-6)
    path.write_text('{"joints": {"nobody": {"deform": true}}}')
    assert 'no joint "nobody"' in refused(run("bind", bar, out, "-r", 16, "--layers", path))


def test_the_method_of_layers_is_taken_unless_an_option_says_otherwise(run, bar, tmp_path):
    path, out = tmp_path / "edits.json", tmp_path / "out.npz"
    cutcell.Edits(method={"resolution": 16, "falloff": "paper", "alpha": 0.3}).save(path)
    document = json.loads(run("bind", bar, out, "--layers", path, "--json").stdout)
    stored = {name: document["parameters"][name] for name in ("resolution", "falloff", "alpha")}
    assert stored == {"resolution": 16, "falloff": "paper", "alpha": 0.3}
    expected = cutcell.bind(cutcell.load(bar), 16, falloff="paper", alpha=0.3).weights
    np.testing.assert_array_equal(cutcell.load(out).weights, expected)
    document = json.loads(run("bind", bar, out, "--layers", path, "-r", 20, "--json").stdout)
    assert document["parameters"]["resolution"] == 20


def test_an_option_of_its_default_counts_beside_layers(run, bar, tmp_path):
    path = tmp_path / "edits.json"
    stored = {"resolution": 16, "samples": 9, "falloff": "paper", "alpha": 0.3}
    cutcell.Edits(method=stored).save(path)
    for words, parameters in (
        (["-r", 64], {"resolution": 64, "samples": 9}),
        (["--samples", 5], {"resolution": 16, "samples": 5, "alpha": 0.3}),
        (["--method", "animation", "-r", 12], {"resolution": 12, "samples": 5, "alpha": None}),
        (["--orient", "--threshold", 0], {"resolution": 16, "orient": True}),
    ):
        done = run("bind", bar, tmp_path / "out.npz", "--layers", path, *words, "--json")
        assert parameters.items() <= json.loads(done.stdout)["parameters"].items()
    weights = cutcell.bind(cutcell.load(bar), 20, falloff="paper", alpha=0.3, samples=9).weights[0]
    done = run("explain", bar, 0, "--layers", path, "-r", 20, "--json")
    for share in json.loads(done.stdout)["joints"]:
        assert share["weight"] == pytest.approx(weights[share["joint"]])


def test_a_resolution_counts_along_the_whole_mesh_and_what_was_built_is_printed(
    run, tmp_path, monkeypatch
):
    """Of characters side by side, one that is left out counts along the largest."""
    two = side_by_side(rigged_bar(12))
    path, out = tmp_path / "two.obj", tmp_path / "bound.npz"
    path.touch()
    monkeypatch.setattr("cutcell.io.load", lambda *_, **__: two)
    for words, resolution in (["-r", 64], 64), (["--resolution", 20], 20), ([], 141):
        document = json.loads(run("bind", path, out, *words, "--json").stdout)
        assert document["parameters"]["resolution"] == resolution
        assert document["graph"]["resolution"] == resolution
    weights = cutcell.bind(two, 20).weights[0]
    done = json.loads(run("explain", path, 0, "-r", 20, "--json").stdout)
    for share in done["joints"]:
        assert share["weight"] == pytest.approx(weights[share["joint"]])


def test_a_template_is_fitted_into_a_mesh_without_a_skeleton(run, tmp_path):
    mesh = write_obj(tmp_path / "bare.obj")
    out = tmp_path / "bound.glb"
    document = json.loads(run("bind", mesh, out, "-r", 16, "--template", "chain", "--json").stdout)
    assert document["template"] == "chain"
    result = cutcell.load(out)
    assert result.skeleton.names == tuple(f"bone.{n}" for n in range(1, 6))
    assert np.ptp(result.skeleton.joints[:, 2]) > 1
    np.testing.assert_allclose(result.weights.sum(axis=1), 1, atol=1e-5)
    for ending in ("txt", "npz"):
        assert (
            run("bind", mesh, tmp_path / f"b.{ending}", "-r", 16, "--template", "chain").exit_code
            == 0
        )
        again = cutcell.load(tmp_path / f"b.{ending}")
        np.testing.assert_allclose(again.skeleton.joints, result.skeleton.joints, atol=1e-4)


def test_templates_that_cannot_be_are_refused(run, bar, tmp_path):
    out = tmp_path / "bound.glb"
    says = refused(run("bind", bar, out, "--template", "chain"))
    assert "has a skeleton of 2 joints already" in says
    assert "centaur" in refused(run("bind", bar, out, "--template", "centaur"))
    bare = write_obj(tmp_path / "bare.obj")
    assert "no three fingers" in refused(run("bind", bare, out, "-r", 16, "--template", "hand"))
    assert not out.exists()


def test_edits_may_bring_the_skeleton(run, tmp_path):
    mesh, held = write_obj(tmp_path / "bare.obj"), tmp_path / "held.json"
    joints = {
        "root": {"added": True, "position": [0.5, 0.5, 0.2], "parent": ""},
        "tip": {"added": True, "position": [0.5, 0.5, 1.8], "parent": "root"},
    }
    held.write_text(json.dumps({"joints": joints}))
    out = tmp_path / "bound.glb"
    assert run("bind", mesh, out, "-r", 16, "--layers", held).exit_code == 0
    assert cutcell.load(out).skeleton.names == ("root", "tip")
