"""The command line: results on stdout, one sentence and exit code 2 for what a person can mend."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import cutcell
from cutcell.cli import ENDINGS, app, main
from cutcell.console import print_json, progress_bars
from cutcell.skinning.weights import DEFAULT_LEAF, FALLOFFS

ROOT = Path(__file__).resolve().parent.parent.parent
BAR = [[x, y, z] for z in (0, 1, 2) for y in (0, 1) for x in (0, 1)]
JOINTS = [
    {"name": "root", "position": [0.5, 0.5, 0.1], "parent": None},
    {"name": "tip", "position": [0.5, 0.5, 1.9], "parent": "root"},
]


def bar_faces() -> list[list[int]]:
    """Return a square bar of two cubes, closed, wound outwards."""
    quads = [[0, 2, 3, 1], [8, 9, 11, 10]]
    for base in (0, 4):
        quads += [[base + i for i in q] for q in ([0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2])]
        quads += [[base + i for i in (1, 3, 7, 5)]]
    return [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]


def write_obj(path: Path, vertices=BAR, faces=None, joints=None) -> Path:
    faces = bar_faces() if faces is None else faces
    lines = [f"v {x} {y} {z}" for x, y, z in vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    path.write_text("\n".join(lines) + "\n")
    if joints is not None:
        path.with_suffix(".json").write_text(json.dumps({"joints": joints}))
    return path


@pytest.fixture
def bar(tmp_path) -> Path:
    return write_obj(tmp_path / "bar.obj", joints=JOINTS)


@pytest.fixture
def run():
    runner = CliRunner(env={"COLUMNS": "120", "NO_COLOR": "1", "TERM": "dumb"})

    def invoke(*arguments):
        result = runner.invoke(app, [str(a) for a in arguments])
        if result.exception and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return invoke


def refused(result) -> str:
    """Return the sentence of a refusal, once it is sure that it is one."""
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert result.stderr.count("error:") == 1
    assert len(result.stderr.strip().splitlines()) == 1
    return result.stderr.strip()


class TestBind:
    def test_saves_what_the_library_computes(self, run, bar, tmp_path):
        out = tmp_path / "bound.glb"
        result = run("bind", bar, out, "-r", 16)
        assert result.exit_code == 0
        assert "12 vertices" in result.stdout
        expected = cutcell.bind(cutcell.load(bar), resolution=16).weights
        found = cutcell.load(out)
        assert found.skeleton.names == ("root", "tip")
        np.testing.assert_allclose(found.weights, expected, atol=1e-6)

    def test_options_reach_the_library(self, run, bar, tmp_path):
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
        result = run("bind", bar, tmp_path / "bound.glb", *words, "--json")
        document = json.loads(result.stdout)
        assert document["parameters"] == {**options, "symmetric": False, "locked": []}
        assert document["influences"] == {"mean": 1.0, "most": 1}
        assert set(document["seconds"]) == {"graph", "distances", "weights"}

    def test_defaults_are_those_of_the_library(self, run, bar, tmp_path):
        document = json.loads(run("bind", bar, tmp_path / "bound.glb", "--json").stdout)
        defaults = {**cutcell.bind.__kwdefaults__, "resolution": cutcell.bind.__defaults__[0]}
        del defaults["progress"]
        defaults["leaf"] = DEFAULT_LEAF[defaults["falloff"]]
        assert document["parameters"] == {**defaults, "locked": list(defaults["locked"])}

    def test_touching_up_reaches_the_library(self, run, bar, tmp_path):
        result = run("bind", bar, tmp_path / "bound.glb", "--symmetric")
        assert "is not mirrored across x, y or z" in refused(result)
        result = run("bind", bar, tmp_path / "bound.glb", "--lock", "tip", "--lock", "toe")
        assert 'there is no joint "toe"' in refused(result)

    def test_quiet_says_nothing(self, run, bar, tmp_path):
        result = run("bind", bar, tmp_path / "bound.glb", "-r", 8, "--quiet")
        assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")

    def test_takes_a_skeleton_from_elsewhere(self, run, tmp_path):
        mesh = write_obj(tmp_path / "bar.obj")
        skeleton = tmp_path / "bones.json"
        skeleton.write_text(json.dumps({"joints": JOINTS}))
        assert run("bind", mesh, tmp_path / "o.glb", "--skeleton", skeleton).exit_code == 0

    def test_warns_of_vertices_that_no_path_reaches(self, run, tmp_path):
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
        [("o.fbx", 'cannot be saved as ".fbx"'), ("no/where/o.glb", "there is no folder")],
    )
    def test_a_wrong_output_is_told_before_the_work(self, run, bar, tmp_path, name, sentence):
        assert sentence in refused(run("bind", bar, tmp_path / name, "-r", 10_000))

    @pytest.mark.parametrize("ending", ENDINGS)
    def test_every_ending_it_lets_through_can_be_saved(self, run, bar, tmp_path, ending):
        result = run("bind", bar, tmp_path / f"out{ending}", "-r", 8)
        if ending == ".gltf":  # only what came from glTF
            assert "saved as .glb" in refused(result)
        else:
            assert result.exit_code == 0
            assert cutcell.load(tmp_path / f"out{ending}").weights is not None


class TestGraph:
    def test_counts_what_the_library_builds(self, run, bar):
        document = json.loads(run("graph", bar, "-r", 16, "--json").stdout)
        graph = cutcell.build_graph(cutcell.load(bar).mesh, 16)
        assert document["graph"]["nodes"]["total"] == len(graph.nodes)
        assert document["graph"]["edges"]["total"] == len(graph.edges)
        kinds = document["graph"]["edges"]
        assert kinds["mesh"] + kinds["interior"] + kinds["surface"] == kinds["total"]
        assert document["graph"]["components"] == 1
        assert document["graph"]["largest_component"] == 1.0
        assert document["mesh"] == {
            "vertices": 12,
            "welded_vertices": 12,
            "triangles": 20,
            "components": 1,
            "open_edges": 0,
            "non_manifold_edges": 0,
            "closed": True,
        }
        assert document["skeleton"] == {"joints": 2, "deform": 2, "roots": 1}
        assert document["fallback"]["vertices"] == 0

    def test_says_it_in_words(self, run, bar):
        words = run("graph", bar, "-r", 16).stdout
        for expected in ("bar.obj", "closed", "2 joints", "1 root", "not reached", "seconds"):
            assert expected in words

    def test_needs_no_skeleton(self, run, tmp_path):
        path = write_obj(tmp_path / "open.obj", faces=bar_faces()[2:])
        document = json.loads(run("graph", path, "-r", 8, "--json").stdout)
        assert document["skeleton"] is None
        assert document["fallback"] is None
        assert document["mesh"]["open_edges"] == 4
        assert not document["mesh"]["closed"]
        assert "open: 4 edges with one triangle" in run("graph", path, "-r", 8).stdout

    def test_a_bare_mesh_that_is_wrong_is_named(self, run, tmp_path):
        path = write_obj(tmp_path / "flat.obj", [[0, 0, 0]] * 3, [[0, 1, 2]])
        assert "flat.obj" in refused(run("graph", path))


def cycle() -> list[dict]:
    return [
        {"name": "a", "position": [0, 0, 0], "parent": "b"},
        {"name": "b", "position": [0, 0, 1], "parent": "a"},
    ]


WRONG = {
    "no faces": ({"faces": []}, "face|triangle"),
    "nan": ({"vertices": [["nan"] * 3, *BAR[1:]]}, "finite|number"),
    "index out of range": ({"faces": [[0, 1, 99]]}, "vert"),
    "cycle": ({"joints": cycle()}, 'cycle: "[ab]" -> "[ab]" -> "[ab]"'),
    "no joints": ({"joints": []}, "no joints"),
    "joint far outside": (
        {"joints": [{**JOINTS[0], "position": [0, 0, 4000]}]},
        '"root" .* times the mesh\'s size away',
    ),
}


@pytest.mark.parametrize("command", ["bind", "graph"])
class TestWrongInput:
    def words(self, command, rig, tmp_path):
        return [command, rig, *([tmp_path / "out.glb"] if command == "bind" else [])]

    def test_missing_file(self, run, tmp_path, command):
        rig = tmp_path / "nope.glb"
        assert "no such file" in refused(run(*self.words(command, rig, tmp_path)))

    def test_text_named_glb(self, run, tmp_path, command):
        rig = tmp_path / "text.glb"
        rig.write_text("This is a letter, not a character.\n")
        assert "text.glb" in refused(run(*self.words(command, rig, tmp_path)))

    @pytest.mark.parametrize("case", WRONG)
    def test_wrong_content(self, run, tmp_path, command, case):
        changed, sentence = WRONG[case]
        rig = write_obj(tmp_path / "wrong.obj", **{"joints": JOINTS, **changed})
        told = refused(run(*self.words(command, rig, tmp_path)))
        assert re.search(sentence, told)
        assert re.search(r"wrong\.(obj|json)", told)

    @pytest.mark.parametrize("resolution", [1, 10_000, -3])
    def test_resolution_out_of_range(self, run, bar, tmp_path, command, resolution):
        words = self.words(command, bar, tmp_path)
        told = refused(run(*words, "--resolution", resolution))
        assert "resolution must be a whole number from 2 to 1,024" in told
        assert not (tmp_path / "out.glb").exists()

    @pytest.mark.parametrize(
        ("option", "value"),
        [
            ("connectivity", 7),
            ("connectivity", "all"),
            ("winding-threshold", 1.5),
            ("samples", 0),
            ("leaf", "twig"),
        ],
    )
    def test_parameter_out_of_range(self, run, bar, tmp_path, command, option, value):
        told = refused(run(*self.words(command, bar, tmp_path), f"--{option}", value))
        assert f"{option.replace('-', '_')} must be" in told


@pytest.mark.parametrize(
    ("option", "value"),
    [("falloff", "steep"), ("alpha", 2), ("max-influences", 0), ("threshold", -1)],
)
def test_weights_parameter_out_of_range(run, bar, tmp_path, option, value):
    told = refused(run("bind", bar, tmp_path / "out.glb", f"--{option}", value))
    assert f"{option.replace('-', '_')} must be" in told


class TestApp:
    def test_serves_what_it_was_asked_to(self, run, bar, monkeypatch):
        seen = []
        monkeypatch.setattr("cutcell.cli._page", lambda: lambda *a, **k: seen.append((a, k)))
        words = ["app", bar, "--port", 5010, "--address", "0.0.0.0", "--no-show"]
        assert run(*words).exit_code == 0
        assert seen == [((bar,), {"port": 5010, "address": "0.0.0.0", "show": False})]

    def test_a_wrong_file_is_told_before_anything_is_served(self, run, monkeypatch, tmp_path):
        monkeypatch.setattr("cutcell.cli._page", lambda: pytest.fail)
        assert "no such file" in refused(run("app", tmp_path / "nope.glb"))

    def test_says_what_to_install_where_the_page_is_missing(self, run, monkeypatch):
        monkeypatch.setitem(sys.modules, "app.serve", None)
        assert "pip install 'cutcell[app]'" in refused(run("app"))

    def test_port_out_of_range(self, run):
        assert "from 0 to 65,535" in refused(run("app", "--port", 70_000))

    def test_an_address_that_cannot_be_served(self, run, monkeypatch):
        def serve(*_, **__):
            raise OSError(98, "Address already in use")

        monkeypatch.setattr("cutcell.cli._page", lambda: serve)
        assert "Address already in use" in refused(run("app"))


class TestHelp:
    def test_no_arguments_show_help(self, run):
        shown = run()
        assert "Usage" in shown.stdout + shown.stderr

    def test_version(self, run):
        assert run("--version").stdout == f"cutcell {cutcell.__version__}\n"

    @pytest.mark.parametrize("command", ["app", "bind", "graph", "render"])
    def test_each_command_shows_examples(self, run, command):
        shown = run(command, "--help")
        assert shown.exit_code == 0
        assert f"cutcell {command} " in shown.stdout.partition("Example")[2]

    def test_every_falloff_is_explained(self, run):
        shown = run("bind", "--help").stdout
        assert all(f"{name}:" in shown for name in FALLOFFS)


def test_ctrl_c_stops_with_130(run, bar, monkeypatch, tmp_path):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("cutcell.skinning.bind", interrupted)
    result = run("bind", bar, tmp_path / "out.glb")
    assert result.exit_code == 130
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "out.glb").exists()


def test_bars_are_drawn_on_a_terminal_only(monkeypatch, capsys):
    with progress_bars() as report:
        report("graph", 0.5)
    assert capsys.readouterr() == ("", "")
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress_bars() as report:
        report("graph", 0.5)
        report("graph", 1.0)
        report("distances", 0.1)
    drawn = capsys.readouterr()
    assert "Building the graph" in drawn.err
    assert drawn.out == ""


def test_json_never_holds_what_is_not_json():
    with pytest.raises(ValueError, match="not JSON compliant"):
        print_json({"seconds": float("nan")})


def test_python_m_cutcell_is_the_command(bar, tmp_path):
    command = [sys.executable, "-m", "cutcell", "bind", str(bar), str(tmp_path / "o.glb"), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["output"].endswith("o.glb")


def test_a_real_process_refuses_with_2(tmp_path):
    command = [sys.executable, "-m", "cutcell", "graph", str(tmp_path / "nope.glb")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 2
    assert done.stderr.endswith("nope.glb: there is no such file\n")


def test_a_real_process_stops_at_ctrl_c(bar, tmp_path):
    code = f"""
