"""A server of the page in a thread of this process, so that a test can look into it."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tornado.ioloop import IOLoop

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
