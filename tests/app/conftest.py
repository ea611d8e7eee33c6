"""What the page's tests share: sessions; one Chromium, one server, one page."""

from collections.abc import Generator, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, sync_playwright

import cutcell
from cutcell.rig import Rig
from cutcell_app.document import loading
from cutcell_app.document.session import Session
from cutcell_app.files.storage import Storage
from cutcell_app.files.upload_cache import UploadCache
from cutcell_app.shell.session.begin import begin
from scripts.get_chromium import FLAGS
from tests.app.browser import Visit, served, visits
from tests.app.loop import Loop
from tests.app.small import SMALL, small_rig
from tests.viewers.arm import arm_rig, bare_arm
from tests.viewers.conftest import binding, rig

__all__ = ["binding", "rig"]

LIGHT = (*FLAGS, "--disable-gpu-rasterization", "--disable-gpu-compositing")
"""Without a graphics card, OpenGL is a slow way to draw what is no 3D view: half of all work."""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, Any]:
    """Add what the open pages show to the report of a test that fails."""
    report = yield
    if report.failed:
        report.sections += [(f"Page {visit.url}", visit.described()) for visit in list(visits)]
    return report


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


@pytest.fixture
def bare(session: Session, loop: Loop) -> Session:
    """Let the session show a mesh without a skeleton."""
    session.state.resolution = 16
    loading.show_rig(session, bare_arm())
    loop.rest(session)
    return session


@pytest.fixture
def keep(tmp_path: Path) -> Iterator[UploadCache]:
    """Keep uploads in an empty folder."""
    keep = UploadCache(Storage(tmp_path))
    yield keep
    keep.close()


@pytest.fixture(scope="package")
def browser(chromium: str) -> Iterator[Browser]:
    """Open a Chromium; each visit is a person of its own in it."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(LIGHT))
        yield browser
        browser.close()


@pytest.fixture(scope="package")
def small_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the figure that `visit` shows."""
    path = tmp_path_factory.mktemp("demo") / "small.glb"
    cutcell.save(path, small_rig())
    return path


@pytest.fixture(scope="package")
def small(small_path: Path) -> Rig:
    """Load the figure that `visit` shows."""
    return cutcell.load(small_path)


@pytest.fixture(scope="package")
def url(small_path: Path) -> Iterator[str]:
    """Serve the page, which opens the first demo unless its address asks for another."""
    with served(program=("tests.app.small", str(small_path.parent))) as url:
        yield url


@pytest.fixture(scope="module")
def open_visits() -> Iterator[list[Visit]]:
    """Keep the page of `visit` for the tests of a file, whose order never changes."""
    visits: list[Visit] = []
    yield visits
    for visit in visits:
        visit.close()


@pytest.fixture
def visit(browser: Browser, url: str, open_visits: list[Visit]) -> Iterator[Visit]:
    """Show the small figure, bound, on the panel Weights, with nothing else chosen.

    It is the page of the test before in the file, where that can be brought back to its beginning.
    """
    visit = open_visits.pop() if open_visits else None
    if visit is not None and not visit.begin_anew():
        visit.context.close()
        visit = None
    if visit is None:
        visit = Visit(browser, url + SMALL)
        visit.wait_until_bound()
        visit.dismiss()  # the box above the head, which no bone reaches
        visit.remember_beginning()
    yield visit
    open_visits.append(visit)
    visit.check()
