"""Layers of the heads besides PyTorch's modules."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import Tensor, nn

from ..batches import Batch

LEAST = 1e-4
"""Added to a prior before its logarithm, so that joints without prior can be learned."""


def mlp(widths: Sequence[int]) -> nn.Sequential:
    """Stack linear layers, each followed by ReLU and batch normalisation, as RigNet does."""
    layers: list[nn.Module] = []
    for before, after in pairwise(widths):
        layers += [nn.Linear(before, after), nn.ReLU(), nn.BatchNorm1d(after)]
    return nn.Sequential(*layers)


def normed(widths: Sequence[int]) -> nn.Sequential:
    """Stack linear layers, each followed by layer normalisation and GELU, as UniRig does."""
    layers: list[nn.Module] = []
    for before, after in pairwise(widths):
        layers += [nn.Linear(before, after), nn.LayerNorm(after), nn.GELU()]
    return nn.Sequential(*layers)


def edge_features(features: Tensor, neighbours: Tensor) -> Tensor:
    """Return each point's features beside the difference to each neighbour's, (p, k, 2 c)."""
    centre = features[:, None].expand(-1, neighbours.shape[1], -1)
    return torch.cat([centre, features[neighbours] - centre], dim=2)


DEFORMATION = 10.0
"""How much the deformation counts beside L1: in longest sides its squares are small."""


def weight_loss(weights: Tensor, batch: Batch) -> Tensor:
    """Sum four losses of weights (s, p, j), each a mean over the points.

    Cross-entropy; L1; L1 on the artist's zeros alone, per joint that is one, and likewise on the
    others; and the deformation: how far the points are apart, squared, when each joint turns, in
    the closed form of `cutcell_lab.metrics.deformation_error`, summed over the joints.
    """
    assert batch.target is not None
    predicted, target = batch.flat(weights), batch.flat(batch.target)
    off = (predicted - target).abs()
    positive = target > 0
    entropy = -(target * predicted.clamp(min=1e-9).log()).sum(dim=1).mean()
    sides = (
        off[positive].mean() + off[~positive].mean() if (~positive).any() else off[positive].mean()
    )
    turned = (weights - batch.target) @ batch.below.transpose(1, 2)
    arms = (batch.points[:, :, None] - batch.joints[:, None]).square().sum(dim=3)
    moved = batch.flat(arms * turned.square() * batch.joint_mask[:, None]).sum(dim=1).mean()
    return entropy + off.sum(dim=1).mean() + sides + DEFORMATION * moved


class PointEncoder(nn.Module):
    """Features of points from places, normals and neighbours.

    A small encoder, trained with the head. The published networks have large ones,
    pretrained elsewhere: PTv3 and Michelangelo in UniRig, PartField's in Puppeteer.
    """

    def __init__(self, width: int, layers: int) -> None:
        super().__init__()
        self.first = normed([6, width, width])
        self.rounds = nn.ModuleList(normed([2 * width, width]) for _ in range(layers))
        self.last = normed([2 * width, width])

    def forward(self, batch: Batch) -> Tensor:
        """Return features (s, p, width), zero where there is no point."""
        features = self.first(torch.cat([batch.flat(batch.points), batch.flat(batch.normals)], 1))
        for layer in self.rounds:
            features = features + layer(edge_features(features, batch.near)).amax(dim=1)
        whole = pooled(batch, features)
        return batch.padded(self.last(torch.cat([features, whole], dim=1)))


def pooled(batch: Batch, features: Tensor) -> Tensor:
    """Return for each point the largest features of all points of its sample, (all, c)."""
    counts = batch.point_mask.sum(dim=1).tolist()
    largest = torch.stack([part.amax(dim=0) for part in features.split(counts)])
    return largest.repeat_interleave(batch.point_mask.sum(dim=1), dim=0)


class CrossAttention(nn.Module):
    """Attention, then two linear layers, each added to its input and normalised."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.attention = nn.MultiheadAttention(width, heads, batch_first=True)
        self.after = nn.LayerNorm(width)
        self.forth = nn.Sequential(
            nn.Linear(width, 4 * width), nn.GELU(), nn.Linear(4 * width, width)
        )
        self.last = nn.LayerNorm(width)

    def forward(
        self, queries: Tensor, keys: Tensor, mask: Tensor, bias: Tensor | None = None
    ) -> Tensor:
        """Return (s, q, width); `mask` (s, k) is true for what may be looked at."""
        # As numbers: PyTorch wants both masks to be of one type.
        closed = torch.zeros(mask.shape, device=mask.device).masked_fill(~mask, float("-inf"))
        attended, _ = self.attention(
            queries, keys, keys, key_padding_mask=closed, attn_mask=bias, need_weights=False
        )
        queries = self.after(queries + attended)
        return self.last(queries + self.forth(queries))


def masked_softmax(logits: Tensor, batch: Batch) -> Tensor:
    """Return weights (s, p, j) that sum to one over the joints; zero where there is no point."""
    logits = logits.float().masked_fill(~batch.joint_mask[:, None], float("-inf"))
    return torch.softmax(logits, dim=2) * batch.point_mask[:, :, None]


def straight_distances(batch: Batch) -> Tensor:
    """Return how far each point is from each bone, (s, p, j)."""
    along = (batch.tails - batch.joints)[:, None]
    away = batch.points[:, :, None] - batch.joints[:, None]
    share = (away * along).sum(3) / along.square().sum(3).clamp(min=1e-12)
    return (away - share.clamp(0, 1)[..., None] * along).norm(dim=3)
