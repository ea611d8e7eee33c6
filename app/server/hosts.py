"""Answers to requests for host names that are not of this server."""

from collections.abc import Collection
from html import escape
from typing import Any

from bokeh.server.util import check_allowlist
from tornado.httputil import HTTPServerRequest
from tornado.routing import Matcher
from tornado.web import RequestHandler

PLAIN = """<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>cutcell</title>
<meta name="viewport" content="width=device-width">
<style>:root {{ color-scheme: light dark; font: 16px/1.5 system-ui, sans-serif }}
p {{ max-width: 36em; margin: 20vh auto 0; padding: 0 24px }}</style><p>{}</p>"""


class UnknownHost(Matcher):
    """Matches requests for unknown hosts."""

    def __init__(self, hosts: Collection[str]) -> None:
        self._hosts = list(hosts)

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """Return a match, or None for a known host."""
        return None if check_allowlist(request.host.lower(), self._hosts) else {}


class MisdirectedRequest(RequestHandler):
    """Answers requests for another host; see `UnknownHost`."""

    def initialize(self, hosts: Collection[str]) -> None:
        """Store the options of the route."""
        self._hosts = hosts

    def prepare(self) -> None:
        """Refuse."""
        self.set_status(421)
        links = " or ".join(f"http://{host}" for host in self._hosts)
        requested = escape(self.request.host[:100])
        self.finish(
            PLAIN.format(
                f"Unknown host name: {requested}. Open {escape(links)}. To serve under another "
                "name, set BOKEH_ALLOW_WS_ORIGIN to it, with its port."
            )
        )
