"""A session without a browser: loading, binding, failing, cancelling."""

import os
import shutil
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import param
import pytest

import cutcell
from cutcell.errors import MeshError
from cutcell_app.document import loading, look
from cutcell_app.editing.binding import recovery as binding
from cutcell_app.editing.binding import results
from cutcell_app.features import scenes
from cutcell_app.features.state import PANELS
from cutcell_app.shell.session import keys
from cutcell_app.shell.session.begin import begin
from cutcell_app.shell.status import stage_text, summary, warning
from cutcell_viewers.character import drawn_segments
from cutcell_viewers.description import Actor
from tests.viewers.arm import arm_rig


def test_a_demo_stands_there_first_and_is_bound_then(session, loop):
    seen = []
    session.state.param.watch(lambda e: seen.append(e.name), ["rig", "binding"])
    loading.load_demo(session, "robot")
    assert session.state.busy
    loop.run_until(lambda: session.state.binding is not None)
    assert [name for name in seen if name == "rig"] == ["rig"]
    assert seen[-1] == "binding"
    assert not session.state.busy
    assert session.state.demo == "robot"
    assert warning(session.state)[0] == "warning"  # its ring is reached by no bone
    assert "52" in summary(session.state) or "joints" in summary(session.state)


def test_another_resolution_binds_again(bound, loop):
    before = bound.state.binding
    bound.state.resolution = 20
    bound.state.resolution = 24  # a moment later: only the last one is built
    loop.run_until(lambda: bound.state.busy)
    loop.run_until(lambda: bound.state.binding is not before)
    assert bound.state.binding.graph.lattice.resolution == 24


@pytest.mark.parametrize("resolution", [1, 10_000])
def test_an_impossible_resolution_is_told_and_changes_nothing(bound, loop, resolution):
    before = bound.state.binding
    bound.state.resolution = resolution
    loop.run_until(lambda: bound.state.message is not None)
    severity, text = bound.state.message
    assert severity == "error"
    assert "resolution" in text.lower()
    assert bound.state.binding is before
    assert not bound.state.busy
    assert bound.state.resolution == 16, "what is shown is what is there"
    assert not bound.history.can_undo


def test_an_impossible_resolution_of_an_address_gives_way_to_what_is_possible(session, loop):
    session.state.resolution = 10_000
    loading.show_rig(session, arm_rig())
    loop.run_until(lambda: session.state.binding is not None)
    assert session.state.binding.graph.lattice.resolution == session.state.resolution == 64
    assert "resolution" in session.state.message[1].lower()


def test_what_fails_with_the_defaults_is_not_tried_again(session, loop, monkeypatch):
    tried = []

    def broken(*args, **kwargs):
        tried.append(1)
        raise MeshError("no room")

    monkeypatch.setattr(results, "bind_wide", broken)
    loading.show_rig(session, arm_rig())
    loop.run_until(lambda: session.state.message is not None)
    loop.rest(session)
    assert len(tried) == 1


def test_a_cancelled_resolution_gives_way_to_the_one_that_is_there(bound, loop):
    bound.state.resolution = 24
    loop.run_until(lambda: bound.state.busy)
    binding.cancel(bound)
    assert bound.state.resolution == 16
    loop.rest(bound)
    assert bound.state.binding.graph.lattice.resolution == 16


def test_a_bad_file_is_told_and_the_old_character_stays(bound, loop, tmp_path):
    before = bound.state.rig
    bad = tmp_path / "bad.glb"
    bad.write_text("this is a text file")
    loading.load_files(bound, [bad])
    loop.run_until(lambda: bound.state.message is not None)
    assert "bad.glb" in bound.state.message[1]
    assert bound.state.rig is before
    assert bound.state.binding is not None


def test_files_without_a_character_are_told(bound, tmp_path):
    loading.load_files(bound, [tmp_path / "notes.txt"])
    assert "notes.txt" in bound.state.message[1]


def test_unexpected_errors_are_told_kindly_and_logged(bound, loop, monkeypatch, caplog):
    def broken(*args, **kwargs):
        raise RuntimeError("the sky fell")

    monkeypatch.setattr(results, "bind_wide", broken)
    bound.state.leaf = "point"
    loop.run_until(lambda: bound.state.message is not None)
    assert "Unexpected" in bound.state.message[1]
    assert "the sky fell" in caplog.text


