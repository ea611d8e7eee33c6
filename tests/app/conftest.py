"""What the page's tests share: sessions; one Chromium, one server, a page that shows the robot."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, sync_playwright

import cutcell
from cutcell.rig import Rig
from cutcell_app.commands import loading
from cutcell_app.commands.session import Session
from cutcell_app.layout.session import begin
from cutcell_assets import demo_path
from scripts.get_chromium import FLAGS
from tests.app.browser import Visit, served
from tests.app.loop import Loop
from tests.viewers.arm import arm_rig
from tests.viewers.conftest import binding, rig

__all__ = ["binding", "rig"]

LIGHT = (*FLAGS, "--disable-gpu-rasterization", "--disable-gpu-compositing")
"""Without a graphics card, OpenGL is a slow way to draw what is no 3D view: half of all work."""


@pytest.fixture
def loop() -> Loop:
    """Stand for the page's thread."""
    return Loop()


@pytest.fixture
def session(loop: Loop) -> Iterator[Session]:
    """Begin a session without a browser."""
    session = begin(loop)
    yield session
    session.close()


@pytest.fixture
def bound(session: Session, loop: Loop) -> Session:
    """Let the session show a bound character."""
    session.state.param.update(resolution=16, graph_resolution=0)
    loading.show_rig(session, arm_rig())
    loop.run_until(lambda: session.state.binding is not None)
    return session


@pytest.fixture(scope="package")
def browser(chromium: str) -> Iterator[Browser]:
    """Open a Chromium; each visit is a person of its own in it."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(LIGHT))
        yield browser
        browser.close()


@pytest.fixture(scope="package")
def url() -> Iterator[str]:
    """Serve the page, which opens the first demo unless its address asks for another."""
    with served() as url:
        yield url


@pytest.fixture(scope="package")
def robot() -> Rig:
    """Load what `visit` shows: the smallest demo, for software rendering is slow."""
    return cutcell.load(demo_path("robot"))


@pytest.fixture(scope="package")
def kept() -> Iterator[list[Visit]]:
    """Keep the page of `visit` from test to test."""
    kept: list[Visit] = []
    yield kept
    for visit in kept:
        visit.close()


@pytest.fixture
def visit(browser: Browser, url: str, kept: list[Visit]) -> Iterator[Visit]:
    """Show the robot, bound, on the panel Weights, with nothing else chosen.

    It is the page of the test before, where that can be brought back to its beginning.
    """
    visit = kept.pop() if kept else None
    if visit is not None and not visit.begin_anew():
        visit.context.close()
        visit = None
    if visit is None:
        visit = Visit(browser, url + "/?rig=robot")
        visit.wait_until_bound()
        visit.dismiss()  # the robot's ring, which no bone reaches
        visit.remember_beginning()
    yield visit
    kept.append(visit)
    visit.check()
