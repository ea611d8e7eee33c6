"""Puppeteer's skinning head: points and joints in one space, weights by the angle between them."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from ..batches import Batch
from ..samples import MAX_HOPS
from .layers import CrossAttention, PointEncoder, masked_softmax, normed, weight_loss

SHARP = 10.0
"""The scale of the cosine that learning begins with."""


class Puppeteer(nn.Module):
    """Puppeteer's head, with the prior beside the features of the points.

    Joints attend to each other, with a bias for the bones between them, then points and joints to
    each other. The prior of a point is pooled: the mean of the features of joints, weighted by the
    prior. So the order of joints cannot matter, as it would in a padded list.

    Parameters
    ----------
    width, heads, layers : int
        Of the attention.
    encoder_layers : int
        Of `PointEncoder`.

    References
    ----------
    Song et al. 2025 (Puppeteer), section 4; paper section 4.1. The paper does not give widths;
    ours are in `heads.py`.
    """

    def __init__(self, width: int, heads: int, layers: int, encoder_layers: int) -> None:
        super().__init__()
        self.encoder = PointEncoder(width, encoder_layers)
        self.joints = normed([6, width, width])
        self.hops = nn.Embedding(MAX_HOPS + 1, heads)
        self.among = nn.ModuleList(CrossAttention(width, heads) for _ in range(layers))
        self.to_points = nn.ModuleList(CrossAttention(width, heads) for _ in range(layers))
        self.to_joints = nn.ModuleList(CrossAttention(width, heads) for _ in range(layers))
        self.fuse = nn.Sequential(nn.Linear(2 * width, width), nn.GELU(), nn.Linear(width, width))
        self.scale = nn.Parameter(torch.tensor(SHARP).log())

    def forward(self, batch: Batch) -> Tensor:
        """Return weights (s, p, j)."""
        points = self.encoder(batch)
        joints = self.joints(torch.cat([batch.joints, batch.tails], dim=2))
        bias = self.hops(batch.hops).permute(0, 3, 1, 2).flatten(0, 1)
        for among, to_points, to_joints in zip(
            self.among, self.to_points, self.to_joints, strict=True
        ):
            joints = among(joints, joints, batch.joint_mask, bias)
            joints = to_points(joints, points, batch.point_mask)
            points = to_joints(points, joints, batch.joint_mask)
        pooled = torch.zeros_like(points) if batch.prior is None else batch.prior @ joints
        points = points + self.fuse(torch.cat([points, pooled], dim=2))
        cosine = torch.einsum(
            "spc,sjc->spj",
            nn.functional.normalize(points, dim=2),
            nn.functional.normalize(joints, dim=2),
        )
        return masked_softmax(self.scale.exp() * cosine, batch)

    def loss(self, batch: Batch) -> Tensor:
        """Return cross-entropy, L1 and deformation; see `weight_loss`."""
        return weight_loss(self(batch), batch)
