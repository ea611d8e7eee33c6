"""Visitors that send half of a request, or read half of an answer, keep nobody else out."""

import socket
import sys
from contextlib import ExitStack

import pytest

from benchmarks.visitors import Visitor, served
from cutcell_app.serve import TIMEOUTS
from cutcell_app.server import connections
from cutcell_app.server.connections import FILES, MAX_CONNECTIONS, MIN_CONNECTIONS, max_connections
from cutcell_app.server.handlers import MAX_SESSIONS
from tests.app.loop import wait_until
from tests.app.serving import serving

pytestmark = pytest.mark.slow

HALVES = (
    b"",
    b"GET / HTTP/1.1\r\nHost: ",
    b"POST / HTTP/1.1\r\nHost: localhost:%d\r\nContent-Length: 9\r\n\r\n1234",
    b"GET /static/js/bokeh.min.js HTTP/1.1\r\nHost: localhost:%d\r\n\r\n",  # and never reads
    b"GET /ws HTTP/1.1\r\nHost: localhost:%d\r\nOrigin: http://localhost:%d\r\n"
    b"Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    b"Sec-WebSocket-Key: x3JJHMbDL1EzLkh9GBhXDw==\r\nSec-WebSocket-Protocol: bokeh, x\r\n\r\n",
)
"""What strangers send before they keep the server waiting."""


@pytest.fixture(scope="module")
def here():
    with serving() as here:
        yield here


@pytest.fixture
def opened():
    """Open sockets that are closed after the test."""
    sockets = []

    def begin(port, data=b"", source="127.0.0.1"):
        sockets.append(socket.create_connection(("127.0.0.1", port), 120, (source, 0)))
        sockets[-1].sendall(data.replace(b"%d", str(port).encode()))
        return sockets[-1]

    yield begin
    for one in sockets:
        one.close()


def is_closed(one):
    """Wait until the server closes a connection, or answers on it."""
    try:
        return one.recv(1) == b""
    except ConnectionResetError:
        return True


def answers(one, port):
    """Return whether the server answers a request on a connection."""
    one.sendall(b"GET /none HTTP/1.1\r\nHost: localhost:%d\r\n\r\n" % port)
    return b"HTTP/1.1 404" in one.recv(10**4)


def test_the_longest_waiting_connection_makes_way(here, opened, monkeypatch):
    monkeypatch.setattr(here.server._http, "_limit", 8)
    waiting = [opened(here.port, HALVES[1]) for _ in range(4)]
    assert answers(opened(here.port), here.port)
    assert is_closed(waiting[0])
    used = opened(here.port)
    assert answers(used, here.port)
    assert is_closed(waiting[1])


@pytest.mark.skipif(sys.platform != "linux", reason="one address for the machine itself")
def test_an_address_closes_its_own_connections_first(here, opened, monkeypatch):
    monkeypatch.setattr(here.server._http, "_limit", 8)
    first = opened(here.port)
    flood = [opened(here.port, HALVES[1], "127.0.0.2") for _ in range(12)]
    assert all(is_closed(one) for one in flood[:8])
    assert answers(first, here.port)


def test_what_waits_goes_before_what_is_served():
    class Stream:
        def __init__(self, waits):
            self.waits, self.is_open = waits, True

        def reading(self):
            return self.waits

        def close(self):
            self.is_open = False

    server = object.__new__(connections.LimitedServer)
    served, waiting, other = (Stream(waits) for waits in (False, True, True))
    server._clients, server._limit = dict.fromkeys((served, waiting, other), "a"), 2
    server._close_surplus(list(server._clients), 1)
    assert (served.is_open, waiting.is_open, other.is_open) == (True, False, True)
    assert waiting not in server._clients


def test_half_a_request_is_not_waited_for_for_long(here, opened, monkeypatch):
    visitor = Visitor(here.address, "?rig=robot&resolution=16")
    limits = here.server._http.conn_params
    assert (limits.header_timeout, limits.body_timeout) == tuple(TIMEOUTS.values())
    monkeypatch.setattr(limits, "header_timeout", 0.2)
    monkeypatch.setattr(limits, "body_timeout", 0.2)
    for half in HALVES[:3]:
        assert is_closed(opened(here.port, half))
    wait_until(lambda: not here.server._http._clients)
    visitor.tell(type="ready", width=900)
    visitor.wait_for("interior, .* surface")
    visitor.close()


def test_closed_connections_and_websockets_are_not_counted(here, opened):
    visitor = Visitor(here.address, "?rig=robot&resolution=16")
    wait_until(lambda: not here.server._http._clients)
    opened(here.port)
    wait_until(lambda: len(here.server._http._clients) == 1)
    visitor.close()


def test_a_ping_to_a_closed_websocket_leaves_its_end_to_on_close(here, opened, caplog):
    wait_until(lambda: here.is_left)
    opened(here.port, here.handshake(here.address))
    tornado = here.server._tornado
    wait_until(lambda: tornado._clients)

    def close_and_ping():
        for client in list(tornado._clients):
            client._socket.ws_connection.stream.close()
        tornado._keep_alive()

    here.server.io_loop.add_callback(close_and_ping)
    wait_until(lambda: here.is_left and not tornado._clients)
    assert [record for record in caplog.records if record.levelname == "ERROR"] == []


def test_websockets_that_share_a_session_are_limited(here, opened, monkeypatch):
    wait_until(lambda: here.is_left)
    token = here.token()
    monkeypatch.setattr("cutcell_app.server.handlers.MAX_SESSIONS", 2)
    for _ in range(2):
        assert b" 101 " in opened(here.port, here.handshake(here.address, token)).recv(100)
    assert len(here.sessions) <= 1
    assert here.upgrade(here.address, token) == 503


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        (-1, MAX_CONNECTIONS),
        (2**63 - 1, MAX_CONNECTIONS),
        (1024, MAX_CONNECTIONS),
        (256, 256 - FILES - MAX_SESSIONS),
        (64, MIN_CONNECTIONS),
    ],
)
def test_the_limit_leaves_files_for_sessions(monkeypatch, files, expected):
    resource = pytest.importorskip("resource")
    monkeypatch.setattr(resource, "RLIM_INFINITY", -1)
    monkeypatch.setattr(resource, "getrlimit", lambda kind: (files, files))
    assert max_connections() == expected


@pytest.mark.skipif(sys.platform == "win32", reason="no limits of a process")
def test_three_hundred_halves_keep_nobody_out_of_256_files(monkeypatch, opened, tmp_path):
    limited = tmp_path / "python"
    limited.write_text(f'#!/bin/sh\nulimit -n 256\nexec "{sys.executable}" "$@"\n')
    limited.chmod(0o755)
    with ExitStack() as stack:
        with monkeypatch.context() as patch:
            patch.setattr(sys, "executable", str(limited))
            address = stack.enter_context(served()).address
        port = int(address.rpartition(":")[2])
        before = Visitor(address, "?rig=robot&resolution=16")
        for index in range(300):
            opened(port, HALVES[index % len(HALVES)])
        assert answers(opened(port), port)
        Visitor(address, "?rig=robot&resolution=16").close()
        before.wait_for("interior, .* surface")
        before.close()
