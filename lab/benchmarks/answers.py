"""Measure the answers that README gives to questions about skinning tools.

    python -m cutcell_lab.benchmarks.answers [--out README.md]

All characters of the sets rigs and wild are bound, at R = 128 for times and at R = 64 for the rest.
"""

from __future__ import annotations

import argparse
import io
import os
import pickle
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import cutcell
from cutcell.geometry.triangles import label_components
from cutcell.rig import Rig

from ..dataset.read.archive import read_archive
from .document import fill
from .rigs import ROOT, rig_paths
from .tables import seconds
from .wild import files_of

SETS = ("rigs", "wild")
REPEATS = 3
EXPLAINED = 3
"""Vertices of each character whose weights are explained."""
AGAIN = """
import sys, hashlib, cutcell
for path in sys.argv[1:]:
    weights = cutcell.bind(cutcell.load(path), 64).weights
    print(hashlib.sha256(weights.tobytes()).hexdigest())
"""
"""Prints what the weights of files are, in a process of its own."""


@dataclass(frozen=True)
class Facts:
    """What was seen of one character."""

    seconds: float
    joints: int
    components: int
    vertices: int
    split: int  # vertices that share a position with an earlier one
    torn: int  # of these, vertices of other weights
    meeting: int  # of those, vertices of another skin, which has other joints
    empty: int  # vertices without weight
    explained: int  # vertices whose explanation ends in the computed weights


def examine(rig: Rig) -> Facts:
    """Bind a character and measure it."""
    spent = []
    for _ in range(REPEATS):
        start = time.process_time()  # of all threads: it counts no other program
        cutcell.bind(rig, 128)
        spent.append(time.process_time() - start)
    weights = cutcell.bind(rig, 64).weights
    places, index = np.unique(rig.mesh.vertices, axis=0, return_inverse=True)
    index = index.reshape(-1)
    first = np.full(len(places), len(weights))
    np.minimum.at(first, index, np.arange(len(weights)))
    differs = (weights != weights[first[index]]).any(axis=1)
    one_skin = np.ones(len(weights), bool)
    if rig.allowed is not None:
        one_skin = (rig.allowed == rig.allowed[first[index]]).all(axis=1)
    used = np.unique(rig.mesh.faces)
    labels = label_components(index[rig.mesh.faces], len(places))
    drawn = np.random.default_rng(0).choice(used, min(EXPLAINED, len(used)), replace=False)
    return Facts(
        min(spent),
        len(rig.skeleton.joints),
        len(np.unique(labels[index[used]])),
        len(weights),
        len(weights) - len(places),
        int(differs.sum()),
        int((differs & ~one_skin).sum()),
        int((weights.sum(axis=1) < 0.5).sum()),
        sum(_is_explained(rig, weights, int(vertex)) for vertex in drawn),
    )


def _is_explained(rig: Rig, weights: np.ndarray, vertex: int) -> bool:
    """Return whether the last step of an explanation has the weights of a vertex."""
    row = np.zeros(weights.shape[1])
    for share in cutcell.explain(rig, vertex, 64).joints:
        row[share.joint] = share.weight
    return bool(np.array_equal(row, weights[vertex]))


def same_again(paths: Sequence[Path]) -> int:
    """Count characters whose weights are byte for byte the same with one thread and with two."""
    runs = [
        subprocess.run(
            [sys.executable, "-c", AGAIN, *map(str, paths)],
            env={**os.environ, "NUMBA_NUM_THREADS": count, "OPENBLAS_NUM_THREADS": count},
            check=True, capture_output=True, text=True, cwd=ROOT,
        ).stdout.split()
        for count in ("1", "2")
    ]  # fmt: skip
    return sum(one == two for one, two in zip(*runs, strict=True))


class Call:
    """Calls a function when Python unpickles it."""

    def __init__(self, function: Any, *arguments: Any) -> None:
        self.call = function, arguments

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        """Say what to call."""
        return self.call


def attacks(mark: Path) -> Iterator[Call]:
    """Yield calls that each leave a folder behind."""
    make = f"import os; os.makedirs({str(mark)!r})"
    yield Call(os.makedirs, str(mark))
    yield Call(os.system, f"mkdir '{mark}'")
    yield Call(subprocess.call, ["mkdir", str(mark)])
    yield Call(exec, make)
    yield Call(eval, f"__import__('os').makedirs({str(mark)!r})")
    yield Call(shutil.copytree, str(mark.parent / "empty"), str(mark))


def run_by_attacks() -> tuple[int, int, int]:
    """Count archives that run code: those made, by Python's own reader, and by ours."""
    made = by_python = by_us = 0
    with tempfile.TemporaryDirectory() as folder:
        mark, path = Path(folder, "mark"), Path(folder, "archive.npz")
        Path(folder, "empty").mkdir()
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            for call in attacks(mark):
                for asset in (call, {"vertices": call}, {"joint_names": ["hips", call]}):
                    _write_archive(path, asset, protocol)
                    made += 1
                    list(read_archive(path))
                    by_us += mark.exists()
                    shutil.rmtree(mark, ignore_errors=True)
                    with np.load(path, allow_pickle=True) as python:
                        python["arr_0"]
                    by_python += mark.exists()
                    shutil.rmtree(mark, ignore_errors=True)
    return made, by_python, by_us


