"""Heads by name, each in three sizes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from cutcell.checks import check_choice

from ..batches import collate
from ..recipe import HEADS, SIZES
from ..samples import Sample
from .puppeteer import Puppeteer
from .rignet import RigNet
from .unirig import UniRig

MADE: dict[str, tuple[Callable[..., nn.Module], dict[str, tuple[int, ...]]]] = {
    # Parts of the published widths.
    "rignet": (RigNet, {"tiny": (8,), "small": (4,), "full": (1,)}),
    # Width, heads, hidden; rounds of bones, of points, of our encoder.
    "unirig": (
        UniRig,
        {
            "tiny": (32, 4, 32, 1, 2, 1),
            "small": (128, 8, 128, 2, 4, 2),
            "full": (768, 16, 512, 8, 16, 4),
        },
    ),
    # Width, heads; rounds, and those of our encoder.
    "puppeteer": (
        Puppeteer,
        {"tiny": (32, 4, 1, 1), "small": (128, 8, 2, 2), "full": (512, 8, 4, 4)},
    ),
}
"""Each head's class, and what it is made with in each size."""


def create_network(head: str, size: str = "tiny", seed: int = 0) -> nn.Module:
    """Make a network that has not learned anything yet.

    Parameters
    ----------
    head : {"rignet", "unirig", "puppeteer"}
    size : {"tiny", "small", "full"}
        "tiny" learns in minutes on one core, "small" in an hour on two, "full" is as published.
    seed : int
        Of its first parameters.

    Returns
    -------
    torch.nn.Module
        Takes a `Batch`, gives weights (s, p, j); `loss(batch)` is what training makes smaller.

    Raises
    ------
    ParameterError
        There is no such head or size.
    """
    make, sizes = MADE[check_choice("head", head, HEADS)]
    options = sizes[check_choice("size", size, SIZES)]
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        return make(*options)


def predict(
    network: nn.Module, samples: Sequence[Sample], points: int = 0
) -> list[NDArray[np.float64]]:
    """Return the weights of each sample, (p, j); rows sum to one.

    Parameters
    ----------
    network : torch.nn.Module
        Made by `create_network`; its head's own last steps are done, such as RigNet's mean.
    samples : sequence of Sample
        All with a prior or all without.
    points : int
        How many to look at together: as many as in training, since neighbours are farther apart
        where there are fewer. 0 for all.
    """
    network.eval()
    predictions = []
    for sample in samples:
        weights = np.empty((len(sample.points), len(sample.joints)))
        for chosen in sample.parts(points, np.random.default_rng(0)):
            weights[chosen] = _predict(network, sample.part(chosen))
        predictions.append(weights / weights.sum(axis=1, keepdims=True))
    return predictions


def _predict(network: nn.Module, sample: Sample) -> NDArray[np.float64]:
    batch = collate([sample]).to(next(network.parameters()).device)
    with torch.no_grad():
        weights = network(batch)
        if isinstance(network, RigNet):
            weights = network.finish(weights, batch)
    return weights[0].double().cpu().numpy()


def parameter_count(network: nn.Module) -> int:
    """Return how many numbers a network learns."""
    return sum(parameter.numel() for parameter in network.parameters())
