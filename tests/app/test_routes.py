"""Each route of a running server, asked by a stranger: no token, and the origin of another site."""

import random
import socket
import sys

import pytest
from tornado.routing import RuleRouter

from cutcell_app.document.session import Session
from cutcell_app.widgets.modules import ADDRESS
from tests.app.loop import wait_until
from tests.app.serving import serving

pytestmark = pytest.mark.slow

ELSEWHERE = "http://evil.example"
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")

ANYONE, PAGES, NOBODY = "anyone", "pages of this server, with their token", "nobody"
ROUTES = {
    ("UnknownHost", "MisdirectedRequest"): (NOBODY, None),
    ("/?$", "PageHandler"): (ANYONE, "/"),
    ("/ws$", "SocketHandler"): (PAGES, "/ws"),
    (".*%00.*$", "ErrorHandler"): (NOBODY, "/static/%00"),
    (f"/{ADDRESS}/(.*)$", "ImmutableFiles"): (ANYONE, f"/{ADDRESS}/view/view.js"),
    ("/favicon.ico$", "IcoHandler"): (ANYONE, "/favicon.ico"),
    ("/static/(?!extensions/)(.*)$", "StaticHandler"): (ANYONE, "/static/js/bokeh.min.js"),
    ("/static/extensions/(.*)$", "MultiRootStaticHandler"): (
        ANYONE,
        "/static/extensions/panel/panel.min.js",
    ),
    # Every address that it matches belongs to one of the two before.
    ("/static/(.*)$", "StaticHandler"): (ANYONE, "/static/js/bokeh.min.js"),
}
"""Who may ask at which address, by the pattern of the route and the name of its handler."""

ANSWERS = {ANYONE: {200, 405}, PAGES: {403}, NOBODY: {404, 421}}

OF_PANEL = (
    "/autoload.js?bokeh-autoload-element=a",
    "/autoload-js?bokeh-autoload-element=a",
    "/metadata",
    "/components/this/x/css/y",
    "/components/unittest.__main__/x/css/y",
    "/components/.x/x/css/y",
    "/components//x/css/y",
    "/rest/session_info",
    "/liveness",
    "/admin",
    "/login",
)
"""Addresses that other servers made with Panel answer, with a session at worst."""

PARTS = (
    "", ".", "..", "%2e%2e", "%2f", "%5c", "\\", "%00", "%0a", "%0d%0a", "%7f", "%ff", "%", "%zz",
    "%2500", "%C3%A9", "%e2%80%ae", "%F0%9F%98%80", ":", "~", "*", "con", "NUL", "x" * 300,
    "static", "extensions", "panel", "js", "bokeh.min.js", ADDRESS, "view.js", "components",
    "this", ".x", "ws", "metadata", "autoload.js", "favicon.ico", "{x}",
)  # fmt: skip


@pytest.fixture(scope="module")
def here():
    with serving() as here:
        here.get()  # the first makes the text of the page
        yield here


@pytest.fixture
def untouched(here, monkeypatch, caplog):
    """Check that what is asked begins no session, imports nothing and logs no traceback."""
    wait_until(lambda: here.is_left)
    begun, modules = [], set(sys.modules)
    monkeypatch.setattr(Session, "__init__", lambda self, *args, **kwargs: begun.append(self))
    yield
    assert not begun
    assert not here.sessions
    assert not {name for name in set(sys.modules) - modules if name.startswith(("this", "unitt"))}
    assert not [record.getMessage() for record in caplog.records if record.exc_info]


def leaves(router):
    """Return the rules that name a handler, by pattern and name."""
    for rule in router.rules:
        if isinstance(rule.target, RuleRouter):
            yield from leaves(rule.target)
        else:
            pattern = getattr(rule.matcher, "regex", None)
            name = pattern.pattern if pattern else type(rule.matcher).__name__
            yield name, getattr(rule.target, "__name__", repr(rule.target))


def test_every_route_is_known(here):
    tornado = here.server._tornado
    assert here.server._http.request_callback is tornado
    assert set(leaves(tornado.default_router)) == set(ROUTES)


def test_an_unknown_route_is_noticed(here):
    class Unknown:
        pass

    rules = here.server._tornado.wildcard_router
    rules.add_rules([("/components/(.*)", Unknown)])
    try:
        assert ("/components/(.*)$", "Unknown") in set(leaves(here.server._tornado.default_router))
    finally:
        rules.rules.pop()


@pytest.mark.parametrize("route", ROUTES, ids=str)
def test_a_stranger_asks(here, untouched, route):
    who, path = ROUTES[route]
    headers = {"Origin": ELSEWHERE, **({} if path else {"Host": f"evil.example:{here.port}"})}
    answers = [here.get(path or "/", method, **headers) for method in METHODS]
    assert {answer.status for answer in answers} <= ANSWERS[who]
    assert (answers[0].status == 200) == (who == ANYONE)
    assert {answer.getheader("Access-Control-Allow-Origin") for answer in answers} == {None}


@pytest.mark.parametrize("path", OF_PANEL)
def test_what_panel_would_answer_is_not_there(here, untouched, path):
    assert {here.get(path, method, Origin=ELSEWHERE).status for method in METHODS} == {404}


def test_a_stranger_opens_no_websocket(here, untouched):
    assert here.upgrade(ELSEWHERE, "") == 403
    assert here.upgrade(ELSEWHERE) == 403
    assert here.upgrade(here.address, "") == 403
    assert here.upgrade(None) == 403


@pytest.mark.parametrize("path", ["/static/%00", "/static/extensions/panel/%00", f"/{ADDRESS}/%00"])
def test_a_name_with_a_null_byte_is_not_there(here, untouched, path):
    assert here.get(path).status == 404


def test_no_address_fails(here, untouched):
    choose = random.Random(57)
    for _ in range(300):
        path = "".join(f"/{part}" for part in choose.choices(PARTS, k=choose.randrange(1, 6)))
        method = choose.choice(("GET", "GET", "HEAD", "POST", "OPTIONS"))
        line = f"{method} {path} HTTP/1.1\r\nHost: {here.host}\r\nConnection: close\r\n\r\n"
        with socket.create_connection(("127.0.0.1", here.port), 120) as raw:
            raw.sendall(line.encode("latin-1"))
            status = int(raw.recv(100).split()[1])
        assert status < 500, line
