"""Names of heads, sizes and priors, without torch."""

from __future__ import annotations

from typing import Literal, get_args

HeadName = Literal["rignet", "unirig", "puppeteer"]
SizeName = Literal["tiny", "small", "full"]
PriorName = Literal["none", "visibility", "voxel_unirig", "voxel", "cutcell", "cutcell_any", "bind"]
HEADS: tuple[HeadName, ...] = get_args(HeadName)
SIZES: tuple[SizeName, ...] = get_args(SizeName)
PRIOR_NAMES: tuple[PriorName, ...] = get_args(PriorName)
TITLES: dict[str, str] = {"rignet": "RigNet", "unirig": "UniRig", "puppeteer": "Puppeteer"}
"""Display names of the heads."""