def test_what_goes_wrong_on_the_pages_own_thread_is_told_too(session, loop):
    session.work.later(lambda: [].pop())
    loop.run_until(lambda: session.state.message is not None)
    assert "Unexpected" in session.state.message[1]


def test_cancelling_keeps_what_was_there(bound, loop, monkeypatch):
    def endless(*inputs):
        while True:
            inputs[-1]("graph", 0.5)

    monkeypatch.setattr(results, "bind_wide", endless)
    before = bound.state.binding
    bound.state.leaf = "point"
    loop.run_until(lambda: bound.state.stage == "graph")
    binding.cancel(bound)
    assert not bound.state.busy
    assert bound.state.binding is before
    assert bound.state.message[0] == "info"
    bound.state.message = None
    binding.cancel(bound)
    assert bound.state.message is None


def test_another_character_supersedes_a_running_computation(bound, loop, monkeypatch):
    real = results.bind_wide

    def slow(rig, *inputs):
        while rig is not other:
            inputs[-1]("graph", 0.5)
        return real(rig, *inputs)

    monkeypatch.setattr(results, "bind_wide", slow)
    other = arm_rig()
    bound.state.leaf = "point"
    loop.run_until(lambda: bound.state.stage == "graph")
    loading.show_rig(bound, other)
    loop.run_until(lambda: bound.state.binding is not None)
    assert bound.state.rig is other
    assert len(bound.state.binding.weights) == len(other.mesh.vertices)


def test_picking_a_bone_shows_its_weights(bound):
    look.pick(bound, 2)
    assert (bound.state.joint, bound.state.weights_shown) == (2, "bone")
    look.pick(bound, 99)
    assert bound.state.joint == 2


def test_the_field_is_fetched_when_it_is_wanted(bound, loop):
    bound.state.param.update(panel="distance", cut_axis="x", joint=1)
    loop.run_until(lambda: bound.state.field is not None)
    np.testing.assert_array_equal(bound.state.field, bound.state.binding.distances.field(1))


def test_a_new_character_starts_at_rest(bound, loop):
    bound.state.param.update(turns={1: (0, 0, 60)}, moving=True, playing=True)
    loading.show_rig(bound, arm_rig())
    assert not bound.state.posed
    assert bound.state.clip == 0
    loop.run_until(lambda: bound.state.binding is not None)


def test_the_end_of_a_session_leaves_nothing_behind(loop):
    session = begin(loop)
    folder = session.folder
    (folder / "upload").mkdir()
    (folder / "upload" / "a.glb").write_bytes(b"1")
    loading.show_rig(session, arm_rig())
    session.close()
    assert not folder.exists()
    session.close()


def test_two_sessions_share_nothing_that_changes(loop):
    one, other = begin(loop), begin(loop)
    try:
        assert one.folder != other.folder
        one.state.param.update(resolution=16, turns={0: (1, 2, 3)})
        assert other.state.resolution == 64
        assert other.state.turns == {}
        loading.show_rig(one, arm_rig())
        assert other.state.rig is None
    finally:
        one.close()
        other.close()


def test_real_characters_open(session, loop, rigs):
    path = next(path for path in rigs if path.stem == "khronos_CesiumMan")
    copy = session.folder / path.name
    shutil.copy(path, copy)
    loading.load_files(session, [Path(copy)])
    loop.run_until(lambda: session.state.binding is not None)
    np.testing.assert_allclose(session.state.binding.weights.sum(axis=1), 1, atol=1e-6)


def test_what_was_odd_about_the_file_is_told(bound):
    bound.state.rig = replace(bound.state.rig, warnings=("two weights are odd",))
    assert warning(bound.state) == ("warning", "Two weights are odd.")


def test_methods_are_compared_one_after_the_other_and_one_that_fails_stops_none(
    bound, loop, monkeypatch
):
    from cutcell_app.features.compare.results import cancel
    from cutcell_lab.baselines import METHODS, BaselineBinding

    def fails(rig):
        return BaselineBinding(None, failed="it cannot")

    def breaks(rig):
        raise ZeroDivisionError("oops")

    monkeypatch.setitem(METHODS, "fails", fails)
    monkeypatch.setitem(METHODS, "breaks", breaks)
    state = bound.state
    state.param.update(panel="compare", methods=["now", "fails", "breaks", "euclidean"])
    loop.run_until(lambda: len(state.compared) == 4 and not state.computing, 60)
    assert state.compared["fails"].failed == "it cannot"
    assert "oops" in state.compared["breaks"].failed
    assert state.compared["euclidean"].weights.shape == state.rig.weights.shape
    before = state.compared["now"]
    state.leaf = "point"
    loop.run_until(lambda: state.compared.get("now", before) is not before, 60)
    state.param.update(methods=["now", "voxel"])
    cancel(bound)
    assert ("compared", "voxel") not in state.computing
    assert "voxel" not in state.methods
    loading.show_rig(bound, arm_rig())
    assert state.compared == {}
    loop.run_until(lambda: state.binding is not None)


