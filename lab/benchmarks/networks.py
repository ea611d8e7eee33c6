"""Train each head with each prior, and measure all on characters that they never saw.

    python -m cutcell_lab.benchmarks.networks [--epochs 3] [--seeds 3] [--heads A,B] [--priors A,B]
                                  [--size tiny] [--folder FOLDER] [--print] [--out docs/networks.md]
                                  [--figure docs/pictures/networks.png]

Trained on ../shared/data/train, by one maker; measured on rigs and wild, parted into characters by
other makers and by the same. Every network and every result is kept in the folder after it is
there: a stopped run continues, and more epochs continue from fewer. Needs cutcell[networks].
"""

from __future__ import annotations

import argparse
import json
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from time import process_time

import numpy as np
import torch
from numpy.typing import NDArray

from cutcell.runtime.writing import write_all
from cutcell_lab.networks import HEADS, PRIORS, Recipe, Sample, Samples, predict, train
from cutcell_lab.networks.priors import cache_folder

from .document import fill
from .network_figure import draw
from .network_scores import Scores, groups, means, scores
from .network_tables import PAPER, Comparison, Results, tables
from .rigs import SHARED


@dataclass(frozen=True)
class Run:
    """One network: its head, its prior and its seed."""

    head: str
    prior: str
    seed: int

    @property
    def name(self) -> str:
        """The name of its folder."""
        return f"{self.head}-{self.prior}-{self.seed}"


def measure_run(run: Run, options: argparse.Namespace) -> tuple[Scores, float]:
    """Train one network, and measure it on all characters; CPU seconds as well."""
    begin = process_time()
    recipe = Recipe(run.head, options.size, run.prior, run.seed, options.points)
    learned = samples(run.prior, ["train"], options)
    network = train(recipe, learned, options.epochs, _folder(options, run))
    seconds = process_time() - begin
    test = samples(run.prior, ["rigs", "wild"], options)
    predicted = predict(network, test, options.points)
    return {s.name: scores(s, w) for s, w in zip(test, predicted, strict=True)}, seconds


LOADED: dict[tuple[str, ...], list[Sample]] = {}


def samples(prior: str, sets: Sequence[str], options: argparse.Namespace) -> list[Sample]:
    """Load the samples of some sets with a prior, once."""
    key = (prior, *sets)
    if key not in LOADED:
        paths = [SHARED / name for name in sets]
        loader = Samples(paths, prior=prior, points=4 * options.points, cache=options.cache)
        LOADED[key] = loader.load(print)
    return LOADED[key]


def _folder(options: argparse.Namespace, run: Run) -> Path:
    return options.folder / options.size / run.name


def machine() -> str:
    """Say what it ran on."""
    cpu = next(
        (line.split(":")[1].strip() for line in _lines("/proc/cpuinfo") if "model name" in line),
        platform.processor() or platform.machine(),
    )
    device = torch.cuda.get_device_name() if torch.cuda.is_available() else "one thread"
    return f"{cpu}, {device}; torch {torch.__version__}"


def _lines(path: str) -> list[str]:
    return Path(path).read_text().splitlines() if Path(path).exists() else []


def read_results(path: Path) -> dict[str, dict]:
    """Return what earlier runs kept."""
    return json.loads(path.read_text()) if path.exists() else {}


def compared(
    stored: dict[str, dict], options: argparse.Namespace, runs: Sequence[Run]
) -> Comparison:
    """Put together what earlier runs kept."""
    results: Results = {}
    seconds = 0.0
    for run in runs:
        one = stored[_key(run, options)]
        results.setdefault((run.head, run.prior), []).append(one["scores"])
        seconds += one["seconds"]
    alone = {
        prior: {
            s.name: scores(s, _rows(s.prior)) for s in samples(prior, ["rigs", "wild"], options)
        }
        for prior in options.priors
        if prior != "none"
    }
    return Comparison(results, alone, len(runs), seconds)


