"""Binding of all assets into a store, on Dask: here, or on the machines of a cluster.

Workers receive the bytes of an asset and return the bytes of its file. Only this process reads
inputs and writes the store, so the machines of a cluster need no shared folder.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

from cutcell import __version__
from cutcell.checks import check_integer, check_number, one_line
from cutcell.errors import CutcellError, TooLargeError
from cutcell.pose.stretch import MAX_SHARE
from cutcell.runtime.compile_cache import announce
from cutcell.runtime.memory import SHARE, available_memory, gigabytes

from ..read.sources import Content, Source, find_sources
from ..read.store import Outcome, Parameters, Store, manifest_row
from .cluster import Cluster, connected
from .runner import AssetLostError, lend_runner

TIME_LIMIT = 600.0
"""Default maximum of seconds per asset."""
MANIFEST_EVERY = 60.0
"""Seconds between two manifests during the run."""


@dataclass(frozen=True)
class BindReport:
    """Result of `bind_all`.

    Parameters
    ----------
    store : Path
    rows : list of dict
        Of the manifest, one for each source of this call.
    bound, known, failed : int
        Number of sources that were bound, were in the store before, and have no file.
    seconds : float
    lost : dict of str to str
        Failures by name that are not in the store because another attempt may succeed: a worker
        that died, too little memory on this machine.
    damaged : tuple of str
        Sources whose file in the store was damaged, so that they were bound again.
    """

    store: Path
    rows: list[dict[str, Any]]
    bound: int
    known: int
    failed: int
    seconds: float
    lost: Mapping[str, str] = field(default_factory=dict)
    damaged: tuple[str, ...] = ()

    @property
    def failures(self) -> dict[str, str]:
        """Why sources have no file, by name."""
        return {row["name"]: row["error"] for row in self.rows if row["error"]}

    @property
    def stretched(self) -> dict[str, float]:
        """Shares of the surface that stretches, by name, where it is much; the largest first."""
        shares = {row["name"]: row["stretch"] or 0.0 for row in self.rows}
        much = {name: share for name, share in shares.items() if share > MAX_SHARE}
        return dict(sorted(much.items(), key=lambda item: -item[1]))


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
    report: Callable[[int, int, str], None] = lambda done, count, name: None,
) -> BindReport:
    """Bind all assets of some files and folders into a store.

    Assets that are in the store are skipped: files are named by a hash of the asset's bytes, of the
    parameters and of the code that computes. The manifest keeps the rows of earlier calls with the
    same parameters and code.

    Parameters
    ----------
    inputs : list of Path
        See `find_sources`.
    folder : Path
        The store; made if it is not there.
    parameters : Parameters, optional
        The paper's method when left out.
    scheduler : str, optional
        Address of a Dask scheduler; this machine when left out.
    workers : int, optional
        Number of assets at a time on this machine; the number of cores when left out.
    processes : bool
        Whether Dask's workers here are processes instead of threads. Assets are bound in
        subprocesses either way.
    time_limit : float
        Maximum of seconds per asset, 1 or more.
    report : callable
        Receives the number of assets done, the total, and the name of the last asset.

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
        The scheduler cannot be reached, or was lost. The store keeps all finished assets.
    """
    begin = perf_counter()
    parameters = parameters or Parameters()
    check_number("time_limit", time_limit, 1, 1e6)
    if workers is not None:
        check_integer("workers", workers, 1, 1024)
    sources = find_sources(inputs)
    store = Store(folder)
    store.begin(parameters)
    run = _Run(store, parameters, len(sources), time_limit, report)
    if scheduler is None:
        announce()  # the processes that bind compile, and print nothing
    with connected(scheduler, workers, processes) as cluster:
        try:
            run.all(sources, cluster)
        finally:
            run.write_manifest()
    rows = run.sorted_rows()
    failed = sum(bool(row["error"]) for row in rows)
    counts = run.bound, run.unchanged, failed
    return BindReport(folder, rows, *counts, perf_counter() - begin, run.lost, tuple(run.damaged))


class _Run:
    """The state of one call of `bind_all`."""

    def __init__(
        self,
        store: Store,
        parameters: Parameters,
        count: int,
        limit: float,
        report: Callable[[int, int, str], None],
    ) -> None:
        self._store, self._parameters = store, parameters
        self._count, self._limit, self._report = count, limit, report
        self._suffix = parameters.digest()
        self._rows: dict[str, dict[str, Any]] = {}
        rows = store.manifest() if store.path_of_manifest.is_file() else []
        self._earlier = {r["name"]: r for r in rows if r["key"].endswith(f"-{self._suffix}")}
        self._written = perf_counter()
        self._jobs: dict[str, _Job] = {}
        self.bound = self.unchanged = 0
        self.lost: dict[str, str] = {}
        self.damaged: list[str] = []

    def all(self, sources: list[Source], cluster: Cluster) -> None:
        """Bind all sources, no more at a time than the workers can take."""
        for source in sources:
            while cluster.is_full():
                self._store_next(cluster)
            self._begin(source, cluster)
        while self._jobs:
            self._store_next(cluster)

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
        outcome = self._store.outcome(key)
        if outcome is not None:
            self.unchanged += 1
            self._note(source, digest, outcome)
            return
        if self._store.path(key).is_file():
            self.damaged.append(source.name)
        self._jobs[key] = _Job(key, digest, [source])
        cluster.submit(
            key, bind_isolated, content, key, self._parameters, self._limit, cluster.slots
        )

    def _store_next(self, cluster: Cluster) -> None:
        """Wait for an asset and write it to the store."""
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
        self._report(len(self._rows), self._count, source.name)

    def sorted_rows(self) -> list[dict[str, Any]]:
        return [self._rows[name] for name in sorted(self._rows)]

    def write_manifest(self) -> None:
        rows = self._earlier | self._rows
        self._store.write_manifest([rows[name] for name in sorted(rows)])
        self._written = perf_counter()


class _MemoryBudget:
    """Memory charged by the assets of this process; an asset waits until its charge fits."""

    def __init__(self) -> None:
        self.charged = 0
        self._changed = threading.Condition()

    def charge(self, size: int, total: int) -> None:
        if size > total:
            raise TooLargeError(
                f"it would need about {gigabytes(size)} of memory, and {gigabytes(total)} are "
                "available; choose a lower resolution, or a machine with more memory"
            )
        with self._changed:
            self._changed.wait_for(lambda: self.charged + size <= total)
            self.charged += size

    def release(self, size: int) -> None:
        with self._changed:
            self.charged -= size
            self._changed.notify_all()


_budget = _MemoryBudget()


def bind_isolated(
    content: Content, key: str, parameters: Parameters, limit: float, slots: int
) -> Outcome:
    """Bind one asset in a subprocess; called by a Dask worker."""
    total = int(available_memory() * SHARE / slots) + _budget.charged
    charges: list[int] = []

    def reserve(size: int) -> None:
        if not charges:  # a second attempt needs the same memory
            _budget.charge(size, total)
            charges.append(size)

    def attempt(last: bool) -> Outcome:
        try:
            return runner.bind(content, key, parameters, limit, reserve)
        except (AssetLostError, TooLargeError) as error:
            passing = getattr(error, "passing", True)
            if isinstance(error, AssetLostError) and passing and not last:
                return attempt(last=True)
            record = {"error": str(error), "version": __version__, "passing": passing}
            return Outcome(key, record)

    with lend_runner() as runner:
        try:
            return attempt(last=False)
        finally:
            for size in charges:
                _budget.release(size)
