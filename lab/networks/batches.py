"""Samples of different sizes as one batch of tensors, padded and masked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import torch
from torch import Tensor

from .samples import Sample, hops_between, joints_below


@dataclass(eq=False)
class Batch:
    """s samples, padded to p points and j joints.

    Parameters
    ----------
    points, normals : Tensor, shape (s, p, 3)
    joints, tails : Tensor, shape (s, j, 3)
    leaf : Tensor, shape (s, j)
        1 where a joint has no children.
    hops : Tensor of int, shape (s, j, j)
        Bones between two joints.
    below : Tensor, shape (s, j, j)
        1 where joint k moves along when joint j turns.
    prior : Tensor, shape (s, p, j), or None
        Weights of another method; None if no sample has a prior.
    target : Tensor, shape (s, p, j), or None
        The artist's weights.
    ring, near : Tensor of int, shape (all points, k)
        Neighbours, numbered through all samples without padding; see `flat`.
    point_mask, joint_mask : Tensor of bool, shapes (s, p) and (s, j)
        True where there is something.
    """

    points: Tensor
    normals: Tensor
    joints: Tensor
    tails: Tensor
    leaf: Tensor
    hops: Tensor
    below: Tensor
    prior: Tensor | None
    target: Tensor | None
    ring: Tensor
    near: Tensor
    point_mask: Tensor
    joint_mask: Tensor

    def flat(self, padded: Tensor) -> Tensor:
        """Return what there is of all points without padding: (s, p, ...) to (all, ...)."""
        return padded[self.point_mask]

    def padded(self, flat: Tensor) -> Tensor:
        """Put features of all points (all, c) into their places (s, p, c), zeros elsewhere."""
        whole = flat.new_zeros(*self.point_mask.shape, flat.shape[1])
        whole[self.point_mask] = flat
        return whole

    def to(self, device: torch.device | str) -> Batch:
        """Return the same on another device."""
        values = (getattr(self, field.name) for field in fields(self))
        return Batch(*(None if value is None else value.to(device) for value in values))  # type: ignore[arg-type]


def collate(samples: Sequence[Sample]) -> Batch:
    """Put samples into one batch.

    Parameters
    ----------
    samples : sequence of Sample
        All with a prior or all without; likewise the target.
    """
    points = max(len(sample.points) for sample in samples)
    joints = max(len(sample.joints) for sample in samples)

    def pad(arrays: Sequence[np.ndarray | None], *shape: int) -> Tensor | None:
        if any(array is None for array in arrays):
            return None
        whole = np.zeros((len(arrays), *shape), arrays[0].dtype)  # type: ignore[union-attr]
        for row, array in zip(whole, arrays, strict=True):
            row[tuple(slice(n) for n in array.shape)] = array  # type: ignore[union-attr]
        return torch.from_numpy(whole)

    starts = np.cumsum([0, *(len(sample.points) for sample in samples[:-1])])
    together = {
        name: torch.from_numpy(
            np.concatenate(
                [start + getattr(s, name) for start, s in zip(starts, samples, strict=True)]
            )
        )
        for name in ("ring", "near")
    }
    leaves = [(~np.isin(np.arange(len(s.parents)), s.parents)).astype(np.float32) for s in samples]
    return Batch(
        points=pad([s.points for s in samples], points, 3),  # type: ignore[arg-type]
        normals=pad([s.normals for s in samples], points, 3),  # type: ignore[arg-type]
        joints=pad([s.joints for s in samples], joints, 3),  # type: ignore[arg-type]
        tails=pad([s.tails for s in samples], joints, 3),  # type: ignore[arg-type]
        leaf=pad(leaves, joints),  # type: ignore[arg-type]
        hops=pad([hops_between(s.parents) for s in samples], joints, joints),  # type: ignore[arg-type]
        below=pad([joints_below(s.parents) for s in samples], joints, joints),  # type: ignore[arg-type]
        prior=pad([s.prior for s in samples], points, joints),
        target=pad([s.target for s in samples], points, joints),
        point_mask=pad([np.ones(len(s.points), bool) for s in samples], points),  # type: ignore[arg-type]
        joint_mask=pad([np.ones(len(s.joints), bool) for s in samples], joints),  # type: ignore[arg-type]
        **together,
    )
