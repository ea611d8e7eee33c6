"""`cutcell render`, and the page's scenes in a notebook."""

import base64
import gzip
import json
import re
import shlex
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import cutcell
import cutcell.editing
import cutcell.io
import cutcell_viewers
from cutcell.cli.app import app
from cutcell.errors import FileError, ParameterError
from cutcell.runtime.progress import silent
from cutcell_app.features.learn.lesson import built_in
from cutcell_app.files.table_export import save_numbers
from cutcell_app.headless import (
    VIEWS,
    Choices,
    Picture,
    bone_index,
    clip_named,
    describe,
    order,
    state_of,
)
from cutcell_app.headless import scene as describing
from cutcell_app.headless.lesson_page import STOPS
from cutcell_app.headless.options import CHOICES, PICTURE, READERS, SETTINGS
from cutcell_app.shell.session import sweep
from cutcell_assets import demo_path
from cutcell_viewers.camera import Camera
from cutcell_viewers.palette import colormap
from tests.viewers.arm import arm_rig
from tests.viewers.textures import wall

DEMOS = demo_path("robot").parent
DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "pictures.md"


@pytest.fixture(scope="module", autouse=True)
def demos_once():
    """Load and bind each demo once for all commands here; rigs and bindings are frozen."""
    load, bind = cutcell.io.load, cutcell.binding.bind
    rigs, bindings = {}, {}

    def load_once(path, **options):
        path = Path(path).resolve()
        if path.parent != DEMOS or any(options.values()):
            return load(path, **options)
        if path not in rigs:
            rigs[path] = load(path)
        return rigs[path]

    def bind_once(rig, *resolution, method=cutcell.ANIMATION, progress=silent):
        if not any(rig is one for one in rigs.values()):
            return bind(rig, *resolution, method=method, progress=progress)
        key = id(rig), resolution, method
        if key not in bindings:
            bindings[key] = bind(rig, *resolution, method=method, progress=progress)
        return bindings[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cutcell.io, "load", load_once)
        patch.setattr(cutcell.binding, "bind", bind_once)
        patch.setattr(describing, "bind", bind_once)
        yield


@pytest.fixture
def short_sweeps(monkeypatch):
    """Let a sweep end after so many frames that it is known how it runs."""
    monkeypatch.setattr(sweep, "SECONDS", 1.2)


@pytest.fixture
def drawn(monkeypatch):
    """Instead of drawing, remember what was to be drawn."""
    orders = []

    def remember(order, path, progress):
        orders.append(order)
        path.write_bytes(b"drawn")

    monkeypatch.setattr("cutcell_viewers.process.draw_isolated", remember)
    return orders


def run(*arguments):
    words = [str(argument) for argument in arguments]
    return CliRunner().invoke(app, ["render", *words, "--resolution", "16"])


@pytest.mark.slow
def test_a_picture_comes_out(tmp_path):
    out = tmp_path / "hand.png"
    result = run(demo_path("robot"), out, "--size", "320x240", "--dark", "--view", "front")
    assert result.exit_code == 0, result.stderr
    assert "320 x 240 pixels" in result.stdout
    with Image.open(out) as picture:
        assert picture.size == (320, 240)
        assert len(picture.getcolors(100_000)) > 200
        assert np.asarray(picture.convert("L")).mean() < 128


