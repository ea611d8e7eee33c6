"""Binding of all assets into a store, on Dask: here, or on the machines of a cluster.

The bytes of an asset go to a worker, and those of its file come back; only this process reads the
inputs and writes the store. So the machines of a cluster need no folder in common.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

from ... import __version__
from ...errors import CutcellError, TooLargeError
from ...rig.checks import check_integer, check_number, one_line
from ...runtime.compile_cache import announce
from ...runtime.memory import SHARE, available_memory, gigabytes
from ..read.sources import Content, Source, find_sources
from ..read.store import Outcome, Parameters, Store, manifest_row
from .cluster import Cluster, connected
from .runner import AssetLostError, lend_runner

TIME_LIMIT = 600.0
"""Seconds that one asset may take, unless told otherwise."""
MANIFEST_EVERY = 60.0
"""Seconds between two manifests while work goes on."""


@dataclass(frozen=True)
class BindReport:
    """What `bind_all` did.

    Parameters
    ----------
    store : Path
    rows : list of dict
        Of the manifest, one for each source.
    bound, known, failed : int
        Sources that were bound now, that the store had already, and that have no file.
    seconds : float
        From begin to end.
    lost : dict of str to str
        Failures that are not in the store, since another try may do better, by name: a worker that
        died, too little memory on this machine.
    """

    store: Path
    rows: list[dict[str, Any]]
    bound: int
    known: int
    failed: int
    seconds: float
    lost: Mapping[str, str] = field(default_factory=dict)

    @property
    def failures(self) -> dict[str, str]:
        """Why sources have no file, by name."""
        return {row["name"]: row["error"] for row in self.rows if row["error"]}


@dataclass(frozen=True)
class _Job:
    """An asset that is being bound, under all the names that it has."""

    key: str
    digest: str
    sources: list[Source]


def bind_all(
    inputs: list[Path],
    folder: Path,
    parameters: Parameters | None = None,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    processes: bool = False,
    time_limit: float = TIME_LIMIT,
    tell: Callable[[int, int, str], None] = lambda done, count, name: None,
) -> BindReport:
    """Bind all assets of some files and folders into a store.

    What the store has already is not computed again: files are named by a hash of the asset's
    bytes and of the parameters.

    Parameters
    ----------
    inputs : list of Path
        See `find_sources`.
    folder : Path
        The store; made if it is not there.
    parameters : Parameters, optional
        The paper's method when left out.
    scheduler : str, optional
        Address of a Dask scheduler. Left out, the work is done here.
    workers : int, optional
        How many assets at a time here; as many as there are cores when left out.
    processes : bool
        Whether Dask's workers here are processes instead of threads. Assets are bound in processes
        of their own either way.
    time_limit : float
        Seconds that one asset may take, 1 or more.
    tell : callable
        Called with the assets done, with their number, and with the name of the last.

    Returns
    -------
    BindReport

    Raises
    ------
    FileError
        There are no assets, or the store cannot be written to.
    MissingLibraryError
        Dask or pyarrow is not installed.
    CutcellError
        The scheduler cannot be reached, or was lost. What was done is in the store.
    """
    begin = perf_counter()
    parameters = parameters or Parameters()
    check_number("time_limit", time_limit, 1, 1e6)
    if workers is not None:
        check_integer("workers", workers, 1, 1024)
    sources = find_sources(inputs)
    store = Store(folder)
    store.begin(parameters)
    run = _Run(store, parameters, len(sources), time_limit, tell)
    if scheduler is None:
        announce()  # the processes that bind compile, and print nothing
    with connected(scheduler, workers, processes) as cluster:
        try:
            run.all(sources, cluster)
        finally:
            run.write_manifest()
    rows = run.sorted_rows()
    failed = sum(bool(row["error"]) for row in rows)
    return BindReport(folder, rows, run.bound, run.known, failed, perf_counter() - begin, run.lost)


class _Run:
    """The state of one call of `bind_all`."""

    def __init__(
        self,
        store: Store,
        parameters: Parameters,
        count: int,
        limit: float,
        tell: Callable[[int, int, str], None],
    ) -> None:
        self._store, self._parameters = store, parameters
        self._count, self._limit, self._tell = count, limit, tell
        self._suffix = parameters.digest()
        self._rows: dict[str, dict[str, Any]] = {}
        self._written = perf_counter()
        self._jobs: dict[str, _Job] = {}
        self.bound = self.known = 0
        self.lost: dict[str, str] = {}

    def all(self, sources: list[Source], cluster: Cluster) -> None:
        """Bind all sources, no more at a time than the workers can take."""
        for source in sources:
            while cluster.is_full():
                self._take(cluster)
            self._begin(source, cluster)
        while self._jobs:
            self._take(cluster)

    def _begin(self, source: Source, cluster: Cluster) -> None:
        try:
            content = source.content()
        except CutcellError as error:
            self._note(source, "", Outcome("", {"error": str(error), "version": __version__}))
            return
        digest = content.digest()
        key = f"{digest}-{self._suffix}"
        if key in self._jobs:
            self._jobs[key].sources.append(source)
            return
        outcome = self._store.known(key)
        if outcome is not None:
            self.known += 1
            self._note(source, digest, outcome)
            return
        self._jobs[key] = _Job(key, digest, [source])
        cluster.submit(key, bind_apart, content, key, self._parameters, self._limit, cluster.slots)

    def _take(self, cluster: Cluster) -> None:
        """Wait for an asset, and put it into the store."""
        key, result = cluster.next_result()
        job = self._jobs.pop(key)
        if isinstance(result, Outcome):
            outcome, lasting = result, not result.record.get("passing")
        else:  # no fault of the asset: a worker died, for one
            error = f"it was not bound: {one_line(result)[:300]}"
            outcome, lasting = Outcome(key, {"error": error, "version": __version__}), False
        if lasting:
            self._store.write(outcome)
        else:
            self.lost |= {source.name: outcome.error for source in job.sources}
        self.bound += not outcome.error
        for source in job.sources:
            self._note(source, job.digest, outcome)
        if perf_counter() - self._written > MANIFEST_EVERY:
            self.write_manifest()

    def _note(self, source: Source, digest: str, outcome: Outcome) -> None:
        where = f"{source.path}{':' if source.sample else ''}{source.sample}"
        self._rows[source.name] = manifest_row(source.name, where, digest, outcome)
        self._tell(len(self._rows), self._count, source.name)

    def sorted_rows(self) -> list[dict[str, Any]]:
        return [self._rows[name] for name in sorted(self._rows)]

    def write_manifest(self) -> None:
        self._store.write_manifest(self.sorted_rows())
        self._written = perf_counter()


class _Room:
    """The memory of one process' assets: each waits until there is room for it."""

    def __init__(self) -> None:
        self._taken = 0
        self._freed = threading.Condition()

    def take(self, size: int, total: int) -> None:
        """Wait for room."""
        if size > total:
            raise TooLargeError(
                f"it would need about {gigabytes(size)} of memory, and {gigabytes(total)} are "
                "there for it; choose a lower resolution, or a machine with more memory"
            )
        with self._freed:
            self._freed.wait_for(lambda: self._taken + size <= total)
            self._taken += size

    def free(self, size: int) -> None:
        """Give memory back."""
        with self._freed:
            self._taken -= size
            self._freed.notify_all()


_room = _Room()


def bind_apart(
    content: Content, key: str, parameters: Parameters, limit: float, slots: int
) -> Outcome:
    """Bind one asset in a process of its own: what a Dask worker does."""
    with lend_runner() as runner:
        total = int(available_memory() * SHARE / slots) + _room._taken
        taken: list[int] = []

        def room(size: int) -> None:
            _room.take(size, total)
            taken.append(size)

        try:
            try:
                return runner.bind(content, key, parameters, limit, room)
            except AssetLostError as error:
                if not error.passing:
                    raise
                return runner.bind(content, key, parameters, limit, room)
        except AssetLostError as error:
            record = {"error": str(error), "version": __version__, "passing": error.passing}
            return Outcome(key, record)
        except TooLargeError as error:
            return Outcome(key, {"error": str(error), "version": __version__, "passing": True})
        finally:
            for size in taken:
                _room.free(size)
