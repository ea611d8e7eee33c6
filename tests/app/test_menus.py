"""Menus of the sidebar, without a page."""

import panel_material_ui as pmui
import pytest

import cutcell
from cutcell_app.document import loading
from cutcell_app.editing.select.controls import WEIGHT_SCALE
from cutcell_app.features.distance import controls as distance
from cutcell_app.features.graph.controls import CONTROLS
from cutcell_app.features.scenes import resolve
from cutcell_app.shell import character
from cutcell_app.shell.bone import BONE
from cutcell_app.widgets.controls import draw, pick
from cutcell_app.widgets.rows import Rows
from cutcell_app.widgets.text import unique_names
from cutcell_viewers.graph_scene import LAYERS
from cutcell_viewers.palette import COLORMAPS, to_hex
from tests.viewers.arm import arm_rig


def test_an_index_that_stays_is_shown_by_its_new_name_at_once(session):
    state = session.state
    state.param.update(actors={"hand": 0, "foot": 0}, joint=1)
    chosen = []
    row = pick(
        "Mesh",
        lambda state: list(state.actors),
        lambda state: state.joint,
        lambda session, index: chosen.append(index),
    )
    select = draw(session, row)
    shown = select.get_root().data
    reports = []
    select.param.watch(lambda event: reports.append(event.new), "value")
    assert (shown.value, shown.options) == ("foot", ["hand", "foot"])
    state.actors = {"paw": 0, "tail": 0}
    assert (shown.value, shown.options) == ("tail", ["paw", "tail"])
    state.joint = 0
    assert shown.value == "paw"
    assert reports == ["tail", "paw"]
    assert chosen == []
    select.value = "tail"
    assert chosen == [1]


def test_names_that_come_again_are_told_apart():
    assert unique_names(["arm", "leg", "arm", "arm"]) == ["arm", "leg", "arm (2)", "arm (3)"]
    assert len(set(unique_names(["arm", "arm (2)", "arm"]))) == 3


def test_the_list_of_bones_follows_the_choice_and_makes_it(bound):
    menu = next(iter(draw(bound, BONE).select(pmui.Select)))
    names = bound.state.rig.skeleton.names
    assert menu.value == names[bound.state.joint]
    menu.value = names[0]
    assert bound.state.joint == 0
    bound.state.joint = 2
    assert menu.value == names[2]


@pytest.mark.parametrize("controls", [distance.CONTROLS, WEIGHT_SCALE, CONTROLS])
def test_a_colour_map_is_chosen_by_name_where_a_field_is_drawn(bound, controls):
    bound.state.param.update(panel="graph", weights_shown="bone", edge_colors="distance")
    menus = {one.label: one for one in draw(bound, controls).select(pmui.Select)}
    menu = menus["Colour map"]
    assert menu.visible
    assert list(menu.options.values()) == list(COLORMAPS)
    assert menu.value == "default"
    menu.value = "viridis"
    assert bound.state.colormap == "viridis"


def test_the_switch_of_a_layer_has_the_colour_that_its_edges_are_drawn_in(bound):
    switches = {one.label: one for one in draw(bound, CONTROLS).select(pmui.Switch)}
    bound.state.panel = "graph"
    for dark in (False, True):
        bound.state.dark = dark
        actors = resolve(bound.state).actors
        for name in LAYERS:
            look = switches[name.capitalize()].sx
            drawn = to_hex(actors[name].color)
            assert {color for style in look.values() for color in style.values()} == {drawn}


def test_no_demo_is_opened_while_a_file_is_read(session, loop, monkeypatch, tmp_path):
    opened = []
    monkeypatch.setattr(character, "load_demo", lambda session, demo: opened.append(demo))
    menu = draw(session, character.CHARACTER).select(pmui.Select)[0]
    menu.get_root()  # as the page is rendered: a value that is not offered would be replaced
    cutcell.save(tmp_path / "file.glb", arm_rig())
    loading.load_files(session, [tmp_path / "file.glb"])
    assert (menu.value, next(iter(menu.options))) == ("Your own", "Your own")
    loop.run_until(lambda: session.state.rig is not None)
    assert (menu.value, next(iter(menu.options))) == ("~", "file.glb")
    assert opened == []


def test_a_row_is_chosen_by_its_name_wherever_it_has_moved():
    rows, chosen = Rows(rows=[("a", "", 0.0), ("b", "", 0.0)]), []
    rows.on_click(chosen.append)
    rows.rows = [("b", "", 0.0), ("a", "", 0.0), ("b", "", 0.0)]
    rows._handle_msg({"type": "pick-row", "name": "b"})
    rows._handle_msg({"type": "pick-row", "name": "b", "nth": 1})
    rows._handle_msg({"type": "pick-row", "name": "gone"})
    assert chosen == [0, 2]
