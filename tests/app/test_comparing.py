"""What several sessions compare at once: none waits for another's slow method."""

import threading

import pytest

from cutcell.isolated.run import _WANTED
from cutcell.runtime.progress import silent
from cutcell_app.derive.jobs import COMPARING, Job
from cutcell_app.document import loading
from cutcell_app.features.compare import results as compare
from cutcell_app.features.compare.controls import rows_of
from cutcell_app.shell.session.begin import begin
from cutcell_lab.baselines import METHODS, BaselineBinding
from tests.app.loop import NEVER
from tests.viewers.arm import arm_rig


@pytest.fixture
def sessions(loop):
    there = [begin(loop) for _ in range(2)]
    for session in there:
        session.state.resolution = 16
        loading.show_rig(session, arm_rig())
    loop.run_until(lambda: all(session.state.binding is not None for session in there), 60)
    yield there
    for session in there:
        session.close()


@pytest.fixture
def slow(monkeypatch):
    """Return a method that goes on until it is unwanted, and what tells that it began."""
    began, stopped = threading.Event(), threading.Event()

    def method(rig):
        began.set()
        try:
            while not stopped.wait(0.02):
                _WANTED.get()()
        finally:
            stopped.set()
        return BaselineBinding(None, failed="it was let go")

    monkeypatch.setitem(METHODS, "slow", method)
    yield began, stopped
    stopped.set()


def note(session, name):
    return next(row["note"] for row in rows_of(session.state) if row["id"] == name)


def test_a_slow_method_of_one_session_does_not_hold_up_another(sessions, loop, slow):
    one, other = sessions
    began, stopped = slow
    one.state.param.update(panel="compare", methods=["slow", "now"])
    assert began.wait(NEVER)
    other.state.param.update(panel="compare", methods=["now", "euclidean"])
    loop.run_until(lambda: len(other.state.compared) == 2, 60)
    assert ("compared", "slow") in one.state.computing
    assert note(one, "slow") == "Computing"
    compare.cancel(one)
    assert stopped.wait(NEVER)  # it was asked whether it is still wanted
    assert "slow" not in one.state.methods


def test_who_waits_is_told_so_and_can_leave(sessions, loop):
    session = sessions[0]
    others = [Job(loop, silent, silent, silent, silent, COMPARING) for _ in range(4)]
    assert all(COMPARING.take(job, 1) for job in others)
    try:
        session.state.param.update(panel="compare", methods=["now", "euclidean"])
        loop.run_until(lambda: ("compared", "now") in session.state.queued)
        assert note(session, "now") == "Waiting for other visitors"
        session.state.panel = "weights"
        assert not session.state.queued, "who left waits no more"
        session.state.panel = "compare"
    finally:
        for job in others:
            COMPARING.give_back(job)
    loop.run_until(lambda: len(session.state.compared) == 2, 60)
    assert not session.state.queued
