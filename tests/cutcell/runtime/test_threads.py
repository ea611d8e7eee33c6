"""Work in threads comes back in order, fails as it should, and may call for threads itself."""

import os
import sys
import threading
import time

import pytest

from cutcell import Cancelled
from cutcell.runtime.threads import (
    MAX_ABANDONED,
    cancellable,
    in_threads,
    parts,
    submit,
    threads,
)


def test_results_keep_the_order_of_the_items():
    assert in_threads(lambda k: k * k, range(100)) == [k * k for k in range(100)]


def test_work_may_call_for_threads_itself():
    def sums(n):
        return sum(in_threads(lambda k: k, range(n)))

    assert in_threads(sums, range(20)) == [n * (n - 1) // 2 for n in range(20)]


def test_threads_may_be_called_for_at_once():
    result = {}

    def call(n):
        result[n] = in_threads(lambda k: n + k, range(50))

    callers = [threading.Thread(target=call, args=(n,)) for n in range(8)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert result == {n: [n + k for k in range(50)] for n in range(8)}


def test_errors_reach_the_caller():
    def fail(k):
        if k == 3:
            raise ValueError("three")
        return k

    with pytest.raises(ValueError, match="three"):
        in_threads(fail, range(8))


def test_something_is_done_submit(monkeypatch):
    monkeypatch.setattr("cutcell.runtime.threads.threads", lambda: 2)
    done = threading.Event()
    result = submit(lambda: done.set() or threading.current_thread())
    assert done.wait(10), "begun before anybody asks"
    assert result() is not threading.current_thread()


def test_what_nobody_has_begun_is_done_by_who_asks():
    free = threading.Event()
    busy = [submit(free.wait) for _ in range(threads() - 1)]
    asked = submit(threading.current_thread)
    assert asked() is threading.current_thread()
    free.set()
    assert all(wait() for wait in busy)


def test_errors_of_what_is_done_submit_reach_who_asks():
    def fail():
        raise ValueError("three")

    with pytest.raises(ValueError, match="three"):
        submit(fail)()


def test_parts_cover_everything_once():
    for count in (0, 1, 5, 1000):
        assert [k for part in parts(count) for k in range(count)[part]] == list(range(count))


@pytest.mark.skipif(sys.platform == "win32", reason="Windows does not fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_starts_threads_of_its_own():
    in_threads(abs, range(4))
    child = os.fork()
    if child == 0:
        ok = in_threads(abs, range(-4, 0)) == [4, 3, 2, 1]
        os._exit(0 if ok else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_progress_is_told_after_each_item():
    reports = []
    in_threads(lambda k: k, range(20), reports.append)
    assert reports == [k / 20 for k in range(1, 21)]


@pytest.mark.parametrize("count", [1, 2, 8])
def test_who_is_told_can_end_the_work(count, monkeypatch):
    monkeypatch.setattr("cutcell.runtime.threads.threads", lambda: count)
    begun = []

    def stop(done):
        raise Cancelled

    def work(k):
        begun.append(k)
        time.sleep(0.001)

    with pytest.raises(Cancelled):
        in_threads(work, range(1000), stop)
    assert len(begun) <= count


def test_work_that_does_not_report_is_cancelled():
    free, ended = threading.Event(), threading.Event()
    reports = []

    def work(report):
        report("graph", 0.25)
        free.wait()
        try:
            report("graph", 0.5)
        finally:
            ended.set()

    def progress(stage, done):
        reports.append((stage, done))
        if len(reports) > 2:
            raise Cancelled

    with pytest.raises(Cancelled):
        cancellable(work, progress, "graph")
    free.set()
    assert ended.wait(60)
    assert reports == [("graph", 0.25)] * 3


def test_work_waits_while_much_that_was_cancelled_goes_on():
    free = threading.Event()

    def stop(stage, done):
        raise Cancelled

    for _ in range(MAX_ABANDONED):
        with pytest.raises(Cancelled):
            cancellable(lambda report: free.wait(), stop, "graph")
    with pytest.raises(Cancelled):
        cancellable(lambda report: pytest.fail("begun"), stop, "graph")
    free.set()
    assert cancellable(lambda report: 7, lambda stage, done: None, "graph") == 7


def test_cancellable_work_gives_its_result_its_reports_and_its_errors():
    reports = []

    def work(report):
        report("graph", 1)
        # Within such work there is no need for another thread.
        return cancellable(lambda report: threading.current_thread(), report, "graph")

    inner = cancellable(work, lambda *given: reports.append(given), "graph")
    assert inner is not threading.current_thread()
    assert inner.name == "cutcell-work"
    assert reports == [("graph", 1)]
    with pytest.raises(ZeroDivisionError):
        cancellable(lambda report: 1 / 0, lambda stage, done: None, "graph")
