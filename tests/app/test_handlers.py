"""Who is let in, and what it costs to be asked."""

import http.client
import re
import time
from urllib.parse import quote

import psutil
import pytest
from bokeh.util.token import generate_jwt_token, generate_session_id

from benchmarks.visitors import Visitor
from cutcell_app.document.session import Session
from cutcell_app.server import handlers
from cutcell_app.widgets.modules import ADDRESS, FOLDER
from tests.app.loop import wait_until
from tests.app.serving import serving

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def here():
    with serving() as here:
        yield here


@pytest.fixture
def begun(here, monkeypatch):
    """Collect the sessions that begin, in order."""
    wait_until(lambda: here.is_left)
    seen = []
    begin = Session.__init__

    def noted(self, *args, **kwargs):
        begin(self, *args, **kwargs)
        seen.append(self)

    monkeypatch.setattr(Session, "__init__", noted)
    return seen


def listening(port):
    """Return the addresses on which this process listens at a port."""
    result = psutil.Process().net_connections("inet")
    return {one.laddr.ip for one in result if one.laddr.port == port and one.status == "LISTEN"}


def test_it_listens_to_this_machine_only(here):
    assert listening(here.port) == {"127.0.0.1"}


def test_it_listens_to_all_only_when_asked():
    with serving(address="0.0.0.0") as here:
        assert listening(here.port) == {"0.0.0.0"}


@pytest.mark.parametrize(
    "origin", [None, "null", "", "http://evil.example", "http://localhost:1", "http://localhost"]
)
def test_a_missing_or_foreign_origin_is_refused(here, begun, origin):
    assert here.upgrade(origin) == 403
    assert not begun


def test_a_page_of_this_server_may_open_a_websocket(here):
    assert here.upgrade(here.address) == 101
    assert here.upgrade(f"http://127.0.0.1:{here.port}") == 101


def test_who_is_gone_at_once_is_forgotten(here):
    for _ in range(3):
        here.upgrade(here.address)
    wait_until(lambda: here.is_left)


def test_a_host_that_this_server_is_not_is_refused(here, begun):
    # A name that its owner lets point to 127.0.0.1, once the browser has his page.
    host = f"rebound.example:{here.port}"
    answer = here.get(Host=host)
    assert answer.status == 421
    assert here.address in answer.text
    assert here.upgrade(f"http://{host}", host=host) == 421
    assert here.get("/static/js/bokeh.min.js", Host=host).status == 421
    assert here.get(Host=f"127.0.0.1:{here.port}").status == 200
    assert not begun


def test_scripts_are_served_and_nothing_beside_them(here):
    answer = here.get(f"/{ADDRESS}/view/view.js")
    assert answer.status == 200
    assert "javascript" in answer.getheader("Content-Type")
    assert answer.text == (FOLDER / "view/view.js").read_text(encoding="utf-8")
    assert here.get(f"/{ADDRESS}/view/view.js", Host=f"rebound.example:{here.port}").status == 421
    absolute = quote(str(FOLDER.parent / "serve.py"))
    for path in ("/../serve.py", "/..%2fserve.py", "/", "/none.js", f"/{absolute}"):
        assert here.get(f"/{ADDRESS}{path}").status in (403, 404)


def test_a_strange_host_is_told_as_text(here):
    assert "<b>" not in here.get(Host="<b>x</b>").text


def made(here, key=None, seconds=300, **payload):
    """Return a token, by default as the server makes it."""
    key = here.server._tornado.secret_key if key is None else key
    session_id = generate_session_id(key, signed=True)
    return generate_jwt_token(session_id, key, True, payload, expiration=seconds)


@pytest.mark.parametrize(
    "token",
    [
        "", "abc", "abc.def", "e30", "%00", "a.b.c", "a, b", "e30.e30", "\xff.\xff",
        lambda here: made(here, seconds=-1),
        lambda here: made(here, key=b"of another server"),
        lambda here: generate_jwt_token(generate_session_id()),
        lambda here: made(here).partition(".")[0],
        lambda here: made(here) + "x",
    ],
)  # fmt: skip
def test_a_token_that_is_none_begins_nothing(here, begun, caplog, token):
    token = token(here) if callable(token) else token
    assert here.upgrade(here.address, token) == 403
    assert here.get().status == 200
    assert not begun
    assert not [record for record in caplog.records if record.exc_info]


def test_the_keys_of_two_servers_differ(here):
    with serving() as other:
        assert other.upgrade(other.address, here.token()) == 403