@pytest.mark.parametrize("falloff", cutcell.method.FALLOFFS)
def test_another_falloff_changes_weights_and_measures_nothing(bound, loop, falloff):
    state = bound.state
    state.falloff = falloff
    loop.run_until(lambda: not state.busy)  # the paper's asks for more joints at first
    before = state.binding
    state.param.update(alpha=0.9, max_influences=2, threshold=0.1)
    loop.run_until(lambda: not state.busy)
    assert state.binding.distances is before.distances
    chosen = {"falloff": falloff, **({"alpha": 0.9} if falloff == "paper" else {})}
    expected = cutcell.weights.skinning_weights(
        before.distances, max_influences=2, threshold=0.1, **chosen
    )
    np.testing.assert_allclose(state.binding.weights, expected, atol=1e-9)
    assert (state.binding.weights > 0).sum(axis=1).max() <= 2


def test_what_is_bound_is_what_the_command_binds(bound):
    state = bound.state
    expected = cutcell.bind(state.rig, 16)
    np.testing.assert_allclose(state.binding.weights, expected.weights, atol=1e-9)


def test_a_falloff_chosen_while_distances_are_measured_counts(session, loop):
    session.state.resolution = 16
    loading.show_rig(session, arm_rig())
    session.state.param.update(max_influences=1, falloff="paper")
    loop.run_until(lambda: session.state.binding is not None and not session.state.busy)
    distances = session.state.binding.distances
    expected = cutcell.weights.skinning_weights(distances, falloff="paper", max_influences=1)
    np.testing.assert_allclose(session.state.binding.weights, expected, atol=1e-9)


def test_a_vertex_is_chosen_and_forgotten_with_its_character(bound, loop):
    look.pick_vertex(bound, 3)
    assert bound.state.vertex == 3
    look.pick_vertex(bound, 10**6)
    assert bound.state.vertex == 3
    loading.show_rig(bound, arm_rig())
    assert bound.state.vertex is None
    look.pick_vertex(bound, 1)
    look.pick_vertex(bound, None)
    assert bound.state.vertex is None


def test_the_wave_is_told_once_and_not_frame_by_frame(bound, loop):
    reports, view = [], bound.view
    send, present = view.send, view.present
    view.send = lambda **parts: reports.append(parts) or send(**parts)
    view.present = lambda scene, **parts: reports.append(parts) or present(scene, **parts)
    bound.state.panel = "distance"
    loop.run_until(lambda: bound.state.field is not None)
    bound.state.param.update(wave=True, animating=True)
    films = [parts["animation"] for parts in reports if "animation" in parts]
    assert len(films) == 1
    assert films[0]["end"] > 0
    bound.state.front = 0.5
    assert [parts["animation"] for parts in reports if "animation" in parts] == films


def test_what_is_told_reads_well(session):
    assert stage_text("graph") == "Building the graph"
    assert stage_text("loading a.glb") == "Loading a.glb"
    assert stage_text("") == "Starting"
    assert summary(session.state) == ""
    assert warning(session.state) is None


def test_a_large_character_is_described_beside_the_pages_own_thread(session, loop, monkeypatch):
    monkeypatch.setattr("cutcell_app.document.state.QUICK_MESH", 10)
    threads, described = [], []
    resolve = scenes.resolve

    def noted(state):
        if state.rig is not None:
            threads.append(threading.current_thread())
        return resolve(state)

    monkeypatch.setattr("cutcell_app.shell.session.view_parts.resolve", noted)
    monkeypatch.setattr(session.view, "present", lambda scene, **parts: described.append(scene))
    session.state.resolution = 16
    loading.show_rig(session, arm_rig())
    loop.run_until(lambda: session.state.binding is not None)
    for panel in ("graph", "pose", "weights"):
        session.state.panel = panel
    session.state.falloff = "paper"
    loop.rest(session)
    session.state.alpha = 0.25
    loop.rest(session)
    assert threading.current_thread() not in threads
    assert described[-1].actors.keys() == resolve(session.state).actors.keys()
    expected = resolve(session.state).actors["body"].colors
    np.testing.assert_array_equal(described[-1].actors["body"].colors, expected)
    paper = cutcell.bind(arm_rig(), 16, falloff="paper", alpha=0.25, leaf="fit")
    np.testing.assert_allclose(session.state.binding.weights, paper.weights, atol=1e-6)


