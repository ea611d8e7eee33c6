"""The animations of a glTF document as clips, which are sampled when they are played."""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError
from ....rig.clip import Clip
from ....rig.transforms import composed
from ..constants import CUBICSPLINE, INTERPOLATIONS, LINEAR, STEP
from ..container import Document
from ..nodes import Nodes, compose, node_shifts, target_of
from .accessors import Accessor, find_accessor, read_accessor

CLIP_RATE, MAX_FRAMES = 30, 3600
"""Two minutes at full rate; a longer clip is shown by frames that are farther apart."""
TOGETHER = 2**18
"""Matrices of nodes that are sampled together: what it takes on the way stays small."""
MAX_MATRICES = 2**22
"""Matrices in all frames: a chain of thousands of nodes is shown by fewer frames, too."""

CHANNEL_PATHS = ("translation", "rotation", "scale")


def read_clips(
    document: Document, nodes: Nodes, joints: list[int], inverse: NDArray, world: NDArray
) -> tuple[Clip, ...]:
    """Return every animation that moves a joint. Shapes: inverse (j, 4, 4), world (4, 4)."""
    animations = document.items("animations")
    if not animations:
        return ()
    tree = _Subtree(nodes, joints, np.linalg.inv(world), inverse)
    key_times: dict[Any, NDArray[np.float64]] = {}
    clips = []
    for i, animation in enumerate(animations):
        label = document.label("animations", i)
        tracks = _tracks(document, tree.place, animation, label, key_times)
        if tracks:
            duration = max(float(track.keys[-1]) for track in tracks)
            name = animation.get("name")
            name = name if isinstance(name, str) and name else f"clip {i}"
            clips.append(Clip(name, motion=Channels(label, tree, tracks, max(duration, 0.0))))
    return tuple(clips)


