"""Menus of the sidebar, without a page."""

import panel_material_ui as pmui

from cutcell_app.panels.bone import bone
from cutcell_app.panels.controls import offer, unique_names
from cutcell_app.panels.graph import graph
from cutcell_app.scenes import resolve
from cutcell_viewers.graph_scene import LAYERS
from cutcell_viewers.palette import to_hex


def test_an_index_that_stays_is_shown_by_its_new_name_at_once():
    select = pmui.Select(options=[])
    shown = select.get_root().data
    told = []
    select.param.watch(lambda event: told.append(event.new), "value")
    offer(select, ["hand", "foot"], 1)
    assert (shown.value, shown.options) == ("foot", ["hand", "foot"])
    offer(select, ["paw", "tail"], 1)
    assert (shown.value, shown.options) == ("tail", ["paw", "tail"])
    offer(select, ["paw", "tail"], 0)
    assert shown.value == "paw"
    assert told == ["foot", "tail", "paw"]


def test_names_that_come_again_are_told_apart():
    assert unique_names(["arm", "leg", "arm", "arm"]) == ["arm", "leg", "arm (2)", "arm (3)"]
    assert len(set(unique_names(["arm", "arm (2)", "arm"]))) == 3


def test_the_list_of_bones_follows_the_choice_and_makes_it(bound):
    menu = next(iter(bone(bound).select(pmui.Select)))
    names = bound.state.rig.skeleton.names
    assert menu.value == names[bound.state.joint]
    menu.value = names[0]
    assert bound.state.joint == 0
    bound.state.joint = 2
    assert menu.value == names[2]


def test_the_switch_of_a_layer_has_the_colour_that_its_edges_are_drawn_in(bound):
    switches = {one.label: one for one in graph(bound).select(pmui.Switch)}
    bound.state.panel = "graph"
    for dark in (False, True):
        bound.state.dark = dark
        actors = resolve(bound.state).actors
        for name in LAYERS:
            look = switches[name.capitalize()].sx
            drawn = to_hex(actors[name].color)
            assert {color for style in look.values() for color in style.values()} == {drawn}
