"""RigNet's SkinNet: the five nearest bones of each point, and a graph network that weighs them."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from ..batches import Batch
from .layers import edge_features, mlp, pooled, straight_distances

BONES = 5
"""Joints considered a point; all others get no weight."""
EACH = 8
"""Numbers a bone: two ends, inverse distance, whether it is a leaf."""
DROPPED = 0.5
"""Weights below this share of a point's largest are dropped in the end."""


class GraphUnit(nn.Module):
    """RigNet's GCU: the largest over the one-ring and over the geodesic ball, brought together."""

    def __init__(self, before: int, after: int) -> None:
        super().__init__()
        self.ring = mlp([2 * before, after // 2, after // 2])
        self.near = mlp([2 * before, after // 2, after // 2])
        self.both = mlp([after, after])

    def forward(self, features: Tensor, batch: Batch) -> Tensor:
        """Return (p, after) for features (p, before)."""
        around = [
            _largest(layers, features, neighbours)
            for layers, neighbours in ((self.ring, batch.ring), (self.near, batch.near))
        ]
        return self.both(torch.cat(around, dim=1))


def _largest(layers: nn.Module, features: Tensor, neighbours: Tensor) -> Tensor:
    edges = edge_features(features, neighbours)
    return layers(edges.flatten(0, 1)).unflatten(0, edges.shape[:2]).amax(dim=1)


class RigNet(nn.Module):
    """SkinNet with the distances of a prior.

    Bones are ranked by the prior. The priors here are weights, of which equation 1 makes inverse
    squares of distances: so the inverse distance is the root of the weight, relative to that of
    the nearest bone. Without a prior distances are straight. A joint has one bone, to the
    mean of its children.

    Parameters
    ----------
    part : int
        Layers are as wide as published divided by this: 1 has 3.7 million parameters.

    References
    ----------
    Xu et al. 2020 (RigNet), section 6.2; paper section 4.1.
    """

    def __init__(self, part: int) -> None:
        super().__init__()
        a, b, c, d = 64 // part, 256 // part, 512 // part, 1024 // part
        self.first = mlp([3 + BONES * EACH, 2 * a, a])
        self.units = nn.ModuleList([GraphUnit(a, c), GraphUnit(c, b), GraphUnit(b, b)])
        self.whole = mlp([c, c, d])
        self.last = nn.Sequential(mlp([d + b, d, c]), nn.Linear(c, BONES))

    def forward(self, batch: Batch) -> Tensor:
        """Return weights (s, p, j)."""
        return self._spread(batch, *self._shares(batch))

    def loss(self, batch: Batch) -> Tensor:
        """Return the soft cross-entropy over the five bones."""
        chosen, shares = self._shares(batch)
        assert batch.target is not None
        target = batch.flat(batch.target).gather(1, chosen)
        total = target.sum(dim=1, keepdim=True)
        target = target / total.clamp(min=1e-6)
        return -(target * shares.clamp(min=1e-9).log()).sum(dim=1).mean()

    def finish(self, weights: Tensor, batch: Batch) -> Tensor:
        """Average over the one-ring, and drop what is below half of the largest."""
        flat = batch.flat(weights)
        mean = (flat + flat[batch.ring].sum(dim=1)) / (batch.ring.shape[1] + 1)
        mean = mean * (mean >= DROPPED * mean.amax(dim=1, keepdim=True))
        return batch.padded(mean / mean.sum(dim=1, keepdim=True).clamp(min=1e-9))

    def _shares(self, batch: Batch) -> tuple[Tensor, Tensor]:
        """Return five joints of each point (all, 5), and the weights of each."""
        straight = straight_distances(batch)
        if batch.prior is None:
            near = straight.amin(dim=2, keepdim=True) / straight.clamp(min=1e-6)
        else:
            near = (batch.prior / batch.prior.amax(dim=2, keepdim=True).clamp(min=1e-9)).sqrt()
        # Among joints to which the prior gives the same the straight way decides, then the middle.
        middle = (batch.joints + batch.tails)[:, None] / 2 - batch.points[:, :, None]
        rank = near.double() + 1e-4 * torch.exp(-straight) + 1e-6 * torch.exp(-middle.norm(dim=3))
        rank = rank.masked_fill(~batch.joint_mask[:, None], -1)
        count = min(BONES, rank.shape[2])
        best, chosen = (batch.flat(x) for x in rank.topk(count, dim=2))
        exists = best >= 0
        features = torch.cat(
            [batch.flat(batch.points), self._bones(batch, near, chosen, exists)], 1
        )
        logits = self._logits(features, batch)[:, :count]
        return chosen, torch.softmax(logits.float().masked_fill(~exists, float("-inf")), dim=1)

    def _bones(self, batch: Batch, near: Tensor, chosen: Tensor, exists: Tensor) -> Tensor:
        """Return the features of the chosen bones, (all, 40); zero where there are fewer."""
        sample = torch.nonzero(batch.point_mask)[:, :1].expand_as(chosen)
        bones = torch.cat([batch.joints, batch.tails, batch.leaf[:, :, None]], dim=2)
        features = torch.cat(
            [bones[sample, chosen], batch.flat(near).gather(1, chosen)[..., None]], 2
        )
        features = (features * exists[:, :, None]).flatten(1)
        return nn.functional.pad(features, (0, BONES * EACH - features.shape[1]))

    def _logits(self, features: Tensor, batch: Batch) -> Tensor:
        features = self.first(features)
        units = []
        for unit in self.units:
            features = unit(features, batch)
            units.append(features)
        whole = pooled(batch, self.whole(units[0]))
        return self.last(torch.cat([whole, units[-1]], dim=1))

    def _spread(self, batch: Batch, chosen: Tensor, shares: Tensor) -> Tensor:
        flat = shares.new_zeros(len(shares), batch.joint_mask.shape[1])
        return batch.padded(flat.scatter(1, chosen, shares))
