"""Sessions of the page's server: apart while they last, gone when they end."""

import gc
import logging
import time
import weakref

import pytest

from benchmarks.visitors import BOUND, Visitor
from cutcell_app.document.session import Session
from cutcell_assets import demo_path
from tests.app.loop import NEVER
from tests.app.serving import serving

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def address():
    with serving(demo_path("robot")) as here:
        yield here.address


@pytest.fixture(autouse=True)
def _unlogged():
    # What is logged is kept for the report of this test, and the sessions with it.
    logging.disable(logging.INFO)
    yield
    logging.disable(logging.NOTSET)


@pytest.fixture
def sessions(monkeypatch):
    """All sessions that begin, by weak references."""
    seen = weakref.WeakSet()
    begin = Session.__init__

    def noted(self, *args, **kwargs):
        begin(self, *args, **kwargs)
        seen.add(self)

    monkeypatch.setattr(Session, "__init__", noted)
    return seen


def test_ended_sessions_are_held_by_nothing(address, sessions):
    visitors = [Visitor(address, "?resolution=16") for _ in range(2)]
    for visitor in visitors:
        visitor.wait_for(BOUND)
    assert len(sessions) == 2
    assert len({id(session.state) for session in sessions}) == 2
    assert len({session.folder for session in sessions}) == 2
    for visitor in visitors:
        visitor.close()
    end = time.monotonic() + NEVER
    while len(sessions) and time.monotonic() < end:
        time.sleep(0.05)
        gc.collect()
    assert not len(sessions), "something still holds sessions that ended"
