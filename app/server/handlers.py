"""Who is let in: what the server answers to requests, before and beside its sessions.

A page that is asked for is text, and costs next to nothing; a session begins when its websocket
opens. Websockets are only taken from pages of this server, and nothing is answered to requests
that know this machine by a name that is not its own (DNS rebinding).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from html import escape
from typing import Any
from urllib.parse import urlparse

from bokeh.server.contexts import ApplicationContext
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import check_allowlist
from bokeh.util.token import generate_jwt_token, generate_session_id, get_token_payload
from panel.io.document import _cleanup_doc
from panel.io.resources import Resources
from panel.io.server import WSHandler, server_html_page_for_session
from panel.io.session import generate_session
from panel.io.state import set_curdoc
from tornado.httputil import HTTPServerRequest
from tornado.routing import Matcher, Rule
from tornado.web import RequestHandler, StaticFileHandler

MAX_SESSIONS = 64
"""Pages that are open at once; each holds some 30 MB, and its character."""

MAX_SESSIONS_OF_CLIENT = MAX_SESSIONS // 2
"""Pages that one computer may have open: a class behind one address, but not the whole server."""

FULL_OF_CLIENT = (
    f"Your network address has its limit of {MAX_SESSIONS_OF_CLIENT} pages open. Close one, or "
    "come back later."
)

FULL = (
    f"As many pages of this server are open as it holds ({MAX_SESSIONS}). Close one, or come back "
    "later."
)

KEPT_SECONDS = 365 * 24 * 3600
"""How long browsers keep files whose address tells their version."""

TOKEN = "token-of-the-session"
"""Placeholder in the page's text of the part that differs for each visitor."""

PLAIN = """<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>cutcell</title>
<meta name="viewport" content="width=device-width">
<style>:root {{ color-scheme: light dark; font: 16px/1.5 system-ui, sans-serif }}
p {{ max-width: 36em; margin: 20vh auto 0; padding: 0 24px }}</style><p>{}</p>"""


def guard(
    tornado: BokehTornado,
    hosts: Collection[str],
    static: Mapping[str, str] | None = None,
    head: str = "",
) -> PageText:
    """Restrict a server to permitted visitors; return the text of its page.

    Parameters
    ----------
    tornado : BokehTornado
        With one application, at "/".
    hosts : collection of str
        The hosts, with their port, under which browsers know this server.
    static : mapping, optional
        Folders by their addresses; what is in them never changes under the same address.
    head : str
        What is added to the head of the page.
    """
    context = tornado.applications["/"]
    text = PageText(tornado, context, head)
    websocket = {
        "application_context": context,
        "bokeh_websocket_path": "/ws",
        "hosts": hosts,
        "clients": Counter(),
    }
    routes: list[Any] = [
        (r"/?", PageHandler, {"context": context, "text": text}),
        (r"/ws", SocketHandler, websocket),
        # These would begin sessions, too.
        (r"/autoload\.js", Absent),
        (r"/metadata", Absent),
        *(
            (rf"/{address}/(.*)", Lasting, {"path": path})
            for address, path in (static or {}).items()
        ),
    ]
    tornado.add_handlers(".*", routes)
    strange = Rule(Strange(hosts), Misdirected, {"hosts": hosts})
    tornado.default_router.rules.insert(0, tornado.default_router.process_rule(strange))
    return text


def full(context: ApplicationContext) -> bool:
    """Whether no more sessions can begin. Those that a browser has left are asked to end."""
    sessions = list(context.sessions)
    if len(sessions) < MAX_SESSIONS:
        return False
    for session in sessions:
        if session.connection_count == 0:
            session.request_expiration()
    return True


class PageText:
    """The page's HTML, made once: it is the same for all but for the token of the session."""

    def __init__(self, tornado: BokehTornado, context: ApplicationContext, head: str = "") -> None:
        self._tornado = tornado
        self._head = head
        self._context = context
        self._text = ""

    def __call__(self, token: str) -> str:
        """Return the page for a visitor."""
        self.make()
        return self._text.replace(TOKEN, token)

    def make(self) -> None:
        """Make it, unless that is done."""
        self._text = self._text or self._made()

    def _made(self) -> str:
        session = generate_session(self._context.application)
        document = session.document
        try:
            with set_curdoc(document):
                resources = Resources.from_bokeh(self._tornado.resources())
            text = server_html_page_for_session(
                session,
                resources=resources,
                title=document.title,
                token=TOKEN,
                template=document.template,
                template_variables=document.template_variables,
            )
            return text.replace("</head>", f"{self._head}</head>", 1)
        finally:
            _cleanup_doc(document)


