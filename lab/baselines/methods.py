"""The register of methods, with cutcell and the artist's weights."""

from __future__ import annotations

from collections.abc import Callable
from inspect import signature
from time import perf_counter
from typing import Any

from cutcell.binding import bind
from cutcell.method import ANIMATION, PAPER, Method
from cutcell.rig import Rig

from .bone_heat import bone_heat
from .cages.cage_methods import harmonic, mean_value
from .euclidean import euclidean
from .frame import BaselineBinding
from .visible_geodesics import visibility
from .volumes.volume import bbw, biharmonic, quasi_harmonic
from .volumes.voxel_binding import voxel, voxel_unirig

Baseline = Callable[..., BaselineBinding]


def cutcell(rig: Rig, resolution: int = 64, **options: Any) -> BaselineBinding:
    """Bind by the paper's method; `options` are those of `cutcell.bind`."""
    return _bind(rig, PAPER, resolution, options)


def cutcell_any(rig: Rig, resolution: int = 64, **options: Any) -> BaselineBinding:
    """Bind by the paper's falloff on true distances: paths inside may run at any angle."""
    return _bind(rig, PAPER.with_options(connectivity="any"), resolution, options)


def cutcell_rig(rig: Rig, resolution: int = 64, **options: Any) -> BaselineBinding:
    """Bind by the falloff for rigs, with bones fitted to the body: what `cutcell.bind` does.

    As for all methods here, nothing limits the influences unless it is asked for.
    """
    return _bind(rig, ANIMATION.with_options(max_influences=None), resolution, options)


def _bind(rig: Rig, method: Method, resolution: int, options: dict[str, Any]) -> BaselineBinding:
    binding = bind(rig, resolution, **{"method": method, **options})
    return BaselineBinding(binding.weights, binding.seconds, binding.warnings)


def accepted_options(method: Baseline, **options: Any) -> dict[str, Any]:
    """Return the options that a method accepts."""
    parameters = signature(method).parameters
    every = any(one.kind is one.VAR_KEYWORD for one in parameters.values())
    return {name: value for name, value in options.items() if every or name in parameters}


def artist(rig: Rig) -> BaselineBinding:
    """Return the weights that the file came with."""
    begin = perf_counter()
    if rig.weights is None:
        return BaselineBinding(None, failed="the file has no weights")
    return BaselineBinding(rig.weights, {"weights": perf_counter() - begin})


METHODS: dict[str, Baseline] = {
    "artist": artist,
    "bbw": bbw,
    "biharmonic": biharmonic,
    "bone_heat": bone_heat,
    "cutcell": cutcell,
    "cutcell_any": cutcell_any,
    "cutcell_rig": cutcell_rig,
    "euclidean": euclidean,
    "harmonic": harmonic,
    "mean_value": mean_value,
    "quasi_harmonic": quasi_harmonic,
    "visibility": visibility,
    "voxel": voxel,
    "voxel_unirig": voxel_unirig,
}
"""Every method by name: `method(rig, **options) -> BaselineBinding`."""
