"""Try a learned division: boosted trees instead of distances choose among the nearest joints.

    python -m cutcell_lab.benchmarks.learned_division [--out docs/quality.md]

The trees learn from `rigs`, `wild`, `more` and `train` in ../shared/data whether a joint is the
strongest of a vertex, in five folds by maker, and are judged on the makers of `rigs`, `wild` and
`more` that they have not seen. What they answer is the share that diffusion begins with; all other
steps are those of the product.
"""

from __future__ import annotations

import argparse
import sys
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from sklearn.ensemble import HistGradientBoostingClassifier

import cutcell
from cutcell.animation.falloff.pipeline import RigFalloff
from cutcell.rig import Rig
from cutcell.rig.rows import rows_of_entries
from cutcell.weights.skinning_weights import last_of, weight_steps

from .division_features import pair_features
from .document import fill
from .makers import maker_of
from .tables import Table
from .weight_changes import LARGE, NOTABLE
from .wild import MODES, characters, score_of

JUDGED = ("rigs", "wild", "more")
FOLDS = 5
LARGEST = "Quaternius"
"""A fold of its own: most of the training set."""
OF_CHARACTER, OF_MAKER = 500, 3000
"""Vertices to learn from, at most."""
TREES = {"max_iter": 150, "max_leaf_nodes": 24, "learning_rate": 0.08, "min_samples_leaf": 60}
TREES |= {"l2_regularization": 5.0, "max_features": 0.4, "max_bins": 63, "early_stopping": False}


@dataclass(frozen=True)
class Sample:
    """Some vertices of a character: features (e, f) of their entries, and which are strongest."""

    maker: str
    features: NDArray[np.float32]
    strongest: NDArray[np.bool_]
    vertices: int


def features_of(falloff: RigFalloff) -> NDArray[np.float32]:
    """Return the features (e, f) of each entry of the distances."""
    values = [np.asarray(value, np.float32) for value in pair_features(falloff).values()]
    return np.stack(values, axis=1)


def sample(name: str, rig: Rig, random: np.random.Generator) -> Sample:
    """Choose vertices of a character, and compare its nearest joints with its artist's weights."""
    distances = cutcell.bind(rig).distances
    rows, node = distances.rows, distances.graph.vertex_node
    weights = np.zeros(rows.shape)
    np.add.at(weights, node, np.asarray(rig.weights))
    weighted = np.flatnonzero(weights.any(axis=1))
    some = random.permutation(weighted)[:OF_CHARACTER]
    vertex = rows_of_entries(rows)
    chosen = np.isin(vertex, some)
    strongest = weights.argmax(axis=1)[vertex] == rows.indices
    features = features_of(RigFalloff.over(distances))[chosen]
    return Sample(maker_of(name), features, strongest[chosen], len(some))


def fold_of(maker: str) -> int:
    """Return which fold leaves a maker out."""
    return 0 if maker == LARGEST else zlib.crc32(maker.encode()) % FOLDS


def fit(samples: Sequence[Sample]) -> HistGradientBoostingClassifier:
    """Learn from characters, all makers with the weight of the square root of their vertices."""
    random = np.random.default_rng(0)
    total: dict[str, int] = {}
    for one in samples:
        total[one.maker] = total.get(one.maker, 0) + one.vertices
    features, strongest, weight = [], [], []
    for one in samples:
        part = min(1.0, OF_MAKER / total[one.maker])
        chosen = random.random(len(one.strongest)) < part
        features.append(one.features[chosen])
        strongest.append(one.strongest[chosen])
        weight.append(np.full(chosen.sum(), (part * total[one.maker]) ** -0.5))
    model = HistGradientBoostingClassifier(random_state=0, **TREES)
    learned = np.concatenate(weight)
    return model.fit(np.concatenate(features), np.concatenate(strongest), learned / learned.mean())


def scaled_to_one(share: NDArray, rows: csr_array) -> NDArray:
    """Scale shares (e,) of the entries of rows so that those of each row sum to one."""
    row = rows_of_entries(rows)
    return share / np.bincount(row, share, rows.shape[0])[row]


def bound(rig: Rig, falloff: RigFalloff, share: NDArray) -> NDArray:
    """Return the weights (n, j) of a division by shares (e,) of the entries of the distances."""
    distances = falloff.distances
    weights = csr_array(
        (share, distances.rows.indices, distances.rows.indptr), distances.rows.shape
    )
    other = replace(falloff, division=replace(falloff.division, weights=weights))
    return last_of(weight_steps(distances, cutcell.ANIMATION, rig.allowed, None, other)).toarray()


def judged(
    model_of: Callable[[str], HistGradientBoostingClassifier], mode: str
) -> Iterator[dict[str, tuple[float, float, float]]]:
    """Score every version on each character: L1, cm², and seconds of a binding."""
    for group in JUDGED:
        for name, rig in characters(group):
            used = rig if mode == "known" else cutcell.choose_deform(rig, fresh=True)
            binding = cutcell.bind(used)
            falloff = RigFalloff.over(binding.distances)
            began = time.perf_counter()
            features = features_of(falloff)
            learned = model_of(maker_of(name)).predict_proba(features)[:, 1]
            seconds = sum(binding.seconds.values())
            more = seconds + time.perf_counter() - began
            learned = scaled_to_one(learned, binding.distances.rows)
            mean = (learned + falloff.division.weights.data) / 2
            versions = {
                "by distance": (binding.weights, seconds),
                "learned": (bound(used, falloff, learned), more),
                "mean of both": (bound(used, falloff, mean), more),
            }
            scores = {}
            for version, (weights, spent) in versions.items():
                score = score_of(rig, weights)
                scores[version] = score.l1, score.deformation, spent
            print(group, name, mode, *(f"{e:.2f}" for _, e, _ in scores.values()), flush=True)
            yield scores


def table(scores: dict[str, list[dict[str, tuple[float, float, float]]]]) -> Table:
    """Compare the versions over all characters."""
    columns = ["joints", "characters", "division", "L1 median", "L1 mean", "cm² geometric mean"]
    columns += ["cm² mean", f"over {LARGE}", "better : worse", "seconds of a binding, median"]
    note = f"Makers left out. Better and worse: by over {NOTABLE:.0%} of cm² than by distance."
    result = Table("A learned division", columns, note)
    for mode, characters_ in scores.items():
        before = np.array([one["by distance"][1] for one in characters_])
        for version in characters_[0]:
            l1, error, seconds = np.array([one[version] for one in characters_]).T
            ratio = error / before
            result.add(
                mode,
                len(error),
                version,
                *(f"{f(l1):.3f}" for f in (np.median, np.mean)),
                f"{np.exp(np.log(error).mean()):.2f}",
                f"{error.mean():.2f}",
                int((error > LARGE).sum()),
                f"{(ratio < 1 - NOTABLE).sum()} : {(ratio > 1 + NOTABLE).sum()}",
                f"{np.median(seconds):.2f}",
            )
    return result


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="a document whose table to replace")
    options = parser.parse_args(arguments)
    random, samples = np.random.default_rng(0), []
    for group in (*JUDGED, "train"):
        samples += [sample(name, rig, random) for name, rig in characters(group)]
    models = []
    for fold in range(FOLDS):
        print(f"fold {fold}", file=sys.stderr, flush=True)
        models.append(fit([one for one in samples if fold_of(one.maker) != fold]))
    scores = {mode: list(judged(lambda maker: models[fold_of(maker)], mode)) for mode in MODES}
    text = table(scores).markdown()
    print(text)
    if options.out:
        fill(options.out, {"learned": text})


if __name__ == "__main__":
    main()
