"""A character before it is a file: bones, surfaces with weights, and a motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass
class Bones:
    """Joints by name, parents before children."""

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    places: list[NDArray] = field(default_factory=list)

    def add(self, name: str, parent: str | None, place: ArrayLike, both: bool = False) -> None:
        """Add a joint; with `both`, "x.L" gets its reflection "x.R"."""
        self.names.append(name)
        self.parents.append(-1 if parent is None else self.names.index(parent))
        self.places.append(np.round(np.asarray(place, float), 5))
        if both and parent is not None:
            mirror = np.asarray(place, float) * [-1, 1, 1]
            self.add(name.replace(".L", ".R"), parent.replace(".L", ".R"), mirror)

    def add_chain(self, name: str, parent: str, places: ArrayLike, both: bool = False) -> None:
        """Add joints "name1", "name2", ... ("name1.L" for "name.L"), each below the last."""
        stem, dot, side = name.partition(".")
        for k, place in enumerate(np.asarray(places, float), start=1):
            self.add(f"{stem}{k}{dot}{side}", parent, place, both)
            parent = f"{stem}{k}{dot}{side}"

    def __getitem__(self, name: str) -> NDArray:
        """Return where a joint is."""
        return self.places[self.names.index(name)]

    def neighbours(self) -> NDArray:
        """Whether two joints are the same, or parent and child: shape (j, j)."""
        near = np.eye(len(self.names), dtype=bool)
        for child, parent in enumerate(self.parents):
            if parent >= 0:
                near[child, parent] = near[parent, child] = True
        return near

    def below(self, name: str) -> Iterator[int]:
        """Yield the index of a joint and of all joints below it."""
        listed = {self.names.index(name)}
        yield from listed
        for child, parent in enumerate(self.parents):
            if parent in listed:
                listed.add(child)
                yield child


@dataclass(frozen=True)
class Material:
    """How a surface looks; `colour` is sRGB as in "#aabbcc"."""

    name: str
    colour: str = "#ffffff"
    metallic: float = 0.0
    roughness: float = 0.7
    both_sides: bool = False


@dataclass
class Surface:
    """Triangles of one material: vertices (n, 3), faces (m, 3), weights (n, j)."""

    vertices: NDArray
    faces: NDArray
    normals: NDArray | None
    weights: NDArray
    material: Material


@dataclass
class Motion:
    """Keyframes: unit quaternions (f, 4), x y z w, and moves (f, 3) from the rest place."""

    name: str
    times: NDArray
    rotations: dict[str, NDArray] = field(default_factory=dict)
    moves: dict[str, NDArray] = field(default_factory=dict)


@dataclass
class Character:
    """Everything that one GLB file holds."""

    name: str
    bones: Bones
    surfaces: list[Surface]
    motion: Motion


def rgb(colour: str) -> NDArray:
    """Return "#rrggbb" as three numbers from 0 to 1."""
    return np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255


def linear(colour: NDArray) -> NDArray:
    """Return sRGB values as linear light, as glTF stores colours."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
