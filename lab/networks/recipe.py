"""Recipes of networks, without torch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from cutcell.checks import check_choice, check_flag, check_integer

HeadName = Literal["rignet", "unirig", "puppeteer"]
SizeName = Literal["tiny", "small", "full"]
PriorName = Literal["none", "visibility", "voxel_unirig", "voxel", "cutcell", "cutcell_any", "bind"]
HEADS: tuple[HeadName, ...] = get_args(HeadName)
SIZES: tuple[SizeName, ...] = get_args(SizeName)
PRIOR_NAMES: tuple[PriorName, ...] = get_args(PriorName)
TITLES: dict[str, str] = {"rignet": "RigNet", "unirig": "UniRig", "puppeteer": "Puppeteer"}
"""Display names of the heads."""


@dataclass(frozen=True)
class Recipe:
    """Settings that determine a network; on a CPU, even its parameters.

    Parameters
    ----------
    head, size : str
        See `create_network`.
    prior : str
        Of `PRIORS`.
    seed : int
        Of the first parameters, the order of characters, the points, and the augmentation.
    points : int
        Points a character, sampled again in each epoch.
    resolution : int
        R of the prior.
    augment : bool
        Whether joints, parts, poses and points are changed at random; see
        `augmentation.drawn`. Networks of earlier versions were trained without.
    """

    head: str
    size: str = "tiny"
    prior: str = "cutcell"
    seed: int = 0
    points: int = 128
    resolution: int = 64
    augment: bool = False

    def __post_init__(self) -> None:
        check_choice("head", self.head, HEADS)
        check_choice("size", self.size, SIZES)
        check_choice("prior", self.prior, PRIOR_NAMES)
        check_integer("seed", self.seed, 0, 2**31 - 1)
        check_integer("points", self.points, 16, 1_000_000)
        check_integer("resolution", self.resolution, 2, 1024)
        check_flag("augment", self.augment)

    @property
    def name(self) -> str:
        """Its name among methods, such as "rignet-cutcell-tiny-0"."""
        name = f"{self.head}-{self.prior}-{self.size}-{self.seed}"
        return f"{name}-augmented" if self.augment else name

    @property
    def title(self) -> str:
        """Its title, such as "RigNet with cutcell, tiny, seed 0"."""
        prior = "without prior" if self.prior == "none" else f"with {self.prior}"
        title = f"{TITLES[self.head]} {prior}, {self.size}, seed {self.seed}"
        return f"{title}, augmented" if self.augment else title
