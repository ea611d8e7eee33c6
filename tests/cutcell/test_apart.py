"""Work in a process of its own: it ends by its time limit, or when it is unwanted."""

import sys
import time

import psutil
import pytest

from cutcell import apart
from cutcell.apart import WorkFailedError
from cutcell.errors import Cancelled


def sleepers():
    return [p for p in psutil.Process().children() if "time.sleep(601)" in " ".join(p.cmdline())]


@pytest.fixture
def sleeping(monkeypatch):
    monkeypatch.setattr(apart, "COMMAND", (sys.executable, "-c", "import time; time.sleep(601)"))


def test_what_is_no_longer_wanted_ends_with_its_process(sleeping):
    begin = time.monotonic()

    def wanted():
        if sleepers():
            raise Cancelled

    with apart.stoppable(wanted), pytest.raises(Cancelled):
        apart.run_apart("bbw", {}, 600.0, "the sleeper")
    assert time.monotonic() - begin < 300
    assert not sleepers()


def test_what_takes_too_long_is_ended_and_says_so(sleeping):
    with pytest.raises(WorkFailedError, match=r"the sleeper took longer than 0\.3 seconds"):
        apart.run_apart("bbw", {}, 0.3, "the sleeper")
    assert not sleepers()


def test_nobody_is_asked_outside_the_block(sleeping):
    def never():
        raise AssertionError

    with apart.stoppable(never):
        pass
    with pytest.raises(WorkFailedError):
        apart.run_apart("bbw", {}, 0.1, "the sleeper")
