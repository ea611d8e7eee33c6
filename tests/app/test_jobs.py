"""Work off the event loop: results, progress, errors; stopped and superseded work."""

import threading
from functools import partial
from types import SimpleNamespace

import pytest

from cutcell.errors import Cancelled
from cutcell_app.derive.jobs import MAX_UNRESPONSIVE, Gate, on_its_thread
from cutcell_app.derive.work import Work
from tests.app.loop import NEVER

LESS = 0.2
"""Seconds of patience in a test."""


@pytest.fixture
def reports():
    return []


def begin(work, action, reports, report=lambda stage, fraction: None):
    """Start some work of one name, whose results are reported."""
    work.start("work", action, reports.append, report=report)


@pytest.fixture
def start(loop, reports):
    def fail(error):
        reports.append(("failed", error, threading.current_thread()))

    work = Work(loop, fail)

    def start(action):
        work.start(
            "work",
            action,
            lambda result: reports.append(("done", result, threading.current_thread())),
            report=lambda stage, fraction: reports.append(("progress", stage, fraction)),
        )

    start.work = work
    yield start
    work.close()


def endless(started):
    """Work that goes on until it is stopped."""

    def work(progress):
        started.set()
        while True:
            progress("on and on", 0.5)

    return work


def test_work_that_stops_by_itself_fails_and_leaves_nothing_running(loop, reports, start):
    def work(progress):
        raise Cancelled

    start(work)
    loop.run_until(lambda: not start.work.busy)
    assert [(what, type(error)) for what, error, _ in reports] == [("failed", Cancelled)]


def test_work_runs_in_another_thread_and_is_told_of_in_this(loop, reports, start):
    start(lambda progress: threading.current_thread())
    loop.run_until(lambda: len(reports) == 1)
    what, worker, teller = reports[0]
    assert what == "done"
    assert worker is not threading.current_thread()
    assert teller is threading.current_thread()
    assert not start.work.busy


def test_progress_arrives_before_the_result(loop, reports, start):
    def work(progress):
        for stage in ("one", "two"):
            progress(stage, 0.25)
        return 3

    start(work)
    loop.run_until(lambda: any(t[0] == "done" for t in reports))
    assert [t[:2] for t in reports] == [("progress", "one"), ("progress", "two"), ("done", 3)]


def test_progress_is_thinned_out(loop, reports, start):
    start(lambda progress: [progress("many", i / 10000) for i in range(10000)] and None)
    loop.run_until(lambda: any(t[0] == "done" for t in reports))
    assert len(reports) < 200


def test_errors_are_told(loop, reports, start):
    def work(progress):
        raise ValueError("no")

    start(work)
    loop.run_until(lambda: bool(reports))
    assert reports[0][0] == "failed"
    assert str(reports[0][1]) == "no"


def test_newer_work_supersedes_what_runs(loop, reports, start):
    started = threading.Event()
    start(endless(started))
    assert started.wait(NEVER)
    start(lambda progress: "new")
    loop.run_until(lambda: any(t[0] == "done" for t in reports))
    loop.run_out()
    assert [t[1] for t in reports if t[0] != "progress"] == ["new"]


def test_a_result_that_comes_too_late_is_dropped(loop, reports, start):
    held, go = threading.Event(), threading.Event()

    def deaf(progress):  # asks for no permission to go on, as a numeric kernel does
        held.set()
        assert go.wait(NEVER)
        return "old"

    start(deaf)
    assert held.wait(NEVER)
    start(lambda progress: "new")
    go.set()
    loop.run_until(lambda: any(t[0] == "done" for t in reports))
    loop.run_out()
    assert [t[1] for t in reports if t[0] == "done"] == ["new"]


def test_cancelling_stops_without_a_word(loop, reports, start):
    started = threading.Event()
    start(endless(started))
    assert started.wait(NEVER)
    assert start.work.cancel("work")
    assert not start.work.cancel("work")
    loop.run_out()
    assert [t for t in reports if t[0] != "progress"] == []


def test_a_closed_session_starts_nothing(loop, reports, start):
    start.work.close()
    start(lambda progress: 1)
    loop.run_out()
    assert reports == []


def test_sessions_compute_in_turn(loop):
    busy, most = [], []

    def work(progress):
        busy.append(1)
        most.append(len(busy))
        threading.Event().wait(0.05)
        busy.pop()

    done = []
    for _ in range(3):
        begin(Work(loop, done.append), work, done)
    loop.run_until(lambda: len(done) == 3)
    assert max(most) == 1


