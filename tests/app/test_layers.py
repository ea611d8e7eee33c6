"""Layers on the page: chosen, painted, computed, exported and opened again."""

import json

import numpy as np
import panel_material_ui as pmui
import pytest
from typer.testing import CliRunner

import cutcell
from cutcell import Computed, Edits, Filled, FromFile, Layer, Locked, Mask, Painted, Smoothed
from cutcell.cli.app import app
from cutcell.editing.stored import load_edits
from cutcell_app.document import loading
from cutcell_app.editing.binding import recovery
from cutcell_app.editing.brush import strokes
from cutcell_app.editing.correct import commands as correct
from cutcell_app.editing.layers import commands as layers
from cutcell_app.editing.layers.controls import LAYERS, NEW_LAYERS
from cutcell_app.files.reading import load_with_materials
from cutcell_app.shell.session import export, keys
from cutcell_app.widgets.controls import draw
from cutcell_app.widgets.rows import Rows
from tests.app.loop import check_bound_as_by_core, settled
from tests.cutcell.io.gltf.test_vrm import VRM0, VRM1, avatar
from tests.viewers.arm import arm_rig

RNG = np.random.default_rng(11)
SOME = np.arange(10, 40)
STACK = (
    Layer(Computed({"falloff": "paper", "leaf": "fit"}), Mask(vertices=SOME), "paper", 0.5),
    Layer(Computed({"resolution": 20}), Mask(vertices=SOME[::2])),
    Layer(FromFile(), Mask(vertices=SOME[:8]), opacity=0.75),
    Layer(Filled({"elbow": 0.5, "wrist": 0.5}), Mask(vertices=[1, 3, 5]), on=False),
    Layer(Smoothed(2), Mask(vertices=[60, 61], strengths=[0.5, 1])),
    Layer(Painted([3, 50], ["shoulder", "wrist"], [[1, 0], [0.25, 0.75]]), name="mine"),
    Layer(Locked(["elbow"])),
)


@pytest.fixture
def arm_file(tmp_path):
    rig = arm_rig()
    rows = RNG.dirichlet(np.ones(3), len(rig.mesh.vertices))
    cutcell.save(tmp_path / "arm.glb", rig.with_weights(rows))
    return tmp_path / "arm.glb"


def opened(session, loop, path):
    loading.show_rig(session, load_with_materials(path))
    settled(session, loop)
    return session.state


def exported(session, loop, path):
    got = []
    export.export_bound(session, lambda name, content: got.append(content))
    loop.run_until(lambda: bool(got))
    path.write_bytes(got[0])
    return path