def test_each_choice_of_the_command_reaches_the_picture(drawn, tmp_path):
    robot = cutcell.load(demo_path("robot"))
    bone = robot.skeleton.names[3]
    clip = robot.clips[0].name
    for panel in ("graph", "distance", "weights", "pose", "compare"):
        result = run(
            demo_path("robot"), tmp_path / "a.png", "--panel", panel, "--bone", bone.upper()
        )
        assert result.exit_code == 0, result.stderr
    titles = [one.description.legend and one.description.legend.title for one in drawn]
    assert titles[1] == f"Distance from {bone}"
    assert titles[2] == f"Weight of {bone}"
    assert len(drawn[4].description.views) == 3
    films = [("--turntable",), ("--clip", "1"), ("--turntable", "--clip", clip)]
    for options in films:
        result = run(demo_path("robot"), tmp_path / "a.mp4", "--panel", "pose", *options)
        assert result.exit_code == 0, result.stderr
    assert [one.turntable for one in drawn[5:]] == [True, False, True]
    assert [one.motion is not None for one in drawn[5:]] == [False, True, True]
    assert drawn[5].size == (960, 720)
    options = [
        "--panel",
        "pose",
        "--turn",
        "z=-30.5",
        "--no-bones",
        "--no-legend",
        "--view",
        "back",
        "--error",
        "--blending",
        "dual",
    ]
    result = run(demo_path("robot"), tmp_path / "a.png", "--bone", bone, *options)
    assert result.exit_code == 0, result.stderr
    last = drawn[-1]
    assert last.description.pose is not None
    assert last.description.blending == "dual"
    assert not last.description.actors["bones"].visible
    assert not last.legend
    assert last.direction == VIEWS["back"]
    assert last.description.legend.high.endswith("mm")


def test_what_is_seen_inside_reaches_the_picture(drawn, tmp_path):
    def actors(*options):
        result = run(demo_path("robot"), tmp_path / "a.png", *options)
        assert result.exit_code == 0, result.stderr
        return drawn[-1].description

    scene = actors("--panel", "graph", "--layers", "mesh,nodes", "--cut", "30,20=0.4", "--face",
                   "winding", "--method", "paper", "--color-by", "component")  # fmt: skip
    seen = {name for name, actor in scene.actors.items() if actor.visible}
    assert {"mesh edges", "mesh nodes", "inside", "section outline"} <= seen
    assert not {"body", "interior edges", "surface edges"} & seen
    assert np.linalg.norm(scene.cut.normal) == pytest.approx(1)
    scene = actors("--panel", "graph", "--slice", "z=0.4:x")
    assert "slice rays" in scene.actors
    robot = cutcell.load(demo_path("robot"))
    bone, vertex = robot.skeleton.names[3], robot.weights[:, 3].argmax()
    scene = actors("--panel", "distance", "--bone", bone, "--sources", "--path", vertex, "--wave",
                   "0.5", "--connectivity", "6")  # fmt: skip
    assert {"sources", "path"} <= scene.actors.keys()
    assert scene.front is not None
    scene = actors(
        "--panel", "distance", "--bone", bone, "--measures", "straight,surface", "-r", "16"
    )
    assert scene.views == ("Straight line", "Over the surface")
    scene = actors("--panel", "check", "--finding", "unreachable-vertices", "--near", "0.3")
    assert "finding faces" in scene.actors
    assert drawn[-1].camera is not None


@pytest.mark.parametrize(("ending", "count"), [("gif", 120), ("mp4", 180)])
def test_the_wave_is_filmed_from_the_bone_to_the_farthest_vertex(drawn, tmp_path, ending, count):
    options = ("--panel", "distance", "--sweep", "wave", "--turntable")
    result = run(demo_path("robot"), tmp_path / f"a.{ending}", *options)
    assert result.exit_code == 0, result.stderr
    scenes = drawn[-1].scenes
    body = scenes[0].actors["body"]
    farthest = body.scalars[body.scalars < body.limits[1]].max()  # the limit: unreached
    fronts = np.array([one.front for one in scenes])
    assert len(scenes) == count
    assert fronts[0] == 0
    assert (np.diff(fronts) >= 0).all()
    assert fronts[-1] >= farthest
    assert {one.actors["body"].limits for one in scenes} == {body.limits}
    assert len({one.legend for one in scenes}) == 1
    assert drawn[-1].turntable


@pytest.mark.parametrize("panel", ["graph", "distance"])
def test_the_cut_is_filmed_through_the_whole_body(drawn, short_sweeps, tmp_path, panel):
    result = run(
        demo_path("robot"), tmp_path / "a.gif", "--panel", panel, "--cut", "x", "--sweep", "cut"
    )
    assert result.exit_code == 0, result.stderr
    scenes = drawn[-1].scenes
    x = np.array([one.cut.origin[0] for one in scenes])
    body = scenes[0].actors["body"].points[:, 0]
    np.testing.assert_allclose(x[[0, -1]], [body.min(), body.max()], atol=1e-6)
    assert (np.diff(x) >= 0).all()
    assert drawn[-1].description is scenes[-1]