class PageHandler(RequestHandler):
    """Answers with the page, whose script then opens the websocket."""

    def initialize(self, context: ApplicationContext, text: PageText) -> None:
        """Take what the routes give."""
        self._context = context
        self._text = text

    def prepare(self) -> None:
        """Refuse when the server is full; let no other site put the page into a frame."""
        self.set_header("Cache-Control", "no-store")
        self.set_header("Content-Security-Policy", "frame-ancestors 'self'")
        if full(self._context):
            self.set_status(503)
            self.finish(PLAIN.format(FULL))

    def head(self) -> None:
        """Report that the server is up and not full."""

    def get(self) -> None:
        """Answer with the page."""
        agent = self.request.headers.get("User-Agent", "")
        arguments = {name: values[:1] for name, values in self.request.arguments.items()}
        application = self._context.application
        token = generate_jwt_token(
            generate_session_id(),
            extra_payload={
                "headers": {"User-Agent": agent[:400]},
                "cookies": {},
                "arguments": arguments,
                **application.process_request(self.request),
            },
        )
        self.finish(self._text(token))


class SocketHandler(WSHandler):
    """Accepts websockets only from pages of this server, up to the limit of sessions."""

    def initialize(
        self,
        application_context: Any,
        bokeh_websocket_path: str,
        hosts: Collection[str] = (),
        clients: Counter[str] | None = None,
    ) -> None:
        """Take what the routes give; `clients` counts the open websockets of each address."""
        self._hosts = hosts
        self._clients = Counter() if clients is None else clients
        self._is_counted = False

    async def prepare(self) -> None:
        """Refuse before anything begins."""
        if "Origin" not in self.request.headers:
            # Browsers always tell it: this is a program that may run for anyone.
            self._refuse(403, "A websocket must tell its Origin.")
        elif full(self.application_context):
            self._refuse(503, FULL)
        elif self._clients[self._client] >= MAX_SESSIONS_OF_CLIENT:
            self._refuse(503, FULL_OF_CLIENT)
        else:
            await super().prepare()

    @property
    def _client(self) -> str:
        return str(self.request.remote_ip)

    def open(self, *args: Any, **more: Any) -> None:
        """Begin, or rejoin, the session of the token that came along."""
        try:
            get_token_payload(str(self._token))
        except Exception:
            self.close(1008, "no token of a session")
        else:
            self._is_counted = True
            self._clients[self._client] += 1
            super().open(*args, **more)

    def on_close(self) -> None:
        """Count one page of the client less."""
        if self._is_counted:
            self._is_counted = False
            self._clients[self._client] -= 1
        super().on_close()

    def check_origin(self, origin: str) -> bool:
        """Whether a page of this origin may talk to the server."""
        return check_allowlist(urlparse(origin).netloc.lower(), list(self._hosts))

    async def _async_open(self, token: str) -> None:
        if self.ws_connection is not None:  # else it has ended already
            await super()._async_open(token)

    def _refuse(self, status: int, sentence: str) -> None:
        self.set_status(status)
        self.finish(sentence)


class Lasting(StaticFileHandler):
    """Answers with files that browsers may keep, since another version has another address."""

    def get_cache_time(self, *args: Any) -> int:
        """Return for how many seconds."""
        return KEPT_SECONDS


class Absent(RequestHandler):
    """Answers that there is nothing here."""

    def prepare(self) -> None:
        """Refuse."""
        self.send_error(404)


class Strange(Matcher):
    """Requests to a host that this server is not."""

    def __init__(self, hosts: Collection[str]) -> None:
        self._hosts = list(hosts)

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """Return a match, or None where the host is one of ours."""
        return None if check_allowlist(request.host.lower(), self._hosts) else {}


class Misdirected(RequestHandler):
    """Answers requests for another host; see `Strange`."""

    def initialize(self, hosts: Collection[str]) -> None:
        """Take what the routes give."""
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
