"""A server of the page in a thread of this process, so that a test can look into it."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tornado.ioloop import IOLoop

from cutcell_app.serve import begin, free_port


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
def serving(path: Path | None = None, address: str = "localhost") -> Iterator[Serving]:
    """Serve the page while the block runs; sessions that were left end within a second."""
    port = free_port(0, address)
    ready, found = threading.Event(), []
    quick = {"check_unused_sessions_milliseconds": 100, "unused_session_lifetime_milliseconds": 200}

    def run() -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        server = begin(path, port, address, **quick)
        server.start()
        found.append(server)
        IOLoop.current().add_callback(ready.set)
        IOLoop.current().start()
        server.stop()
        server.unlisten()
        IOLoop.current().close(all_fds=True)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    assert ready.wait(60)
    try:
        yield Serving(port, found[0])
    finally:
        # What visitors began must not take its turn from the tests that follow.
        _wait_until(lambda: not found[0].get_sessions("/"))
        _wait_until(lambda: all(t.name != "cutcell job" for t in threading.enumerate()))
        found[0].io_loop.add_callback(found[0].io_loop.stop)
        thread.join(30)


def _wait_until(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.05)