@dataclass(frozen=True, eq=False)
class Track:
    """Channels with common keys: exporters give hundreds the same."""

    keys: NDArray[np.float64]  # (k,): seconds
    how: str  # LINEAR, STEP, CUBICSPLINE
    path: str  # translation, rotation, scale
    values: dict[int, Accessor]
    """By what moves, numbered as in the subtree: the values at the keys, three each for a cubic
    spline."""

    def at(self, seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values at some times, shape (f, c, width)."""
        left = np.searchsorted(self.keys, seconds, side="right") - 1
        left = left.clip(0, len(self.keys) - 1)
        right = np.minimum(left + 1, len(self.keys) - 1)
        before, a, b = self.keys[left], self._keyed(left), self._keyed(right)
        if self.how == STEP:
            return a
        span = self.keys[right] - before
        u = np.divide(seconds - before, span, out=np.zeros(len(seconds)), where=span > 0)
        u = u.clip(0, 1)[:, None, None]
        if self.how == CUBICSPLINE:
            return _hermite(a, b, span[:, None, None], u)
        return _slerp(a, b, u) if self.path == "rotation" else a * (1 - u) + b * u

    def _keyed(self, at: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the values at some keys, shape (f, c, width), or (f, c, 3, width)."""
        if self.how != CUBICSPLINE:
            return np.stack([one.decoded(at) for one in self.values.values()], axis=1)
        three = (3 * at[:, None] + np.arange(3)).ravel()
        values = [one.decoded(three).reshape(len(at), 3, -1) for one in self.values.values()]
        return np.stack(values, axis=1)


@dataclass(frozen=True, eq=False)
class Channels:
    """A motion as a glTF animation has it; see `cutcell.rig.clip.Motion`."""

    label: str
    tree: _Subtree
    tracks: list[Track]
    duration: float

    @property
    def joints(self) -> int:
        """How many joints it moves."""
        return len(self.tree.inverse)

    @property
    def times(self) -> NDArray[np.float64]:
        """Return times of frames, shape (f,)."""
        if self.duration <= 0:
            return np.zeros(1)
        most = min(MAX_FRAMES, MAX_MATRICES / len(self.tree.parents))
        frames = min(self.duration * CLIP_RATE + 1e-6, most)
        return np.linspace(0, self.duration, max(math.floor(frames), 1) + 1)

    def sample(self, seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return skinning matrices at some times, shape (f, j, 4, 4)."""
        matrices = np.empty((len(seconds), self.joints, 4, 4))
        step = max(TOGETHER // len(self.tree.parents), 1)
        for first in range(0, len(seconds), step):
            frames = slice(first, first + step)
            with np.errstate(over="ignore", invalid="ignore"):
                matrices[frames] = self.tree.skinning(self.tracks, seconds[frames])
        if not np.isfinite(matrices).all():
            raise FileError(f"{self.label} leads to matrices that are not finite numbers")
        return matrices

    def moved(self, by: NDArray[np.float64]) -> Channels:
        """Return it as it is in the file that is written with joints moved; see `Clip.moved`."""
        return replace(self, tree=self.tree.moved(by))


def _tracks(
    document: Document, place: dict[int, int], animation: dict[str, Any], label: str,
    key_times: dict[Any, NDArray[np.float64]],
) -> list[Track]:  # fmt: skip
    """Return the channels that move a node of a subtree, by their keys, and check the others."""
    channels, samplers = animation.get("channels"), animation.get("samplers")
    if not isinstance(channels, list) or not isinstance(samplers, list):
        raise FileError(f'{label}: needs "channels" and "samplers"')
    groups: dict[Any, Track] = {}
    for channel in channels:
        if not isinstance(channel, dict) or not isinstance(channel.get("target"), dict):
            raise FileError(f'{label}: a channel has no "target"')
        node, path = target_of(channel)
        at = channel.get("sampler")
        if type(at) is not int or not 0 <= at < len(samplers):
            raise FileError(f"{label}: a channel uses sampler {at!r} of {len(samplers)}")
        sampler = samplers[at]
        if not isinstance(sampler, dict):
            raise FileError(f"{label}: its sampler {at} is not an object")
        if node not in place or path not in CHANNEL_PATHS:
            if path == "translation":
                find_accessor(document, sampler.get("output"), "VEC3", label)
                if node is not None:
                    document.item("nodes", node, label)
            continue
        how, index = sampler.get("interpolation", LINEAR), sampler.get("input")
        if type(index) is not int or index not in key_times:
            keys = read_accessor(document, index, "SCALAR", label)[:, 0]
            if keys.dtype.kind != "f" or not np.isfinite(keys).all() or (np.diff(keys) < 0).any():
                raise FileError(f"{label}: its key times must be ascending numbers of seconds")
            key_times[index] = keys
        keys = key_times[index]
        track = groups.setdefault((index, how, path), Track(keys, how, path, {}))
        track.values[place[node]] = _values(document, sampler, how, path, len(keys), label)
    return list(groups.values())


def _values(
    document: Document, sampler: dict[str, Any], how: Any, path: str, keys: int, label: str
) -> Accessor:
    """Return the values of a sampler, checked."""
    kind = "VEC4" if path == "rotation" else "VEC3"
    values = find_accessor(document, sampler.get("output"), kind, label)
    if how not in INTERPOLATIONS:
        raise FileError(f"{label}: the interpolation {how!r} is none of glTF's")
    needed = keys * (3 if how == CUBICSPLINE else 1)
    if len(values) != needed:
        raise FileError(f"{label}: {keys} keys need {needed} values, {len(values)} are there")
    if not values.is_finite:
        raise FileError(f"{label} holds values that are not finite numbers")
    return values


class _Subtree:
    """The joints and all above them."""

    def __init__(self, nodes: Nodes, joints: list[int], back: NDArray, inverse: NDArray) -> None:
        subtree = nodes.with_ancestors(joints)
        self.place = {node: k for k, node in enumerate(subtree)}
        self.parents = np.array([self.place.get(nodes.parents[i], -1) for i in subtree])
        self.rest = {path: getattr(nodes, path)[subtree] for path in CHANNEL_PATHS}
        self.local = nodes.local[subtree]
        self.joints = [self.place[node] for node in joints]
        self.back, self.inverse = back, inverse
        self.shift = np.zeros((len(subtree), 3))

    def moved(self, by: NDArray[np.float64]) -> _Subtree:
        """Return it with joints moved at rest by `by`, shape (j, 3), in the rig's space."""
        frame_shifts = np.einsum("jab,jb->ja", self.inverse[:, :3, :3], by)
        at = np.zeros_like(self.shift)
        at[self.joints] = frame_shifts
        other = copy(self)
        other.shift = self.shift + node_shifts(self.local, self.parents, at)
        other.inverse = self.inverse.copy()
        other.inverse[:, :3, 3] -= frame_shifts
        return other

    def skinning(self, tracks: list[Track], seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return skinning matrices at some times, shape (f, j, 4, 4)."""
        return self.back @ self._worlds(tracks, seconds)[:, self.joints] @ self.inverse

    def _worlds(self, tracks: list[Track], seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        count = len(seconds)
        posed = {k: np.tile(v, (count, 1, 1)) for k, v in self.rest.items()}
        moved = np.zeros(len(self.parents), bool)
        for track in tracks:
            nodes = list(track.values)
            posed[track.path][:, nodes] = track.at(seconds)
            moved[nodes] = True
        world = np.tile(self.local, (count, 1, 1, 1))
        world[:, moved] = compose(*(posed[path][:, moved] for path in CHANNEL_PATHS))
        world[..., :3, 3] += self.shift
        return composed(world, self.parents)


def _hermite(a: NDArray, b: NDArray, span: NDArray, u: NDArray) -> NDArray:
    """Cubic spline of the glTF specification, appendix C.5."""
    u2, u3 = u * u, u * u * u
    return (
        (2 * u3 - 3 * u2 + 1) * a[:, :, 1]
        + span * (u3 - 2 * u2 + u) * a[:, :, 2]
        + (3 * u2 - 2 * u3) * b[:, :, 1]
        + span * (u3 - u2) * b[:, :, 0]
    )


def _slerp(a: NDArray, b: NDArray, u: NDArray) -> NDArray:
    """Interpolate quaternions along the shorter arc; nearly equal ones linearly."""
    cosine = (a * b).sum(axis=-1, keepdims=True)
    b = np.where(cosine < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(cosine), 0, 1))
    sine = np.sin(angle)
    near = sine < 1e-4
    safe = np.where(near, 1, sine)
    from_a = np.where(near, 1 - u, np.sin((1 - u) * angle) / safe)
    from_b = np.where(near, u, np.sin(u * angle) / safe)
    return from_a * a + from_b * b
