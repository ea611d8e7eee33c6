"""What a person takes along from a session: the bound character, pictures, films, numbers."""

import base64
import gzip
import io
import json
import os
import re
import signal
import time
from dataclasses import fields, replace
from functools import partial

import numpy as np
import pytest

import cutcell
from cutcell_app.derive import jobs
from cutcell_app.derive.work import Work
from cutcell_app.document import loading
from cutcell_app.editing.binding import recovery as binding
from cutcell_app.features.state import PANELS, PageState
from cutcell_app.shell.export_controls import _described, page
from cutcell_app.shell.session.export import (
    export_bound,
    export_interactive,
    export_motion,
    export_numbers,
    export_picture,
    export_sweep,
    export_turntable,
)
from tests.cutcell.io.gltf.gltf_builder import COLUMN
from tests.cutcell.io.gltf.test_vrm import VRM1, avatar


def test_the_bound_character_can_be_taken_along(bound, loop, tmp_path):
    got = []
    export_bound(bound, lambda name, content: got.append((name, content)))
    loop.run_until(lambda: bool(got))
    name, content = got[0]
    assert name == "arm-bound.glb"
    path = tmp_path / name
    path.write_bytes(content)
    loaded = cutcell.load(path)
    np.testing.assert_allclose(loaded.weights, bound.state.binding.weights, atol=1e-6)


def test_the_interactive_page_begins_with_what_is_seen(bound, loop):
    bound.state.param.update(panel="graph", joint=1)
    files = []
    export_interactive(bound, page(bound.state), lambda *file: files.append(file))
    loop.run_until(lambda: bool(files))
    name, content = files[0]
    assert name == "arm.html"
    packed = re.search(rb'id="scenes">([^<]*)<', content).group(1)
    scenes = json.loads(gzip.decompress(base64.b64decode(packed)))
    assert (scenes["view"], scenes["joint"]) == ("graph", 1)


@pytest.mark.parametrize(
    ("name", "taken_as"),
    [
        ("骨" * 85, "骨" * 66 + "-bound.glb"),
        ("a/b\\c:d.glb", "cd-bound.glb"),
        ("..", "file-bound.glb"),
        ("nul\0l\ud800.obj", "null-bound.glb"),
        ("", "character-bound.glb"),
        ('<"?*|>', "file-bound.glb"),
    ],
)
def test_a_name_that_no_file_can_have_is_no_hindrance(bound, loop, name, taken_as):
    bound.state.rig = replace(bound.state.rig, name=name)
    got = []
    export_bound(bound, lambda *file: got.append(file))
    loop.run_until(lambda: bool(got))
    assert got[0][0] == taken_as
    assert got[0][1].startswith(b"glTF")


def test_an_avatar_keeps_its_ending(session, loop, tmp_path):
    path = avatar(VRM1).save(tmp_path / "avatar.glb").rename(tmp_path / "avatar.vrm")
    session.state.resolution = 16
    loading.show_rig(session, cutcell.load(path))
    loop.run_until(lambda: session.state.binding is not None)
    got = []
    export_bound(session, lambda *file: got.append(file))
    loop.run_until(lambda: bool(got))
    assert got[0][0] == "avatar-bound.vrm"
    assert got[0][1].startswith(b"glTF")


def test_nothing_to_export_is_told(session):
    export_bound(session, lambda name, content: None)
    assert session.state.message[0] == "info"


def taken(loop, act, *arguments):
    got = []
    act(*arguments, lambda name, content: got.append((name, content)))
    loop.run_until(lambda: bool(got), 60)
    return got[0]


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr("cutcell_app.shell.session.export.PICTURE_PIXELS", 160 * 120)
    monkeypatch.setattr("cutcell_app.shell.session.export.FILM_PIXELS", 64 * 48)


@pytest.fixture
def orders(monkeypatch):
    """Instead of drawing, remember what was to be drawn."""
    orders = []

    def remember(order, path, progress):
        orders.append(order)
        path.write_bytes(b"drawn")

    monkeypatch.setattr("cutcell_app.shell.session.export.draw_isolated", remember)
    return orders