def _write_archive(path: Path, asset: Any, protocol: int) -> None:
    array = np.empty(1, object)
    array[0] = asset
    data = io.BytesIO()
    header = {"descr": "|O", "fortran_order": False, "shape": array.shape}
    np.lib.format.write_array_header_1_0(data, header)
    pickle.dump(array, data, protocol=protocol)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("arr_0.npy", data.getvalue())


def wheels() -> tuple[int, int]:
    """Count pairs of system and Python that need no compiler, of all that were resolved."""
    rows = re.findall(r"^\| [^|]+ \| core \|(.*)\|$", (ROOT / "docs/systems.md").read_text(), re.M)
    cells = [cell.strip() for row in rows for cell in row.split("|")]
    return cells.count("yes"), len(cells)


def answers(every: Sequence[Facts], same: int) -> Iterator[tuple[str, str]]:
    """Yield heads and sentences of the answers."""
    free, resolved = wheels()
    median, slowest = (
        seconds(pick([one.seconds for one in every])) for pick in (statistics.median, max)
    )
    fewest, most = (pick(one.joints for one in every) for pick in (min, max))
    several = [one.components for one in every if one.components > 1]
    split, torn, meeting, empty, vertices, explained = (
        sum(getattr(one, name) for one in every)
        for name in ("split", "torn", "meeting", "empty", "vertices", "explained")
    )
    made, by_python, by_us = run_by_attacks()
    (l1, moved), heat, voxel = (medians(name) for name in ("cutcell_rig", "bone_heat", "voxel"))
    yield (
        "Why not bone heat or voxels",
        f"L1 to artists' weights (0 to 2) is {l1} (bone heat {heat[0]}, voxels {voxel[0]}), "
        f"the deformation error {moved} cm² ({heat[1]}, {voxel[1]}): medians of the 14 "
        "characters that the method was developed on; the paper's falloff for voxels. See "
        "[where it is worse](docs/falloff.md).",
    )
    yield (
        "One `pip install`",
        f"{free} of {resolved} pairs of system and Python version need no compiler "
        "([systems](docs/systems.md)).",
    )
    yield (
        "Milliseconds, no GPU",
        f"`bind` at R = 128 takes {median} of CPU time in the median of {len(every)} characters "
        f"by others, {slowest} at most. Users of RigNet's script report [10 to 40 minutes "
        "and over 100 GB](https://github.com/zhan-xu/RigNet/issues/27) for one mesh.",
    )
    yield (
        "The same weights each time",
        f"byte for byte on {same} of {len(every)} characters, in two processes, with one thread "
        "and with two.",
    )
    yield (
        "Your own skeleton",
        f"{fewest} to {most} joints of people, animals, hands and machines, without a template.",
    )
    yield (
        "Seams do not tear",
        f"weights at one position are the same at {split - torn:,} of {split:,} split vertices; "
        f"{torn} differ, {meeting} of them where skins with different joints meet.",
    )
    yield (
        "Parts and garments",
        f"{len(several)} of the characters have {min(several)} to {max(several)} components; "
        f"{empty} of {vertices:,} vertices are left without weight.",
    )
    yield (
        "A reason for each weight",
        "`cutcell explain` lists paths, distances and steps; "
        f"the last step is the weight at {explained} of {EXPLAINED * len(every)} vertices.",
    )
    yield (
        "An archive can run no code",
        f"{by_us} of {made} malicious pickles ran ({by_python} with Python's own reader).",
    )


def medians(method: str) -> tuple[str, str]:
    """Return the median L1 and deformation error of a method, as docs/quality.md has them."""
    page = (ROOT / "docs/quality.md").read_text(encoding="utf-8")
    row = re.search(rf"^\| {method} \| ([\d.]+), .*$", page, re.MULTILINE)
    if row is None:
        raise SystemExit(f"docs/quality.md has no results of {method}")
    return row[1], row[0].split(" | ")[4].split(",")[0]


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.answers", description=__doc__
    )
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    paths = [path for group in SETS for path in files_of(group)]
    cutcell.bind(cutcell.load(rig_paths()[0]), 16)  # what is compiled once
    every = []
    for path in paths:
        every.append(examine(cutcell.load(path)))
        print(path.stem, every[-1], file=sys.stderr, flush=True)
    text = "\n".join(f"- **{head}**: {said}" for head, said in answers(every, same_again(paths)))
    print(text)
    if options.out:
        fill(options.out, {"answers": text})


if __name__ == "__main__":
    main()
