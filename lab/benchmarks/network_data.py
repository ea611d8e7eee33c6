"""Do augmentation and generated characters help a network? Train with and without, and measure.

    python -m cutcell_lab.benchmarks.network_data [--epochs 12] [--seeds 3] [--heads rignet,unirig]
                                      [--size tiny] [--prior cutcell_any] [--folder FOLDER]
                                      [--print] [--out docs/networks.md]

Four ways to learn: from ../shared/data/train alone or with as many characters more, 70 generated
and 40 people, each with augmentation and without. All look at equally many characters in all: with
twice as many there are half as many epochs. Measured on rigs and wild, as in `networks` beside it;
those by MakeHuman, the source of generated people, apart from the others.
Every result is kept in the folder; the table lists all that are there. People take `pip install
anny`. Needs cutcell[networks,dataset].
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path
from time import process_time

import numpy as np
import torch
from numpy.typing import NDArray

import cutcell
from cutcell.runtime.writing import write_all
from cutcell_assets.generate import KINDS, Kind, generate
from cutcell_lab.networks import Recipe, Sample, Samples, predict, train
from cutcell_lab.networks.priors import cache_folder

from .document import fill
from .network_scores import Scores, groups, means, scores
from .network_tables import spread
from .networks import machine, read_results
from .rigs import SHARED
from .tables import Table

GENERATED, PEOPLE = 70, 40
MAKEHUMAN = "makehuman_"
"""Characters of rigs and wild that have the bodies and the weights which people are made of: no
measure of characters by makers that were never seen."""
KIND: tuple[Kind, ...] = tuple(kind for kind in KINDS if kind != "person")


@dataclass(frozen=True)
class Run:
    """One network; `epochs` as if it saw the characters of train alone."""

    size: str
    head: str
    prior: str
    epochs: int
    points: int
    more: bool
    augment: bool
    seed: int

    @property
    def way(self) -> Run:
        """The same but for the seed."""
        return replace(self, seed=-1)

    @property
    def today(self) -> Run:
        """The same from train alone, without augmentation."""
        return replace(self, more=False, augment=False)


@dataclass(frozen=True)
class Result:
    """Results of a run."""

    scores: Scores
    characters: int
    seconds: float


class Data:
    """The characters to learn from and to measure on, each set loaded once."""

    def __init__(self, options: argparse.Namespace) -> None:
        self._options = options
        self._loaded: dict[tuple[Path, ...], list[Sample]] = {}

    def learned(self, more: bool) -> list[Sample]:
        """Return the samples to learn from."""
        samples = self._load(SHARED / "train")
        return samples + self._load(*_generated(self._options.folder / "more")) if more else samples

    def measured(self) -> list[Sample]:
        """Return the samples to measure on."""
        return self._load(SHARED / "rigs", SHARED / "wild")

    def _load(self, *paths: Path) -> list[Sample]:
        if paths not in self._loaded:
            prior, points = self._options.prior, 4 * self._options.points
            loader = Samples(paths, prior=prior, points=points, cache=self._options.cache)
            self._loaded[paths] = loader.load(print)
        return self._loaded[paths]


def _generated(folder: Path) -> tuple[Path, Path]:
    """Generate the further characters, as `cutcell dataset generate` does, if not there yet."""
    made: dict[str, list[tuple[Kind, int]]] = {
        "any": [(KIND[k % len(KIND)], k) for k in range(GENERATED)],
        "people": [("person", k) for k in range(PEOPLE)],
    }
    for name, characters in made.items():
        (folder / name).mkdir(parents=True, exist_ok=True)
        for kind, seed in characters:
            path = folder / name / f"{kind}_{seed}.npz"
            if not path.exists():
                cutcell.save(path, replace(generate(kind, seed), parts=()))
    return folder / "any", folder / "people"


def measure_run(run: Run, data: Data) -> Result:
    """Train one network, and measure it on all characters."""
    begin = process_time()
    learned = data.learned(run.more)
    epochs = max(1, round(run.epochs * len(data.learned(False)) / len(learned)))
    recipe = Recipe(run.head, run.size, run.prior, run.seed, run.points, augment=run.augment)
    network = train(recipe, learned, epochs)
    seconds = process_time() - begin
    test = data.measured()
    predicted = predict(network, test, run.points)
    by_name = {s.name: scores(s, w) for s, w in zip(test, predicted, strict=True)}
    return Result(by_name, len(learned), seconds)


def table_of(results_of: dict[Run, Result]) -> Table:
    """List all ways to learn, each beside the same head as it learns today."""
    names, makehuman = unseen(next(iter(results_of.values())).scores)
    note = (
        f"On {len(names)} characters by makers that are in none of the data, and L1 on "
        f"{len(makehuman)} by MakeHuman, the source of generated people. Means over the "
        "characters, over the seeds ± standard deviation. `better`: than from train alone without "
        "augmentation, in how many seeds. CPU seconds are of one training."
    )
    columns = ["size", "head", "learns from", "augmented", "characters", "epochs", "seeds", "L1"]
    columns += ["better", "precision", "recall", "cm²", "better", "L1, MakeHuman", "CPU s"]
    table = Table("Augmentation and further characters", columns, note)
    for way in dict.fromkeys(run.way for run in results_of):
        runs = sorted((run for run in results_of if run.way == way), key=lambda run: run.seed)
        results = [results_of[run] for run in runs]
        values = np.array([means(one.scores, names) for one in results])
        base = [run.today for run in runs]
        better = ["-", "-"]
        if way != way.today and all(run in results_of for run in base):
            before = np.array([means(results_of[run].scores, names) for run in base])
            count = (values < before).sum(axis=0)
            better = [f"{count[at]} of {len(runs)}" for at in (0, 3)]
        characters = results[0].characters
        first = next((r.characters for run, r in results_of.items() if not run.more), characters)
        cells = [_spread(values[:, at], 2 if at == 3 else 3) for at in range(4)]
        table.add(
            way.size,
            way.head,
            "train, generated, people" if way.more else "train",
            "yes" if way.augment else "no",
            characters,
            max(1, round(way.epochs * first / characters)),
            len(runs),
            cells[0],
            better[0],
            cells[1],
            cells[2],
            cells[3],
            better[1],
            _spread(np.array([means(one.scores, makehuman)[0] for one in results]), 3)
            if makehuman
            else "-",
            f"{np.mean([one.seconds for one in results]):.0f}",
        )
    return table


def _spread(values: NDArray, digits: int) -> str:
    return spread(values, digits) if len(values) > 1 else f"{values[0]:.{digits}f}"


def unseen(measured: Iterable[str]) -> tuple[list[str], list[str]]:
    """Part characters by other makers into those by makers never seen, and MakeHuman's."""
    names = groups(measured)["other makers"]
    makehuman = [name for name in names if name.startswith(MAKEHUMAN)]
    return [name for name in names if name not in makehuman], makehuman


