"""The page in a frame: of an allowed origin it works, of another it is refused."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import unquote

import pytest
from playwright.sync_api import expect

from tests.app.browser import LOAD_MS, Visit, served
from tests.app.small import SMALL

pytestmark = pytest.mark.nightly

# Browsers that block other sites' data let no frame of another site use its storage.
NO_STORAGE = """if (self !== top) {
  for (const name of ["localStorage", "sessionStorage"]) {
    Object.defineProperty(window, name, {get() { throw new DOMException(name, "SecurityError") }})
  }
}"""


class Course(BaseHTTPRequestHandler):
    """Answers with a page whose frame shows the address behind the question mark."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        address = unquote(self.path.partition("?")[2])
        if address:
            style = "width: 1000px; height: 640px; border: 0"
            frame = f'<iframe title="cutcell" style="{style}" src="{address}"></iframe>'
            self.wfile.write(f'<!doctype html><link rel="icon" href="data:,">{frame}'.encode())

    def log_message(self, *arguments: object) -> None:
        """Say nothing."""


@contextmanager
def course() -> Iterator[str]:
    """Serve a course's site; give its origin."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), Course)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://localhost:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def test_only_pages_of_an_allowed_origin_frame_the_page(browser, small_path):
    program = ("tests.app.small", str(small_path.parent))
    with (
        course() as allowed,
        course() as other,
        served("--allow-frame", allowed, program=program) as url,
    ):
        visit = Visit(browser, f"{allowed}/")
        visit.context.add_init_script(NO_STORAGE)
        visit.page.goto(f"{allowed}/?{url}{SMALL}")
        inside = visit.page.frames[1]
        inside.wait_for_function("window.__cutcell?.report().actors.body", timeout=LOAD_MS)
        # A choice goes to the server and comes back.
        inside.get_by_role("tab", name="Graph", exact=True).click()
        expect(inside.get_by_role("switch", name="Mesh edges")).to_be_visible()
        inside.get_by_role("button", name="Toggle theme").click()
        inside.wait_for_function("location.search.includes('panel=graph')")
        visit.close()

        page = browser.new_page()
        with page.expect_console_message(lambda message: "frame-ancestors" in message.text):
            page.goto(f"{other}/?{url}{SMALL}")
        page.frames[1].wait_for_url("chrome-error:**")
        page.close()
