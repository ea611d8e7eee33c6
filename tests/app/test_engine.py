"""The engine of derived results, alone: with a state, a pool and a clock of the tests."""

import operator

import param
import pytest

from cutcell.errors import ParameterError
from cutcell_app.derive.derived import ComputedWhenRead, Derived
from cutcell_app.derive.engine import Engine
from cutcell_app.derive.work import Work


class PageState(param.Parameterized):
    """Two choices, and results that follow from them."""

    a = param.Integer(1)
    b = param.Integer(1)
    shown = param.Boolean(True)
    doubled = param.Parameter(None)
    total = param.Parameter(None)
    powers = param.Dict({})
    chosen = param.List([2, 3])
    computing = param.Parameter(frozenset())
    queued = param.Parameter(frozenset())


class Pool:
    """Collects what would run in threads; a test runs it when it wants."""

    def __init__(self):
        self.waiting = []

    def __call__(self, run):
        self.waiting.append(run)

    def run(self):
        """Run all that waits, oldest first."""
        waiting, self.waiting = self.waiting, []
        for run in waiting:
            run()


class Clock:
    """A clock that a test winds on."""

    def __init__(self):
        self.now, self._due = 0.0, []

    def __call__(self, seconds, action):
        entry = [self.now + seconds, action]
        self._due.append(entry)
        return lambda: entry in self._due and self._due.remove(entry)

    def pass_by(self, seconds):
        """Let time pass."""
        self.now += seconds
        due = [one for one in self._due if one[0] <= self.now]
        self._due = [one for one in self._due if one[0] > self.now]
        for _, action in due:
            action()


class Page:
    """An engine with all that surrounds it."""

    def __init__(self, *results):
        self.state, self.pool, self.clock = PageState(), Pool(), Clock()
        self.errors, self.hooks = [], []
        self.work = Work(
            lambda action: action(), self.errors.append, pool=self.pool, clock=self.clock
        )
        self.engine = Engine(self.state, self.work, self)
        self.engine.declare(results)


computed = []


@pytest.fixture(autouse=True)
def fresh():
    computed.clear()


def double(a, progress):
    progress("doubling", 0.5)
    computed.append(a)
    if a < 0:
        raise ParameterError("a is negative")
    return 2 * a


def doubled(**options):
    return Derived("doubled", lambda state: (state.a,), double, **options)


def total(**options):
    return Derived(
        "total",
        lambda state: None if state.doubled is None else (state.doubled, state.b),
        lambda doubled, b, progress: doubled + b,
        after=("doubled",),
        **options,
    )


def powers(**options):
    return Derived(
        "powers",
        lambda state, part: (state.a, part),
        lambda a, part, progress: a**part,
        parts=lambda state: state.chosen,
        **options,
    )


def test_results_follow_choices_in_their_order():
    page = Page(doubled(), total())
    page.state.a = 3
    assert page.state.computing == {("doubled",)}
    page.pool.run()
    assert page.state.doubled == 6
    assert page.state.computing == {("total",)}
    assert not page.engine.is_fresh("total")
    assert page.engine.is_pending("total")
    page.pool.run()
    assert page.state.total == 7
    assert page.engine.is_fresh("total")
    page.state.b = 5
    assert (page.state.doubled, page.state.total) == (6, None), "only what no longer holds is gone"
    page.pool.run()
    assert page.state.total == 11
    assert computed == [3]


def test_nobody_sees_a_value_that_does_not_hold():
    page = Page(doubled(), total())
    page.engine.update()
    page.pool.run()
    page.pool.run()
    seen = []
    page.state.param.watch(lambda *events: seen.append((page.state.a, page.state.doubled)), "a")
    page.state.a = 2
    assert seen == [(2, None)]