def test_whoever_only_asks_for_the_page_begins_no_session(here, begun):
    here.get()  # the first makes the text, for which a page is laid out and thrown away
    begun.clear()
    for path in ("/", "/?rig=robot", "/?bokeh-session-id=abc", "/?theme=1"):
        answer = here.get(path, Bokeh_Session_Id="") if "id" in path else here.get(path)
        assert answer.status == 200
        assert "bokeh" in answer.text
    for path in ("/autoload.js?bokeh-autoload-element=a", "/metadata"):
        assert here.get(path).status == 404
    assert here.get(method="HEAD").status == 200
    assert begun == []
    assert here.sessions == []


def test_each_visitor_gets_a_token_of_their_own(here):
    texts = [here.get().text for _ in range(2)]
    tokens = [re.findall(r'"token":"([^"]+)"', text.replace("&quot;", '"')) for text in texts]
    assert all(len(result) == 1 for result in tokens)
    assert tokens[0] != tokens[1]
    assert handlers.TOKEN not in texts[0]


def test_nothing_is_computed_before_a_browser_has_the_view(here, begun, monkeypatch):
    monkeypatch.setattr(Visitor, "tell", lambda self, **message: None)
    silent = Visitor(here.address, "?rig=robot&panel=graph")
    wait_until(lambda: begun)
    session = begun[-1]
    time.sleep(0.5)
    assert not session.work.busy
    assert session.state.rig is None
    assert session.state.panel == "graph", "what the address says is chosen"
    monkeypatch.undo()
    silent.tell(type="ready", width=1200)
    wait_until(lambda: session.state.rig is not None)
    silent.close()


def test_a_browser_that_cannot_show_the_view_gets_all_else(here, begun, monkeypatch):
    tell = Visitor.tell
    monkeypatch.setattr(
        Visitor, "tell", lambda self, **message: tell(self, type="ready", pictures=True)
    )
    visitor = Visitor(here.address, "?rig=robot&resolution=16")
    wait_until(lambda: begun and begun[-1].state.binding is not None)
    visitor.close()


def test_when_the_server_is_full_it_says_so_and_takes_visitors_again(here, monkeypatch):
    wait_until(lambda: here.is_left)
    monkeypatch.setattr(handlers, "MAX_SESSIONS", 2)
    token = here.token()
    visitors = [Visitor(here.address, "?rig=robot&resolution=16") for _ in range(2)]
    assert len(here.sessions) == 2
    answer = here.get()
    assert answer.status == 503
    assert "open pages is reached" in answer.text
    assert here.get(method="HEAD").status == 503
    assert here.upgrade(here.address, token) == 503
    visitors[0].close()
    wait_until(lambda: here.get().status == 200)
    visitors[1].close()


def test_one_client_cannot_fill_the_server(here, monkeypatch):
    wait_until(lambda: here.is_left)
    monkeypatch.setattr(handlers, "MAX_SESSIONS_OF_CLIENT", 2)
    visitors = [Visitor(here.address, "?rig=robot&resolution=16") for _ in range(2)]
    assert here.upgrade(here.address) == 503
    assert here.get().status == 200, "the server has room for others"
    visitors[0].close()
    wait_until(lambda: here.upgrade(here.address) == 101)
    visitors[1].close()


def test_no_other_site_can_frame_the_page(here):
    answer = here.get()
    assert answer.getheader("Content-Security-Policy") == "frame-ancestors 'self'"
    assert answer.getheader("X-Frame-Options") == "SAMEORIGIN"


def test_allowed_origins_can_frame_the_page_but_open_no_websocket(monkeypatch):
    allowed = ("https://course.example", "http://localhost:8000")
    with serving(frames=allowed) as here:
        answer = here.get()
        policy = "frame-ancestors 'self' https://course.example http://localhost:8000"
        assert answer.getheader("Content-Security-Policy") == policy
        assert answer.getheader("X-Frame-Options") is None
        assert here.upgrade(here.address) == 101, "the page in the frame has its own origin"
        assert [here.upgrade(origin) for origin in allowed] == [403, 403]
        monkeypatch.setattr(handlers, "MAX_SESSIONS", 0)
        assert here.get().getheader("Content-Security-Policy") == policy, "the frame says why"


def test_a_large_body_is_refused(here):
    connection = http.client.HTTPConnection("127.0.0.1", here.port, timeout=120)
    connection.putrequest("POST", "/", skip_host=True)
    connection.putheader("Host", here.host)
    connection.putheader("Content-Length", str(10**9))
    connection.endheaders()
    assert connection.getresponse().status in (400, 413)
    connection.close()