def test_no_wave_begins_at_a_bone_that_moves_nothing(rig):
    skeleton = replace(rig.skeleton, deform=[True, False, True])
    partial = replace(rig, skeleton=skeleton, weights=None)
    with pytest.raises(ParameterError, match="elbow"):
        state_of(partial, Choices("distance", bone="elbow", sweep="wave"))


def test_a_finding_is_seen_from_where_it_is_asked_for(drawn, tmp_path):
    def look(*options):
        finding = ("--panel", "check", "--finding", "unreachable-vertices")
        result = run(demo_path("robot"), tmp_path / "a.png", *finding, *options)
        assert result.exit_code == 0, result.stderr
        look = np.subtract(drawn[-1].camera.position, drawn[-1].camera.focal_point)
        return look / np.linalg.norm(look)

    assert look()[2] > 0
    for view in ("back", "left"):
        direction = np.array(VIEWS[view])
        np.testing.assert_allclose(look("--view", view), direction / np.linalg.norm(direction))


def test_the_files_materials_reach_the_picture(drawn, tmp_path):
    options = ("--panel", "pose", "--colors", "materials")
    result = run(demo_path("robot"), tmp_path / "a.png", *options)
    assert result.exit_code == 0, result.stderr
    scene = drawn[-1].description
    assert len(np.unique(scene.actors["body"].materials.tints.reshape(-1, 3), axis=0)) == 6
    assert scene.legend is None
    broken = wall(b"no image", pbr={"baseColorFactor": [1, 0, 0, 1]}).save(tmp_path / "wall.glb")
    result = run(broken, tmp_path / "a.png", *options)
    assert result.exit_code == 0, result.stderr
    assert 'image "wall" cannot be shown' in " ".join((result.stdout + result.stderr).split())
    cutcell.save(tmp_path / "plain.glb", arm_rig())
    result = run(tmp_path / "plain.glb", tmp_path / "b.png", *options)
    assert result.exit_code == 2
    assert "has no materials with colours of their own" in " ".join(result.stderr.split())
    assert not (tmp_path / "b.png").exists()


def test_measures_side_by_side_know_some_resolutions():
    choices = Choices("distance", settings={"beside_6": True})
    with pytest.raises(ParameterError, match="resolution of 16, 32, 64, 128, not 20"):
        describe(arm_rig(), choices, resolution=20)


