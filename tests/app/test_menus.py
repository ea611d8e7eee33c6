"""Menus of the sidebar, without a page."""

import panel_material_ui as pmui

from app.panels.parts import offer


def test_an_index_that_stays_is_shown_by_its_new_name():
    select = pmui.Select(options={})
    shown = select.get_root().data
    offer(select, {"hand": 0, "foot": 1}, 1)
    assert (shown.value, shown.options) == ("foot", ["hand", "foot"])
    offer(select, {"paw": 0, "tail": 1}, 1)
    assert (shown.value, shown.options) == ("tail", ["paw", "tail"])
    offer(select, {"paw": 0, "tail": 1}, 0)
    assert shown.value == "paw"