def test_a_picture_is_drawn_and_leaves_no_file(bound, loop, small):
    bound.state.panel = "pose"
    name, content = taken(loop, export_picture, bound)
    assert name == "arm-pose.png"
    assert content.startswith(b"\x89PNG")
    assert list(bound.folder.iterdir()) == []


def test_pictures_show_what_is_seen_in_its_pose(bound, loop, orders):
    bound.state.panel = "pose"
    taken(loop, export_picture, bound)
    bound.state.turns = {1: (0, 0, 60)}
    taken(loop, export_picture, bound)
    bound.state.param.update(moving=True, clip=0)
    bound.view.time = 0.5
    taken(loop, export_picture, bound)
    rest, turned, halfway = (order.description.pose for order in orders)
    assert rest is None or np.allclose(rest, np.eye(4))
    assert not np.allclose(turned, np.eye(4))
    assert not np.allclose(turned, halfway)


@pytest.mark.parametrize("panel", PANELS)
def test_the_body_goes_through_a_filmed_motion_on_every_panel(bound, loop, panel, orders):
    bound.state.param.update(panel=panel, cut_axis="z")
    taken(loop, export_motion, bound, "gif")
    shown = orders[0].description
    assert any("body" in name for name in shown.actors)
    assert all(actor.skin is not None for actor in shown.actors.values())
    assert shown.cut is None
    assert orders[0].motion is not None


def test_no_motion_is_filmed_before_there_are_weights(session):
    export_motion(session, "gif", lambda name, content: None)
    assert session.state.message[0] == "info"


@pytest.mark.parametrize("what", ["front", "cut"])
def test_the_wavefront_or_the_cut_is_filmed_where_it_is_shown(bound, loop, what, orders):
    bound.state.param.update(panel="distance", cut_axis="x", wave=what == "front")
    name, _ = taken(loop, export_sweep, bound, "gif")
    assert name == "arm-distance.gif"
    scenes = orders[0].scenes
    assert len(scenes) == 120
    moved = [scene.front if what == "front" else scene.cut.origin for scene in scenes]
    assert moved[0] < moved[60] < moved[-1]
    assert scenes[0].cut is not None


def test_no_sweep_is_filmed_where_nothing_can_move(bound):
    bound.state.panel = "weights"
    export_sweep(bound, "gif", lambda name, content: pytest.fail("nothing moves"))
    assert bound.state.message[0] == "info"


def test_drawing_leaves_the_page_free_and_can_be_cancelled(bound, loop, small):
    got = []
    export_turntable(bound, "gif", lambda name, content: got.append(name))
    stages = []
    bound.state.param.watch(lambda event: stages.append(event.new), "stage")
    loop.run_until(lambda: "drawing the film" in stages)
    assert bound.state.busy
    binding.cancel(bound)
    assert not bound.state.busy
    loop.run_out()
    assert got == []


def never_ends(*given, **tables):
    time.sleep(600)


def killed(*given):
    os.kill(os.getpid(), signal.SIGKILL)


WRITERS = {
    "file": ("cutcell_app.shell.session.export.save_bound", export_bound),
    "numbers": (
        "cutcell_app.shell.session.export.save_numbers",
        partial(export_numbers, what="all"),
    ),
}


@pytest.mark.parametrize("what", WRITERS)
def test_writing_can_be_cancelled_and_others_compute_then(bound, loop, monkeypatch, what):
    writer, act = WRITERS[what]
    monkeypatch.setattr(writer, never_ends)
    monkeypatch.setattr(jobs, "PATIENCE", 3600)  # so that others run only where it has ended
    more = {"ending": "csv"} if what == "numbers" else {}
    act(bound, done=lambda name, content: pytest.fail("it never ends"), **more)
    loop.run_until(lambda: bound.state.stage.startswith("writing"))
    loop.run_for(0.2)
    binding.cancel(bound)
    assert not bound.state.busy
    got: list = []
    Work(loop, got.append).start("other", lambda progress: "computed", got.append)
    loop.run_until(lambda: got == ["computed"])
    assert list(bound.folder.iterdir()) == []