@pytest.mark.parametrize(
    ("out", "options", "words"),
    [
        ("a.png", ("--bone", "antena"), 'has no bone "antena"; the nearest names are'),
        ("a.png", ("--panel", "grap"), "panel must be one of"),
        ("a.png", ("--view", "below"), "view must be one of"),
        ("a.png", ("--show", "all"), "shown must be one of"),
        ("a.png", ("--size", "huge"), "such as 1600x1200"),
        ("a.png", ("--size", "9000x9000"), "16 to 8192"),
        ("a.png", ("--turn", "30"), "such as z=30"),
        ("a.png", ("--cut", "w"), "cut must be x, y or z"),
        ("a.png", ("--cut", "z=2"), "number from 0 to 1 after the ="),
        ("a.png", ("--face", "up"), "face must be one of"),
        ("a.png", ("--colormap", "jet"), "colormap must be one of 'default', 'viridis'"),
        ("a.png", ("--keep", "all"), "cut_keeps must be one of 'half', 'face', 'slab'"),
        ("a.png", ("--layers", "mesh,bones"), "layer must be one of"),
        ("a.png", ("--color-by", "hue"), "edge_colors must be one of"),
        ("a.png", ("--slice", "q"), "such as z, z=0.5 or z=0.5:x"),
        ("a.png", ("--path", "999999"), "vertex must be one of 0 to"),
        ("a.png", ("--wave", "2"), "front must be a number from 0 to 1"),
        ("a.png", ("--measures", "near"), "measure must be one of 'straight', 'surface', 'voxel'"),
        ("a.png", ("--measures", "straight,surface,voxel,6,26"), "at most 4 measures"),
        ("a.png", ("--panel", "pose", "--colors", "paint"), "pose_colors must be one of 'weights'"),
        ("a.png", ("--panel", "pose", "--blending", "cubic"), "blending must be one of 'linear'"),
        ("a.png", ("--connectivity", "7"), "connectivity"),
        ("a.png", ("--near", "3"), "near must be"),
        ("a.png", ("--panel", "check", "--finding", "gout"), 'has no finding "gout"'),
        ("a.png", ("--methods", "magic", "--panel", "compare"), "method must be one of"),
        ("a.png", ("--time", "1"), "name the clip"),
        ("a.gif", ("--clip", "no such clip"), 'has no clip "no such clip"'),
        ("a.png", ("--turntable",), ".mp4 or .gif"),
        ("a.mp4", (), "turntable, a clip or a sweep"),
        ("a.png", ("--panel", "distance", "--sweep", "wave"), ".mp4 or .gif"),
        ("a.gif", ("--sweep", "wave"), "add --panel distance"),
        ("a.gif", ("--panel", "distance", "--sweep", "cut"), "add --cut"),
        ("a.gif", ("--panel", "graph", "--slice", "z", "--sweep", "cut"), "add --cut"),
        ("a.gif", ("--panel", "graph", "--sweep", "slice"), "sweep must be one of"),
        ("a.gif", ("--panel", "distance", "--sweep", "wave", "--clip", "1"), "a clip or a sweep"),
        ("a.gif", ("--address", "?panel=graph", "--address", "?panel=weights"), ".pdf or .svg"),
        ("a.jpg", ("--address", "?panel=graph", "--address", "?panel=weights"), ".pdf or .svg"),
        ("a.pdf", ("--address", "?panel=graph") * 7, "at most 6 panels"),
        ("a.pdf", ("--address", "?panel=graph") * 2 + ("--turntable",), "does not move"),
        ("a.tga", (), "not as .tga"),
        ("no/a.png", (), "no folder"),
    ],
)
def test_what_cannot_be_drawn_is_told_in_one_sentence(drawn, tmp_path, out, options, words):
    result = run(demo_path("robot"), tmp_path / out, *options)
    assert result.exit_code == 2
    assert words in result.stderr.replace("\n", " ")
    assert result.stderr.count("error:") == 1
    assert not (tmp_path / out).exists()
    assert drawn == []


def test_names_are_found_as_people_write_them(rig):
    assert bone_index(rig, "elbow") == bone_index(rig, "ELBOW") == bone_index(rig, "Ｅlbow") == 1
    with pytest.raises(ParameterError, match='nearest names are "elbow"'):
        bone_index(rig, "elbo")
    with pytest.raises(ParameterError, match="there are"):
        bone_index(rig, "xyz")
    assert clip_named(rig, "wave") is clip_named(rig, "1") is rig.clips[0]
    with pytest.raises(ParameterError, match="no clips"):
        clip_named(cutcell.Rig(rig.mesh, rig.skeleton), "wave")


def test_an_error_needs_weights_to_tell_it_against(rig):
    with pytest.raises(ParameterError, match="no weights of its own to compare"):
        state_of(rig.with_weights(None), Choices("pose", error=True))


def test_the_error_of_a_clip_has_the_scale_of_the_whole_clip(rig, binding):
    choices = Choices("pose", clip="wave", error=True)
    scene = describe(rig, choices, binding=binding)
    assert scene.actors["body"].limits[1] > 0.1
    film = order(rig, scene, choices)
    assert len(film.motion.times) == 2
    moment = Choices("pose", clip="wave", error=True, time=0.5)
    still = order(rig, describe(rig, moment, binding=binding), moment)
    assert still.motion is None
    dual = replace(choices, settings={"blending": "dual"})
    assert describe(rig, dual, binding=binding).blending == "dual"
    assert not np.allclose(still.description.pose, scene.pose)


