"""Access control: answers to requests outside of sessions.

The page is text and costs next to nothing; a session begins when its websocket opens. Websockets
are accepted only from pages of this server, with the token of a page that is at most five minutes
old, and requests for unknown host names are refused (DNS rebinding).
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Collection, Mapping
from functools import cached_property
from typing import Any
from urllib.parse import urlparse

from bokeh.server.contexts import ApplicationContext
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import check_allowlist
from bokeh.server.views.ico_handler import IcoHandler
from bokeh.server.views.multi_root_static_handler import MultiRootStaticHandler
from bokeh.server.views.static_handler import StaticHandler
from bokeh.util import token as tokens
from panel.io.document import _cleanup_doc
from panel.io.resources import Resources
from panel.io.server import WSHandler, server_html_page_for_session
from panel.io.session import generate_session
from panel.io.state import set_curdoc
from tornado.routing import Rule
from tornado.web import ErrorHandler, RequestHandler, StaticFileHandler

from .frames import headers_of
from .hosts import PLAIN, MisdirectedRequest, UnknownHost

MAX_SESSIONS = 64
"""Limit of open pages; each takes some 30 MB, and its character."""
MAX_SESSIONS_OF_CLIENT = MAX_SESSIONS // 2
"""Limit for one network address: enough for a class, but not the whole server."""

PUBLIC = (IcoHandler, StaticHandler, MultiRootStaticHandler)
"""Handlers of Bokeh and Panel that are kept: they answer anyone with files of their packages."""

REMEDY = "Close one, or come back later."
FULL_OF_CLIENT = (
    f"Your network address has its limit of {MAX_SESSIONS_OF_CLIENT} pages open. {REMEDY}"
)
FULL = f"The limit of {MAX_SESSIONS} open pages is reached. {REMEDY}"

CACHED_SECONDS = 365 * 24 * 3600
"""Lifetime in browsers' caches of files whose address contains their version."""
TOKEN = "token-of-the-session"
"""Placeholder in the page's text of the part that differs for each visitor."""