def report(comparison: Comparison, options: argparse.Namespace) -> str:
    """Return what was compared and all tables, as Markdown."""
    measured = len(next(iter(comparison.results.values()))[0])
    trained = len(samples("none", ["train"], options))
    about = (
        f"Size {options.size}; {options.epochs} epochs over {trained} characters, "
        f"{options.points} points each; up to {options.seeds} seeds; measured at up to "
        f"{4 * options.points} vertices of each of {measured} characters. {comparison.runs} "
        f"trainings took {comparison.seconds / 60:.0f} minutes of CPU time on {machine()}."
    )
    return "\n\n".join([about, *(table.markdown() for table in tables(comparison))])


def draw_figure(comparison: Comparison, path: Path) -> None:
    """Draw L1 and the deformation error on characters by other makers."""
    names = groups(next(iter(comparison.results.values()))[0])["other makers"]

    def errors_of(one: Scores) -> tuple[float, float]:
        l1, _, _, moved = means(one, names).tolist()
        return l1, moved

    networks = {
        which: [errors_of(one) for one in runs] for which, runs in comparison.results.items()
    }
    alone = {prior: errors_of(one) for prior, one in comparison.alone.items()}
    paper = {
        (head, prior): (l1[k], moved[k])
        for head, (base, l1, moved) in PAPER.items()
        for k, prior in enumerate((base, "cutcell"))
    }
    draw(networks, alone, paper, path)


def _rows(prior: NDArray | None) -> NDArray[np.float64]:
    assert prior is not None
    total = prior.astype(np.float64).sum(axis=1, keepdims=True)
    return np.divide(prior, total, out=np.zeros(prior.shape), where=total > 0)


def _key(run: Run, options: argparse.Namespace) -> str:
    return f"{options.size} {options.points} {run.name} {options.epochs}"


def _before(stored: dict[str, dict], run: Run, options: argparse.Namespace) -> float:
    """Return the CPU seconds of the same run with fewer epochs, which it continued."""
    same, _, epochs = _key(run, options).rpartition(" ")
    fewer = (key for key in stored if key.rpartition(" ")[0] == same)
    earlier = [key for key in fewer if int(key.rpartition(" ")[2]) < int(epochs)]
    return max((stored[key]["seconds"] for key in earlier), default=0.0)


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, train what is not there yet, print."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.networks", description=__doc__
    )
    parser.add_argument("--epochs", type=int, default=3)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--size", default="tiny")
    parser.add_argument("--points", type=int, default=128)
    parser.add_argument("--heads", type=lambda text: text.split(","), default=list(HEADS))
    parser.add_argument("--priors", type=lambda text: text.split(","), default=list(PRIORS))
    parser.add_argument("--folder", type=Path, default=cache_folder() / "benchmark")
    parser.add_argument("--cache", type=Path, default=cache_folder())
    parser.add_argument("--print", action="store_true", help="train nothing; print what is there")
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    parser.add_argument("--figure", type=Path, help="a picture, such as docs/pictures/networks.png")
    options = parser.parse_args(argv)
    torch.set_num_threads(1)
    path = options.folder / "results.json"
    runs = [Run(*one) for one in product(options.heads, options.priors, range(options.seeds))]
    stored = read_results(path)
    # All heads and priors by the first seed first: a run that is broken off tells most.
    for run in sorted(runs, key=lambda run: run.seed):
        key = _key(run, options)
        if key not in stored and not options.print:
            scored, seconds = measure_run(run, options)
            stored[key] = {"scores": scored, "seconds": seconds + _before(stored, run, options)}
            options.folder.mkdir(parents=True, exist_ok=True)
            write_all({path: json.dumps(stored).encode()})
            names = groups(scored)["other makers"]
            print(key, *(f"{x:.3f}" for x in means(scored, names)), f"{seconds:.0f} s", flush=True)
    comparison = compared(stored, options, [run for run in runs if _key(run, options) in stored])
    text = report(comparison, options)
    print(text)
    if options.figure:
        draw_figure(comparison, options.figure)
    if options.out:
        fill(options.out, {"networks": text})


if __name__ == "__main__":
    main()