@pytest.mark.parametrize("panel", ["graph", "distance", "weights"])
def test_the_body_follows_a_clip_on_panels_where_it_rests_otherwise(rig, binding, panel):
    choices = Choices(panel, clip="wave", settings={"blending": "dual"})
    scene = describe(rig, choices, binding=binding)
    assert scene.blending == "dual"
    assert {"body"} <= scene.actors.keys()
    assert all(actor.skin is not None for actor in scene.actors.values())


@pytest.mark.slow
def test_a_notebook_gets_a_picture_or_a_plotter(rig, binding):
    scene = describe(rig, Choices("weights", bone="elbow"), binding=binding)
    picture = cutcell_viewers.show(scene, size=(160, 120))
    assert picture.size == (160, 120)
    assert picture._repr_png_().startswith(b"\x89PNG")
    plotter = cutcell_viewers.plotter(scene, size=(160, 120), dark=True)
    assert plotter.window_size == [160, 120]
    plotter.close()


@pytest.mark.slow
def test_the_documents_commands_are_understood(drawn, short_sweeps, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "character.glb").symlink_to(demo_path("biped"))
    for demo in ("biped", "biped_soup", "biped_cape"):
        (tmp_path / f"{demo}.glb").symlink_to(demo_path(demo))
    commands = re.findall(r"^cutcell render (.*)$", DOCUMENT.read_text(), re.MULTILINE)
    assert len(commands) >= 5
    for command in commands:
        result = run(*shlex.split(command))
        assert result.exit_code == 0, (command, result.stderr)


@pytest.mark.slow
def test_the_documents_examples_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "assets").symlink_to(demo_path("biped").parent)
    monkeypatch.setattr("cutcell_viewers.film.TURN_SECONDS", 0.2)
    names: dict = {}
    for example in re.findall(r"```python\n(.*?)```", DOCUMENT.read_text(), re.DOTALL):
        exec(example, names)
    assert (tmp_path / "turn.gif").exists()


def test_numbers_are_saved_and_read_back(rig, binding, tmp_path):
    save_numbers(tmp_path / "a.csv", rig, weights=binding.weights)
    table = np.genfromtxt(tmp_path / "a.csv", delimiter=",", skip_header=1)
    np.testing.assert_array_equal(table[:, 0], np.arange(len(binding.weights)))
    np.testing.assert_allclose(table[:, 1:], binding.weights, rtol=1e-6)
    save_numbers(tmp_path / "a.npz", rig, weights=binding.weights, other=2 * binding.weights)
    with np.load(tmp_path / "a.npz") as numbers:
        np.testing.assert_array_equal(numbers["other"], 2 * binding.weights)
        np.testing.assert_array_equal(numbers["parents"], rig.skeleton.parents)
        assert len(numbers["vertex_indices"]) == len(binding.weights)


@pytest.mark.parametrize(
    ("name", "tables", "error", "words"),
    [
        ("a.xls", {"w": 1}, FileError, "saved as .csv or .npz"),
        ("no/a.csv", {"w": 1}, FileError, "no folder"),
        ("a.csv", {"w": 1, "v": 1}, ParameterError, "one table"),
        ("a.npz", {}, ParameterError, "no numbers"),
        ("a.npz", {"w": None}, ParameterError, "w has the shape"),
    ],
)
def test_numbers_that_cannot_be_saved_are_told(rig, tmp_path, name, tables, error, words):
    tables = {k: np.zeros(2) if v is None else rig.weights for k, v in tables.items()}
    with pytest.raises(error, match=words):
        save_numbers(tmp_path / name, rig, **tables)


