"""Train a small network to correct `bind`, and measure it on makers that it never saw.

    python -m cutcell_lab.benchmarks.refinement [--epochs 10] [--parts 0.3 1] [--out FILE]

For each vertex and each of its nearest joints it sees what the core knows of the pair, and changes
the logarithm of the weight. Each maker of ../shared/data/rigs and wild is left out in turn: a
network learns from all other characters there and in train, and is measured on those. `--parts` are
parts of the change that are applied. Minutes on one core; needs cutcell[networks].
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

import cutcell
from cutcell.geodesics import BoneDistances, bone_distances
from cutcell.graph import build_graph
from cutcell.method import ANIMATION
from cutcell.rig import Rig
from cutcell.weights import keep_strongest
from cutcell.weights.context import Context, run
from cutcell.weights.rig_falloff.pipeline import TAIL
from cutcell.weights.rig_falloff.surface_operators import SurfaceOperators
from cutcell.weights.skinning_weights import permit, weight_steps

from .document import fill
from .network_scores import SAME_MAKER
from .tables import Table
from .wild import SETS, Score, characters, score_of

JOINTS = 6
"""Joints considered a vertex: those with the largest weights."""
LEAST = 1e-5
"""A joint with less weight than this before tails are cut off is no candidate."""
HIDDEN = 24
MOST = 4.0
"""The logarithm of a weight changes by less than this."""
BATCH = 4096
ONE_MAKER = "quaternius"


@dataclass(frozen=True, eq=False)
class Pairs:
    """The welded vertices of a character, k, and the candidates among the joints of each.

    Parameters
    ----------
    name, rig
        `rig` has its artist's weights.
    distances : BoneDistances
    joint : array, shape (k, JOINTS)
    is_candidate : array, shape (k, JOINTS), bool
    features : array, shape (k, JOINTS, f), float32
        The first is the logarithm of the weight.
    target : array, shape (k, JOINTS), float32
        The artist's weights.
    is_rigid : array, shape (k,), bool
        Of parts that follow one joint, or the body where they touch it: these stay as they are.
    """

    name: str
    rig: Rig
    distances: BoneDistances
    joint: NDArray[np.intp]
    is_candidate: NDArray[np.bool_]
    features: NDArray[np.float32]
    target: NDArray[np.float32]
    is_rigid: NDArray[np.bool_]

    @property
    def learns(self) -> NDArray[np.intp]:
        """Vertices to learn from: candidates hold most of what the artist gave them."""
        return np.flatnonzero(~self.is_rigid & (self.target.sum(axis=1) > 0.5))


def pairs_of(name: str, rig: Rig, resolution: int = ANIMATION.resolution) -> Pairs:
    """Bind a character up to where its weights are cut off, and describe all pairs."""
    graph = build_graph(rig.mesh, resolution)
    distances = bone_distances(
        graph, rig.skeleton, nearest_joints=ANIMATION.joints_needed, allowed=rig.allowed
    )
    context, by_step = Context(ANIMATION, graph=graph, distances=distances), {}
    run(
        weight_steps(ANIMATION),
        context,
        lambda step: by_step.update({step.name: context.weights.copy()}),
    )
    weights = by_step["rigid"]
    order = np.argsort(-weights, axis=1, kind="stable")[:, :JOINTS]
    joint = np.pad(order, ((0, 0), (0, JOINTS - order.shape[1])), mode="edge")
    is_candidate = np.take_along_axis(weights, joint, axis=1) > LEAST
    is_candidate[:, order.shape[1] :] = False
    is_candidate[:, 0] = True
    first = np.zeros(len(weights), np.intp)
    first[graph.vertex_node[::-1]] = np.arange(len(graph.vertex_node))[::-1]
    assert rig.weights is not None
    target = np.take_along_axis(rig.weights[first], joint, axis=1)
    return Pairs(
        name,
        rig,
        distances,
        joint,
        is_candidate,
        _features(rig, distances, weights, context.division.radius, joint),
        np.where(is_candidate, target, 0).astype(np.float32),
        np.abs(weights - by_step["spread"]).max(axis=1) > 1e-6,
    )


def _features(
    rig: Rig,
    distances: BoneDistances,
    weights: NDArray[np.float64],
    radius: NDArray[np.float64],
    joint: NDArray[np.intp],
) -> NDArray[np.float32]:
    """Describe each vertex and joint; nothing depends on the order or the names of joints."""
    graph, skeleton, bones = distances.graph, rig.skeleton, distances.bones
    surface = SurfaceOperators.of(graph)
    points, normals = surface.points, surface.normals
    joints, top = graph.lattice.to_unit(skeleton.joints), joint[:, :1]
    weight = np.maximum(np.take_along_axis(weights, joint, axis=1), LEAST)
    away = np.take_along_axis(distances.at_welded.T, joint, axis=1)
    away = np.maximum(np.where(np.isfinite(away), away, 2.0), 1e-3)
    nearest = away.min(axis=1, keepdims=True)
    straight, along, facing, length = (np.zeros(joint.shape) for _ in range(4))
    straight[:] = 2.0
    axis = np.zeros((*joint.shape, 3))
    for start, end, of in zip(bones.start, bones.end, bones.joint, strict=True):
        at = np.nonzero(joint == of)
        span = np.linalg.norm(end - start)
        unit = (end - start) / max(span, 1e-12)
        reached = (points[at[0]] - start) @ unit
        out = points[at[0]] - start - np.clip(reached, 0, span)[:, None] * unit
        distance = np.linalg.norm(out, axis=1)
        nearer = distance < straight[at]
        at = at[0][nearer], at[1][nearer]
        straight[at], length[at], axis[at] = distance[nearer], span, unit
        along[at] = (reached[nearer] / max(span, 1e-3)).clip(-1, 2)
        outward = (out[nearer] * normals[at[0]]).sum(axis=1)
        facing[at] = outward / np.maximum(straight[at], 1e-9)
    depth, subtree = skeleton.depth, skeleton.subtree
    common = subtree.astype(np.float32).T @ subtree.astype(np.float32)  # ancestors of both
    hops = depth[:, None] + depth[None, :] - 2 * (common - 1)
    # The joint at which the bone and that of the largest weight part: seen from there, how far on?
    is_child = skeleton.parents[joint] == top
    parting = points[:, None] - joints[np.where(is_child, joint, top)]
    share = surface.areas @ weights / surface.areas.sum()
    of_component = np.bincount(surface.component, surface.areas) / surface.areas.sum()
    spans = np.maximum(length, 1e-3)
    columns = [
        np.log(weight),
        np.log(weight / weight[:, :1]),
        np.log(away / nearest),
        np.log(away),
        away / np.maximum(np.where(np.isfinite(radius), radius, 1.0)[joint], 1e-3),
        np.log(np.maximum(straight, 1e-3) / away),
        facing,
        along,
        np.log(spans),
        np.log(spans / nearest),
        np.minimum(hops[joint, top], 6),
        subtree[joint, top],
        subtree[top, joint],
        is_child,
        skeleton.parents[top] == joint,
        joint == top,
        (parting * axis[:, :1]).sum(axis=2) / nearest,
        (parting * axis).sum(axis=2) / nearest,
        (axis * axis[:, :1]).sum(axis=2),
        np.log(share[joint] + 1e-4),
        np.log1p(subtree.sum(axis=1) - 1)[joint],
        np.log(share[top] + 1e-4),
        of_component[surface.component][:, None],
        (weight > 0.05).sum(axis=1, keepdims=True),
        np.abs((axis[:, 0] * normals).sum(axis=1, keepdims=True)),
    ]
    every = [np.broadcast_to(np.clip(column, -20, 20), joint.shape) for column in columns]
    return np.stack(every, axis=2).astype(np.float32)


class Corrector(torch.nn.Module):
    """A network of 2,000 numbers that changes the weights of a vertex. It begins with no change.

    Parameters
    ----------
    features : tensor, shape (p, f)
        Of pairs to learn from: means and deviations are taken from them.
    """

    def __init__(self, features: torch.Tensor) -> None:
        super().__init__()
        self.register_buffer("mean", features.mean(0))
        self.register_buffer("deviation", features.std(0) + 1e-3)
        self.pair = torch.nn.Linear(features.shape[1], HIDDEN)
        self.vertex = torch.nn.Linear(2 * HIDDEN, HIDDEN)
        self.change = torch.nn.Linear(HIDDEN, 1)
        self.drop = torch.nn.Dropout(0.1)
        torch.nn.init.zeros_(self.change.weight)
        torch.nn.init.zeros_(self.change.bias)

    def forward(
        self, features: torch.Tensor, is_candidate: torch.Tensor, part: float = 1.0
    ) -> torch.Tensor:
        """Return weights, shape (k, JOINTS); `part` of the change is applied."""
        scaled = ((features - self.mean) / self.deviation).clamp(-4, 4)
        if self.training:
            scaled = scaled + 0.1 * torch.randn_like(scaled)
        each = torch.relu(self.pair(scaled))
        others = (each * is_candidate[..., None]).amax(1, keepdim=True).expand_as(each)
        hidden = torch.relu(self.vertex(self.drop(torch.cat([each, others], 2))))
        change = MOST * torch.tanh(self.change(self.drop(hidden))[..., 0] / MOST)
        changed = features[..., 0] + part * change
        return torch.softmax(changed.masked_fill(~is_candidate, -1e9), 1)


def fit(learned: Sequence[Pairs], epochs: int, points: int = 500, seed: int = 0) -> Corrector:
    """Train a network on characters, by L1 and a third of the squared difference."""
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    learned = [pairs for pairs in learned if len(pairs.learns)]
    network = Corrector(
        torch.tensor(np.concatenate([p.features[p.is_candidate][::11] for p in learned]))
    )
    balance = _balance([pairs.name for pairs in learned])
    steps = max(1, len(learned) * points // BATCH)
    optimiser = torch.optim.AdamW(network.parameters(), lr=3e-3, weight_decay=1e-3)
    rate = torch.optim.lr_scheduler.OneCycleLR(optimiser, 3e-3, total_steps=epochs * steps + 1)
    network.train()
    for _ in range(epochs):
        drawn = [_draw(pairs, points, rng) for pairs in learned]
        features, is_candidate, target = (
            torch.tensor(np.concatenate(arrays)) for arrays in zip(*drawn, strict=True)
        )
        counts = torch.tensor(np.repeat(balance, points))
        order = torch.randperm(len(features))
        for chosen in order.split(-(-len(features) // steps)):
            off = network(features[chosen], is_candidate[chosen]) - target[chosen]
            each = off.abs().sum(1) + 0.3 * (off**2).sum(1)
            optimiser.zero_grad()
            (each * counts[chosen]).mean().backward()
            optimiser.step()
            rate.step()
    return network.eval()


def _draw(pairs: Pairs, count: int, rng: np.random.Generator) -> tuple[NDArray, ...]:
    """Draw vertices; each counts alike, as in the measure."""
    chosen = rng.choice(pairs.learns, count)
    return pairs.features[chosen], pairs.is_candidate[chosen], pairs.target[chosen]


def _balance(names: Sequence[str]) -> NDArray[np.float32]:
    """Weigh characters: many that are alike count less, and one maker half at most."""
    pack = [name.split("__")[0] for name in names]  # of train; elsewhere the name itself
    count = Counter(pack)
    balance = np.array([count[one] ** -0.5 for one in pack])
    his = np.array([maker(name) == ONE_MAKER for name in names])
    for group in (his, ~his):
        if group.any():
            balance[group] /= balance[group].mean() * (2 * group.mean() if his.any() else 1)
    return balance.astype(np.float32)


def corrected(network: Corrector, pairs: Pairs, part: float) -> NDArray[np.float64]:
    """Return a character's weights, shape (n, j), as corrected and then cut off as in `bind`."""
    with torch.no_grad():
        inputs = [torch.tensor(x) for x in (pairs.features, pairs.is_candidate)]
        rows, same = (network(*inputs, p).numpy().astype(float) for p in (part, 0.0))
    rows[pairs.is_rigid] = same[pairs.is_rigid]
    rows = np.maximum(rows - TAIL * rows.max(axis=1, keepdims=True), 0)
    weights = np.zeros((len(rows), len(pairs.rig.skeleton.joints)))
    np.add.at(weights, (np.arange(len(rows))[:, None], pairs.joint), rows)
    weights /= weights.sum(axis=1, keepdims=True)
    weights = weights[pairs.distances.graph.vertex_node]
    if pairs.rig.allowed is not None:
        graph, distances = pairs.distances.graph, pairs.distances
        context = Context(
            ANIMATION, pairs.rig.allowed, graph=graph, distances=distances, weights=weights
        )
        weights = permit(context)
    return keep_strongest(pairs.distances, weights)


