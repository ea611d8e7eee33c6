"""What all tests share: characters to load, a browser, and how several processes run them."""

import os
from pathlib import Path

import pytest

from cutcell.skinning import is_compiled, warm_up

ROOT = Path(__file__).resolve().parent.parent
SHARED_RIGS = ROOT.parent / "shared" / "data" / "rigs"


@pytest.hookimpl(trylast=True)  # pytest itself may heed them
def pytest_configure() -> None:
    """Let commands print the same whatever is said of the terminal that the tests run on."""
    for name in ("COLUMNS", "FORCE_COLOR", "GITHUB_ACTIONS", "LINES", "NO_COLOR", "PY_COLORS"):
        os.environ.pop(name, None)


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile all functions before there are workers: each of them would compile its own."""
    if session.config.getoption("numprocesses", None) and not is_compiled():
        warm_up()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Deal the tests to workers, where there are several."""
    from tests.dealing import Dealing

    return Dealing(config, log)


@pytest.fixture(scope="session")
def rigs() -> list[Path]:
    """GLB files of real characters. They are not part of the project and may be absent."""
    paths = sorted(SHARED_RIGS.glob("*.glb"))
    if not paths:
        pytest.skip(f"there are no characters in {SHARED_RIGS}; they are not part of the project")
    return paths


@pytest.fixture(scope="session")
def demo_paths() -> list[Path]:
    """GLB files of the demo characters, which are part of the project."""
    paths = sorted((ROOT / "assets").glob("*.glb"))
    assert paths, "assets/ holds no demo characters; make them by: make assets"
    return paths


@pytest.fixture(scope="session")
def chromium() -> str:
    """Path of a Chromium that opens pages. Without one the tests fail: they are not skipped."""
    from scripts.get_chromium import NoChromiumError, find

    try:
        return find()
    except NoChromiumError as error:
        pytest.fail(str(error), pytrace=False)
