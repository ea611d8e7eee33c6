"""No message to the browser stays on the server."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest
from bokeh.document import Document
from panel.io import document
from tornado.websocket import WebSocketClosedError

from cutcell_app.server.writes import patch_panel_dispatch

PRIVATE = ("_dispatch_msgs", "_WRITE_MSGS", "_WRITE_BLOCK", "extra_socket_handlers")


class Socket:
    """A browser's; a write to it ends when the test says so."""

    def __init__(self):
        self.messages, self.writes = [], []


class Connection:
    protocol = SimpleNamespace(create=lambda kind, events: events[0])

    def __init__(self):
        self._socket = Socket()


def write(connection, msg):
    socket = connection._socket
    socket.messages.append(msg)
    socket.writes.append(asyncio.get_running_loop().create_future())
    return socket.writes[-1:]


@pytest.fixture
def connection(monkeypatch):
    missing = [name for name in PRIVATE if not hasattr(document, name)]
    assert not missing, f"panel.io.document has no {missing}: see server/writes.py"
    monkeypatch.setattr(document, "_dispatch_msgs", document._dispatch_msgs)  # as it is afterwards
    monkeypatch.setitem(document.extra_socket_handlers, Socket, write)
    return Connection()


def run(coroutine):
    """Run a coroutine in a thread: a browser's loop may run in this one."""
    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, coroutine).result()


def test_a_message_that_comes_when_a_write_ends_is_written(connection):
    patch_panel_dispatch()
    socket, doc = connection._socket, Document()

    async def page():
        document.schedule_write_events(doc, [connection], ["first"])
        await asyncio.sleep(0.01)
        assert socket.messages == ["first"]
        socket.writes[0].set_result(None)
        document.schedule_write_events(doc, [connection], ["second"])
        await asyncio.sleep(0.01)
        assert socket.messages == ["first", "second"]
        socket.writes[1].set_result(None)
        await asyncio.sleep(0.01)

    run(page())
    assert doc not in document._WRITE_MSGS
    assert doc not in document._WRITE_BLOCK, "later ones are written at once"


def test_a_browser_that_leaves_between_two_parts_of_a_message_is_no_error(connection, monkeypatch):
    patch_panel_dispatch()
    doc = Document()

    def leave(connection, msg):
        raise WebSocketClosedError

    monkeypatch.setitem(document.extra_socket_handlers, Socket, leave)
    document._WRITE_MSGS[doc] = {connection: ["first"]}
    document._WRITE_BLOCK[doc] = True
    run(document._dispatch_msgs(doc))
    assert doc not in document._WRITE_BLOCK, "later ones are written at once"
