"""The demo characters as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

import cutcell
from cutcell_assets import demo_path


@dataclass(frozen=True)
class Loaded:
    """A demo character with equal positions welded."""

    rig: cutcell.Rig
    vertices: NDArray
    faces: NDArray
    weights: NDArray

    @property
    def owner(self) -> NDArray:
        """The name of the joint that holds most of each vertex."""
        return np.array(self.rig.skeleton.names)[self.weights.argmax(axis=1)]

    def held_by(self, *starts: str) -> NDArray:
        """Return the vertices whose joint's name starts with one of these."""
        return self.vertices[[name.startswith(starts) for name in self.owner]]


@cache
def load(id: str) -> Loaded:
    """Return one demo character."""
    rig = cutcell.load(demo_path(id))
    vertices, first, number = np.unique(
        rig.mesh.vertices, axis=0, return_index=True, return_inverse=True
    )
    faces = number.reshape(-1)[rig.mesh.faces]
    return Loaded(rig, vertices, faces, rig.weights[first])


@pytest.fixture(params=["biped", "rabbit", "octopus"])
def closed(request: pytest.FixtureRequest) -> Loaded:
    """Each character made of one closed surface."""
    return load(request.param)
