"""Fuzz the readers: a damaged file loads and can be saved, or a sentence says why not.

python -m tests.fuzz.readers glb --count 10000
python -m tests.fuzz.readers glb --case 17 --keep FOLDER
"""

from __future__ import annotations

import argparse
import os
import pickle
import resource
import signal
import sys
import tempfile
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import cutcell
from cutcell.io import keeps_document
from cutcell.io.formats import scene as scenes
from cutcell.io.gltf.read import compressed as gltf_draco
from cutcell.isolated.__main__ import limit_memory
from cutcell.isolated.run import WorkFailedError

from .formats import READERS, Files
from .harness import SECONDS, try_cases

LARGEST = 2_000_000
"""Bytes of a case: larger ones may take longer than is watched for here."""
LONGEST_SENTENCE = 1200
SAVED = 4
"""Of so many cases, one is also saved in each format."""
EXACT = 1e-5
NAMES = list(READERS)


def files_of(number: int) -> Files:
    """Make the files of a case; its number also says whose."""
    rng = np.random.default_rng([15, number])
    make = READERS[NAMES[number % len(NAMES)]]
    return next(files for files in iter(lambda: make(rng), {}) if _size(files) <= LARGEST)


def _size(files: Files) -> int:
    return sum(map(len, files.values()))


def describe(number: int) -> str:
    """Say what a case is made of."""
    sizes = {name: len(content) for name, content in files_of(number).items()}
    return f"case {number}: {NAMES[number % len(NAMES)]}, {sizes}"


def check(number: int) -> None:
    """Load a case, play and save what could be loaded."""
    warnings.simplefilter("error")
    for module in (scenes, gltf_draco):
        module.run_isolated = _forked  # type: ignore[attr-defined]
    with tempfile.TemporaryDirectory() as folder:
        saved = number // len(NAMES) % SAVED == 0
        check_files(Path(folder), files_of(number), saved)


def check_files(folder: Path, files: Files, saved: bool = True) -> None:
    """See that files load, play, and are saved, or that a sentence names the one that does not.

    A glTF document that loads can be saved.
    """
    for name, content in files.items():
        (folder / name).write_bytes(content)
    rig = _ours(lambda: cutcell.load(folder / next(iter(files))), [*files])
    if rig is None:
        return
    assert all(isinstance(reports, str) for reports in rig.warnings)
    for clip in rig.clips:
        _ours(lambda clip=clip: clip.sample([0, clip.duration / 3, clip.duration]), [""])  # type: ignore[misc]
        assert len(clip.times) <= 3601
    if keeps_document(rig):
        _check_kept(rig, folder / "kept.glb")
    if rig.weights is None:
        return
    assert np.isfinite(rig.weights).all()
    assert (rig.weights >= 0).all()
    sums = rig.weights.sum(axis=1)
    assert (np.minimum(np.abs(sums), np.abs(sums - 1)) < EXACT).all()
    for end in (".glb", ".txt", ".npz") if saved else ():
        _check_saved(rig, folder / f"out{end}")


def _check_kept(rig: cutcell.Rig, path: Path) -> None:
    """See that what loaded goes back into its document, also after its joints moved."""
    if not len(rig.skeleton.joints):
        joint = cutcell.Skeleton(rig.mesh.vertices[:1], [-1], ("joint",))
        rig = replace(rig, skeleton=joint)
    if rig.weights is None:
        shape = len(rig.mesh.vertices), len(rig.skeleton.joints)
        allowed = np.ones(shape, bool) if rig.allowed is None else rig.allowed
        rig = rig.with_weights((allowed.cumsum(axis=1) == 1) & allowed)
    cutcell.save(path, rig)
    by = 0.01 * np.ptp(rig.mesh.vertices, axis=0).max()
    with suppress(cutcell.SkeletonError):  # a skin without matrices
        cutcell.save(path, rig.with_joints(rig.skeleton.joints + by))


def _check_saved(rig: cutcell.Rig, path: Path) -> None:
    if _ours(lambda: cutcell.save(path, rig), [path.name, "out.obj"]) is None:
        return
    again = cutcell.load(path).weights
    if again is None:  # a rig file without any weight has no lines for them
        again = np.zeros(rig.weights.shape)
    assert np.abs(again - rig.weights).max(initial=0) < EXACT


def _ours(do: Any, names: list[str]) -> Any:
    """Return what is done, or None after a sentence that names one of the files."""
    try:
        return do()
    except cutcell.CutcellError as error:
        sentence = str(error)
    assert 10 < len(sentence) < LONGEST_SENTENCE, sentence
    assert "\n" not in sentence, sentence
    assert any(name in sentence for name in names), sentence
    return None


def _forked(
    task: str, job: Mapping[str, Any], limit: float, who: str, memory: int = 0, extra: str = ""
) -> dict[str, Any]:
    """Stand in for `run_isolated`: a copy of this process does the work, which starts at once."""
    read, write = os.pipe()
    child = os.fork()
    if not child:
        os.close(read)
        _work(task, job, memory, write)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        answer = pipe.read()
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status) or not answer:
        ended = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        assert ended != signal.SIGXCPU, f"{who} took longer than {SECONDS} s"
        raise WorkFailedError(f"{who} crashed (signal {ended})")
    result = pickle.loads(answer)
    if isinstance(result, str):
        raise WorkFailedError(result)
    return result  # type: ignore[no-any-return]


def _work(task: str, job: Mapping[str, Any], memory: int, pipe: int) -> None:
    """Do the work in the copy, which then ends."""
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        limit_memory(memory)
        module, function = task.split(":")
        answer: Any = getattr(import_module(module), function)(**job)
    except (RuntimeError, ValueError, MemoryError) as error:
        answer = str(error) or type(error).__name__
    except BaseException as error:  # what ends the process by a traceback
        answer = f"{task} stopped: {type(error).__name__}: {error}"
    with os.fdopen(pipe, "wb") as out:
        pickle.dump(answer, out)
    os._exit(0)


def warm_up() -> None:
    """Import what is slow to import: a case is not to be blamed for that."""
    for task in ("draco", "fbx", "usd"):
        import_module(f"cutcell.isolated.{task}")
    for number in range(len(NAMES)):
        check(number)


def main() -> None:
    """Run the fuzzer by the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz.readers")
    parser.add_argument("reader", choices=NAMES)
    parser.add_argument("--count", type=int, default=100, help="how many cases")
    parser.add_argument("--first", type=int, default=0, help="the number of the first")
    parser.add_argument("--case", type=int, help="this one alone, here, without limits")
    parser.add_argument("--keep", type=Path, help="the folder for the files of that case")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    if options.case is not None:
        print(describe(options.case))
        if options.keep:
            options.keep.mkdir(exist_ok=True)
            for name, content in files_of(options.case).items():
                (options.keep / name).write_bytes(content)
        check(options.case)
        return
    start = options.first * len(NAMES) + NAMES.index(options.reader)
    numbers = range(start, start + options.count * len(NAMES), len(NAMES))
    report = try_cases("tests.fuzz.readers", numbers, options.processes)
    for failure in report.failures:
        print(f"case {failure.number}:\n{failure.why}")
    print(
        f"{options.reader}: {report.passed:,} of {options.count:,} cases passed; the slowest took "
        f"{report.slowest[0]:.1f} s (case {report.slowest[1]}), the largest process "
        f"{report.peak / 1e9:.2f} GB"
    )
    sys.exit(bool(report.failures))


if __name__ == "__main__":
    main()
