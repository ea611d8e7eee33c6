"""Work in threads comes back in order, fails as it should, and may call for threads itself."""

import os
import sys
import threading

import pytest

from cutcell.threads import in_threads, parts


def test_results_keep_the_order_of_the_items():
    assert in_threads(lambda k: k * k, range(100)) == [k * k for k in range(100)]


def test_work_may_call_for_threads_itself():
    def sums(n):
        return sum(in_threads(lambda k: k, range(n)))

    assert in_threads(sums, range(20)) == [n * (n - 1) // 2 for n in range(20)]


def test_threads_may_be_called_for_at_once():
    found = {}

    def call(n):
        found[n] = in_threads(lambda k: n + k, range(50))

    callers = [threading.Thread(target=call, args=(n,)) for n in range(8)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert found == {n: [n + k for k in range(50)] for n in range(8)}


def test_errors_reach_the_caller():
    def fail(k):
        if k == 3:
            raise ValueError("three")
        return k

    with pytest.raises(ValueError, match="three"):
        in_threads(fail, range(8))


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
