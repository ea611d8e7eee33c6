"""Limits of connections: idle ones are closed for new ones."""

import sys
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.iostream import IOStream

from .handlers import MAX_SESSIONS

MIN_CONNECTIONS, MAX_CONNECTIONS = 16, 400
"""Limit of connections, besides websockets. A browser opens up to six to load a page."""
FILES = 48
"""Files of the process that are neither connections nor websockets, at most."""


def max_connections() -> int:
    """Return how many connections fit into the number of files that this process may open."""
    if sys.platform != "win32":
        import resource

        files, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        if files != resource.RLIM_INFINITY:
            return min(MAX_CONNECTIONS, max(files - FILES - MAX_SESSIONS, MIN_CONNECTIONS))
    return MAX_CONNECTIONS


class LimitedServer(HTTPServer):
    """Closes a connection when one too many is open, in all or of one network address.

    The oldest that waits for its client is closed, so that new visitors get in while others send
    half of a request. Websockets do not count, because sessions have their own limit.
    """

    def initialize(self, *args: Any, **options: Any) -> None:
        """Store the options of the server."""
        super().initialize(*args, **options)
        self._clients: dict[IOStream, str] = {}
        self._limit = max_connections()

    def handle_stream(self, stream: IOStream, address: tuple[Any, ...]) -> None:
        """Serve a new connection."""
        client = self._clients[stream] = str(address[0])
        super().handle_stream(stream, address)
        self._close_surplus([one for one, of in self._clients.items() if of == client], 2)
        self._close_surplus(list(self._clients), 1)

    def on_close(self, server_conn: Any) -> None:
        """Stop counting a connection that has ended or become a websocket."""
        self._clients.pop(server_conn.stream, None)
        super().on_close(server_conn)

    def _close_surplus(self, streams: list[IOStream], share: int) -> None:
        if len(streams) > self._limit // share:
            # The first of those that are being read, or else the first of all.
            stream = min(streams, key=lambda one: not one.reading())
            del self._clients[stream]
            stream.close()