def report(results: dict[Run, Result], data: Data) -> str:
    """Return what was compared and the table, as Markdown."""
    run = next(iter(results))
    seconds = sum(one.seconds for one in results.values())
    about = (
        f"Prior {run.prior}; {run.points} points of a character at a time; `train` is "
        f"{len(data.learned(False))} characters by one maker; further are {GENERATED} generated "
        f"and {PEOPLE} people. {len(results)} trainings took {seconds / 60:.0f} minutes of CPU "
        f"time on {machine()}."
    )
    return f"{about}\n\n{table_of(results).markdown()}"


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, train what is not there yet, print."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.network_data", description=__doc__
    )
    parser.add_argument("--epochs", type=int, default=12)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--size", default="tiny")
    parser.add_argument("--points", type=int, default=128)
    parser.add_argument("--prior", default="cutcell_any")
    parser.add_argument("--heads", type=lambda text: text.split(","), default=["rignet", "unirig"])
    parser.add_argument("--today", action="store_true", help="from train alone, no augmentation")
    parser.add_argument("--folder", type=Path, default=cache_folder() / "benchmark-data")
    parser.add_argument("--cache", type=Path, default=cache_folder())
    parser.add_argument("--print", action="store_true", help="train nothing; print what is there")
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    torch.set_num_threads(1)
    data, path = Data(options), options.folder / "results.json"
    ways = [(False, False)] if options.today else product((False, True), repeat=2)
    runs_to_do = [
        Run(options.size, head, options.prior, options.epochs, options.points, more, augment, seed)
        for seed, head, (more, augment) in product(range(options.seeds), options.heads, [*ways])
    ]
    for run in [] if options.print else runs_to_do:
        stored = read_results(path)
        if (key := json.dumps(asdict(run))) in stored:
            continue
        result = measure_run(run, data)
        options.folder.mkdir(parents=True, exist_ok=True)
        # Read again: another head may be trained beside this one.
        write_all({path: json.dumps({**read_results(path), key: asdict(result)}).encode()})
        names, _ = unseen(result.scores)
        print(key, *(f"{x:.3f}" for x in means(result.scores, names)), f"{result.seconds:.0f} s")
    results = {Run(**json.loads(key)): Result(**one) for key, one in read_results(path).items()}
    order = {"tiny": 0, "small": 1, "full": 2}
    results = dict(
        sorted(
            results.items(),
            key=lambda one: (order[one[0].size], *map(str, asdict(one[0]).values())),
        )
    )
    text = report(results, data)
    print(text)
    if options.out:
        fill(options.out, {"network-data": text})


if __name__ == "__main__":
    main()
