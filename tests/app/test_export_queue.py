"""Exports while something else is computed: none stops the other, and none holds old weights."""

import base64
import gzip
import io
import json
import re
import threading
from functools import partial

import numpy as np
import pytest

import cutcell
from cutcell.binding import bind
from cutcell.errors import MeshError
from cutcell_app.document import loading
from cutcell_app.editing.binding import recovery as binding
from cutcell_app.editing.binding import results
from cutcell_app.editing.correct import commands as correct
from cutcell_app.features.check import results as check
from cutcell_app.shell.export_controls import page
from cutcell_app.shell.session import export
from tests.viewers.arm import arm_rig


class Gate:
    """Work that waits until it is let go on, or is cancelled."""

    def __init__(self):
        self.open = threading.Event()
        self.failure = None

    def wait(self, progress):
        while not self.open.wait(0.02):
            progress("graph", 0.5)
        if self.failure:
            raise self.failure


@pytest.fixture
def slow(bound, monkeypatch):
    """Let bindings wait at a gate."""
    gate = Gate()

    def late(*inputs):
        gate.wait(inputs[-1])
        return real(*inputs)

    real = results.bind_wide
    monkeypatch.setattr(results, "bind_wide", late)
    yield gate
    gate.open.set()


def bound_with(session, resolution):
    """Return the weights that the page's settings mean."""
    state = session.state
    return bind(state.rig, resolution, edits=state.edits).weights


def read(tmp_path, content):
    """Return the weights in an exported GLB, and the settings that it names."""
    path = tmp_path / "exported.glb"
    path.write_bytes(content)
    length = int.from_bytes(content[12:16], "little")
    document = json.loads(content[20 : 20 + length])
    return cutcell.load(path).weights, document["asset"]["extras"]["cutcell"]


def test_an_export_waits_for_the_binding_that_runs(bound, slow, loop, tmp_path):
    files = []
    bound.state.resolution = 24
    loop.run_until(lambda: bound.state.stage == "graph")
    export.export_bound(bound, lambda *file: files.append(file))
    assert bound.state.exporting
    loop.run_for(0.3)
    assert (bound.state.busy, files) == (True, [])
    slow.open.set()
    loop.run_until(lambda: files)
    assert bound.state.binding.graph.lattice.resolution == 24
    weights, settings = read(tmp_path, files[0][1])
    np.testing.assert_allclose(weights, bound_with(bound, 24), atol=1e-6)
    assert settings["resolution"] == 24
    loop.run_until(lambda: not bound.state.busy)
    assert not bound.state.exporting


def test_an_export_right_after_a_choice_holds_it(bound, loop, tmp_path):
    before = bound.state.binding.weights
    bound.state.resolution = 24
    files = []
    export.export_bound(bound, lambda *file: files.append(file))
    assert bound.state.busy
    loop.run_until(lambda: files)
    weights, settings = read(tmp_path, files[0][1])
    assert settings["resolution"] == 24
    assert np.abs(weights - before).max() > 0.01
    bound.state.falloff = "paper"
    export.export_bound(bound, lambda *file: files.append(file))
    loop.run_until(lambda: len(files) == 2)
    weights, settings = read(tmp_path, files[1][1])
    assert settings["falloff"] == "paper"
    np.testing.assert_allclose(weights, bound.state.binding.weights, atol=1e-6)


def test_a_joint_that_is_switched_on_as_an_export_begins_carries_weight(bound, loop, tmp_path):
    correct.correct_joint(bound, 1, deform=False)
    loop.run_until(lambda: not bound.state.binding.weights[:, 1].any())
    correct.correct_joint(bound, 1, deform=True)
    files = []
    export.export_bound(bound, lambda *file: files.append(file))
    loop.run_until(lambda: files)
    assert bound.state.binding.weights[:, 1].any()
    assert read(tmp_path, files[0][1])[0][:, 1].any()


def test_a_choice_changed_while_an_export_waits_counts(bound, slow, loop, tmp_path):
    files = []
    bound.state.resolution = 24
    loop.run_until(lambda: bound.state.stage == "graph")
    export.export_bound(bound, lambda *file: files.append(file))
    bound.state.resolution = 20
    loop.run_for(0.5)
    slow.open.set()
    loop.run_until(lambda: files)
    assert read(tmp_path, files[0][1])[1]["resolution"] == 20
    loop.rest(bound)
    assert len(files) == 1


def test_a_choice_taken_back_lets_the_export_go(bound, loop, tmp_path):
    files = []
    bound.state.resolution = 24
    export.export_bound(bound, lambda *file: files.append(file))
    bound.state.resolution = 16
    loop.run_until(lambda: files)
    assert read(tmp_path, files[0][1])[1]["resolution"] == 16


