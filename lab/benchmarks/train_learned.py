"""Train the model of `refine="learned"` again, the same bit for bit on one machine.

    pip install 'cutcell[learn]'
    python -m cutcell_lab.benchmarks.train_learned [--out cutcell/weights/learned/forest.npz]

It learns on all characters of rigs, wild and train in ../shared/data with weights whose licences
allow derived work (docs/learned_weights.md), from which joint is the strongest of each vertex.
Each maker counts the same. Needs scikit-learn, which the trained model does not.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell.rig import Rig
from cutcell.weights.context import Context, run
from cutcell.weights.learned.features import pair_features
from cutcell.weights.learned.forest import STORED, Forest
from cutcell.weights.skinning_weights import weight_steps

from .makers import maker_of
from .wild import SETS, characters

TREES = 250
LEAVES = 31
VERTICES = 400
"""Sampled vertices a character."""
MAX_CHARACTERS = 3
"""Characters used of each pack of one maker: most of them share a skeleton."""


@dataclass(frozen=True, eq=False)
class Sample:
    """Pairs of a vertex and a near joint of one character: features, and if it is strongest."""

    maker: str
    features: NDArray[np.float32]
    strongest: NDArray[np.bool_]


def sample_of(name: str, rig: Rig) -> Sample:
    """Draw vertices of a character at random, half of them by area."""
    assert rig.weights is not None
    graph = cutcell.build_graph(rig.mesh)
    distances = cutcell.bone_distances(graph, rig.skeleton)
    context = Context(cutcell.ANIMATION, graph=graph, distances=distances)
    run(weight_steps(cutcell.ANIMATION)[:1], context)
    spread = context.diffusion.spread(context.division.weights)
    pairs = pair_features(context.division, spread, rig.skeleton)
    node, first = np.unique(graph.vertex_node, return_index=True)
    has_weight = rig.weights[first].sum(axis=1) > 0.5
    node, first = node[has_weight], first[has_weight]
    areas = context.division.surface.areas[node] + 1e-12
    chance = (areas / areas.sum() + 1 / len(node)) / 2
    rng = np.random.default_rng(0)
    drawn = rng.choice(len(node), min(VERTICES, len(node)), replace=False, p=chance)
    strongest = np.full(len(spread), -1)
    strongest[node[drawn]] = rig.weights[first[drawn]].argmax(axis=1)
    chosen = strongest[pairs.vertex] >= 0
    is_strongest = strongest[pairs.vertex] == pairs.joint
    return Sample(maker_of(name), pairs.features[chosen], is_strongest[chosen])


def all_samples() -> list[Sample]:
    """Sample all sets, of each pack of the train set only a few characters."""
    samples, count = [], defaultdict[str, int](int)
    for group in SETS:
        for name, rig in characters(group):
            pack = f"{maker_of(name)} {name.partition('__')[0] if '__' in name else ''}"
            count[pack] += group == "train"
            if count[pack] <= MAX_CHARACTERS:
                samples.append(sample_of(name, rig))
                print(name, flush=True)
    return samples


def train(samples: Iterable[Sample]) -> Forest:
    """Train on samples; each maker counts the same, and each of its characters."""
    from sklearn.ensemble import HistGradientBoostingClassifier

    samples = [sample for sample in samples if len(sample.features)]
    makers = [sample.maker for sample in samples]
    weight = [
        np.full(len(one.features), 1 / (makers.count(one.maker) * len(one.features)))
        for one in samples
    ]
    features = np.concatenate([sample.features for sample in samples])
    strongest = np.concatenate([sample.strongest for sample in samples])
    weights = np.concatenate(weight)
    model = HistGradientBoostingClassifier(
        max_iter=TREES, max_leaf_nodes=LEAVES, early_stopping=False, random_state=0
    )
    model.fit(features, strongest, sample_weight=weights / weights.mean())
    return as_forest(model)


def as_forest(model: object) -> Forest:
    """Return the trees of scikit-learn's model as arrays, parents before children."""
    root, feature, value, right = [], [], [], []
    for (tree,) in model._predictors:  # type: ignore[attr-defined]
        root.append(len(feature))
        todo = [(0, -1)]
        while todo:
            index, parent = todo.pop()
            node = tree.nodes[index]
            if parent >= 0:
                right[parent] = len(feature)
            is_leaf = bool(node["is_leaf"])
            if not is_leaf:  # the left one comes next, the right one after all below it
                todo += [(node["right"], len(feature)), (node["left"], -1)]
            feature.append(-1 if is_leaf else node["feature_idx"])
            value.append(node["value"] if is_leaf else node["num_threshold"])
            right.append(0)
    return Forest(
        np.array(root, np.int32),
        np.array(feature, np.int16),
        np.array(value, np.float64),
        np.array(right, np.int32),
        float(np.ravel(model._baseline_prediction)[0]),  # type: ignore[attr-defined]
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=STORED)
    options = parser.parse_args(arguments)
    forest = train(all_samples())
    forest.save(options.out)
    print(f"{options.out}: {len(forest.root)} trees, {options.out.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
