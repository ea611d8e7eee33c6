"""`cutcell dataset` on data of the size and the faults that are out there.

python -m cutcell_lab.benchmarks.dataset PART [--assets N] [--folder DIR] [--document]

PART is whole, kills, workers, audit or growth.

With --document the tables also go into docs/dataset.md.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from scipy.spatial import cKDTree

import cutcell
from cutcell_assets.generate import KINDS, generate
from cutcell_lab.dataset.audit.auditing import THRESHOLD, compare, readings
from cutcell_lab.dataset.audit.auditing import audit as audit_of
from cutcell_lab.dataset.audit.chamfer import Block
from cutcell_lab.dataset.audit.likeness import features_of
from cutcell_lab.dataset.audit.points import Normalised, normalised
from cutcell_lab.dataset.bind.cluster import connected
from cutcell_lab.dataset.read.sources import read_source
from cutcell_lab.dataset.read.store import MANIFEST, read_table
from tests.lab.dataset.planted import planted

from .document import fill
from .rigs import ROOT, SHARED
from .tables import Table, publish

DOCUMENT = ROOT / "docs" / "dataset.md"
DETAIL = 20
"""Sizes of generated characters: 300 to 700 vertices."""
BROKEN = 10
WITHOUT_PERSONS = [kind for kind in KINDS if kind != "person"]
BIND = ("--quiet", "--resolution", "32")
MODES = ("command", "runner", "worker", "scheduler")
SEED = 18


class Attack:
    """Makes a folder when it is unpickled by Python's own means."""

    def __init__(self, mark: Path) -> None:
        self._mark = str(mark)

    def __reduce__(self) -> Any:
        return os.makedirs, (self._mark,)