def bound_by_command(path, layers, out):
    arguments = ["bind", str(path), str(out), "--layers", str(layers), "--quiet"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    return out


def check_written_by_command(session, path, out):
    """Check that the command writes a file of the page, with layers of a sidecar and of itself."""
    files = []
    session.view.offer = lambda *file: files.append(file)
    correct.save(session)
    sidecar = out.with_name("saved.layers.json")
    sidecar.write_bytes(files[0][1])
    for layers_in in (sidecar, out):
        for source in (path, out):
            name = f"{layers_in.stem} of {source.stem}{out.suffix}"
            check_same_file(bound_by_command(source, layers_in, out.with_name(name)), out)


def chunks(path):
    """Return the document of a GLB, its binary chunk, and what its asset says of layers."""
    data = path.read_bytes()
    size = int.from_bytes(data[12:16], "little")
    document = json.loads(data[20 : 20 + size])
    entry = document["asset"]["extras"]["cutcell"]
    return document, data[20 + size :], entry


def check_same_file(one, other):
    assert chunks(one) == chunks(other)


@pytest.mark.parametrize("base", ["file", "computed"])
def test_the_command_writes_what_the_page_exports(session, loop, arm_file, tmp_path, base):
    session.state.param.update(resolution=16, max_influences=3)
    state = opened(session, loop, arm_file)
    correct.correct(session, Edits(base=base, layers=STACK))
    settled(session, loop)
    check_bound_as_by_core(session, load_with_materials(arm_file), max_influences=3)
    out = exported(session, loop, tmp_path / "page.glb")
    check_written_by_command(session, arm_file, out)
    # Opened again, the stack lies over the weights that it began from.
    weights, edits, begun = state.binding.weights, state.edits, state.rig.weights
    assert load_edits(out).layers == edits.layers
    session.state.param.update(resolution=24, max_influences=4)
    state = opened(session, loop, out)
    assert (state.edits, state.resolution, state.max_influences) == (edits, 16, 3)
    np.testing.assert_array_equal(state.rig.weights, begun)
    np.testing.assert_array_equal(state.binding.weights, weights)
    check_same_file(exported(session, loop, tmp_path / "again.glb"), out)
    correct.clear(session)
    correct.choose_file(session, True)
    settled(session, loop)
    np.testing.assert_array_equal(state.binding.weights, begun)


@pytest.mark.parametrize("extension", [VRM0, VRM1], ids=["0", "1"])
@pytest.mark.parametrize("base", ["file", "computed"])
def test_an_avatar_holds_layers(session, loop, tmp_path, base, extension):
    path = tmp_path / "avatar.vrm"
    avatar(extension).save(path)
    session.state.resolution = 8
    state = opened(session, loop, path)
    correct.choose_file(session, base == "file")
    settled(session, loop)
    content = FromFile if base == "computed" else Computed
    layers.put_content(session, np.array([2, 3]), content, opacity=0.5)
    settled(session, loop)
    edits, weights = state.edits, state.binding.weights
    out = exported(session, loop, tmp_path / "out.vrm")
    check_written_by_command(session, path, out)
    state = opened(session, loop, out)
    assert state.edits == edits
    np.testing.assert_array_equal(state.binding.weights, weights)


def test_damaged_layers_of_a_file_are_said_and_left(session, loop, arm_file, tmp_path):
    session.state.resolution = 16
    opened(session, loop, arm_file)
    layers.take_from_file(session, SOME)
    settled(session, loop)
    out = exported(session, loop, tmp_path / "out.glb")
    data = out.read_bytes()
    out.write_bytes(data.replace(b'"kind":"file"', b'"kind":"mile"'))
    loading.show_rig(session, load_with_materials(out))
    loop.rest(session)
    assert "layers of the file were not applied" in session.state.message[1]
    assert not session.state.edits


def test_a_file_with_layers_says_so_where_they_are_not_applied(session, loop, arm_file, tmp_path):
    session.state.resolution = 16
    opened(session, loop, arm_file)
    layers.take_from_file(session, SOME)
    settled(session, loop)
    out = exported(session, loop, tmp_path / "out.glb")
    result = CliRunner(env={"COLUMNS": "500"}).invoke(
        app, ["bind", str(out), str(tmp_path / "other.glb"), "-r", "16"]
    )
    assert result.output.count("holds 1 layers, which were not applied") == 1


def test_rows_go_into_the_chosen_layer_or_into_a_new_one_on_top(bound, loop):
    state, rows = bound.state, np.eye(3)
    layers.put_rows(bound, np.array([7]), rows[[2]], "first")
    layers.put_rows(bound, np.array([5, 7]), rows[[0, 1]])
    (layer,) = state.edits.layers
    assert (layer.name, layer.content.vertices.tolist(), state.layer) == ("first", [5, 7], 0)
    layers.recompute(bound, SOME, 0.5, "mixed", falloff="paper")
    assert (state.layer, len(state.edits.layers)) == (1, 2)
    settled(bound, loop)
    layers.put_rows(bound, np.array([7]), rows[[2]])
    settled(bound, loop)
    assert [one.title for one in state.edits.layers] == ["first", "mixed", "Painted"]
    assert state.binding.weights[7].tolist() == [0, 0, 1]
    check_bound_as_by_core(bound, arm_rig())
    state.layer = 0
    layers.put_rows(bound, np.array([7]), rows[[0]])
    settled(bound, loop)
    assert state.binding.weights[7].tolist() == [0, 0, 1], "it lies below another layer"
    for _ in range(5):
        keys.act(bound, "undo")
    assert not state.edits
    assert not bound.history.can_undo
    for _ in range(5):
        keys.act(bound, "redo")
    settled(bound, loop)
    check_bound_as_by_core(bound, arm_rig())


def test_locked_joints_stay_on_top(bound, loop):
    correct.lock(bound, [1])
    layers.put_rows(bound, np.array([7]), np.array([[0.2, 0.3, 0.5]]))
    correct.lock(bound, [0])
    assert [one.content.kind for one in bound.state.edits.layers] == ["painted", "locked"]
    assert bound.state.edits.layers[1].content.joints == ("elbow", "shoulder")
    correct.correct_joint(bound, 1, locked=False)
    assert bound.state.edits.layers[1].content.joints == ("shoulder",)
    settled(bound, loop)
    check_bound_as_by_core(bound, arm_rig())


def test_recomputed_layers_follow_all_choices_and_are_computed_once(bound, loop):
    state = bound.state
    layers.recompute(bound, SOME, resolution=20)
    settled(bound, loop)
    (first,) = state.recomputed.values()
    layers.set_layer(bound, 0, opacity=0.5)
    settled(bound, loop)
    assert list(state.recomputed.values()) == [first]
    layers.set_layer(bound, 0, on=False)
    settled(bound, loop)
    assert not state.recomputed
    layers.set_layer(bound, 0, on=True)
    settled(bound, loop)
    assert list(state.recomputed.values()) == [first]
    state.leaf = "point"
    settled(bound, loop)
    assert list(state.recomputed.values()) != [first]
    fresh = cutcell.bind(arm_rig(), 16, leaf="point", edits=state.edits)
    np.testing.assert_allclose(state.binding.weights, fresh.weights, rtol=0, atol=1e-9)


def test_a_layer_that_is_cancelled_or_cannot_be_computed_is_taken_back(bound, loop):
    before = bound.state.binding.weights
    layers.recompute(bound, SOME, resolution=20)
    recovery.cancel(bound)
    loop.rest(bound)
    assert not bound.state.edits
    np.testing.assert_array_equal(bound.state.binding.weights, before)
    layers.recompute(bound, SOME, resolution=1)
    assert "Resolution must be" in bound.state.message[1]
    assert not bound.state.edits


def buttons(section):
    return {one.label: one for one in section.select(pmui.Button)}


def test_the_panel_shows_the_stack_and_changes_the_chosen_layer(bound, loop):
    section = draw(bound, LAYERS)
    loop.rest(bound)
    state = bound.state
    layers.put_rows(bound, np.array([7]), np.array([[0.2, 0.3, 0.5]]), "mine")
    layers.take_from_file(bound, SOME, opacity=0.5)
    settled(bound, loop)
    (rows,) = section.select(Rows)
    assert rows.rows == [("From file", "30 · 50%", 0.5), ("mine", "1", 1)]
    assert (rows.chosen, state.layer) == (0, 1)
    below = state.binding.weights
    buttons(section)["Down"].clicks += 1
    assert [one.title for one in state.edits.layers] == ["From file", "mine"]
    assert buttons(section)["Down"].disabled
    buttons(section)["Up"].clicks += 1
    settled(bound, loop)
    np.testing.assert_array_equal(state.binding.weights, below)
    buttons(section)["Merge down"].clicks += 1
    settled(bound, loop)
    (merged,) = state.edits.layers
    assert (merged.title, merged.content.kind) == ("mine", "painted")
    assert merged.content.vertices.tolist() == [7, *SOME]
    np.testing.assert_allclose(state.binding.weights, below, atol=1e-4)
    (name,) = section.select(pmui.TextInput)
    name.value = "both"
    (on,) = section.select(pmui.Switch)
    on.value = False
    settled(bound, loop)
    assert rows.rows == [("both", "off", 0)]
    on.value = True
    (opacity,) = section.select(pmui.FloatSlider)
    opacity.value = 0.25
    settled(bound, loop)
    assert state.edits.layers[0].opacity == 0.25
    check_bound_as_by_core(bound, arm_rig())
    rows._handle_msg({"type": "pick-row", "name": rows.rows[0][0]})
    assert state.layer is None
    rows._handle_msg({"type": "pick-row", "name": rows.rows[0][0]})
    buttons(section)["Delete"].clicks += 1
    assert not state.edits


def test_layers_are_added_over_the_selection_or_everything(bound, loop):
    menus = draw(bound, LAYERS).select(pmui.MenuButton)
    menu = next(one for one in menus if one.label == "Add layer")
    offered = [item["label"] for item in menu.items]
    assert offered == list(NEW_LAYERS)
    NEW_LAYERS["Smoothed"](bound)
    settled(bound, loop)
    chosen = np.zeros(len(arm_rig().mesh.vertices), bool)
    chosen[SOME] = True
    strokes.select(bound, chosen)
    NEW_LAYERS["Computed, finer"](bound)
    NEW_LAYERS["Selected bone locked"](bound)
    settled(bound, loop)
    first, finer, locked = bound.state.edits.layers
    assert first.mask.is_all
    assert finer.mask.vertices.tolist() == locked.mask.vertices.tolist() == SOME.tolist()
    assert finer.content.options == {"resolution": 32}
    check_bound_as_by_core(bound, arm_rig())
    NEW_LAYERS["With the body it touches"](bound)
    loop.rest(bound)
    assert "none is left" in bound.state.message[1].lower()
    assert len(bound.state.edits.layers) == 3