def test_waiting_for_a_turn_can_be_cancelled(loop):
    started, reports = threading.Event(), []
    first, second = Work(loop, reports.append), Work(loop, reports.append)
    begin(first, endless(started), reports)
    assert started.wait(NEVER)
    stages = []
    begin(second, lambda p: "never", reports, lambda stage, f: stages.append(stage))
    loop.run_until(lambda: bool(stages))
    assert "waiting" in stages[0]
    second.close()
    first.close()
    loop.run_out()
    assert reports == []


def deaf_work(go, started=None):
    """Work that does not look whether it is still wanted."""

    def work(progress):
        if started is not None:
            started.set()
        assert go.wait(NEVER)

    return work


def nothing(*given):
    pass


@pytest.fixture
def impatient(monkeypatch):
    """Let stopped work be waited for less long."""
    monkeypatch.setattr("cutcell_app.derive.jobs.PATIENCE", LESS)


def test_stopped_work_that_does_not_look_holds_nobody_up_for_long(loop, reports, impatient):
    go, started = threading.Event(), threading.Event()
    deaf, other = Work(loop, nothing), Work(loop, reports.append)
    begin(deaf, deaf_work(go, started), [])
    assert started.wait(NEVER)
    begin(other, lambda progress: "done", reports)
    loop.run_for(LESS + 0.3)
    assert reports == [], "it is wanted, and others wait for it"
    deaf.cancel("work")
    loop.run_until(lambda: reports == ["done"])
    go.set()


def test_only_so_much_of_it_goes_on_beside_what_is_wanted(loop, reports, impatient):
    go, deaf = threading.Event(), Work(loop, nothing)
    for _ in range(MAX_UNRESPONSIVE + 1):
        started = threading.Event()
        begin(deaf, deaf_work(go, started), [])
        assert started.wait(NEVER)
    deaf.cancel("work")
    other = Work(loop, reports.append)
    begin(other, lambda progress: "done", reports)
    loop.run_for(LESS + 0.5)
    assert reports == []
    go.set()
    loop.run_until(lambda: reports == ["done"])


def test_of_what_a_slider_asks_for_only_the_newest_is_done(loop, reports):
    go, begun = threading.Event(), []
    work_of_page = Work(loop, reports.append)

    def work(number, progress):
        begun.append(number)
        assert go.wait(NEVER)
        return number

    for number in range(5):
        work_of_page.newest("scene", partial(work, number), reports.append)
    loop.run_until(lambda: begun)
    go.set()
    loop.run_until(lambda: reports == [0, 4])
    assert begun == [0, 4]


def test_the_newest_is_done_after_a_failure_too(loop, reports):
    work_of_page = Work(loop, reports.append)
    error, go = ValueError("no"), threading.Event()

    def fails(progress):
        assert go.wait(NEVER)
        raise error

    work_of_page.newest("scene", fails, reports.append)
    work_of_page.newest("scene", lambda progress: "yes", reports.append)
    go.set()
    loop.run_until(lambda: reports == [error, "yes"])
    work_of_page.close()


def test_running_out_of_memory_is_told_like_any_error(loop, reports, start):
    def work(progress):
        raise MemoryError("Unable to allocate 44.0 GiB")

    start(work)
    loop.run_until(lambda: bool(reports))
    assert reports[0][0] == "failed"
    start(lambda progress: "next")
    loop.run_until(lambda: reports[-1][:2] == ("done", "next"))


def test_a_gate_holds_actions_back_and_keeps_their_order(loop):
    reports = []
    gate = Gate(loop)
    for i in range(3):
        gate(lambda i=i: reports.append(i))
    loop.run_out()
    assert reports == []
    gate.open()
    gate(lambda: reports.append(3))
    loop.run_until(lambda: len(reports) == 4)
    assert reports == [0, 1, 2, 3]


class Document:
    """Notes on which threads it is asked for something."""

    def __init__(self):
        self.session_context = object()
        self.threads = []

    def add_next_tick_callback(self, action):
        self.threads.append(threading.current_thread())
        action()


def test_a_document_is_only_touched_on_its_own_thread(loop, reports):
    document = Document()
    tornado = SimpleNamespace(add_callback=lambda act, *given: loop(lambda: act(*given)))
    schedule = on_its_thread(document, tornado)
    worker = threading.Thread(target=schedule, args=(lambda: reports.append("a"),))
    worker.start()
    worker.join()
    assert reports == document.threads == []
    loop.run_until(lambda: reports == ["a"])
    assert document.threads == [threading.current_thread()]
    document.session_context = None  # its browser is gone
    schedule(lambda: reports.append("b"))
    loop.run_out()
    assert reports == ["a"]


def test_work_that_gives_up_by_itself_has_failed(session, loop):
    def give_up(progress):
        raise Cancelled

    session.work.start("x", give_up, print)
    loop.rest(session)
    assert not session.state.busy
    assert session.state.message[0] == "error"