def test_the_address_of_a_page_is_drawn_from_where_it_looks(drawn, tmp_path):
    query = (
        "?rig=biped&panel=graph&bone=hips&cut_axis=x&mesh_edges=0&graph_resolution=24"
        "&camera=1,2,3,0,1,0"
    )
    for address in (query, "http://127.0.0.1:5006/" + query):
        result = run(demo_path("robot"), tmp_path / "a.png", "--address", address)
        assert result.exit_code == 0, result.stderr
        scene = drawn[-1].description
        assert scene.cut.normal == (1, 0, 0)
        assert not scene.actors["mesh edges"].visible
        assert scene.legend.title == "Graph, R = 24 (weights: 16)"
        assert drawn[-1].camera == Camera((1, 2, 3), (0, 1, 0))
    run(demo_path("robot"), tmp_path / "a.png", "--address", query, "--cut", "z", "--view", "back")
    assert drawn[-1].description.cut.normal == (0, 0, 1)
    assert drawn[-1].camera is None
    assert drawn[-1].direction == VIEWS["back"]
    field = "?panel=distance&colormap=viridis"
    for options, name in (([], "viridis"), (["--colormap", "turbo"], "turbo")):
        run(demo_path("robot"), tmp_path / "a.png", "--address", field, *options)
        assert drawn[-1].description.legend.colormap == f"distance:{name}"


def test_addresses_are_the_panels_of_a_figure_with_the_first_camera(drawn, tmp_path):
    addresses = (
        "?panel=graph",
        "?panel=weights&camera=1,2,3,0,1,0",
        "?panel=distance&falloff=paper",
    )
    options = [word for address in addresses for word in ("--address", address)]
    options += [word for text in "ABC" for word in ("--caption", text)]
    result = run(demo_path("robot"), tmp_path / "a.pdf", *options)
    assert result.exit_code == 0, result.stderr
    titles = [panel.legend.title.split()[0] for panel in drawn[-1].panels]
    assert titles == ["Graph,", "Each", "Distance"]
    assert drawn[-1].captions == ("A", "B", "C")
    assert drawn[-1].camera == Camera((1, 2, 3), (0, 1, 0))
    assert run(demo_path("robot"), tmp_path / "a.svg").exit_code == 0
    assert not drawn[-1].panels


def test_an_address_opens_the_panel_and_the_settings_it_says(drawn, tmp_path):
    robot = cutcell.load(demo_path("robot"))
    names = robot.skeleton.names
    query = f"?panel=pose&bone={names[3]}&turns=3:0,0,40&weights_shown=dominant&falloff=paper"
    assert run(demo_path("robot"), tmp_path / "a.png", "--address", query).exit_code == 0
    assert drawn[-1].description.pose is not None
    assert "ominant" in drawn[-1].description.legend.title


def test_a_step_of_the_lesson_is_drawn(drawn, tmp_path):
    steps = built_in().steps
    step = next(k for k, one in enumerate(steps) if "weights_shown" in one.address)
    made_by_the_page = "?rig=biped&panel=weights&bone=hand.L&weights_shown=bone&step=3"
    for query, title in ((f"?step={step + 1}", "chest"), (made_by_the_page, "hand.L")):
        result = run(demo_path("biped"), tmp_path / "a.png", "--address", query)
        assert result.exit_code == 0, result.stderr
        assert title in drawn[-1].description.legend.title


@pytest.mark.parametrize(
    "options",
    [
        ("--address", "?panel=graph&kitchen=1"),
        ("--address", "?edits=abc"),
        ("--camera", "1,2,3"),
        ("--camera", "1,2,3,0,0,0", "--view", "back"),
    ],
)
def test_what_cannot_be_followed_is_refused(drawn, tmp_path, options):
    assert run(demo_path("robot"), tmp_path / "a.png", *options).exit_code == 2
    assert not drawn


def test_a_view_of_a_finding_is_seen_from_there(drawn, tmp_path):
    for view in ("front", "back"):
        options = ("--panel", "check", "--finding", "unreachable-vertices", "--view", view)
        assert run(demo_path("biped_cape"), tmp_path / "a.png", *options).exit_code == 0
        away = np.subtract(drawn[-1].camera.position, drawn[-1].camera.focal_point)
        assert np.sign(away[2]) == np.sign(VIEWS[view][2])


def test_each_flag_is_a_choice_a_setting_or_an_option_of_the_picture():
    assert CHOICES.keys() < {field.name for field in fields(Choices)}
    assert SETTINGS.keys() == READERS.keys()
    assert PICTURE.keys() == {field.name for field in fields(Picture)}