def test_a_slider_stops_no_export_and_no_export_stops_another(bound, loop, monkeypatch, tmp_path):
    gate, files = Gate(), []

    def drawn(order, path, progress):
        gate.wait(progress)
        path.write_bytes(b"drawn")

    monkeypatch.setattr(export, "draw_isolated", drawn)
    export.export_turntable(bound, "gif", lambda *file: files.append(file))
    loop.run_until(lambda: bound.state.stage == "drawing the film")
    export.export_bound(bound, lambda *file: files.append(file))
    before = bound.state.binding
    bound.state.resolution = 24
    loop.run_until(lambda: bound.state.binding is not before)
    assert files == []
    assert bound.state.stage == "drawing the film"
    gate.open.set()
    loop.run_until(lambda: len(files) == 2)
    assert files[0][1] == b"drawn"
    assert read(tmp_path, files[1][1])[1]["resolution"] == 24


def test_a_film_goes_on_while_another_character_is_opened(bound, loop, monkeypatch):
    gate, files = Gate(), []

    def drawn(order, path, progress):
        gate.wait(progress)
        path.write_bytes(b"drawn")

    monkeypatch.setattr(export, "draw_isolated", drawn)
    export.export_turntable(bound, "gif", lambda *file: files.append(file))
    loop.run_until(lambda: bound.state.stage == "drawing the film")
    loading.show_rig(bound, arm_rig())
    loop.run_until(lambda: bound.state.binding is not None)
    gate.open.set()
    loop.run_until(lambda: files)


@pytest.mark.parametrize("how", ["fails", "cancelled", "another"])
def test_where_no_weights_come_nothing_is_exported_and_that_is_said(bound, slow, loop, how):
    bound.state.resolution = 24
    loop.run_until(lambda: bound.state.stage == "graph")
    export.export_bound(bound, lambda *file: pytest.fail("there are no such weights"))
    if how == "fails":
        slow.failure = MeshError("the mesh is broken")
        slow.open.set()
    elif how == "cancelled":
        binding.cancel(bound)
    else:
        loading.show_rig(bound, arm_rig())
        slow.open.set()
    loop.run_until(lambda: bound.state.message is not None)
    assert "othing was exported" in bound.state.message[1]
    loop.rest(bound)
    if how != "another":
        assert bound.state.resolution == 16, "what is chosen is what is there"


@pytest.mark.parametrize("other", ["file", "repair"])
def test_other_work_that_fails_ends_no_binding(bound, slow, loop, tmp_path, monkeypatch, other):
    bound.state.resolution = 24
    loop.run_until(lambda: bound.state.stage == "graph")
    if other == "file":
        path = tmp_path / "bad.glb"
        path.write_bytes(b"no character")
        loading.load_files(bound, [path])
    else:

        class Broken:
            def repaired(self, codes):
                raise MeshError("it cannot be repaired")

        bound.state.diagnosis = Broken()
        check.repair(bound, ["inverted-faces"])
    loop.run_until(lambda: bound.state.message is not None)
    slow.open.set()
    loop.run_until(lambda: not bound.state.busy)
    assert bound.state.binding.graph.lattice.resolution == bound.state.resolution == 24


def test_cancelled_weights_of_another_falloff_choose_the_one_that_is_there(
    bound, loop, monkeypatch
):
    gate = Gate()

    def late(*inputs):
        gate.open.wait(60)
        return bound.state.bound

    monkeypatch.setattr(results, "bind_wide", late)
    before = bound.state.falloff
    bound.state.falloff = "paper"
    assert bound.state.busy
    binding.cancel(bound)
    gate.open.set()
    assert bound.state.falloff == before
    assert binding.is_current(bound)


EXPORTS = {
    "npz": partial(export.export_numbers, what="all", ending="npz"),
    "csv": partial(export.export_numbers, what="weights", ending="csv"),
    "graph": partial(export.export_graph, ending="npz"),
}


@pytest.mark.parametrize("what", [*EXPORTS, "html"])
def test_every_file_of_numbers_waits_and_names_its_settings(bound, slow, loop, what):
    files = []
    bound.state.resolution = 24
    loop.run_until(lambda: bound.state.stage == "graph")
    taken = {"done": lambda *file: files.append(file)}
    if what == "html":
        export.export_interactive(bound, page(bound.state), **taken)
    else:
        EXPORTS[what](bound, **taken)
    slow.open.set()
    loop.run_until(lambda: files)
    content = files[0][1]
    if what == "csv":
        assert b"# resolution: 24\r\n" in content
    elif what == "html":
        packed = re.search(rb'id="scenes">([^<]*)<', content).group(1)
        settings = json.loads(gzip.decompress(base64.b64decode(packed)))["settings"]
        assert settings["resolution"] == 24
    else:
        with np.load(io.BytesIO(content)) as numbers:
            assert json.loads(str(numbers["settings"]))["resolution"] == 24


def test_settings_of_a_file_leave_with_its_weights(bound, loop, tmp_path):
    files = []
    export.export_bound(bound, lambda *file: files.append(file))
    loop.run_until(lambda: files)
    read(tmp_path, files[0][1])
    again = cutcell.load(tmp_path / "exported.glb")
    path = tmp_path / "again.glb"
    cutcell.save(path, again.with_weights(np.roll(again.weights, 1, axis=0)))
    assert b'"resolution"' not in path.read_bytes()