@pytest.mark.parametrize("patient", [False, True])
def test_of_two_changes_while_one_runs_the_last_one_counts(patient):
    page = Page(doubled(patient=patient, keeps=lambda old, new: True))
    page.engine.update()
    page.pool.run()
    page.state.a = 2
    page.state.a = 3
    page.state.a = 4
    page.pool.run()
    assert page.state.doubled == (4 if patient else 8)
    page.pool.run()
    assert page.state.doubled == 8
    assert page.engine.is_fresh("doubled")
    assert computed == ([1, 2, 4] if patient else [1, 4])


def test_an_older_value_stays_where_that_is_declared_and_is_not_fresh():
    page = Page(doubled(keeps=lambda old, new: old[0] * new[0] > 0))
    page.engine.update()
    page.pool.run()
    page.state.a = 2
    assert page.state.doubled == 2
    assert not page.engine.is_fresh("doubled")
    page.state.a = -2
    assert page.state.doubled is None


def test_what_is_not_wanted_is_stopped_and_what_was_computed_stays():
    page = Page(doubled(wanted=lambda state: state.shown))
    page.engine.update()
    page.state.shown = False
    page.pool.run()
    assert (page.state.doubled, computed) == (None, [])
    page.state.shown = True
    page.pool.run()
    page.state.shown = False
    assert page.state.doubled == 2
    page.state.a = 2
    assert page.state.doubled is None
    assert not page.engine.is_pending("doubled")


def test_what_fails_is_reported_once_and_tried_again_with_other_inputs():
    page = Page(doubled(failed=lambda page: page.hooks.append(page.state.a)))
    page.state.a = -1
    page.pool.run()
    assert [str(error) for error in page.errors] == ["a is negative"]
    assert page.hooks == [-1]
    page.engine.update()
    page.state.b = 2
    assert not page.pool.waiting
    assert not page.engine.is_pending("doubled")
    page.state.a = 1
    page.pool.run()
    assert page.state.doubled == 2


@pytest.mark.parametrize("immediate", [False, True])
def test_a_failure_may_choose_what_can_be_computed(immediate):
    def go_back(page):
        page.state.a = 1

    page = Page(doubled(immediate=lambda state: immediate, failed=go_back))
    page.engine.update()
    page.pool.run()
    page.state.a = -5
    page.pool.run()
    assert page.state.a == 1
    page.pool.run()
    assert page.state.doubled == 2
    assert len(page.errors) == 1


def test_what_is_refused_waits_for_other_inputs_or_a_retry():
    page = Page(doubled(), total())
    assert not page.engine.refuse("total"), "it has no inputs yet"
    page.engine.update()
    assert page.engine.refuse("doubled")
    page.pool.run()
    assert page.state.doubled is None
    assert not page.work.busy
    page.engine.retry("doubled")
    page.pool.run()
    assert page.state.doubled == 2


def test_choices_rest_before_a_value_is_replaced():
    waits = {"pause": lambda old, new: old is not None, "keeps": lambda old, new: True}
    page = Page(doubled(**waits))
    page.engine.update()
    page.pool.run()
    assert page.state.doubled == 2, "the first one need not wait"
    for a in (2, 3, 4):
        page.state.a = a
        page.clock.pass_by(0.15)
        assert not page.pool.waiting
        assert page.work.busy
    page.clock.pass_by(0.15)
    page.pool.run()
    assert page.state.doubled == 8
    assert computed == [1, 4]


def test_some_values_are_remembered():
    page = Page(doubled(cached=2, keeps=lambda old, new: True))
    for a in (1, 2, 1, 2):
        page.state.a = a
        page.engine.update()
        page.pool.run()
        assert page.state.doubled == 2 * a
    assert computed == [1, 2]


def test_an_older_value_may_be_good_enough():
    page = Page(doubled(current=lambda old, new: operator.ge(old[0], new[0])))
    for a in (5, 3, 6):
        page.state.a = a
        page.pool.run()
    assert computed == [5, 6]


