"""Dask, here or on other machines: a few jobs at a time, results as they come."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from cutcell.checks import one_line
from cutcell.errors import CutcellError, MissingLibraryError

from .runner import cores, stop_runners

AHEAD = 2
"""Submitted jobs per core of the workers: one runs while the next is sent."""
CONNECT = "10s"
LOOPBACK = "127.0.0.1:0"
"""Any free port, for this machine alone."""


class Cluster:
    """Connection to a Dask scheduler; `slots` worker processes share a machine's memory."""

    def __init__(self, client: Any, slots: int) -> None:
        from distributed import as_completed

        self._client, self.slots = client, slots
        self._done = as_completed(loop=client.loop)
        self._keys: dict[str, str] = {}  # by name of the pending job

    def is_full(self) -> bool:
        """Return whether the workers have enough jobs."""
        return len(self._keys) >= AHEAD * max(1, sum(self._client.nthreads().values()))

    def submit(self, key: str, work: Callable[..., Any], *arguments: Any) -> None:
        """Begin a job; its arguments stay with the scheduler and survive a dead worker."""
        # Another client of the scheduler may still hold a job of this key, or be releasing it.
        name = f"cutcell-{key}-{self._client.id}"
        self._keys[name] = key
        self._done.add(self._client.submit(work, *arguments, key=name, retries=0))

    def scatter(self, blocks: list[Any]) -> list[Any]:
        """Send arguments of several jobs to the workers once."""
        return list(self._client.scatter(blocks, hash=False)) if blocks else []

    def next_result(self) -> tuple[str, Any]:
        """Wait for a job; return its key, and its result or the exception that it ended with."""
        future = next(self._done)
        key = self._keys.pop(future.key)
        if future.status in ("cancelled", "lost") or self._client.status not in ("running",):
            raise CutcellError(
                "the Dask scheduler was lost; what was done is kept. Run the same command again to "
                "go on"
            )
        try:
            return key, future.result()
        except Exception as error:  # any error of the job
            return key, error
        finally:
            future.release()


@contextmanager
def connected(scheduler: str | None, workers: int | None, processes: bool) -> Iterator[Cluster]:
    """Yield the cluster at an address, or one in this process."""
    try:
        import dask
        from distributed import Client, LocalCluster
        from distributed.utils import get_ip
    except ImportError:
        raise MissingLibraryError(
            "work is shared out by Dask, which is not installed; try: pip install "
            "'cutcell[dataset]'"
        ) from None
    settings = {
        "distributed.admin.large-graph-warning-threshold": "1GB",
        "distributed.scheduler.worker-saturation": 1.0,
        "distributed.comm.timeouts.connect": CONNECT,
        "distributed.logging.distributed": "critical",
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
    }
    with dask.config.set(settings):
        if scheduler is not None:
            try:
                client = Client(scheduler, timeout=CONNECT, set_as_default=False)
            except (OSError, TimeoutError, ValueError) as error:
                raise CutcellError(
                    f"there is no Dask scheduler at {scheduler} ({one_line(error)[:200]}); start "
                    "one with: dask scheduler"
                ) from None
            with client:
                workers_of = client.scheduler_info(n_workers=-1)["workers"].values()
                machines = Counter(worker["host"] for worker in workers_of)
                yield Cluster(client, max(machines.values(), default=1))
            return
        with warnings.catch_warnings():  # it warns, once, where there is no network
            warnings.simplefilter("ignore", RuntimeWarning)
            get_ip()
        count = workers or cores()
        shape = (count, 1) if processes else (1, count)
        with (
            LocalCluster(
                n_workers=shape[0],
                threads_per_worker=shape[1],
                processes=processes,
                # Dask opens these servers even where they have no pages.
                dashboard_address=LOOPBACK,
                worker_dashboard_address=LOOPBACK,
                scheduler_kwargs={"dashboard": False},
                memory_limit=0,
                silence_logs=False,
                host="127.0.0.1" if processes else None,
            ) as local,
            Client(local, set_as_default=False) as client,
        ):
            try:
                yield Cluster(client, shape[0])
            finally:
                with suppress(Exception):
                    stop_runners()