def test_a_writer_that_crashes_is_told_in_a_sentence(bound, loop, monkeypatch):
    monkeypatch.setattr("cutcell_app.shell.session.export.save_bound", killed)
    export_bound(bound, lambda name, content: pytest.fail("it crashed"))
    loop.run_until(lambda: not bound.state.busy)
    assert "Writing it came to a sudden end" in bound.state.message[1]
    assert bound.state.binding is not None


def test_numbers_are_those_that_were_computed(bound, loop):
    name, content = taken(loop, export_numbers, bound, "all", "npz")
    assert name == "arm-numbers.npz"
    with np.load(io.BytesIO(content)) as numbers:
        np.testing.assert_array_equal(numbers["weights"], bound.state.binding.weights)
        assert numbers["joint_names"].tolist() == ["shoulder", "elbow", "wrist"]
    name, content = taken(loop, export_numbers, bound, "weights", "csv")
    assert name == "arm-weights.csv"
    lines = content.decode().splitlines()
    header = next(line for line in lines if not line.startswith("#"))
    assert header == "vertex,shoulder,elbow,wrist"


def test_exported_distances_are_in_the_files_units(bound, loop):
    size = np.ptp(bound.state.rig.mesh.bounds, axis=0).max()
    assert size != pytest.approx(1)
    expected = bound.state.binding.distances.joint.T * size
    _, content = taken(loop, export_numbers, bound, "all", "npz")
    with np.load(io.BytesIO(content)) as numbers:
        np.testing.assert_allclose(numbers["distances"], expected)
    _, content = taken(loop, export_numbers, bound, "distances", "csv")
    text = io.StringIO(content.decode())
    rows = [line for line in text if not line.startswith("#")]
    table = np.genfromtxt(rows, delimiter=",", skip_header=1)
    np.testing.assert_allclose(table[:, 1:], expected, rtol=1e-6)


def test_exported_numbers_name_the_settings_that_they_were_computed_with(bound, loop):
    for chosen in ({"max_influences": 2}, {"falloff": "paper", "alpha": 0.25}):
        before = bound.state.binding
        bound.state.param.update(**chosen)
        loop.run_until(
            lambda before=before: bound.state.binding is not before and not bound.state.busy, 60
        )
        _, content = taken(loop, export_numbers, bound, "all", "npz")
        with np.load(io.BytesIO(content)) as numbers:
            settings = json.loads(str(numbers["settings"]))
        assert settings["program"] == f"cutcell {cutcell.__version__}"
        assert "file's units" in settings["lengths"]
        names = {field.name for field in fields(cutcell.Method)}
        assert names <= set(settings)
        assert settings["resolution"] == bound.state.resolution
        assert settings["max_influences"] == 2
        assert {name: settings[name] for name in chosen} == chosen
        _, content = taken(loop, export_numbers, bound, "weights", "csv")
        assert f"# falloff: {settings['falloff']}" in content.decode().splitlines()


def test_numbers_that_are_not_there_yet_are_told(session):
    export_numbers(session, "all", "npz", lambda name, content: None)
    assert session.state.message[0] == "info"


def test_a_machine_that_cannot_draw_is_told_so(bound, loop, small, monkeypatch):
    got = []
    monkeypatch.setattr("cutcell_viewers.process.sys.executable", "false")
    monkeypatch.setattr("cutcell_viewers.process._can_draw", lambda: False)
    export_picture(bound, lambda name, content: got.append(name))
    loop.run_until(lambda: bound.state.message is not None)
    assert "no OpenGL" in bound.state.message[1]
    assert got == []
    assert bound.state.binding is not None


def test_the_panel_says_whether_colours_come_along(tmp_path, demo_paths):
    def said(path):
        rig = cutcell.load(path)
        return _described(PageState(own=rig, rig=rig))

    assert "Only weights" in said(demo_paths[0])
    path = tmp_path / "column.obj"
    path.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in COLUMN) + "f 1 2 3\nf 2 3 4\n")
    assert "no materials" in said(path)
    colors = "".join(f"v {x} {y} {z} {x} {y} 0\n" for x, y, z in COLUMN)
    path.write_text(colors + "f 1 2 3\nf 2 3 4\n")
    assert "base colours" in said(path)
