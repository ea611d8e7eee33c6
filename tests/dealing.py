"""Which tests go to which worker, where several run them at once (pytest-xdist)."""

from collections import Counter
from pathlib import PurePosixPath

import pytest
from xdist.remote import Producer
from xdist.scheduler import LoadScopeScheduling
from xdist.workermanage import WorkerController

BROWSER = "test_browser"
"""How the names of files begin whose tests need a browser and a server."""

RECORD = "cutcell/seconds"
"""Where pytest's cache has the seconds that each file took when it last ran."""


class Dealing(LoadScopeScheduling):
    """Deals tests file by file, longest first: the browser's, then all others.

    Files of which nothing is recorded count as long as their tests are many. The browser's come
    together, because a worker closes its browser and its server when it leaves their folder; and
    they come first, because many short files, at the end, let all workers end at the same time.
    """

    def __init__(self, config: pytest.Config, log: Producer | None = None) -> None:
        config.option.loadscopereorder = False
        super().__init__(config, log)
        self.cache = getattr(config, "cache", None)  # absent with -p no:cacheprovider
        self.record: dict[str, float] = self.cache.get(RECORD, {}) if self.cache is not None else {}
        self.seconds: Counter[str] = Counter()

    def _split_scope(self, nodeid: str) -> str:
        return nodeid.partition("::")[0]

    def _length(self, path: str) -> tuple[bool, float]:
        is_browser = PurePosixPath(path).name.startswith(BROWSER)
        guess = len(self.workqueue[path]) * (5 if is_browser else 0.1)
        return is_browser, self.record.get(path, guess)

    def _assign_work_unit(self, node: WorkerController) -> None:
        self.workqueue.move_to_end(max(self.workqueue, key=self._length), last=False)
        super()._assign_work_unit(node)

    def mark_test_complete(
        self, node: WorkerController, item_index: int, duration: float = 0
    ) -> None:
        """Count the seconds of a test, and record those of its file when it was the last there."""
        path = self._split_scope(self.registered_collections[node][item_index])
        super().mark_test_complete(node, item_index, duration)
        self.seconds[path] += duration
        if all(self.assigned_work[node][path].values()):
            self.record[path] = round(self.seconds[path], 1)
            if self.cache is not None:
                self.cache.set(RECORD, self.record)
