"""Menus of the sidebar, without a page."""

import panel_material_ui as pmui

from cutcell_app.panels.bone import bone
from cutcell_app.panels.parts import offer, unique_names


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
