"""UniRig's skinning head: points attend to bones, and the scores are weighed with the prior."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from ..batches import Batch
from .layers import LEAST, CrossAttention, PointEncoder, masked_softmax, normed, weight_loss


class UniRig(nn.Module):
    """UniRig's head, to which the prior is an input, and whose output is a residual to it.

    The paper does not say how a residual passes a softmax. Here the weights are
    ``softmax(log(prior + LEAST) + f)``: f = 0 gives the prior, and the last layer begins at zero.
    Without a prior they are ``softmax(f)``.

    Parameters
    ----------
    width, heads : int
        Of the attention.
    hidden : int
        Of the MLP that weighs the scores.
    bone_layers, point_layers : int
        Rounds in which bones attend to bones and the surface, and points to bones.
    encoder_layers : int
        Of `PointEncoder`.

    References
    ----------
    Zhang et al. 2025 (UniRig), section 5; paper section 4.1.
    """

    def __init__(
        self,
        width: int,
        heads: int,
        hidden: int,
        bone_layers: int,
        point_layers: int,
        encoder_layers: int,
    ) -> None:
        super().__init__()
        self.heads = heads
        self.encoder = PointEncoder(width, encoder_layers)
        self.bones = normed([6, width, width])
        self.bone_rounds = nn.ModuleList(CrossAttention(width, heads) for _ in range(bone_layers))
        self.point_rounds = nn.ModuleList(CrossAttention(width, heads) for _ in range(point_layers))
        self.ask, self.answer = (nn.Linear(width, width * heads) for _ in range(2))
        self.score_norm = nn.LayerNorm(heads)
        self.prior = nn.Sequential(nn.Linear(1, heads), nn.LayerNorm(heads))
        self.both = normed([2 * heads, heads])
        self.weigh = nn.Sequential(normed([heads, *[hidden] * 4]), nn.Linear(hidden, 1))
        nn.init.zeros_(self.weigh[-1].weight)  # type: ignore[arg-type]
        nn.init.zeros_(self.weigh[-1].bias)  # type: ignore[arg-type]

    def forward(self, batch: Batch) -> Tensor:
        """Return weights (s, p, j)."""
        points = self.encoder(batch)
        bones = self.bones(torch.cat([batch.joints, batch.tails], dim=2))
        # The surface as a whole, in place of Michelangelo's latents: one more thing to look at.
        whole = points.amax(dim=1, keepdim=True)
        mask = nn.functional.pad(batch.joint_mask, (0, 1), value=True)
        for layer in self.bone_rounds:
            bones = layer(bones, torch.cat([bones, whole], dim=1), mask)
        for layer in self.point_rounds:
            points = layer(points, torch.cat([bones, whole], dim=1), mask)
        scores = self.score_norm(self._scores(points, bones, batch))
        prior = torch.zeros_like(scores[..., :1]) if batch.prior is None else batch.prior[..., None]
        both = self.both(torch.cat([scores, self.prior(prior)], dim=3))
        logits = self.weigh(both)[..., 0]
        if batch.prior is not None:
            logits = logits + torch.log(batch.prior + LEAST)
        return masked_softmax(logits, batch)

    def loss(self, batch: Batch) -> Tensor:
        """Return UniRig's losses; see `weight_loss`."""
        return weight_loss(self(batch), batch)

    def _scores(self, points: Tensor, bones: Tensor, batch: Batch) -> Tensor:
        """Return the attention of each point to each bone by all heads, (s, p, j, heads)."""
        queries = self.ask(points).unflatten(2, (self.heads, -1))
        keys = self.answer(bones).unflatten(2, (self.heads, -1))
        scores = torch.einsum("sphc,sjhc->spjh", queries, keys) / points.shape[2] ** 0.5
        closed = ~batch.joint_mask[:, None, :, None]
        return torch.softmax(scores.masked_fill(closed, float("-inf")), dim=2)
