"""The heads and their sizes by name; nothing of torch is needed to know them."""

from __future__ import annotations

from typing import Literal, get_args

HeadName = Literal["rignet", "unirig", "puppeteer"]
SizeName = Literal["tiny", "small", "full"]
HEADS: tuple[HeadName, ...] = get_args(HeadName)
SIZES: tuple[SizeName, ...] = get_args(SizeName)
TITLES: dict[str, str] = {"rignet": "RigNet", "unirig": "UniRig", "puppeteer": "Puppeteer"}
"""What people call the heads."""
