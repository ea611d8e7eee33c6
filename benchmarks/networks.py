"""Train each head with each prior, and measure all on characters that they never saw.

    python -m benchmarks.networks [--epochs 3] [--seeds 3] [--heads A,B] [--priors A,B]
                                  [--size tiny] [--folder FOLDER] [--print] [--out docs/networks.md]
                                  [--figure docs/pictures/networks.png]

Trained on ../shared/data/train, by one maker; measured on rigs and wild, parted into characters by
other makers and by the same. Every network and every result is kept in the folder after it is
there: what was stopped goes on, and more epochs go on from fewer. Needs cutcell[networks].
"""

from __future__ import annotations

import argparse
import json
import platform
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from time import process_time

import numpy as np
import torch
from numpy.typing import NDArray

from cutcell.metrics import deformation_error, precision_recall, weight_l1
from cutcell.metrics.deformation import longest_side
from cutcell.networks import HEADS, PRIORS, Recipe, Sample, Samples, predict, train
from cutcell.networks.priors import cache_folder
from cutcell.rig import Skeleton, TriangleMesh
from cutcell.writing import write_all

from .document import fill
from .network_figure import draw
from .rigs import SHARED
from .tables import Table

SAME_MAKER = ("quaternius_", "quat_", "deok_dino_quant", "packt_woman", "m2m_eagle")
"""Characters of rigs and wild by the maker of train, surely or probably (SOURCES.md)."""
PART, LOST = 0.15, 0.01
"""The published evaluation drops weights below this part of a point's largest, but for points that
lose less than this."""
MEASURES = ("L1", "precision", "recall", "cm²")
PAPER = {
    "rignet": ("voxel", (0.432, 0.367), (8.58, 6.06)),
    "unirig": ("voxel_unirig", (0.747, 0.386), (21.25, 10.91)),
    "puppeteer": ("none", (0.335, 0.320), (5.949, 5.333)),
}
"""Of each head what the paper has as base, and its L1 and deformation error before and after; of
RigNet on ModelsResource, of the others on Articulation-XL 2.0."""

Scores = dict[str, list[float]]
"""By character: L1, precision, recall, cm², and the same after dropping."""


@dataclass(frozen=True)
class Run:
    """One network: its head, its prior and its seed."""

    head: str
    prior: str
    seed: int

    @property
    def name(self) -> str:
        """What its folder is called."""
        return f"{self.head}-{self.prior}-{self.seed}"


def scores(sample: Sample, weights: NDArray) -> list[float]:
    """Measure weights at the points of a character, as they are and after dropping."""
    return [*_measured(sample, weights), *_measured(sample, dropped(weights))]


def dropped(weights: NDArray) -> NDArray[np.float64]:
    """Return weights without those that the published evaluation drops."""
    kept = np.where(weights >= PART * weights.max(axis=1, keepdims=True), weights, 0)
    total = kept.sum(axis=1, keepdims=True)
    return np.where(weights.sum(axis=1, keepdims=True) - total < LOST, weights, kept / total)


def _measured(sample: Sample, weights: NDArray) -> list[float]:
    there = sample.target.any(axis=1)  # type: ignore[union-attr]
    points, target = sample.points[there], sample.target[there]  # type: ignore[index]
    weights = weights[there]
    corners = np.arange(len(points) - 2)[:, None] + np.arange(3)
    mesh = TriangleMesh(points, corners)
    skeleton = Skeleton(sample.joints, sample.parents)
    error = deformation_error((mesh, skeleton), weights, target, count="vertices")
    # The longest side of the character is 1, that of the points that were drawn a little less.
    centimetres = error.mean * longest_side(mesh) ** 2
    return [weight_l1(weights, target), *precision_recall(weights, target), centimetres]


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
        kept = Samples(paths, prior=prior, points=4 * options.points, cache=options.cache)
        LOADED[key] = kept.load(print)
    return LOADED[key]


def _folder(options: argparse.Namespace, run: Run) -> Path:
    return options.folder / options.size / run.name


def groups(names: Iterable[str]) -> dict[str, list[str]]:
    """Part characters by who made them."""
    parted: dict[str, list[str]] = {"other makers": [], "same maker": []}
    for name in names:
        parted["same maker" if name.startswith(SAME_MAKER) else "other makers"].append(name)
    return parted


def means(found: Scores, names: Sequence[str], at: slice = slice(0, 4)) -> NDArray:
    """Average each measure over characters; nan where a measure has no value is left out."""
    return np.nanmean([found[name][at] for name in names], axis=0)


def spread(values: NDArray, digits: int) -> str:
    """Format the mean over seeds and their standard deviation."""
    deviation = values.std(ddof=1) if len(values) > 1 else 0.0
    return f"{values.mean():.{digits}f} ± {deviation:.{digits}f}"


Results = dict[tuple[str, str], list[Scores]]
"""By head and prior: the scores of each seed."""


def head_table(results: Results, alone: dict[str, Scores], which: str, after: bool) -> Table:
    """List each head with each prior: the four measures over the characters of a group."""
    at = slice(4, 8) if after else slice(0, 4)
    names = groups(next(iter(alone.values())))[which]
    title = f"On {len(names)} characters by {'other makers' if which[0] == 'o' else 'the same'}"
    note = "Means over the characters; mean over the seeds ± standard deviation."
    if after:
        title += ", small weights dropped"
        note += f" Weights below {PART:.0%} of a point's largest are dropped, as in evaluations."
    columns = ["head", "prior", "seeds", "L1", "L1 median", "L1 worst", *MEASURES[1:]]
    table = Table(title, columns, note)

    def add(head: str, prior: str, found: Sequence[Scores]) -> None:
        each = np.array([means(one, names, at) for one in found])
        l1 = np.array([[one[name][at][0] for name in names] for one in found])
        cells = [each[:, 0], np.median(l1, axis=1), l1.max(axis=1), each[:, 1], each[:, 2]]
        if len(found) == 1:
            shown = [f"{v[0]:.3f}" for v in cells] + [f"{each[0, 3]:.2f}"]
        else:
            shown = [spread(v, 3) for v in cells] + [spread(each[:, 3], 2)]
        table.add(head, prior, "-" if head[0] == "(" else len(found), *shown)

    for prior, found in alone.items():
        add("(the prior alone)", prior, [found])
    for (head, prior), runs in results.items():
        add(head, prior, runs)
    return table


