"""The characters that are measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import cutcell

ROOT = Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared" / "data"


@dataclass(frozen=True)
class Character:
    """A rig, the name of its file, and what Blender took for it elsewhere, if that is known."""

    name: str
    rig: cutcell.Rig
    blender_seconds: float | None

    @property
    def size(self) -> str:
        """Vertices and bones in short."""
        return f"{len(self.rig.mesh.vertices):,} v, {len(self.rig.skeleton.joints)} j"


def load_characters(paths: Sequence[str | Path] = ()) -> list[Character]:
    """Load rigs by path; all at hand when none is named.

    These are the demo characters in assets/ and all rigs in shared/data/rigs beside
    the checkout.
    """
    return [
        Character(path.stem, cutcell.load(path), _blender_seconds(path))
        for path in rig_paths(paths)
    ]


def rig_paths(paths: Sequence[str | Path] = ()) -> list[Path]:
    """Return the files of rigs, see `load_characters`."""
    return [Path(path) for path in paths] or [
        *sorted((ROOT / "assets").glob("*.glb")),
        *sorted((SHARED / "rigs").glob("*.glb")),
    ]


def _blender_seconds(path: Path) -> float | None:
    """Read how long Blender's automatic weights took on this file."""
    stored = path.resolve().parent.parent / "bone_heat" / f"{path.stem}.npz"
    if not stored.exists():
        return None
    with np.load(stored) as arrays:
        return float(arrays["seconds"])
