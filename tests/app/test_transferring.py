"""Clothes dropped beside the open character: opened with its weights as a layer, or refused."""

import shlex
from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import Edits, Painted, Rig, Skeleton, TriangleMesh
from cutcell.editing.transfer import matching
from cutcell_app.document import loading, opening
from cutcell_app.editing.binding import recovery
from cutcell_app.editing.layers.commands import set_layer
from cutcell_app.editing.select.saved import take
from cutcell_app.editing.transfer.controls import transfer_to
from cutcell_app.features.scenes import resolve
from cutcell_app.features.weights import controls
from cutcell_app.shell.export_code import copy_command, copy_script
from cutcell_app.shell.session import keys
from cutcell_app.shell.session.export import export_bound
from cutcell_viewers.palette import UNREACHED, to_bytes
from cutcell_viewers.weights_scene import selections_colors
from tests.app.loop import settled
from tests.cutcell.cli.conftest import run
from tests.cutcell.cli.files import write_obj
from tests.viewers.arm import WORLD, arm_rig

__all__ = ["run"]


@pytest.fixture
def dressing(session, loop, monkeypatch):
    """Show an arm that its key opens again."""
    arm = arm_rig()
    monkeypatch.setattr(opening, "demo_rig", lambda id: arm)
    monkeypatch.setattr(matching, "RESOLUTION", 16)
    session.state.param.update(resolution=16, graph_resolution=0, panel="weights")
    loading.load_demo(session, "robot")
    settled(session, loop)
    return session


def sleeve(high=0.0, z=0.0):
    """Return a sleeve around the arm in the scene, with its upper end lifted; y is up there."""
    arm = arm_rig().mesh
    points = arm.vertices * [0.9, 1.05, 1.05]
    points = points @ WORLD[:3, :3].T + [0, 0, z]
    points[:, 1] += np.where(points[:, 0] > 0.8, high, 0.0)
    return TriangleMesh(points, arm.faces)


def written(path, mesh):
    """Write a mesh as OBJ."""
    return write_obj(path, mesh.vertices.tolist(), mesh.faces.tolist())


def drop(session, loop, *paths):
    """Send files as the browser does, and wait."""
    files = [{"name": path.name, "size": path.stat().st_size} for path in paths]
    receiver = loading.receiver(session, transfer_to)
    receiver.answer({"type": "upload-begin", "files": files})
    for index, path in enumerate(paths):
        receiver.answer({"type": "upload-piece", "index": index, "data": path.read_bytes()})
    assert receiver.answer({"type": "upload-end"}) == {"ok": True}
    loop.rest(session)


def test_a_sleeve_opens_with_the_weights_as_a_layer(dressing, loop, tmp_path):
    state, source = dressing.state, dressing.state.rig.with_weights(dressing.state.weights)
    mesh = sleeve(high=2.0)
    drop(dressing, loop, written(tmp_path / "sleeve.obj", mesh))
    expected = cutcell.transfer(source, Rig(mesh, Skeleton([], [])))
    assert set(expected.state.tolist()) == {0, 1}
    np.testing.assert_allclose(state.weights, expected.weights, atol=1e-5)  # of rounded corners
    assert state.rig.skeleton.names == source.skeleton.names
    (layer,) = state.edits.layers
    assert layer.title == "Transferred from arm"
    assert isinstance(layer.content, Painted)
    assert state.layer == 0
    assert state.message[0] == "info"
    legend = resolve(state).legend
    counts = {"Matched": expected.report["matched"], "In-painted": expected.report["in-painted"]}
    texts = [text for _, text in legend.swatches]
    assert texts == [f"{name}: {number:,}" for name, number in counts.items()]
    colors, reading = (getattr(resolve(state).actors["body"], n) for n in ("colors", "reading"))
    for number in (0, 1):
        assert len(np.unique(colors[expected.state == number], axis=0)) == 1
    np.testing.assert_array_equal(reading.values, expected.state + 1)
    take(dressing, "In-painted")
    np.testing.assert_array_equal(state.brush_selection.chosen, expected.state == 1)


def test_its_layer_fades_is_undone_and_exported(dressing, loop, tmp_path):
    state, body = dressing.state, dressing.state.own
    drop(dressing, loop, written(tmp_path / "sleeve.obj", sleeve()))
    weights, mesh = state.weights, state.rig.mesh
    files = []
    export_bound(dressing, lambda *file: files.append(file))
    loop.rest(dressing)
    (name, content), path = files[0], tmp_path / "again.glb"
    assert name == "sleeve-bound.glb"
    path.write_bytes(content)
    np.testing.assert_allclose(cutcell.load(path).weights, weights, atol=1e-6)
    assert Edits.from_json(state.edits.to_json()) == state.edits
    state.message = None
    set_layer(dressing, 0, opacity=0.5)
    settled(dressing, loop)
    assert np.abs(state.weights - weights).max() > 0.01, "it blends with the computed weights"
    keys.act(dressing, "undo")
    settled(dressing, loop)
    np.testing.assert_array_equal(state.weights, weights)
    keys.act(dressing, "undo")
    settled(dressing, loop)
    assert state.own is body
    assert state.weights_shown == "mix"
    keys.act(dressing, "redo")
    settled(dressing, loop)
    np.testing.assert_array_equal(state.weights, weights)
    np.testing.assert_array_equal(state.rig.mesh.vertices, mesh.vertices)