def paper_table(results: Results) -> Table:
    """Put what the paper's prior changes beside what the paper says."""
    note = (
        "What the paper's prior (cutcell) changes against what each head had before, on characters "
        "by other makers. `better`: in how many seeds."
    )
    columns = ["head", "before", "L1 here", "better", "cm² here", "better", "paper L1", "paper cm²"]
    table = Table("Beside the paper", columns, note)
    for head, (base, l1, moved) in PAPER.items():
        before, after = results.get((head, base)), results.get((head, "cutcell"))
        if not before or not after:
            continue
        names = groups(before[0])["other makers"]
        count = min(len(before), len(after))
        before, after = before[:count], after[:count]
        one = np.array([means(found, names)[[0, 3]] for found in before])
        other = np.array([means(found, names)[[0, 3]] for found in after])
        better = (other < one).sum(axis=0)
        change = other.mean(axis=0) / one.mean(axis=0) - 1
        table.add(
            head,
            base,
            f"{change[0]:+.1%}",
            f"{better[0]} of {count}",
            f"{change[1]:+.1%}",
            f"{better[1]} of {count}",
            f"{l1[1] / l1[0] - 1:+.1%}",
            f"{moved[1] / moved[0] - 1:+.1%}",
        )
    return table


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


@dataclass(frozen=True)
class Comparison:
    """What all runs found.

    Parameters
    ----------
    results : Results
    alone : dict of str to Scores
        By prior, of the prior itself.
    runs : int
    seconds : float
        CPU seconds of all trainings.
    """

    results: Results
    alone: dict[str, Scores]
    runs: int
    seconds: float


def compared(kept: dict[str, dict], options: argparse.Namespace, runs: Sequence[Run]) -> Comparison:
    """Put together what earlier runs kept."""
    results: Results = {}
    seconds = 0.0
    for run in runs:
        one = kept[_key(run, options)]
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


def tables(found: Comparison, options: argparse.Namespace) -> str:
    """Return all tables as Markdown."""
    results, alone = found.results, found.alone
    measured = len(next(iter(results.values()))[0])
    trained = len(samples("none", ["train"], options))
    about = (
        f"Size {options.size}; {options.epochs} epochs over {trained} characters, "
        f"{options.points} points each; up to {options.seeds} seeds; measured at up to "
        f"{4 * options.points} vertices of each of {measured} characters. {found.runs} trainings "
        f"took {found.seconds / 60:.0f} minutes of CPU time on {machine()}."
    )
    listed = [
        paper_table(results),
        *(head_table(results, alone, which, False) for which in ("other makers", "same maker")),
        head_table(results, alone, "other makers", True),
    ]
    return "\n\n".join([about, *(table.markdown() for table in listed)])


def draw_figure(found: Comparison, path: Path) -> None:
    """Draw L1 and the deformation error on characters by other makers."""
    names = groups(next(iter(found.results.values()))[0])["other makers"]

    def shown(one: Scores) -> tuple[float, float]:
        l1, _, _, moved = means(one, names).tolist()
        return l1, moved

    networks = {which: [shown(one) for one in runs] for which, runs in found.results.items()}
    alone = {prior: shown(one) for prior, one in found.alone.items()}
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


def _before(kept: dict[str, dict], run: Run, options: argparse.Namespace) -> float:
    """Return the CPU seconds of the same run with fewer epochs, which it went on from."""
    same, _, epochs = _key(run, options).rpartition(" ")
    fewer = (key for key in kept if key.rpartition(" ")[0] == same)
    earlier = [key for key in fewer if int(key.rpartition(" ")[2]) < int(epochs)]
    return max((kept[key]["seconds"] for key in earlier), default=0.0)


def main(given: Sequence[str] | None = None) -> None:
    """Read the command line, train what is not there yet, print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.networks", description=__doc__)
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
    options = parser.parse_args(given)
    torch.set_num_threads(1)
    path = options.folder / "results.json"
    runs = [Run(*one) for one in product(options.heads, options.priors, range(options.seeds))]
    kept = read_results(path)
    # All heads and priors by the first seed first: a run that is broken off tells most.
    for run in sorted(runs, key=lambda run: run.seed):
        key = _key(run, options)
        if key not in kept and not options.print:
            scored, seconds = measure_run(run, options)
            kept[key] = {"scores": scored, "seconds": seconds + _before(kept, run, options)}
            options.folder.mkdir(parents=True, exist_ok=True)
            write_all({path: json.dumps(kept).encode()})
            names = groups(scored)["other makers"]
            print(key, *(f"{x:.3f}" for x in means(scored, names)), f"{seconds:.0f} s", flush=True)
    found = compared(kept, options, [run for run in runs if _key(run, options) in kept])
    text = tables(found, options)
    print(text)
    if options.figure:
        draw_figure(found, options.figure)
    if options.out:
        fill(options.out, {"networks": text})


if __name__ == "__main__":
    main()
