"""Work in a process of its own: it ends by its time limit, or when it is unwanted."""

import subprocess
import sys
import time

import psutil
import pytest

from cutcell.errors import Cancelled
from cutcell.isolated import run as apart
from cutcell.isolated.run import WorkFailedError
from tests.conftest import ROOT


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
        apart.run_isolated("bbw", {}, 600.0, "the sleeper")
    assert time.monotonic() - begin < 300
    assert not sleepers()


def test_what_takes_too_long_is_ended_and_says_so(sleeping):
    with pytest.raises(WorkFailedError, match=r"the sleeper took longer than 0\.3 seconds"):
        apart.run_isolated("bbw", {}, 0.3, "the sleeper")
    assert not sleepers()


def test_nobody_is_asked_outside_the_block(sleeping):
    def never():
        raise AssertionError

    with apart.stoppable(never):
        pass
    with pytest.raises(WorkFailedError):
        apart.run_isolated("bbw", {}, 0.1, "the sleeper")


@pytest.mark.parametrize(
    ("soft", "hard", "allowance", "expected"),
    [
        (64, 64, 1, lambda soft: 1 <= soft < 64),
        (64, 64, 128, lambda soft: soft == 64),
        (64, -1, 128, lambda soft: soft == 64),
        (64, 64, 0, lambda soft: soft == 64),
    ],
)
def test_a_memory_limit_is_never_raised(soft, hard, allowance, expected):
    pytest.importorskip("resource")
    code = """
import resource, sys
from cutcell.isolated.__main__ import limit_memory

soft, hard, allowance = (int(word) * 2**30 if word != "-1" else -1 for word in sys.argv[1:])
resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
limit_memory(allowance)
print(*resource.getrlimit(resource.RLIMIT_AS))
"""
    words = [str(value) for value in (soft, hard, allowance)]
    out = subprocess.check_output([sys.executable, "-c", code, *words], cwd=ROOT, text=True)
    after = [int(word) for word in out.split()]
    assert expected(after[0] / 2**30)
    assert after[1] == (hard * 2**30 if hard > 0 else hard)
