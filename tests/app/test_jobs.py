"""Work off the event loop: results, progress, errors; stopped and superseded work."""

import threading
from functools import partial
from types import SimpleNamespace

import pytest

from cutcell_app.derive.jobs import MAX_UNRESPONSIVE, Gate, on_its_thread
from cutcell_app.derive.work import Work

LESS = 0.2
"""Seconds of patience in a test."""


@pytest.fixture
def told():
    return []


def begin(work, action, told, report=lambda stage, fraction: None):
    """Start some work of one name, of which results are told."""
    work.start("work", action, told.append, report=report)


@pytest.fixture
def start(loop, told):
    def fail(error):
        told.append(("failed", error, threading.current_thread()))

    work = Work(loop, fail)

    def start(action):
        work.start(
            "work",
            action,
            lambda result: told.append(("done", result, threading.current_thread())),
            report=lambda stage, fraction: told.append(("progress", stage, fraction)),
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


def test_work_runs_in_another_thread_and_is_told_of_in_this(loop, told, start):
    start(lambda progress: threading.current_thread())
    loop.run_until(lambda: len(told) == 1)
    what, worker, teller = told[0]
    assert what == "done"
    assert worker is not threading.current_thread()
    assert teller is threading.current_thread()
    assert not start.work.busy


def test_progress_arrives_before_the_result(loop, told, start):
    def work(progress):
        for stage in ("one", "two"):
            progress(stage, 0.25)
        return 3

    start(work)
    loop.run_until(lambda: any(t[0] == "done" for t in told))
    assert [t[:2] for t in told] == [("progress", "one"), ("progress", "two"), ("done", 3)]


def test_progress_is_thinned_out(loop, told, start):
    start(lambda progress: [progress("many", i / 10000) for i in range(10000)] and None)
    loop.run_until(lambda: any(t[0] == "done" for t in told))
    assert len(told) < 200


def test_errors_are_told(loop, told, start):
    def work(progress):
        raise ValueError("no")

    start(work)
    loop.run_until(lambda: bool(told))
    assert told[0][0] == "failed"
    assert str(told[0][1]) == "no"


def test_newer_work_supersedes_what_runs(loop, told, start):
    started = threading.Event()
    start(endless(started))
    assert started.wait(120)
    start(lambda progress: "new")
    loop.run_until(lambda: any(t[0] == "done" for t in told))
    loop.run_for(0.2)
    assert [t[1] for t in told if t[0] != "progress"] == ["new"]


def test_a_result_that_comes_too_late_is_dropped(loop, told, start):
    held, go = threading.Event(), threading.Event()

    def deaf(progress):  # asks for no permission to go on, as a numeric kernel does
        held.set()
        assert go.wait(10)
        return "old"

    start(deaf)
    assert held.wait(10)
    start(lambda progress: "new")
    go.set()
    loop.run_until(lambda: any(t[0] == "done" for t in told))
    loop.run_for(0.2)
    assert [t[1] for t in told if t[0] == "done"] == ["new"]


def test_cancelling_stops_without_a_word(loop, told, start):
    started = threading.Event()
    start(endless(started))
    assert started.wait(120)
    assert start.work.cancel("work")
    assert not start.work.cancel("work")
    loop.run_for(0.2)
    assert [t for t in told if t[0] != "progress"] == []


def test_a_closed_session_starts_nothing(loop, told, start):
    start.work.close()
    start(lambda progress: 1)
    loop.run_for(0.1)
    assert told == []


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
    started, told = threading.Event(), []
    first, second = Work(loop, told.append), Work(loop, told.append)
    begin(first, endless(started), told)
    assert started.wait(120)
    stages = []
    begin(second, lambda p: "never", told, lambda stage, f: stages.append(stage))
    loop.run_until(lambda: bool(stages))
    assert "waiting" in stages[0]
    second.close()
    first.close()
    loop.run_for(0.3)
    assert told == []


def deaf_work(go, started=None):
    """Work that does not look whether it is still wanted."""

    def work(progress):
        if started is not None:
            started.set()
        assert go.wait(30)

    return work


def nothing(*given):
    pass


@pytest.fixture
def impatient(monkeypatch):
    """Let stopped work be waited for less long."""
    monkeypatch.setattr("cutcell_app.derive.jobs.PATIENCE", LESS)


def test_stopped_work_that_does_not_look_holds_nobody_up_for_long(loop, told, impatient):
    go, started = threading.Event(), threading.Event()
    deaf, other = Work(loop, nothing), Work(loop, told.append)
    begin(deaf, deaf_work(go, started), [])
    assert started.wait(120)
    begin(other, lambda progress: "done", told)
    loop.run_for(LESS + 0.3)
    assert told == [], "it is wanted, and others wait for it"
    deaf.cancel("work")
    loop.run_until(lambda: told == ["done"])
    go.set()


def test_only_so_much_of_it_goes_on_beside_what_is_wanted(loop, told, impatient):
    go, deaf = threading.Event(), Work(loop, nothing)
    for _ in range(MAX_UNRESPONSIVE + 1):
        started = threading.Event()
        begin(deaf, deaf_work(go, started), [])
        assert started.wait(LESS + 120)
    deaf.cancel("work")
    other = Work(loop, told.append)
    begin(other, lambda progress: "done", told)
    loop.run_for(LESS + 0.5)
    assert told == []
    go.set()
    loop.run_until(lambda: told == ["done"])


def test_of_what_a_slider_asks_for_only_the_newest_is_done(loop, told):
    go, begun = threading.Event(), []
    work_of_page = Work(loop, told.append)

    def work(number, progress):
        begun.append(number)
        assert go.wait(10)
        return number

    for number in range(5):
        work_of_page.newest("scene", partial(work, number), told.append)
    loop.run_for(0.1)
    go.set()
    loop.run_until(lambda: told == [0, 4])
    assert begun == [0, 4]


def test_the_newest_is_done_after_a_failure_too(loop, told):
    work_of_page = Work(loop, told.append)
    error, go = ValueError("no"), threading.Event()

    def fails(progress):
        assert go.wait(10)
        raise error

    work_of_page.newest("scene", fails, told.append)
    work_of_page.newest("scene", lambda progress: "yes", told.append)
    go.set()
    loop.run_until(lambda: told == [error, "yes"])
    work_of_page.close()


def test_running_out_of_memory_is_told_like_any_error(loop, told, start):
    def work(progress):
        raise MemoryError("Unable to allocate 44.0 GiB")

    start(work)
    loop.run_until(lambda: bool(told))
    assert told[0][0] == "failed"
    start(lambda progress: "next")
    loop.run_until(lambda: told[-1][:2] == ("done", "next"))


def test_a_gate_holds_actions_back_and_keeps_their_order(loop):
    told = []
    gate = Gate(loop)
    for i in range(3):
        gate(lambda i=i: told.append(i))
    loop.run_for(0.1)
    assert told == []
    gate.open()
    gate(lambda: told.append(3))
    loop.run_until(lambda: len(told) == 4)
    assert told == [0, 1, 2, 3]


class Document:
    """Notes on which threads it is asked for something."""

    def __init__(self):
        self.session_context = object()
        self.threads = []

    def add_next_tick_callback(self, action):
        self.threads.append(threading.current_thread())
        action()


def test_a_document_is_only_touched_on_its_own_thread(loop, told):
    document = Document()
    tornado = SimpleNamespace(add_callback=lambda act, *given: loop(lambda: act(*given)))
    schedule = on_its_thread(document, tornado)
    worker = threading.Thread(target=schedule, args=(lambda: told.append("a"),))
    worker.start()
    worker.join()
    assert told == document.threads == []
    loop.run_until(lambda: told == ["a"])
    assert document.threads == [threading.current_thread()]
    document.session_context = None  # its browser is gone
    schedule(lambda: told.append("b"))
    loop.run_for(0.05)
    assert told == ["a"]