def test_an_html_file_is_an_interactive_page(tmp_path):
    cutcell.save(tmp_path / "arm.glb", arm_rig())
    rig, out = cutcell.load(tmp_path / "arm.glb"), tmp_path / "arm.html"
    bone = rig.skeleton.names[1]
    options = ["--panel", "distance", "--bone", bone, "--colormap", "viridis"]
    result = run(tmp_path / "arm.glb", out, *options)
    assert result.exit_code == 0, result.output
    page = out.read_text(encoding="utf-8")
    scenes = json.loads(unpacked(page, "scenes"))
    assert (scenes["view"], scenes["joint"]) == ("distance", 1)
    joints = len(rig.skeleton.joints)
    assert (len(scenes["weights"]), len(scenes["distance"])) == (joints + 1, joints)
    weights = cutcell.bind(rig, 16).weights
    arrays = unpacked(page, "arrays")

    def stored(part):
        kind, first, count, unit = part["$"]
        return unit * np.frombuffer(arrays, kind, count, first)

    np.testing.assert_allclose(
        stored(scenes["weights"][1]["actors"]["body"]["scalars"]), weights[:, 1], atol=1e-4
    )
    table = stored(scenes["distance"][1]["legend"]["table"])
    assert (table.reshape(-1, 3) == colormap("distance:viridis")).all()


@pytest.mark.parametrize(
    "options",
    [
        ["--clip", "1"],
        ["--turntable"],
        ["--panel", "distance", "--sweep", "wave"],
        ["--panel", "check"],
        ["--bone", "no such bone"],
        ["--colormap", "no such map"],
    ],
)
def test_an_interactive_page_refuses_what_it_does_not_follow(options, tmp_path):
    cutcell.save(tmp_path / "arm.glb", arm_rig())
    result = run(tmp_path / "arm.glb", tmp_path / "arm.html", *options)
    assert result.exit_code == 2
    assert not (tmp_path / "arm.html").exists()


@pytest.mark.slow
def test_a_lesson_is_written_as_one_file(tmp_path):
    (tmp_path / "steps.md").write_text(STEPS, encoding="utf-8")
    out = tmp_path / "lesson.html"
    source = str(tmp_path / "steps.md")
    result = CliRunner().invoke(app, ["render", "--lesson", str(out), "--lesson-from", source])
    assert result.exit_code == 0, result.output
    page = out.read_text(encoding="utf-8")
    scenes = json.loads(unpacked(page, "scenes"))
    views = scenes["records"][0]["views"]
    assert list(views) == ["ask", "show", "offer 0", *(f"alpha={a}" for a in STOPS["alpha"])]
    assert [views[name]["values"]["alpha"]["value"] for name in ("ask", "alpha=1.0")] == [0.25, 1]
    assert views["offer 0"]["pressed"] == [True]
    assert "<p>How far?</p>" in page
    assert page.count("data:image/jpeg") == 1


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (("--lesson", "lesson.png"), "--lesson lesson.html"),
        (("--lesson-from", "steps.md"), "--lesson lesson.html"),
        (("--lesson", "lesson.html", "--bone", "head"), "leave out bone"),
        (("--lesson", "lesson.html", "--lesson-from", "nowhere.md"), "nowhere.md"),
        ((), "cutcell render character.glb picture.png"),
    ],
)
def test_a_lesson_is_refused_with_what_it_does_not_follow(options, text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["render", *options])
    assert result.exit_code == 2
    assert text in " ".join(result.stderr.split())


STEPS = """---
title: Falloff
question: How far?
address: rig=rabbit&resolution=16&panel=weights&bone=chest&falloff=paper&alpha=0.25
answer: {kind: number, expected: 2, tolerance: 1}
offers: {Animation: falloff=rig}
---
α is {alpha}.
"""


def unpacked(page, name):
    """Return the bytes of an element of an interactive page."""
    content = re.search(rf'id="{name}">([^<]*)<', page).group(1)
    return gzip.decompress(base64.b64decode(content))
