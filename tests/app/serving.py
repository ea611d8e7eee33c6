"""A server of the page in a thread of this process, so that a test can look into it."""

from __future__ import annotations

import asyncio
import http.client
import socket
import threading
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tornado.ioloop import IOLoop

from benchmarks.visitors import token_of
from cutcell_app.serve import begin, free_port
from tests.app.loop import wait_until


class Serving:
    """A server and where it is.

    Parameters
    ----------
    port : int
    server : panel.io.server.Server
    """

    def __init__(self, port: int, server: Any) -> None:
        self.port = port
        self.server = server
        self.host = f"localhost:{port}"
        self.address = f"http://{self.host}"

    @property
    def sessions(self) -> list[Any]:
        """Return the sessions that Bokeh knows."""
        return self.server.get_sessions("/")

    @property
    def is_left(self) -> bool:
        """Whether no websocket is open and no session is left."""
        routers = [rule.target for rule in self.server._tornado.default_router.rules]
        rules = [rule for router in routers for rule in getattr(router, "rules", ())]
        (clients,) = [
            rule.target_kwargs["clients"] for rule in rules if "clients" in rule.target_kwargs
        ]
        return not clients.total() and not self.sessions

    def get(self, path: str = "/", method: str = "GET", **headers: str) -> Any:
        """Ask for a page; return the answer, its text in `text`."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        try:
            given = {name.replace("_", "-"): value for name, value in headers.items()}
            connection.request(method, path, headers={"Host": self.host, **given})
            answer: Any = connection.getresponse()
            answer.text = answer.read().decode(errors="replace")
            return answer
        finally:
            connection.close()

    def token(self) -> str:
        """Return the token of a new page."""
        return token_of(self.get().text)

    def handshake(self, origin: str | None, token: str | None = None, host: str = "") -> bytes:
        """Return the request for a websocket, by default with the token of a new page."""
        token = self.token() if token is None else token
        lines = [
            "GET /ws HTTP/1.1", f"Host: {host or self.host}", "Connection: Upgrade",
            "Upgrade: websocket", "Sec-WebSocket-Version: 13",
            "Sec-WebSocket-Key: x3JJHMbDL1EzLkh9GBhXDw==",
            *([f"Sec-WebSocket-Protocol: bokeh, {token}"] if token else []),
            *([] if origin is None else [f"Origin: {origin}"]), "", "",
        ]  # fmt: skip
        return "\r\n".join(lines).encode("latin-1")

    def upgrade(self, origin: str | None, token: str | None = None, host: str = "") -> int:
        """Ask for a websocket as no browser could; return the status of the answer."""
        with socket.create_connection(("127.0.0.1", self.port), 120) as raw:
            raw.sendall(self.handshake(origin, token, host))
            return int(raw.recv(100).split()[1])


@contextmanager
def serving(
    path: Path | None = None, address: str = "localhost", frames: Collection[str] = ()
) -> Iterator[Serving]:
    """Serve the page while the block runs; sessions that were left end within a second."""
    port = free_port(0, address)
    ready, result = threading.Event(), []
    quick = {"check_unused_sessions_milliseconds": 100, "unused_session_lifetime_milliseconds": 200}

    def run() -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        server = begin(path, port, address, frames=frames, **quick)
        server.start()
        result.append(server)
        IOLoop.current().add_callback(ready.set)
        IOLoop.current().start()
        server.stop()
        server.unlisten()
        IOLoop.current().close(all_fds=True)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    assert ready.wait(60)
    try:
        yield Serving(port, result[0])
    finally:
        # What visitors began must not take its turn from the tests that follow.
        wait_until(lambda: not result[0].get_sessions("/"))
        wait_until(lambda: all(t.name != "cutcell job" for t in threading.enumerate()))
        result[0].io_loop.add_callback(result[0].io_loop.stop)
        thread.join(30)
