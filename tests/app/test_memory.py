"""Sessions of the page's server: apart while they last, gone when they end."""

import gc
import logging
import time
import weakref

import panel as pn
import panel_material_ui  # noqa: F401  its components must be known before a page is served
import pytest

from app.page import page
from app.serve import free_port
from app.session import Session
from assets import demo_path
from benchmarks.visitors import BOUND, Visitor


@pytest.fixture(scope="module")
def address():
    port = free_port(0)
    server = pn.serve(
        {"/": lambda: page(demo_path("robot"))},
        port=port, threaded=True, show=False, verbose=False,
        websocket_origin=[f"localhost:{port}"],
        check_unused_sessions_milliseconds=100, unused_session_lifetime_milliseconds=200,
    )  # fmt: skip
    yield f"http://localhost:{port}"
    server.stop()


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
    visitors = [Visitor(address) for _ in range(3)]
    for visitor in visitors:
        visitor.wait_for(BOUND)
    assert len(sessions) == 3
    assert len({id(session.state) for session in sessions}) == 3
    assert len({session.folder for session in sessions}) == 3
    for visitor in visitors:
        visitor.close()
    end = time.monotonic() + 30
    while len(sessions) and time.monotonic() < end:
        time.sleep(0.2)
        gc.collect()
    assert not len(sessions), "something still holds sessions that ended"