def maker(name: str) -> str:
    """Return a character's maker by the name of its file; those of train are all by one."""
    if "__" in name or name.startswith(SAME_MAKER):
        return ONE_MAKER
    return name.split("_")[0]


def tables_of(
    before: dict[str, Score],
    after: dict[float, dict[str, Score]],
    all_seen: dict[str, Score],
    characters: int,
    epochs: int,
) -> tuple[Table, Table]:
    """List each character, and sum up; `all_seen`: by a network trained on all of them."""
    heads = [f"{what}, {part:.0%}" for part in after for what in ("L1", "cm²")]
    note = (
        f"{characters} characters; {epochs} epochs for each maker left out. By the part of the "
        "network's change that is applied; 0 %: `bind` alone."
    )
    each = Table("A network that corrects bind, each maker left out in turn", [
        "character", "L1, 0%", "cm², 0%", *heads], note)  # fmt: skip
    for name, alone in before.items():
        cells_of = [alone, *(scores[name] for scores in after.values())]
        cells = [(f"{score.l1:.3f}", f"{score.deformation:.2f}") for score in cells_of]
        each.add(name, *(cell for pair in cells for cell in pair))
    columns = ["part", "L1 median", "L1 mean", "L1 worst", "cm² median", "cm² mean", "cm² worst"]
    overall = Table("All of them", [*columns, "L1 better", "L1 worse"],
        "Better, worse: by 0.005. Seen: by a network that learned from all of them.")  # fmt: skip
    first = np.array([score.l1 for score in before.values()])
    shares = {f"{part:.0%}": scores for part, scores in {0.0: before, **after}.items()}
    for part, scores in {**shares, "100%, seen": all_seen}.items():
        values = np.array([(score.l1, score.deformation) for score in scores.values()])
        l1, moved = values.T
        overall.add(
            part,
            *(f"{f(l1):.3f}" for f in (np.median, np.mean, np.max)),
            *(f"{f(moved):.2f}" for f in (np.median, np.mean, np.max)),
            int((l1 < first - 0.005).sum()),
            int((l1 > first + 0.005).sum()),
        )
    return overall, each


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--epochs", type=int, default=10)
    parser.add_argument("--parts", type=float, nargs="+", default=[0.3, 1.0])
    parser.add_argument("--resolution", type=int, default=ANIMATION.resolution)
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(arguments)
    torch.set_num_threads(1)
    every, before = [], {}
    for group in SETS:
        for name, rig in characters(group):
            every.append(pairs_of(name, rig, options.resolution))
            if group != "train":
                before[name] = score_of(rig, cutcell.bind(rig, options.resolution).weights)
    after: dict[float, dict[str, Score]] = {part: {} for part in options.parts}
    for left_out in sorted({maker(name) for name in before}):
        learned = [pairs for pairs in every if maker(pairs.name) != left_out]
        network = fit(learned, options.epochs)
        for pairs in every:
            if pairs.name in before and maker(pairs.name) == left_out:
                for part in options.parts:
                    after[part][pairs.name] = score_of(pairs.rig, corrected(network, pairs, part))
        print(f"{left_out} is left out", flush=True)
    after = {part: {name: scores[name] for name in before} for part, scores in after.items()}
    network = fit(every, options.epochs)
    all_seen = {
        pairs.name: score_of(pairs.rig, corrected(network, pairs, 1.0))
        for pairs in every
        if pairs.name in before
    }
    tables = tables_of(before, after, all_seen, len(every), options.epochs)
    text = "\n\n".join(one.markdown() for one in tables)
    print(text)
    if options.out:
        fill(options.out, {"refinement": text})


if __name__ == "__main__":
    main()