def guard(
    tornado: BokehTornado,
    hosts: Collection[str],
    static: Mapping[str, str] | None = None,
    head: str = "",
    frames: Collection[str] = (),
) -> PageText:
    """Restrict a server to permitted visitors; return the text of its page.

    Parameters
    ----------
    tornado : BokehTornado
        With one application, at "/".
    hosts : collection of str
        The hosts, with their port, that browsers may use for this server.
    static : mapping, optional
        Folders by their addresses, under which files never change.
    head : str
        HTML that is added to the head of the page.
    frames : collection of str
        Origins whose pages may put this page into a frame; see `check_origins`.
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
        (r"/?", PageHandler, {"context": context, "text": text, "frames": frames}),
        (r"/ws", SocketHandler, websocket),
        # No file system has such a name; looking for it fails.
        (r".*%00.*", ErrorHandler, {"status_code": 404}),
        *(
            (rf"/{address}/(.*)", ImmutableFiles, {"path": path})
            for address, path in (static or {}).items()
        ),
    ]
    # The others begin sessions or import modules.
    public = tornado.wildcard_router.rules
    public[:] = [rule for rule in public if rule.target in PUBLIC]
    tornado.add_handlers(".*", routes)
    unknown = Rule(UnknownHost(hosts), MisdirectedRequest, {"hosts": hosts})
    tornado.default_router.rules.insert(0, tornado.default_router.process_rule(unknown))
    return text


def full(context: ApplicationContext) -> bool:
    """Return whether no more sessions can begin; sessions without a browser are asked to end."""
    sessions = list(context.sessions)
    if len(sessions) < MAX_SESSIONS:
        return False
    for session in sessions:
        if session.connection_count == 0:
            session.request_expiration()
    return True


class PageText:
    """The page's HTML, made once: it is the same for all visitors except the session's token."""

    def __init__(self, tornado: BokehTornado, context: ApplicationContext, head: str = "") -> None:
        self._tornado = tornado
        self._head = head
        self._context = context

    def __call__(self, token: str) -> str:
        """Return the page for a visitor."""
        return self.text.replace(TOKEN, token)

    @cached_property
    def text(self) -> str:
        """The page with a placeholder for the token."""
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

    def initialize(
        self, context: ApplicationContext, text: PageText, frames: Collection[str] = ()
    ) -> None:
        """Store the options of the route."""
        self._context = context
        self._text = text
        self._frames = frames

    def prepare(self) -> None:
        """Refuse when the server is full; let only allowed sites put the page into a frame."""
        self.set_header("Cache-Control", "no-store")
        for name, value in headers_of(self._frames).items():
            self.set_header(name, value)
        if full(self._context):
            self.set_status(503)
            self.finish(PLAIN.format(FULL))

    def head(self) -> None:
        """Report that the server is up and not full."""

    def get(self) -> None:
        """Answer with the page."""
        agent = self.request.headers.get("User-Agent", "")
        arguments = {name: values[:1] for name, values in self.request.arguments.items()}
        server: Any = self.application
        signed = {"secret_key": server.secret_key, "signed": server.sign_sessions}
        token = tokens.generate_jwt_token(
            tokens.generate_session_id(**signed),
            **signed,
            extra_payload={
                "headers": {"User-Agent": agent[:400]},
                "cookies": {},
                "arguments": arguments,
                **self._context.application.process_request(self.request),
            },
        )
        self.finish(self._text(token))


class SocketHandler(WSHandler):
    """Accepts websockets only from pages of this server, up to the limit of sessions."""

    def initialize(self, *args: Any, **options: Any) -> None:
        """Store the options of the route; `clients` counts the open websockets of each address."""
        self._hosts, self._clients = options["hosts"], options["clients"]
        self._is_counted = False

    async def prepare(self) -> None:
        """Refuse before the handshake."""
        if "Origin" not in self.request.headers:
            # Browsers always send it: this is a program that may run for anyone.
            self._refuse(403, "A websocket must have an Origin.")
        elif not self._has_token():
            self._refuse(403, "The page is too old. Reload it.")
        elif full(self.application_context) or self._clients.total() >= MAX_SESSIONS:
            self._refuse(503, FULL)
        elif self._clients[self._client] >= MAX_SESSIONS_OF_CLIENT:
            self._refuse(503, FULL_OF_CLIENT)
        else:
            await super().prepare()

    @property
    def _client(self) -> str:
        return str(self.request.remote_ip)

    def open(self, *args: Any, **more: Any) -> None:
        """Begin, or rejoin, the session of the request's token."""
        self._is_counted = True
        self._clients[self._client] += 1
        super().open(*args, **more)

    def ping(self, data: str | bytes = b"") -> None:
        """Send a ping, unless the websocket is closed and `on_close` has yet to be called.

        An error would let Bokeh take the session away before the last messages are handled.
        """
        if self.ws_connection is None or not self.ws_connection.is_closing():
            super().ping(data)

    def on_close(self) -> None:
        """Count one page of the client less."""
        if self._is_counted:
            self._is_counted = False
            self._clients[self._client] -= 1
        super().on_close()

    def check_origin(self, origin: str) -> bool:
        """Return whether a page of this origin may talk to the server."""
        return check_allowlist(urlparse(origin).netloc.lower(), list(self._hosts))

    async def _async_open(self, token: str) -> None:
        if self.ws_connection is not None:  # else it has ended already
            await super()._async_open(token)

    def _has_token(self) -> bool:
        """Return whether the request has a token that this server made a few minutes ago."""
        server: Any = self.application
        try:
            kind, token = self.request.headers["Sec-WebSocket-Protocol"].replace(" ", "").split(",")
            return (
                kind == "bokeh"
                and tokens.check_token_signature(token, server.secret_key, server.sign_sessions)
                and tokens.get_token_payload(token)["session_expiry"] > time.time()
            )
        except Exception:  # of Bokeh, which expects tokens to be whole
            return False

    def _refuse(self, status: int, sentence: str) -> None:
        self.set_status(status)
        self.finish(sentence)


class ImmutableFiles(StaticFileHandler):
    """Answers with files that browsers may keep, because each version has its own address."""

    def get_cache_time(self, *args: Any) -> int:
        """Return for how many seconds."""
        return CACHED_SECONDS
