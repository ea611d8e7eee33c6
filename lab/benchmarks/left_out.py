"""Compare rules and the learned model on characters of makers that it did not learn from.

    python -m cutcell_lab.benchmarks.left_out [--groups N] [--out docs/learned_weights.md]

For each maker of `rigs` and `wild` the model is trained again on all others; with --groups only so
many times, each time without several makers. Its characters are
bound by the rules and with this model, with the deforming joints of the file and as fresh ones.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

import cutcell
from cutcell.rig import Rig
from cutcell.weights.context import Context, Step, run
from cutcell.weights.learned.forest import Forest
from cutcell.weights.learned.shares import correct_shares
from cutcell.weights.skinning_weights import weight_steps

from .document import fill
from .makers import maker_of
from .tables import Table
from .train_learned import all_samples, train
from .wild import MODES, Score, characters, score_of

GROUPS = ("rigs", "wild")
LEARNED = cutcell.ANIMATION.with_options(refine="learned")
KINDS = ("rules", "learned")

Scores = dict[tuple[str, str], Score]
"""By one of `MODES` and one of `KINDS`."""


def scores_of(rig: Rig, forest: Forest) -> Scores:
    """Bind a character by the rules and with a model, as known and as fresh."""
    scores: Scores = {}
    graph = cutcell.build_graph(rig.mesh)
    for mode, bound in zip(MODES, (rig, cutcell.choose_deform(rig, fresh=True)), strict=True):
        distances = cutcell.bone_distances(graph, bound.skeleton, allowed=bound.allowed)
        for kind, method in zip(KINDS, (cutcell.ANIMATION, LEARNED), strict=True):
            context = Context(method, bound.allowed, graph=graph, distances=distances)
            run(
                [
                    Step("learned", partial(correct_shares, forest=forest))
                    if step.name == "learned"
                    else step
                    for step in weight_steps(method, bound.allowed)
                ],
                context,
            )
            scores[mode, kind] = score_of(rig, context.weights)
    return scores


def all_scores(groups: int | None) -> Iterator[tuple[str, str, str, Scores]]:
    """Yield set, maker, name and scores of each character, by a model that left out its maker."""
    samples = all_samples()
    makers = sorted({sample.maker for sample in samples})
    forests: dict[int, Forest] = {}
    for group in GROUPS:
        for name, rig in characters(group):
            maker = maker_of(name)
            part = makers.index(maker) % (groups or len(makers))
            if part not in forests:
                left_out = makers[part :: groups or len(makers)]
                forests[part] = train(one for one in samples if one.maker not in left_out)
            yield group, maker, name, scores_of(rig, forests[part])


def tables(results: Sequence[tuple[str, str, str, Scores]]) -> list[Table]:
    """Summarise by set, by maker and by character."""
    head = ["joints", "weights", "L1 median", "L1 mean", "cm² median", "cm² mean", "cm² worst"]
    sets = Table("Sets", ["set", *head], "Medians and means over makers in the last rows.")
    makers = Table("Makers", ["maker", "characters", *(f"{m} {k}" for m in MODES for k in KINDS)])
    each = Table("Characters", ["character", *(f"{m} {k}" for m in MODES for k in KINDS)])
    of_maker: dict[str, list[Scores]] = {}
    for _, maker, name, scores in results:
        of_maker.setdefault(maker, []).append(scores)
        cells = (scores[mode, kind] for mode in MODES for kind in KINDS)
        each.add(name, *(f"{cell.l1:.3f}, {cell.deformation:.2f}" for cell in cells))
    for maker, several in sorted(of_maker.items()):
        pairs = [np.mean([_pair(s[m, k]) for s in several], axis=0) for m in MODES for k in KINDS]
        makers.add(maker, len(several), *(f"{l1:.3f}, {error:.2f}" for l1, error in pairs))
    for group in (*GROUPS, "makers"):
        for mode in MODES:
            for kind in KINDS:
                rows = [_pair(s[mode, kind]) for g, _, _, s in results if g == group]
                if group == "makers":
                    rows = [
                        tuple(np.mean([_pair(s[mode, kind]) for s in several], axis=0))
                        for several in of_maker.values()
                    ]
                l1, error = np.array(rows).T
                sets.add(
                    group, mode, kind, f"{np.median(l1):.3f}", f"{l1.mean():.3f}",
                    f"{np.median(error):.2f}", f"{error.mean():.2f}", f"{error.max():.1f}",
                )  # fmt: skip
    return [sets, makers, each]


def _pair(score: Score) -> tuple[float, float]:
    return score.l1, score.deformation


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="a document whose tables to replace")
    parser.add_argument("--groups", type=int, help="train so many times; once a maker by default")
    options = parser.parse_args(arguments)
    report(options.out, options.groups)


def report(out: Path | None = None, groups: int | None = None) -> None:
    """Measure all, print the tables, and put them into a document."""
    results = []
    for result in all_scores(groups):
        results.append(result)
        print(
            result[2],
            {k: f"{s.l1:.3f} {s.deformation:.2f}" for k, s in result[3].items()},
            flush=True,
        )
    text = "\n\n".join(table.markdown() for table in tables(results))
    print(text)
    if out:
        fill(out, {"left out": text})


if __name__ == "__main__":
    main()
