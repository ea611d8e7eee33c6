"""Training of a head on rigs, saved after each epoch, so that it can be resumed."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch
from torch import nn

from cutcell.checks import check_integer
from cutcell.errors import FileError, ParameterError
from cutcell.runtime.writing import reason, write_all

from .augmentation import drawn
from .batches import Batch, collate
from .heads.heads import create_network
from .recipe import Recipe
from .samples import Sample

BATCH = 2
"""Characters in a batch."""
RATE = 2e-3
"""AdamW's learning rate, the same all the time, so that any training can be gone on with."""
LARGEST_GRADIENT = 1.0
ANOTHER_VERSION = "is a network of another version of cutcell; train it again"


def train(
    recipe: Recipe,
    samples: Sequence[Sample],
    epochs: int,
    folder: Path | None = None,
    report: Callable[[int, float], Any] = lambda epoch, loss: None,
) -> nn.Module:
    """Train a network, or continue the training in the folder.

    A GPU is used if there is one, with mixed precision; on a CPU the result is the same each time.

    Parameters
    ----------
    recipe : Recipe
    samples : sequence of Sample
        With the recipe's prior.
    epochs : int
        Epochs in all, earlier runs included.
    folder : Path, optional
        Gets `network.pt` after each epoch, and `log.csv`: epoch, loss, seconds.
    report : callable
        Called after each epoch with its number and its mean loss.

    Returns
    -------
    torch.nn.Module

    Raises
    ------
    ParameterError
        No samples, or some without weights to learn from.
    FileError
        The folder holds a network of another recipe, or cannot be read.
    """
    check_integer("epochs", epochs, 1, 1_000_000)
    if not samples or any(sample.target is None for sample in samples):
        raise ParameterError("there is nothing to learn from: give rigs that have weights")
    device = "cuda" if torch.cuda.is_available() else "cpu"
    network = create_network(recipe.head, recipe.size, recipe.seed).to(device)
    optimizer = torch.optim.AdamW(network.parameters(), RATE)
    done = _resume(recipe, network, optimizer, folder) if folder else 0
    for epoch in range(done, epochs):
        begin = perf_counter()
        loss = _epoch(recipe, network, optimizer, samples, epoch, device)
        if folder:
            _keep(recipe, network, optimizer, epoch + 1, folder)
            with (folder / "log.csv").open("a", encoding="utf-8") as log:
                log.write(f"{epoch + 1},{loss:.6f},{perf_counter() - begin:.3f}\n")
        report(epoch + 1, loss)
    return network


def load_network(folder: Path) -> tuple[nn.Module, Recipe]:
    """Return a trained network and its recipe.

    Raises
    ------
    FileError
        There is none in the folder, or one of another version.
    """
    path = folder / "network.pt"
    stored, recipe = _read(path, in_parts=True), read_recipe(folder)
    network = create_network(recipe.head, recipe.size, recipe.seed)
    try:
        network.load_state_dict(stored["network"])
    except RuntimeError:
        raise FileError(f"{path}: {ANOTHER_VERSION}") from None
    return network.eval(), recipe


def read_recipe(folder: Path) -> Recipe:
    """Return the recipe of a trained network; nothing else of it is read."""
    path = folder / "network.pt"
    try:
        return Recipe(**json.loads(_read(path, in_parts=True)["recipe"]))
    except (TypeError, json.JSONDecodeError, ParameterError):
        raise FileError(f"{path}: {ANOTHER_VERSION}") from None


def _epoch(
    recipe: Recipe,
    network: nn.Module,
    optimizer: torch.optim.Optimizer,
    samples: Sequence[Sample],
    epoch: int,
    device: str,
) -> float:
    network.train()
    rng = np.random.default_rng([recipe.seed, epoch])
    losses = []
    groups = np.array_split(rng.permutation(len(samples)), -(-len(samples) // BATCH))
    for chosen in groups:
        drawn_samples = [drawn(samples[k], recipe.points, rng, recipe.augment) for k in chosen]
        batch = collate(drawn_samples).to(device)
        loss = _loss(network, batch, device)
        optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(network.parameters(), LARGEST_GRADIENT)
        optimizer.step()
        losses.append(float(loss.detach()))
    return float(np.mean(losses))


def _loss(network: nn.Module, batch: Batch, device: str) -> torch.Tensor:
    # bfloat16 has the range of float32, so that the loss need not be scaled.
    with torch.autocast(device, torch.bfloat16, enabled=device == "cuda"):
        return network.loss(batch)  # type: ignore[operator]


def _keep(
    recipe: Recipe,
    network: nn.Module,
    optimizer: torch.optim.Optimizer,
    epoch: int,
    folder: Path,
) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    packed = io.BytesIO()
    torch.save(
        {
            "recipe": json.dumps(asdict(recipe)),
            "epoch": epoch,
            "network": network.state_dict(),
            "optimizer": optimizer.state_dict(),
        },
        packed,
    )
    write_all({folder / "network.pt": packed.getvalue()})


def _resume(
    recipe: Recipe, network: nn.Module, optimizer: torch.optim.Optimizer, folder: Path
) -> int:
    """Load the network in the folder, and return its epochs."""
    path = folder / "network.pt"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        write_all({folder / "log.csv": b"epoch,loss,seconds\n"})
        return 0
    stored = _read(path)
    if read_recipe(folder) != recipe:
        raise FileError(
            f"{folder}: holds a network of another recipe, {stored['recipe']}; name another folder"
        )
    network.load_state_dict(stored["network"])
    optimizer.load_state_dict(stored["optimizer"])
    return int(stored["epoch"])


def _read(path: Path, in_parts: bool = False) -> dict[str, Any]:
    """Read a file; `in_parts` maps it, so that the optimizer's state is not read."""
    try:
        stored = torch.load(path, map_location="cpu", weights_only=True, mmap=in_parts)
    except OSError as error:
        raise FileError(f"{path}: cannot be read ({reason(error)})") from None
    except Exception:
        raise FileError(f"{path}: is no network that cutcell trained") from None
    parts = {"recipe": str, "epoch": int, "network": dict, "optimizer": dict}
    if not isinstance(stored, dict) or any(
        not isinstance(stored.get(name), kind) for name, kind in parts.items()
    ):
        raise FileError(f"{path}: is no network that cutcell trained")
    return stored
