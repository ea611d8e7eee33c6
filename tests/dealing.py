"""Which tests go together to one worker, where several run them at once (pytest-xdist)."""

from pathlib import PurePosixPath

import pytest
from xdist.remote import Producer
from xdist.scheduler import LoadScopeScheduling

BROWSER = "test_browser"
"""How the names of files begin whose tests share one browser and one server."""


class Dealing(LoadScopeScheduling):
    """Deals tests file by file, in their order, and those in the browser as if of one file.

    The browser's come early (`tests/app` is the first folder) and take about as long as all others
    on a machine with two cores.
    """

    def __init__(self, config: pytest.Config, log: Producer | None = None) -> None:
        config.option.loadscopereorder = False
        super().__init__(config, log)

    def _split_scope(self, nodeid: str) -> str:
        path = nodeid.partition("::")[0]
        return BROWSER if PurePosixPath(path).name.startswith(BROWSER) else path
