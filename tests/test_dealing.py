"""Files of tests go to workers longest first, the browser's before all others."""

from types import SimpleNamespace

import pytest

from tests.dealing import RECORD, Dealing

FILES = {"test_a.py": 3, "test_browser_b.py": 1, "test_c.py": 40, "test_browser_d.py": 2}
TESTS = [f"{file}::test_{i}" for file, count in FILES.items() for i in range(count)]


class Cache(dict):
    """What pytest keeps between runs."""

    def set(self, name, value):
        self[name] = dict(value)


class Worker:
    """Keeps the numbers of the tests that it is given."""

    shutting_down = False

    def __init__(self, number):
        self.gateway = SimpleNamespace(id=f"gw{number}")
        self.tests = []

    def send_runtest_some(self, tests):
        self.tests += tests

    def shutdown(self):
        self.shutting_down = True


@pytest.fixture
def order(monkeypatch):
    """Return the files in the order in which they are dealt, each test taking a second."""
    monkeypatch.setattr("xdist.scheduler.loadscope.parse_tx_spec_config", lambda config: [1, 2])

    def order(cache):
        option = SimpleNamespace(loadscopereorder=True, debug=False, verbose=0)
        config = SimpleNamespace(option=option, cache=cache)
        dealing, workers = Dealing(config), [Worker(0), Worker(1)]
        for worker in workers:
            dealing.add_node(worker)
            dealing.add_node_collection(worker, TESTS)
        dealt, assign = [], dealing._assign_work_unit
        monkeypatch.setattr(
            dealing, "_assign_work_unit",
            lambda node: (assign(node), dealt.append(TESTS[node.tests[-1]].partition("::")[0])),
        )  # fmt: skip
        dealing.schedule()
        while any(worker.tests for worker in workers):
            for worker in workers:
                if worker.tests:
                    dealing.mark_test_complete(worker, worker.tests.pop(0), 1.0)
        return dealt

    return order


def test_without_a_record_files_of_many_tests_come_first(order):
    cache = Cache()
    assert order(cache) == ["test_browser_d.py", "test_browser_b.py", "test_c.py", "test_a.py"]
    assert cache[RECORD] == FILES
    assert order(None)[:2] == ["test_browser_d.py", "test_browser_b.py"]


def test_files_that_took_long_come_first(order):
    cache = Cache({RECORD: {"test_a.py": 50, "test_browser_b.py": 9, "test_browser_d.py": 8}})
    assert order(cache) == ["test_browser_b.py", "test_browser_d.py", "test_a.py", "test_c.py"]
