"""Which tests go together to one worker, where several run them at once (pytest-xdist)."""

from pathlib import PurePosixPath

import pytest
from xdist.remote import Producer
from xdist.scheduler import LoadScopeScheduling
from xdist.workermanage import WorkerController

BROWSER = "test_browser"
"""How the names of files begin whose tests need a browser and a server."""


class Dealing(LoadScopeScheduling):
    """Deals tests file by file: those in the browser to one worker, all others to the rest.

    Who has done all of his own takes the others': a second browser and server cost half a minute,
    and that only at the end.
    """

    def __init__(self, config: pytest.Config, log: Producer | None = None) -> None:
        config.option.loadscopereorder = False
        super().__init__(config, log)

    def _split_scope(self, nodeid: str) -> str:
        return nodeid.partition("::")[0]

    def _assign_work_unit(self, node: WorkerController) -> None:
        own = node is self.nodes[0]
        for path in self.workqueue:
            if PurePosixPath(path).name.startswith(BROWSER) == own:
                self.workqueue.move_to_end(path, last=False)
                break
        super()._assign_work_unit(node)
