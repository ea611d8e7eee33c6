"""A case that fails, hangs, dies or takes too much memory is told; the others go on."""

import os
import signal
import time
from types import SimpleNamespace

import numpy as np
import pytest

from tests.fuzz import harness

pytestmark = pytest.mark.slow

SELF = "tests.fuzz.test_harness"


def check(number):
    """Stand for a fuzzer's."""
    if number == 1:
        raise ValueError("one is wrong")
    if number == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 3:
        np.ones(harness.MEMORY // 8)
    if number == 4:
        while True:
            pass
    if number == 5:
        print("no answer")
    if number == 6:
        time.sleep(60)


@pytest.fixture(scope="module")
def report():
    return harness.try_cases(SELF, range(8), processes=2, seconds=1)


def test_what_is_wrong_is_told_of_each_case(report):
    why = {failure.number: failure.why.splitlines()[-1] for failure in report.failures}
    assert why[1] == "ValueError: one is wrong"
    assert why[2] == "the process died of SIGKILL"
    assert "MemoryError" in why[3]
    assert why[4] == why[6] == "it took longer than 1 s"
    assert sorted(why) == [1, 2, 3, 4, 6]


def test_all_others_pass(report):
    assert report.passed == 3
    assert report.slowest[0] < 1
    assert 1e7 < report.peak < harness.MEMORY


def test_the_command_prints_how_to_try_a_case_again(monkeypatch, capsys):
    report = harness.Report(9, [harness.Failure(3, "it is odd")], (0.5, 7), 10**9)
    monkeypatch.setattr(harness, "try_cases", lambda *given: report)
    monkeypatch.setattr("sys.argv", ["fuzz", "--count", "10"])
    with pytest.raises(SystemExit) as ended:
        harness.main(SELF)
    assert ended.value.code == 1
    reports = capsys.readouterr().out
    assert f"case 3 (python -m {SELF} --case 3):\nit is odd\n" in reports
    assert "9 of 10 cases passed; the slowest took 0.5 s (case 7)" in reports
    tried = []
    fuzzer = SimpleNamespace(describe=lambda number: f"case {number}", check=tried.append)
    monkeypatch.setattr(harness, "import_module", lambda name: fuzzer)
    monkeypatch.setattr("sys.argv", ["fuzz", "--case", "5"])
    harness.main(SELF)
    assert tried == [5]
    assert capsys.readouterr().out == "case 5\n"
