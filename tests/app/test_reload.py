"""What a page that is loaded again goes on with, without a browser."""

import numpy as np
import pytest

import cutcell
from cutcell_app.document import loading
from cutcell_app.document.opening import Request
from cutcell_app.document.selection import selected_vertices
from cutcell_app.editing.brush.strokes import select
from cutcell_app.editing.correct import commands as correct
from cutcell_app.editing.layers.commands import put_rows
from cutcell_app.editing.select import saved
from cutcell_app.features.check.results import repair
from cutcell_app.features.learn import steps
from cutcell_app.shell.session import keys
from cutcell_app.shell.session.begin import begin
from cutcell_app.shell.session.reload import CHANGED, GONE, Pages, arrive
from tests.viewers.arm import arm_rig


class Tab:
    """A browser's tab, which loads its page again."""

    def __init__(self, loop, pages, path):
        self.loop, self.pages, self.first = loop, pages, Request("~", paths=[path])
        self.address = "?panel=weights&resolution=16"
        self.page = None
        self.load()

    def load(self):
        """Open a page; the one before is open still, as while its websocket closes."""
        self.session = begin(self.loop)
        self.key = self.pages.enter(self.session)
        self.session.view.page_before = self.page or ""
        arrive(self.session, self.address, self.first, self.pages)
        self.loop.rest(self.session)
        self.address = self.session.view.last_sent("address")
        self.page = self.session.view.last_sent("page")
        return self.session.state

    def leave(self):
        """End the page, as some seconds after its websocket has closed."""
        self.address = self.session.view.last_sent("address")
        self.pages.leave(self.key)
        self.session.close()

    def reload(self, ended=False):
        """Load the page again, before or after the one before has ended."""
        before = self.session, self.key
        self.address = self.session.view.last_sent("address")
        if ended:
            self.leave()
        state = self.load()
        if not ended:
            self.pages.leave(before[1])
            before[0].close()
        return state

    def act(self, name):
        keys.act(self.session, name)
        self.loop.rest(self.session)

    def paint(self, vertex, joint=1):
        """Give a vertex to a joint, as a stroke does."""
        row = np.zeros((1, len(self.session.state.rig.skeleton.names)))
        row[0, joint] = 1
        put_rows(self.session, np.array([vertex]), row)
        self.loop.rest(self.session)

    def choose(self, *vertices):
        """Select some vertices."""
        chosen = np.zeros(len(self.session.state.rig.mesh.vertices), bool)
        chosen[list(vertices)] = True
        select(self.session, chosen)


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "arm.glb"
    cutcell.save(path, arm_rig())
    return path


@pytest.fixture
def pages():
    return Pages()


@pytest.fixture
def tab(loop, pages, path):
    tab = Tab(loop, pages, path)
    yield tab
    tab.leave()


@pytest.mark.parametrize("ended", [False, True])
def test_edits_selections_undo_and_redo_are_as_before(tab, ended):
    first = tab.session.state.edits
    tab.choose(1, 2, 3)
    saved.save(tab.session, "some")
    tab.session.state.param.update(brush=True, brush_radius=0.1)
    tab.paint(5)
    tab.paint(9)
    tab.paint(12)
    before, weights = tab.session.state.edits, tab.session.state.weights
    tab.act("undo")
    now = tab.session.state.edits
    state = tab.reload(ended)
    assert (state.edits, state.message) == (now, None)
    assert selected_vertices(state).tolist() == [1, 2, 3]
    assert (state.brush, state.brush_radius, state.layer) == (True, 0.1, 0)
    assert list(state.edits.selections) == ["some"]
    assert tab.session.view.last_sent("able") == [True, True]
    tab.act("redo")
    assert tab.session.state.edits == before
    np.testing.assert_array_equal(tab.session.state.weights, weights)
    while tab.session.history.can_undo:
        tab.act("undo")
    assert tab.session.state.edits == first
    assert tab.session.view.last_sent("able") == [False, True]


def test_after_a_reload_strokes_go_into_the_same_layer_and_drop_what_was_undone(tab):
    tab.paint(5)
    tab.paint(9)
    tab.act("undo")
    state = tab.reload()
    tab.paint(12)
    assert [len(layer.content.vertices) for layer in state.edits.layers] == [2]
    assert tab.session.view.last_sent("able") == [True, False]


def test_a_page_that_is_loaded_again_while_it_loads_loses_nothing(tab, loop):
    tab.paint(5)
    for _ in range(2):
        session = begin(loop)
        key = tab.pages.enter(session)
        session.view.page_before = tab.page
        arrive(session, tab.address, tab.first, tab.pages)
        assert session.view.last_sent("page") is None  # its tab has the key of the page before
        tab.pages.leave(key)
        session.close()
    tab.reload(ended=True)
    tab.act("undo")
    assert not tab.session.state.edits.layers


