"""How far weights are from the artist's, as something to make smaller."""

from __future__ import annotations

from torch import Tensor

from .batches import Batch

DEFORMATION = 10.0
"""How much the deformation counts beside L1: in longest sides its squares are small."""


def weight_loss(weights: Tensor, batch: Batch) -> Tensor:
    """Sum four losses of weights (s, p, j), each a mean over the points.

    Cross-entropy; L1; L1 on the artist's zeros alone, per joint that is one, and likewise on the
    others; and the deformation: how far the points are apart, squared, when each joint turns, in
    the closed form of `cutcell.metrics.deformation_error`, summed over the joints.
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
