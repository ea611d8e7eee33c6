"""What all tests share: characters to load, and a browser."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SHARED_RIGS = ROOT.parent / "shared" / "data" / "rigs"


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