def test_a_character_of_many_joints_is_large(session):
    mesh, state = arm_rig().mesh, session.state
    for count, quick in ((3, True), (20_000, False)):
        joints, parents = np.zeros((count, 3)), np.arange(-1, count - 1)
        skeleton = cutcell.Skeleton(joints, parents, tuple(map(str, range(count))))
        with param.parameterized.discard_events(state):
            state.rig = cutcell.Rig(mesh, skeleton)
        assert state.quick == quick


def test_reading_that_does_not_come_to_an_end_is_cancelled(session, loop, tmp_path):
    pipe = tmp_path / "pipe.glb"
    os.mkfifo(pipe)  # whoever reads it waits for someone who writes
    loading.load_files(session, [pipe])
    loop.run_until(lambda: session.state.stage == "loading pipe.glb")
    loop.run_for(0.2)
    binding.cancel(session)
    assert "Cancelled" in session.state.message[1]
    session.state.resolution = 16
    loading.show_rig(session, arm_rig())
    loop.run_until(lambda: session.state.binding is not None)


def test_running_out_of_memory_is_a_sentence_and_the_page_goes_on(bound, loop, monkeypatch):
    before = bound.state.binding

    def too_much(*args, **kwargs):
        raise MemoryError("Unable to allocate 44.0 GiB for an array")

    with monkeypatch.context() as patch:
        patch.setattr(results, "bind_wide", too_much)
        bound.state.resolution = 24
        loop.run_until(lambda: bound.state.message is not None)
    assert "Not enough memory" in bound.state.message[1]
    assert bound.state.binding is before
    bound.state.resolution = 20
    loop.run_until(lambda: bound.state.binding is not before)


def test_a_falloff_that_asks_for_more_joints_measures_them(bound, loop):
    bound.state.falloff = "paper"
    loop.rest(bound)
    assert bound.state.message is None
    expected = cutcell.bind(arm_rig(), 16, falloff="paper", leaf="fit").weights
    np.testing.assert_allclose(bound.state.binding.weights, expected, atol=1e-6)
    before = bound.state.binding.distances
    bound.state.max_influences = 8
    loop.rest(bound)
    assert bound.state.binding.distances is before


def test_an_error_that_nobody_looks_at_is_measured_no_longer(session, loop, monkeypatch):
    begun = threading.Event()

    def measured(rig, ours, theirs, progress):
        begun.set()
        while True:
            progress("deformation", 0.0)

    monkeypatch.setattr("cutcell_app.features.pose.results.scene_error", measured)
    session.state.param.update(resolution=16, panel="pose")
    loading.show_rig(session, arm_rig())
    loop.run_until(begun.is_set)
    session.state.panel = "weights"
    assert ("errors",) not in session.state.computing
    session.state.panel = "pose"
    assert ("errors",) in session.state.computing


def test_a_key_frames_the_chosen_bone(bound):
    bound.state.joint = 0
    keys.act(bound, "frame")
    camera, (start, end, joint) = bound.view.camera, drawn_segments(bound.state.rig)
    middle = np.concatenate([start[joint == 1], end[joint == 1]]).mean(axis=0)
    bound.state.joint = 1
    keys.act(bound, "frame")
    np.testing.assert_allclose(bound.view.camera.focal_point, middle, atol=1e-9)
    assert bound.view.camera != camera
    away = np.subtract(bound.view.camera.position, middle)
    before = np.subtract(camera.position, camera.focal_point)
    np.testing.assert_allclose(away / np.linalg.norm(away), before / np.linalg.norm(before))


def test_meshes_of_the_server_are_shown_with_every_character(bound):
    points, cells = np.zeros((1, 3), np.float32), np.zeros((1, 1), np.int32)
    sensor = Actor("points", points, cells)
    bound.state.actors = {"sensor": sensor}
    for panel in PANELS:
        if panel != "pairs":
            bound.state.panel = panel
            assert scenes.resolve(bound.state).actors["sensor"] is sensor
