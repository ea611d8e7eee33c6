"""What all tests share: characters to load, a browser, and how several processes run them."""

import os
import warnings
from collections.abc import Iterator
from pathlib import Path

import hypothesis
import pytest

from cutcell.weights.warm_up import is_compiled, warm_up

# Other work takes time as well.
SLOW = [hypothesis.HealthCheck.too_slow]
hypothesis.settings.register_profile("patient", deadline=None, suppress_health_check=SLOW)
hypothesis.settings.load_profile("patient")

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


class ReversedEntries:
    """Directory entries in reverse order of their names, used as `os.scandir` is."""

    def __init__(self, entries) -> None:
        with entries:
            self.entries = iter(sorted(entries, key=lambda entry: entry.name, reverse=True))

    def __iter__(self):
        return self.entries

    def __next__(self):
        return next(self.entries)

    def __enter__(self):
        return self

    def __exit__(self, *error) -> None:
        pass

    def close(self) -> None:
        pass


@pytest.fixture(scope="session", autouse=True)
def reversed_directories():
    """List directories backwards: nothing may depend on the order that a file system has."""
    with pytest.MonkeyPatch.context() as patch:
        listdir, scandir = os.listdir, os.scandir
        patch.setattr(os, "listdir", lambda *path: sorted(listdir(*path), reverse=True))
        patch.setattr(os, "scandir", lambda *path: ReversedEntries(scandir(*path)))
        for name in ("glob", "rglob"):  # some versions of Python list by a function of their own
            search = getattr(Path, name)
            patch.setattr(Path, name, _reversed(search))
        yield


def _reversed(search):
    return lambda *words, **options: iter(sorted(search(*words, **options), reverse=True))


@pytest.fixture(scope="session")
def rigs() -> list[Path]:
    """GLB files of real characters. They are not part of the project and may be absent."""
    paths = sorted(SHARED_RIGS.glob("*.glb"))
    if not paths:
        pytest.skip(f"there are no characters in {SHARED_RIGS}; they are not part of the project")
    return paths


@pytest.fixture(scope="session")
def rig_of_each_maker(rigs) -> list[Path]:
    """Of the real characters, the smallest that each program wrote."""
    smallest = sorted(rigs, key=lambda path: path.stat().st_size, reverse=True)
    return sorted({path.name.partition("_")[0]: path for path in smallest}.values())


@pytest.fixture(scope="session")
def demo_paths() -> list[Path]:
    """GLB files of the demo characters, which are part of the project."""
    paths = sorted((ROOT / "assets").glob("*.glb"))
    assert paths, "assets/ holds no demo characters; make them by: make assets"
    return paths


@pytest.fixture(scope="session")
def scheduler() -> Iterator[str]:
    """Address of a Dask cluster in this process, and of a runner that stays for the next test."""
    from cutcell_lab.dataset.bind.cluster import connected

    with warnings.catch_warnings():  # what Dask leaves to the garbage collector is not ours
        warnings.simplefilter("ignore")
        with connected(None, 1, processes=False) as cluster:
            yield cluster._client.scheduler.address


@pytest.fixture(scope="session")
def chromium() -> str:
    """Path of a Chromium that opens pages. Without one the tests fail: they are not skipped."""
    from scripts.get_chromium import NoChromiumError, find

    try:
        return find()
    except NoChromiumError as error:
        pytest.fail(str(error), pytrace=False)