def test_a_rig_keeps_its_joints_and_its_weights_below_the_layer(dressing, loop, tmp_path):
    own, path = arm_rig(), tmp_path / "dressed.glb"
    weights = np.tile([0.0, 1.0, 0.0], (len(own.weights), 1))
    cutcell.save(path, replace(own, weights=weights, clips=(), attachments=()))
    source = dressing.state.weights
    drop(dressing, loop, path)
    state = dressing.state
    np.testing.assert_allclose(state.weights, source, atol=1e-5)
    assert state.edits.base == "file"
    state.message = None
    set_layer(dressing, 0, on=False)
    settled(dressing, loop)
    np.testing.assert_allclose(state.weights, weights)


def test_another_transfer_adds_a_layer_and_renews_the_selections(dressing, loop, tmp_path):
    drop(dressing, loop, written(tmp_path / "sleeve.obj", sleeve(high=2.0)))
    state, files = dressing.state, []
    assert set(state.edits.selections) == {"Matched", "In-painted"}
    export_bound(dressing, lambda *file: files.append(file))
    loop.rest(dressing)
    (tmp_path / "again.glb").write_bytes(files[0][1])
    state.transfer_distance = 30.0
    drop(dressing, loop, tmp_path / "again.glb")
    assert [layer.title for layer in state.edits.layers] == [
        "Transferred from arm", "Transferred from sleeve",
    ]  # fmt: skip
    assert set(state.edits.selections) == {"Matched"}
    assert state.layer == 1


def test_copied_code_comes_with_the_files_that_it_reads(dressing, loop, tmp_path, monkeypatch, run):
    copied = []

    def save(name, content):
        (tmp_path / name).write_bytes(content)

    monkeypatch.setattr(dressing.view, "offer", save)
    monkeypatch.setattr(dressing.view, "answer", lambda copy: copied.append(copy["text"]))
    monkeypatch.chdir(tmp_path)
    drop(dressing, loop, written(tmp_path / "sleeve.obj", sleeve()))
    out = tmp_path / "sleeve-bound.glb"
    copy_command(dressing)
    result = run(*shlex.split(copied[-1])[1:])
    assert result.exit_code == 0, result.stderr
    np.testing.assert_allclose(cutcell.load(out).weights, dressing.state.weights, atol=1e-6)
    copy_script(dressing)
    exec(copied[-1], {})
    np.testing.assert_allclose(cutcell.load(out).weights, dressing.state.weights, atol=1e-6)


@pytest.mark.parametrize(
    ("name", "content", "text"),
    [
        ("skin.png", b"\x89PNG", "skin.png"),
        ("empty.obj", b"# nothing\n", "empty.obj"),
        ("broken.glb", b"this is a text file", "broken.glb"),
    ],
)
def test_what_is_no_mesh_is_refused_and_changes_nothing(
    dressing, loop, tmp_path, name, content, text
):
    before = dressing.state.own, dressing.state.edits, len(dressing.history)
    (tmp_path / name).write_bytes(content)
    drop(dressing, loop, tmp_path / name)
    severity, message = dressing.state.message
    assert severity == "error"
    assert text in message
    assert (dressing.state.own, dressing.state.edits, len(dressing.history)) == before
    assert not dressing.state.busy


def test_a_mesh_that_is_far_away_is_refused_and_removed(dressing, loop, tmp_path):
    before = set(dressing.uploads.cache._groups)
    drop(dressing, loop, written(tmp_path / "hat.obj", sleeve(z=5.0)))
    severity, message = dressing.state.message
    assert severity == "error"
    assert "hat.obj" in message
    assert "arm.glb" in message
    assert set(dressing.uploads.cache._groups) == before


def test_a_cancelled_transfer_leaves_the_character(dressing, loop, tmp_path):
    own, before = dressing.state.own, set(dressing.uploads.cache._groups)
    path = written(tmp_path / "sleeve.obj", sleeve())
    group = dressing.uploads.cache.begin(path.stat().st_size, dressing.uploads)
    group.paths = [path]
    transfer_to(dressing, group)
    assert dressing.state.busy
    recovery.cancel(dressing)
    loop.rest(dressing)
    assert dressing.state.own is own
    assert set(dressing.uploads.cache._groups) == before


def test_saved_selections_are_offered_as_colours_where_there_are_some(dressing, loop, tmp_path):
    assert "selections" not in controls._colours(dressing.state)["options"].values()
    dressing.state.weights_shown = "selections"
    assert resolve(dressing.state).legend.title != "Saved selections"
    drop(dressing, loop, written(tmp_path / "sleeve.obj", sleeve()))
    assert controls._colours(dressing.state)["value"] == "selections"


def test_the_last_of_selections_that_overlap_is_seen_and_the_rest_is_grey():
    sets = {"all of them": None, "some": np.array([1, 2]), "others": np.array([2, 3])}
    style, legend = selections_colors(sets, 5)
    assert style["reading"].values.tolist() == [1, 2, 3, 3, 1]
    assert [text for _, text in legend.swatches] == ["all of them: 5", "some: 2", "others: 2"]
    shown = [tuple(color) for color in style["colors"].tolist()]
    assert shown[2] == shown[3]
    assert len({shown[0], shown[1], shown[2]}) == 3
    style, _ = selections_colors({"some": np.array([1])}, 2)
    assert style["colors"][0].tolist() == to_bytes(UNREACHED).tolist()
