"""Near-duplicates in a data set, or between two (paper, algorithms 3 and 4)."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_integer, check_number
from cutcell.errors import CutcellError
from cutcell.io.files import naming

from ..bind.cluster import Cluster, connected
from ..read.sources import Content, Source, find_sources, read_content
from .chamfer import Block, block_of, close_joints, close_surfaces, reach_of
from .duplicates import Audit, Pair
from .likeness import Features, features_of, likeness, same_skeletons
from .points import Normalised, normalised

POINTS = 2048
"""Points sampled on each surface."""
BLOCK = 1000
"""Characters of each of the two sets in one comparison job."""
BATCH = 16
"""Characters in one reading job."""
THRESHOLD = 0.01


def audit(
    first: Sequence[Path],
    second: Sequence[Path] = (),
    *,
    joint_threshold: float = THRESHOLD,
    surface_threshold: float = THRESHOLD,
    points: int = POINTS,
    least: int = 2,
    poses: bool = True,
    scheduler: str | None = None,
    workers: int | None = None,
    report: Callable[[int, int, str], None] = lambda done, count, name: None,
) -> Audit:
    """Find near-duplicates in a data set, or between two.

    Each character is moved into the unit cube, and points are drawn on its surface with a fixed
    seed. Pairs whose joints are closer than one threshold and whose surfaces are closer than the
    other are near-duplicates. In one data set they are clustered by DBSCAN, as in the paper.

    Parameters
    ----------
    first, second : sequence of Path
        See `find_sources`; `first` is compared with itself where `second` is empty.
    joint_threshold, surface_threshold : float
        T_J and T_V, above 0, squared Chamfer distances.
    points : int
        On each surface, 16 to 100,000.
    least : int
        DBSCAN's MinPts, the point itself included. With 2 each pair is a cluster; the paper
        gives no value.
    poses : bool
        Whether to find pairs of one skeleton in other poses as well.
    scheduler, workers, report
        See `bind_all`; the workers are processes.

    Returns
    -------
    Audit

    Raises
    ------
    FileError
        There are no characters.
    ParameterError
        An argument is out of its range.
    MissingLibraryError
        Dask or scikit-learn is not installed.
    CutcellError
        The scheduler cannot be reached, or was lost.

    References
    ----------
    Paper, appendix on the audit of the data set, algorithms 3 and 4.
    """
    limits = (
        check_number("joint_threshold", joint_threshold, 1e-12, 10),
        check_number("surface_threshold", surface_threshold, 1e-12, 10),
    )
    check_integer("points", points, 16, 100_000)
    check_integer("least", least, 2, 1_000_000)
    one, two = find_sources(first), find_sources(second) if second else None
    seconds: dict[str, float] = {}
    begin = perf_counter()
    with connected(scheduler, workers, True) as cluster:
        failed: dict[str, str] = {}
        first_set = _read(one, points, cluster, failed, report)
        second_set = first_set if two is None else _read(two, points, cluster, failed, report)
        seconds["reading"] = perf_counter() - begin
        begin = perf_counter()
        matches = compare(first_set, None if two is None else second_set, limits, cluster, report)
    pairs = _pairs(first_set, second_set, matches)
    posed = _posed(first_set, None if two is None else second_set, pairs) if poses else []
    seconds["pairs"] = perf_counter() - begin
    return Audit(
        [source.name for source in first_set.sources],
        [source.name for source in second_set.sources],
        pairs,
        posed,
        matches.candidates,
        failed,
        first_set.sources,
        second_set.sources,
        seconds,
        limits[1],
        least,
    )


@dataclass(frozen=True, eq=False)
class Readings:
    """Readable characters of a set, in order."""

    sources: list[Source]
    traits: list[Features]
    blocks: list[Block]
    size: int = BLOCK


@dataclass(frozen=True, eq=False)
class Matches:
    """Pairs by their indices in both sets, with distances; `candidates` passed stage 1."""

    pairs: NDArray[np.int64]
    joints: NDArray[np.float64]
    surface: NDArray[np.float64]
    reach: NDArray[np.float64]
    candidates: int


def readings(
    sources: list[Source], characters: list[tuple[Normalised, Features]], size: int = BLOCK
) -> Readings:
    """Put characters into blocks."""
    blocks = [
        block_of([character for character, _ in characters[k : k + size]])
        for k in range(0, len(characters), size)
    ]
    return Readings(sources, [traits for _, traits in characters], blocks, size)


def _read(
    sources: list[Source],
    points: int,
    cluster: Cluster,
    failed: dict[str, str],
    report: Callable[[int, int, str], None],
) -> Readings:
    """Read all characters, many at a time; those that cannot be read are in `failed`."""
    results: dict[int, list[Any]] = {}
    done = 0

    def take() -> None:
        nonlocal done
        key, result = cluster.next_result()
        number = int(key.rpartition("-")[2])
        batch = sources[number * BATCH : (number + 1) * BATCH]
        if isinstance(result, BaseException):
            result = [f"it was not read: {result}"] * len(batch)
        results[number] = result
        done += len(batch)
        report(done, len(sources), batch[-1].name)

    count = 0
    for number in range(0, -(-len(sources) // BATCH)):
        contents: list[Content | str] = []
        for source in sources[number * BATCH : (number + 1) * BATCH]:
            try:
                contents.append(source.content())
            except CutcellError as error:
                contents.append(str(error))
        while cluster.is_full():
            take()
        cluster.submit(f"read-{id(sources)}-{number}", _characters, contents, points)
        count += 1
    while len(results) < count:
        take()
    good, characters = [], []
    read = [one for number in range(count) for one in results[number]]
    for source, one in zip(sources, read, strict=True):
        if isinstance(one, str):
            failed[source.name] = one
        else:
            good.append(source)
            characters.append(one)
    return readings(good, characters)


def _characters(
    contents: list[Content | str], points: int
) -> list[tuple[Normalised, Features] | str]:
    """Read characters in a Dask worker; a text is the reason why one cannot be read."""
    return [one if isinstance(one, str) else _character(one, points) for one in contents]


def _character(content: Content, points: int) -> tuple[Normalised, Features] | str:
    try:
        with tempfile.TemporaryDirectory() as folder, naming(Path(next(iter(content.files)))):
            rig = read_content(content, Path(folder))
            if not len(rig.skeleton.joints):
                return "it has no joints"
            return normalised(rig, points), features_of(rig)
    except (CutcellError, MemoryError) as error:
        return str(error) or "there is not enough memory"


def compare(
    first: Readings,
    second: Readings | None,
    limits: tuple[float, float],
    cluster: Cluster,
    report: Callable[[int, int, str], None] = lambda done, count, name: None,
) -> Matches:
    """Run both stages on all pairs; each job compares two blocks."""
    left = cluster.scatter(first.blocks)
    right = left if second is None else cluster.scatter(second.blocks)
    numbers = range(len(left)), range(len(right))
    jobs = list(combinations_with_replacement(numbers[0], 2) if second is None
                else product(*numbers))  # fmt: skip
    parts: dict[str, tuple[NDArray, NDArray, int]] = {}

    def take() -> None:
        key, result = cluster.next_result()
        if isinstance(result, BaseException):
            raise CutcellError(f"a part of the comparison was lost: {result}; run it again")
        parts[key] = result
        report(len(parts), len(jobs), "pairs")

    for i, j in jobs:
        while cluster.is_full():
            take()
        same = second is None and i == j
        cluster.submit(f"pairs-{id(first)}-{i}-{j}", _compared, left[i], right[j], limits, same)
    while len(parts) < len(jobs):
        take()
    rows = []
    for i, j in jobs:
        pairs, figures, count = parts[f"pairs-{id(first)}-{i}-{j}"]
        size = first.size, (second or first).size
        rows.append((pairs + np.array([i * size[0], j * size[1]]), figures, count))
    if not rows:
        nothing = np.zeros(0)
        return Matches(np.zeros((0, 2), np.int64), nothing, nothing, nothing, 0)
    pairs = np.concatenate([row[0] for row in rows])
    joints, surface, reach = np.concatenate([row[1] for row in rows], axis=1)
    order = np.lexsort((pairs[:, 1], pairs[:, 0], surface))
    candidates = sum(row[2] for row in rows)
    return Matches(pairs[order], joints[order], surface[order], reach[order], candidates)


def _compared(
    a: Block, b: Block, limits: tuple[float, float], same: bool
) -> tuple[NDArray[np.int64], NDArray[np.float64], int]:
    """Compare two blocks in a Dask worker; returns pairs, distances and overhang, candidates."""
    pairs, joints = close_joints(a, b, limits[0], same)
    surface = close_surfaces(a, b, pairs, limits[1])
    near = np.isfinite(surface)
    figures = np.stack([joints[near], surface[near], reach_of(a, b, pairs[near])])
    return pairs[near].astype(np.int64), figures, len(pairs)


def _pairs(first: Readings, second: Readings, matches: Matches) -> list[Pair]:
    pairs = []
    figures = matches.joints.tolist(), matches.surface.tolist(), matches.reach.tolist()
    for (a, b), joints, surface, reach in zip(matches.pairs.tolist(), *figures, strict=True):
        alike = likeness(first.traits[a], second.traits[b], surface, reach)
        pairs.append(Pair(a, b, joints, surface, alike))
    return pairs


def _posed(first: Readings, second: Readings | None, pairs: list[Pair]) -> list[Pair]:
    matched = {(pair.a, pair.b) for pair in pairs}
    other = first if second is None else second
    candidates = same_skeletons(first.traits, None if second is None else second.traits)
    posed = []
    for a, b in candidates.tolist():
        if (a, b) not in matched:
            alike = likeness(first.traits[a], other.traits[b], np.inf, np.nan)
            posed.append(Pair(a, b, np.inf, np.inf, alike))
    return posed