def test_parts_are_computed_one_at_a_time_in_a_lane():
    page = Page(powers(lane="powers"))
    page.state.a = 2
    assert page.state.computing == {("powers", 2)}
    page.pool.run()
    assert page.state.powers == {2: 4}
    page.pool.run()
    assert page.state.powers == {2: 4, 3: 8}
    page.state.chosen = [3, 4]
    page.pool.run()
    assert page.state.powers == {2: 4, 3: 8, 4: 16}, "what holds is there when it is chosen again"
    page.state.a = 3
    assert page.state.powers == {}


def test_work_of_a_person_runs_beside_results():
    page = Page(doubled())
    done = []
    page.work.start("export", lambda progress: "file", done.append)
    page.state.a = 2
    page.state.a = 3
    page.work.start("film", lambda progress: "film", done.append)
    page.pool.run()
    assert done == ["file", "film"]
    assert page.state.doubled == 6


def test_work_of_one_name_is_replaced_and_of_newest_the_last_waits():
    page = Page()
    done = []
    page.work.start("open", lambda progress: "a", done.append)
    page.work.start("open", lambda progress: "b", done.append)
    for name in "cde":
        page.work.newest("scene", lambda progress, name=name: name, done.append)
    page.pool.run()
    assert done == ["b", "c"]
    page.pool.run()
    assert done == ["b", "c", "e"]


def test_idle_is_told_once_and_only_when_nothing_is_about_to_begin():
    page = Page(doubled(), total(pause=lambda old, new: True))
    reports = []
    page.engine.update()
    page.work.when_idle(lambda: reports.append(1))
    page.pool.run()
    assert reports == [], "the total waits for a pause"
    page.clock.pass_by(1)
    page.pool.run()
    assert reports == [1]
    assert not page.work.busy
    page.work.when_idle(lambda: reports.append(2))
    assert reports == [1, 2]


def test_a_closed_page_computes_nothing_any_more():
    page = Page(doubled(pause=lambda old, new: True), powers())
    page.state.a = 2
    page.work.start("film", lambda progress: "film", page.hooks.append)
    page.work.close()
    page.clock.pass_by(1)
    page.pool.run()
    page.state.a = 3
    page.work.start("film", lambda progress: "film", page.hooks.append)
    assert not page.pool.waiting
    assert (page.state.doubled, page.hooks, computed) == (None, [], [])


def test_without_an_engine_results_are_computed_when_they_are_read_if_they_are_wanted():
    results = doubled(), total(), powers(wanted=lambda state, part: part == 3)
    view = ComputedWhenRead(PageState(a=2), results)
    assert computed == []
    assert (view.total, view.doubled, view.powers) == (5, 4, {3: 8})
    assert view.total == 5
    assert computed == [2]
    given = ComputedWhenRead(PageState(a=2, doubled=7), results)
    assert given.total == 8, "what is there stays"


def test_progress_of_reported_results_is_shown_and_goes():
    page = Page(doubled(reported=True))
    seen = []
    page.work._reported = lambda: seen.append(dict(page.work.progress))
    page.state.a = 2
    page.pool.run()
    assert seen == [{("doubled",): ("", 0.0)}, {("doubled",): ("doubling", 0.5)}, {}]


def test_nobody_sees_a_new_result_beside_one_that_followed_the_older():
    doubled = Derived(
        "doubled",
        lambda state: (state.a,),
        lambda a, progress: 2 * a,
        wanted=lambda state: True,
        keeps=lambda old, new: True,
    )
    total = Derived(
        "total",
        lambda state: None if state.doubled is None else (state.doubled,),
        lambda doubled, progress: doubled + 1,
        wanted=lambda state: True,
        after=("doubled",),
    )
    page = Page(doubled, total)
    state, seen = page.state, []
    state.param.watch(lambda *events: seen.append((state.doubled, state.total)), ["doubled"])
    page.engine.update()
    for a in (1, 2):
        state.a = a
        page.pool.run()
        page.pool.run()
        assert state.total == 2 * a + 1
    assert seen == [(2, None), (4, None)]