import os, signal, sys, time
import cutcell.cli, cutcell.skinning

def long_work(*_, **__):
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(60)

cutcell.skinning.bind = long_work
sys.argv = ["cutcell", "bind", {str(bar)!r}, {str(tmp_path / "o.glb")!r}]
cutcell.cli.main()
"""
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=50)
    assert (done.returncode, done.stderr) == (130, "stopped: by Ctrl-C\n")
    assert not (tmp_path / "o.glb").exists()


def test_main_runs_the_command(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["cutcell", "--version"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 0
    assert capsys.readouterr().out.startswith("cutcell ")


def test_real_characters_bind_and_stay_in_order(run, rigs, tmp_path):
    for path in rigs[:3]:
        out = tmp_path / path.name
        assert run("bind", path, out, "-r", 24, "--quiet").exit_code == 0
        before, after = cutcell.load(path), cutcell.load(out)
        np.testing.assert_array_equal(before.mesh.vertices, after.mesh.vertices)
        np.testing.assert_allclose(after.weights.sum(axis=1), 1, atol=1e-6)


def test_demo_characters_have_a_graph(run, demo_paths):
    document = json.loads(run("graph", demo_paths[0], "-r", 16, "--json").stdout)
    assert document["graph"]["nodes"]["total"] > 0


class TestCompare:
    def test_measures_each_method_on_each_rig(self, run, bar, tmp_path):
        rigged = tmp_path / "rigged.glb"
        assert run("bind", bar, rigged, "-r", 8).exit_code == 0
        options = ("--methods", "cutcell_rig, euclidean", "-r", 8)
        result = run("compare", rigged, *options, "--json")
        assert result.exit_code == 0
        document = json.loads(result.stdout)
        assert document["methods"] == ["cutcell_rig", "euclidean"]
        assert document["summary"]["cutcell_rig"]["l1"]["median"] < 1e-6
        table = run("compare", rigged, *options).stdout
        assert table.startswith("rigged: 12 vertices, 2 joints with weight")
        assert "cutcell_rig  0.000" in table

    def test_writes_markdown_and_a_figure(self, run, demo_paths, tmp_path):
        plot = tmp_path / "errors.svg"
        rig = next(path for path in demo_paths if path.stem == "rabbit")
        options = ("--methods", "artist,euclidean", "--markdown", "--plot", plot)
        table = run("compare", rig, rig, *options).stdout
        assert "| euclidean |" in table
        assert "| rabbit |" in table
        assert "<svg" in plot.read_text()
        assert "cannot be" in refused(run("compare", rig, "--plot", tmp_path / "errors.txt"))

    def test_unknown_methods_and_rigs_without_weights_are_told(self, run, bar, tmp_path):
        assert "'bone_heat'" in refused(run("compare", bar, "--methods", "magic"))
        assert "weights" in refused(run("compare", bar, "--methods", "euclidean"))