def build_archive(path: Path, count: int, mark: Path) -> None:
    """Write an archive of the published form: some broken, some twice, one an attack."""
    entries: list[Any] = []
    for k in range(count):
        rig = generate(WITHOUT_PERSONS[k % 5], k // 5, detail=DETAIL)
        rows, columns = np.nonzero(rig.weights)
        children = np.flatnonzero(rig.skeleton.parents >= 0)
        plural = "s" if k % 2 else ""
        entries.append(
            {
                "vertices": np.array(rig.mesh.vertices, np.float32),
                "faces": np.array(rig.mesh.faces),
                "joints": np.array(rig.skeleton.joints, np.float32),
                "bones": np.stack([rig.skeleton.parents[children], children], axis=1),
                "root_index": 0,
                "uuid": f"{rig.name}",
                "joint_names": list(rig.skeleton.names),
                "skinning_weights_value": rig.weights[rows, columns].astype(np.float32),
                f"skinning_weights_row{plural}": rows,
                f"skinning_weights_col{plural}": columns,
                "skinning_weights_shape": rig.weights.shape,
            }
        )
    for k in range(BROKEN):
        entry = entries[7 * k + 1]
        if k % 3 == 0:
            entry["faces"] = entry["faces"] + 10**6
        elif k % 3 == 1:
            entry["vertices"] = entry["vertices"] * np.float32("nan")
        else:
            del entry["joints"]
    entries[count // 2] = Attack(mark)
    array = np.empty(count, object)
    array[:] = entries
    np.savez_compressed(path, array)


def timed(*arguments: object) -> tuple[float, float, subprocess.CompletedProcess]:
    """Run a command of `cutcell dataset`; return seconds, CPU seconds of all its processes."""
    before, begin = os.times(), time.perf_counter()
    command = [sys.executable, "-m", "cutcell", "dataset", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    after = os.times()
    cpu = after.children_user + after.children_system
    cpu -= before.children_user + before.children_system
    if done.returncode:
        raise RuntimeError(done.stderr)
    return time.perf_counter() - begin, cpu, done


def whole(count: int, folder: Path) -> list[Table]:
    """Go the whole way with an archive."""
    table = Table(
        f"An archive of {count:,} assets",
        ["command", "assets", "left out", "CPU ms an asset", "seconds"],
        f"Generated characters of 300 to 700 vertices, {BROKEN} of them broken, one an attack; "
        "R=32. CPU time is that of all processes together, starts included. The machine was "
        "shared: seconds are what it took there.",
    )
    archive, mark = folder / "archive.npz", folder / "attacked"
    build_archive(archive, count, mark)
    seconds, cpu, done = timed("split", archive, folder / "rigs", "--json")
    split = json.loads(done.stdout)
    assert not mark.exists()
    table.add("split", split["written"], len(split["refused"]), f"{cpu / count * 1e3:.1f}",
              f"{seconds:.0f}")  # fmt: skip
    store = folder / "store"
    seconds, cpu, done = timed("bind", folder / "rigs", store, "-r", 32, "--json")
    bound = json.loads(done.stdout)
    left = len(bound["failed"])
    table.add("bind", bound["bound"], left, f"{cpu / count * 1e3:.0f}", f"{seconds:.0f}")
    seconds, cpu, done = timed("bind", folder / "rigs", store, "-r", 32, "--json")
    again = json.loads(done.stdout)
    table.add("bind, again", again["bound"], left, f"{cpu / count * 1e3:.1f}", f"{seconds:.0f}")
    for kind, out in (("rignet", "rignet"), ("unirig", "unirig"), ("puppeteer", "train.h5")):
        seconds, cpu, done = timed("export", store, folder / out, "--format", kind, "--json")
        written = json.loads(done.stdout)["assets"]
        table.add(f"export, {kind}", written, "-", f"{cpu / count * 1e3:.1f}", f"{seconds:.0f}")
    seconds, cpu, done = timed("audit", store, "--out", folder / "audit", "--json")
    audited = json.loads(done.stdout)
    table.add("audit", audited["assets"], "-", f"{cpu / count * 1e3:.1f}", f"{seconds:.0f}")
    why = Table("What was left out", ["asset", "why"])
    for name, text in [*split["refused"].items(), *bound["failed"].items()]:
        why.add(name, text)
    return [table, why]


@contextmanager
def dask(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """Start a scheduler and workers, each worker with its own folder."""
    file = folder / f"scheduler{random.getrandbits(40):x}.json"
    python = [sys.executable, "-W", "ignore", "-m"]
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    started = [
        subprocess.Popen(
            [*python, "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard",
             "--host", "127.0.0.1", "--scheduler-file", str(file)], **quiet)
    ]  # fmt: skip
    try:
        while not file.exists() or not file.read_text().strip():
            time.sleep(0.1)
        for k in range(workers):
            worker_folder = folder / f"machine{k}"
            worker_folder.mkdir(exist_ok=True)
            started.append(
                subprocess.Popen(
                    [*python, "distributed.cli.dask_worker", "--scheduler-file", str(file),
                     "--nthreads", "1", "--no-dashboard", "--local-directory", str(worker_folder)],
                    cwd=worker_folder, **quiet)
            )  # fmt: skip
        yield json.loads(file.read_text())["address"], started
    finally:
        for process in started:
            stop(process.pid)
            process.wait()


def family(pid: int) -> list[psutil.Process]:
    """Return a process and all that it started."""
    try:
        process = psutil.Process(pid)
        return [process, *process.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def stop(pid: int) -> None:
    """Kill a process and all that it started."""
    for process in family(pid):
        try:
            process.kill()
        except psutil.NoSuchProcess:
            continue


def contents(store: Path) -> dict[str, Any]:
    """Return the bytes of all files of a store, and its manifest without times."""
    files: dict[str, Any] = {p.name: p.read_bytes() for p in store.glob("??/*.npz")}
    files["manifest"] = [
        {k: v for k, v in row.items() if not k.startswith("seconds")}
        for row in read_table(store / MANIFEST)
    ]
    return files


def kills(count: int, folder: Path) -> list[Table]:
    """Kill a part of a run ten times, and compare the store with that of an undisturbed one."""
    made = folder / "made"
    timed("generate", "any", count, made, "--detail", DETAIL, "--quiet")
    timed("bind", made, folder / "undisturbed", *BIND)
    store, dice = folder / "disturbed", random.Random(SEED)
    table = Table(
        "Ten kills",
        ["killed", "times", "in the store by then"],
        f"`kill -9` at random moments while {count} assets are bound, one part after the other.",
    )
    killed: dict[str, list[int]] = {mode: [] for mode in MODES}
    for turn in range(10):
        mode = MODES[turn % len(MODES)]
        with dask(folder, 1) as (address, parts):
            extra = [] if mode in ("command", "runner") else ["--scheduler", address]
            command = [sys.executable, "-m", "cutcell", "dataset", "bind", str(made), str(store),
                       *BIND, "--workers", "1", *extra]  # fmt: skip
            process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
            before = len(list(store.glob("??/*.npz")))
            goal = before + dice.randint(1, max(1, count // 12))
            while process.poll() is None and len(list(store.glob("??/*.npz"))) < goal:
                time.sleep(dice.uniform(0, 0.05))
            if process.poll() is None:
                strike(mode, process, parts)
                killed[mode].append(len(list(store.glob("??/*.npz"))))
            if mode in ("runner", "worker"):  # the run itself continues: check that, then end it
                goal_count = len(list(store.glob("??/*.npz"))) + 2
                while process.poll() is None and len(list(store.glob("??/*.npz"))) < goal_count:
                    time.sleep(0.05)
            stop(process.pid)
            process.wait()
    for mode, counts in killed.items():
        table.add(mode, len(counts), ", ".join(map(str, counts)))
    timed("bind", made, store, *BIND)
    same = contents(store) == contents(folder / "undisturbed")
    half = len(list(store.rglob(".cutcell-*")))
    table.add("the end", "", f"equal byte for byte: {same}; half-written files: {half}")
    assert same
    return [table]


def strike(mode: str, command: subprocess.Popen, parts: Sequence[subprocess.Popen]) -> None:
    """Kill one part with signal 9."""
    if mode == "command":
        os.kill(command.pid, signal.SIGKILL)
    elif mode == "scheduler":
        os.kill(parts[0].pid, signal.SIGKILL)
    else:
        root = command.pid if mode == "runner" else parts[1].pid
        inner = [
            p for p in family(root)[1:] if ("runner" in " ".join(p.cmdline())) == (mode == "runner")
        ]
        if inner:
            inner[-1].kill()


def workers(count: int, folder: Path) -> list[Table]:
    """Bind on one worker and on two, each with its own folder."""
    made = folder / "made"
    timed("generate", "any", count, made, "--detail", DETAIL, "--quiet")
    table = Table(
        "Cost of an asset on one worker and on two",
        ["workers", "assets", "CPU ms an asset, workers", "all", "seconds", "same store"],
        "Dask worker processes, each with its own folder and one thread. CPU time tells the "
        "cost where other work shares the machine; seconds are what it took there.",
    )
    first: dict[str, Any] = {}
    costs = []
    for number in (1, 2):
        with dask(folder, number) as (address, parts):
            timed("bind", made, folder / "warm", *BIND, "--scheduler", address, "--no-bones")
            store = folder / f"store{number}"
            before = cpu_of(parts)
            seconds, cpu, _ = timed("bind", made, store, *BIND, "--scheduler", address)
            spent = cpu_of(parts) - before
            files = contents(store)
            first = first or files
            costs.append(spent)
            table.add(number, count, f"{spent / count * 1e3:.0f}",
                      f"{(spent + cpu) / count * 1e3:.0f}", f"{seconds:.1f}",
                      files == first)  # fmt: skip
        for path in (folder / "warm").glob("??/*"):
            path.unlink()
    table.add("efficiency", "", f"{costs[0] / costs[1]:.2f}", "", "", "")
    return [table]


def cpu_of(parts: Sequence[subprocess.Popen]) -> float:
    """Return the CPU seconds of processes and all that they started."""
    times = [p.cpu_times() for part in parts for p in family(part.pid)]
    return sum(t.user + t.system + t.children_user + t.children_system for t in times)


def audits(count: int, folder: Path) -> list[Table]:
    """Audit the characters at hand and planted duplicates; compare with brute force."""
    del count
    hidden = folder / "planted"
    hidden.mkdir(exist_ok=True)
    for name, rig in planted().items():
        weights = np.zeros((len(rig.mesh.vertices), len(rig.skeleton.joints)))
        weights[:, 0] = 1
        cutcell.save(hidden / f"{name}.npz", rig.with_weights(weights))
    audit = audit_of([hidden])
    table = Table(
        "Planted duplicates",
        ["what was done to it", "tier", "D", "kind", "reach", "bones turned"],
        "A generated beast, and the same as others would publish it.",
    )
    for row in audit.rows():
        if "original" in (row["a"], row["b"]):
            other = row["a"] if row["b"] == "original" else row["b"]
            degrees = "-" if row["degrees"] is None else f"{row['degrees']:.0f}°"
            table.add(other, row["tier"], f"{row['surface']:.1e}", row["kind"],
                      f"{row['reach']:.3f}", degrees)  # fmt: skip
    real = Table(
        "Characters by others",
        ["sets", "pairs", "stage 1 keeps", "near-duplicates", "twin", "variant", "near",
         "kind copy or remeshed", "equal to brute force"],
        "Brute force compares all joints and all points of every pair by a k-d tree.",
    )  # fmt: skip
    train, rigs = SHARED / "train" / "quaternius", SHARED / "rigs"
    for name, sets in (("train", [train]), ("rigs", [rigs]), ("rigs in train", [rigs, train])):
        result = audit_of(*[[one] for one in sets], poses=False)
        first = [of_source(source) for source in result.sources]
        second = first if len(sets) == 1 else [of_source(s) for s in result.other_sources]
        expected, candidates = brute(first, None if len(sets) == 1 else second)
        same = {(p.a, p.b) for p in result.pairs} == set(expected)
        same &= all(abs(expected[p.a, p.b] - p.surface) < 1e-9 for p in result.pairs)
        same &= candidates == result.candidates
        tiers = [p.tier for p in result.pairs]
        kinds = sum(p.likeness.kind in ("copy", "remeshed") for p in result.pairs)
        number = len(first) * (len(first) - 1) // 2 if len(sets) == 1 else len(first) * len(second)
        counts = [tiers.count(t) for t in ("twin", "variant", "near")]
        real.add(name, f"{number:,}", candidates, len(tiers), *counts, kinds, same)
    return [table, real]


def of_source(source: Any) -> Normalised:
    """Read a character as the audit does."""
    with tempfile.TemporaryDirectory() as folder:
        return normalised(read_source(source, Path(folder)), 2048)


def brute(
    first: Sequence[Normalised], second: Sequence[Normalised] | None
) -> tuple[dict[tuple[int, int], float], int]:
    """Compare every pair in full."""
    other = first if second is None else second
    trees = [(cKDTree(o.joints.astype(float)), cKDTree(o.points.astype(float))) for o in other]
    first_trees = [
        (cKDTree(o.joints.astype(float)), cKDTree(o.points.astype(float))) for o in first
    ]
    surfaces, candidates = {}, 0
    for a in range(len(first)):
        for b in range(a + 1 if second is None else 0, len(other)):
            if _both(first_trees[a][0], trees[b][0]) < THRESHOLD:
                candidates += 1
                surface = _both(first_trees[a][1], trees[b][1])
                if surface < THRESHOLD:
                    surfaces[a, b] = surface
    return surfaces, candidates


def _both(a: cKDTree, b: cKDTree) -> float:
    forth, back = a.query(b.data)[0], b.query(a.data)[0]
    return float((forth**2).mean() + (back**2).mean())


def growth(count: int, folder: Path) -> list[Table]:
    """Audit more and more generated characters."""
    del folder
    table = Table(
        "Growth of the audit",
        ["assets", "pairs", "stage 1 keeps", "near-duplicates", "to read, CPU s",
         "to compare, CPU s", "CPU µs a pair", "memory of the points"],
        "Generated characters of detail 12, each stretched and turned at random, since those of "
        "one kind are too much alike; 2,048 points each. A fifth are an earlier one again with "
        "other points. CPU time of one process; making the characters is not counted.",
    )  # fmt: skip
    sizes = [size for size in (50, 500, 2000, 8000, 48000) if size <= count]
    for size in sizes:
        characters, spent = [], 0.0
        for k in range(size):
            again = k % 5 == 4 and k > 50
            first = k // 2 if again else k
            rig = stretched(generate(WITHOUT_PERSONS[first % 4], first // 4, detail=12), first)
            begin = time.process_time()
            characters.append((normalised(rig, 2048, seed=k % 7), features_of(rig)))
            spent += time.process_time() - begin
        begin = time.process_time()
        ready = readings([], characters)
        spent += time.process_time() - begin
        with connected(None, 1, False) as cluster:
            begin = time.process_time()
            audit = compare(ready, None, (THRESHOLD, THRESHOLD), cluster)
            compared = time.process_time() - begin
        memory = sum(bytes_of(block) for block in ready.blocks)
        pairs = size * (size - 1) // 2
        table.add(
            f"{size:,}", f"{pairs:,}", f"{audit.candidates:,}", f"{len(audit.pairs):,}",
            f"{spent:.0f}", f"{compared:.0f}", f"{compared / pairs * 1e6:.1f}",
            f"{memory / 2**20:,.0f} MB",
        )  # fmt: skip
        print(table.rows[-1], file=sys.stderr, flush=True)
    return [table]


def stretched(rig: cutcell.Rig, seed: int) -> cutcell.Rig:
    """Stretch a character along its axes by up to 2.5, and turn it."""
    dice = np.random.default_rng([SEED, seed])
    turn = np.linalg.qr(dice.normal(size=(3, 3)))[0] * np.exp(dice.uniform(-0.9, 0.9, 3))
    mesh = cutcell.TriangleMesh(rig.mesh.vertices @ turn.T, rig.mesh.faces)
    skeleton = replace(rig.skeleton, joints=rig.skeleton.joints @ turn.T)
    return cutcell.Rig(mesh, skeleton)


def bytes_of(block: Block) -> int:
    """Return the bytes of a block's arrays."""
    return sum(array.nbytes for array in vars(block).values())


PARTS = {"whole": whole, "kills": kills, "workers": workers, "audit": audits, "growth": growth}
ASSETS = {"whole": 2000, "kills": 60, "workers": 200, "audit": 0, "growth": 4000}


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure one part and print its tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("part", choices=sorted(PARTS))
    parser.add_argument("--assets", type=int)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--document", action="store_true")
    parser.add_argument("--markdown", type=Path)
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.folder or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        count = ASSETS[options.part] if options.assets is None else options.assets
        tables = PARTS[options.part](count, folder)
    publish(tables, options.markdown)
    if options.document:
        text = "\n\n".join(table.markdown() for table in tables)
        fill(DOCUMENT, {options.part: text})


if __name__ == "__main__":
    main()
