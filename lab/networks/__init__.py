"""Networks that learn skinning weights, with a prior of another method or without.

They need torch: ``pip install 'cutcell[networks]'``. Nothing of it is imported before a name below
is used; `docs/networks.md` describes the heads and their results.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .torch_required import check_torch

if TYPE_CHECKING:
    from .batches import Batch as Batch
    from .batches import collate as collate
    from .heads.heads import create_network as create_network
    from .heads.heads import parameter_count as parameter_count
    from .heads.heads import predict as predict
    from .priors import PRIORS as PRIORS
    from .priors import Samples as Samples
    from .recipe import HEADS as HEADS
    from .recipe import SIZES as SIZES
    from .recipe import Recipe as Recipe
    from .samples import Sample as Sample
    from .samples import sample_rig as sample_rig
    from .trained import TrainedNetwork as TrainedNetwork
    from .trained import trained_networks as trained_networks
    from .training import load_network as load_network
    from .training import train as train

WITHOUT_TORCH = {
    "HEADS": "recipe",
    "SIZES": "recipe",
    "PRIORS": "priors",
    "Recipe": "recipe",
    "Samples": "priors",
    "Sample": "samples",
    "sample_rig": "samples",
    "TrainedNetwork": "trained",
    "trained_networks": "trained",
}
WITH_TORCH = {
    "Batch": "batches",
    "collate": "batches",
    "create_network": "heads.heads",
    "parameter_count": "heads.heads",
    "predict": "heads.heads",
    "load_network": "training",
    "train": "training",
}
__all__ = sorted([*WITHOUT_TORCH, *WITH_TORCH])


def __getattr__(name: str) -> Any:
    if name in WITH_TORCH:
        check_torch()
    module = {**WITHOUT_TORCH, **WITH_TORCH}.get(name)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{module}"), name)


def __dir__() -> list[str]:
    return __all__