def test_two_tabs_share_no_history(tab, loop, path):
    tab.paint(5)
    tab.choose(1)
    other = Tab(loop, tab.pages, path)
    other.page, other.address = tab.page, tab.session.view.last_sent("address")
    other.reload()
    assert other.page != tab.page
    other.act("undo")
    other.choose(2, 3)
    assert len(tab.session.state.edits.layers) == 1
    assert tab.session.view.last_sent("able") == [True, False]
    assert selected_vertices(tab.reload()).tolist() == [1]
    assert selected_vertices(other.reload()).tolist() == [2, 3]
    assert other.session.view.last_sent("able") == [False, True]
    other.leave()


def test_a_key_that_nobody_has_gives_nothing(tab, loop, path):
    tab.paint(5)
    other = Tab(loop, tab.pages, path)
    other.page = "guessed"
    other.reload()
    assert not other.session.history.can_undo
    assert other.session.state.message is None  # it had nothing to lose
    other.leave()


def test_what_is_old_is_gone_and_that_is_said_once(loop, path):
    tab = Tab(loop, Pages(seconds=0), path)
    tab.paint(5)
    edits = tab.session.state.edits
    state = tab.reload(ended=True)
    assert (state.edits, state.message) == (edits, ("info", GONE))  # edits are in the address
    assert not tab.session.history.can_undo
    assert tab.reload().message is None
    tab.leave()


def test_of_a_large_history_the_newest_steps_are_kept(loop, path):
    tab = Tab(loop, Pages(), path)
    for vertex in range(20):
        tab.paint(vertex)
    count = len(tab.session.history)
    assert count > 10
    size = sum(len(layer.content.vertices) for layer in tab.session.state.edits.layers)
    tab.pages = Pages(most_of_a_page=12_000)
    tab.key = tab.pages.enter(tab.session)
    tab.page = tab.key
    state = tab.reload(ended=True)
    assert 1 < len(tab.session.history) < count
    assert sum(len(layer.content.vertices) for layer in state.edits.layers) == size
    tab.act("undo")
    assert sum(len(layer.content.vertices) for layer in state.edits.layers) == size - 1
    tab.leave()


def test_pages_make_room_first_those_that_others_went_on_with_then_the_oldest(tab):
    tab.paint(5)
    pages = Pages()
    pages.leave(pages.enter(tab.session))
    assert pages.size > 1000
    pages = Pages(most=int(2.5 * pages.size))

    def left():
        key = pages.enter(tab.session)
        pages.leave(key)
        return key

    first, second = left(), left()
    assert pages.find(second) is not None
    third = left()
    assert pages.find(second) is None
    left()
    assert pages.find(first) is None
    assert pages.find(third) is not None


def test_a_file_that_has_changed_drops_what_was_of_the_other(tab, path):
    tab.choose(1, 2)
    tab.paint(5)
    edits = tab.session.state.edits
    rig = arm_rig()
    cutcell.save(path, rig.with_weights(rig.weights[:, ::-1]))
    state = tab.reload()
    assert state.message == ("info", CHANGED)
    assert state.edits == edits  # of the address, which fit
    assert not len(selected_vertices(state))
    assert not tab.session.history.can_undo
    assert tab.reload().message is None


def test_an_address_of_another_character_is_what_it_says(tab):
    tab.paint(5)
    tab.leave()
    tab.address = "?rig=robot&resolution=16"
    state = tab.load()
    assert (state.demo, state.edits.layers, state.message) == ("robot", (), None)
    assert not tab.session.history.can_undo


def test_other_characters_can_be_returned_to(tab):
    tab.paint(5)
    loading.load_demo(tab.session, "robot")
    tab.loop.rest(tab.session)
    tab.reload(ended=True)
    tab.act("undo")
    assert len(tab.session.state.rig.mesh.vertices) == len(arm_rig().mesh.vertices)
    assert len(tab.session.state.edits.layers) == 1


def test_repairs_are_not_repeated_by_undo_after_a_reload(loop, pages, tmp_path, monkeypatch):
    rig = arm_rig()
    faces = rig.mesh.faces.copy()
    faces[::7] = faces[::7, ::-1]
    cutcell.save(tmp_path / "arm.glb", cutcell.Rig(cutcell.TriangleMesh(rig.mesh.vertices, faces),
                                                   rig.skeleton, rig.weights))  # fmt: skip
    tab = Tab(loop, pages, tmp_path / "arm.glb")
    state = tab.session.state
    repair(tab.session, [next(one.code for one in state.diagnosis.findings if one.repair)])
    loop.rest(tab.session)
    repaired = state.repair
    assert repaired is not None
    correct.choose_deform(tab.session, [0, 1])
    loop.rest(tab.session)
    state = tab.reload()
    assert state.repair == repaired
    monkeypatch.setattr("cutcell_app.document.opening.repaired_again", None)
    tab.act("undo")
    assert (state.repair, state.message) == (repaired, None)
    assert state.rig.skeleton.deform.sum() > 2
    tab.leave()


def test_a_lesson_still_ends_where_it_began(tab):
    tab.paint(5)
    edits = tab.session.state.edits
    steps.go(tab.session, 0)
    tab.loop.rest(tab.session)
    state = tab.reload(ended=True)
    assert state.step == 0
    steps.go(tab.session, -1)
    tab.loop.rest(tab.session)
    assert (state.step, state.edits) == (-1, edits)
    tab.act("undo")
    assert not state.edits.layers
