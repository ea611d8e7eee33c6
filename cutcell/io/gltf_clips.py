"""Sampling glTF animations into clips of skinning matrices."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray

from ..errors import FileError
from ..rig import Clip
from .gltf_accessors import read_accessor
from .gltf_container import Document
from .gltf_nodes import Nodes, compose

FRAMES_A_SECOND = 30
MOST_FRAMES = 3600
"""Two minutes at full rate; a longer clip is sampled more coarsely."""

WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}


def read_clips(
    document: Document, nodes: Nodes, joints: list[int], inverse: NDArray, world: NDArray
) -> tuple[Clip, ...]:
    """Sample every animation that moves a joint.

    Parameters
    ----------
    document : Document
    nodes : Nodes
    joints : list of int
        The node of each joint.
    inverse : array, shape (j, 4, 4)
        Inverse bind matrices, for vertices in the rig's space.
    world : array, shape (4, 4)
        From the rig's space to the scene.
    """
    needed = sorted({a for j in joints for a in (j, *nodes.ancestors(j))})
    tree = _Subtree(nodes, needed)
    back = np.linalg.inv(world)
    clips = []
    for i, animation in enumerate(document.items("animations")):
        label = document.label("animations", i)
        tracks = _tracks(document, animation, tree, label)
        if not tracks:
            continue
        duration = max(float(keys[-1]) for (keys, _), _ in tracks)
        times = _times(duration)
        pose = tree.worlds(tracks, times, label)[:, [tree.place[j] for j in joints]]
        transforms = back @ pose @ inverse
        if not np.isfinite(transforms).all():
            raise FileError(f"{label} holds values that are not finite numbers")
        name = animation.get("name")
        clips.append(
            Clip(name if isinstance(name, str) and name else f"clip {i}", times, transforms)
        )
    return tuple(clips)


def _times(duration: float) -> NDArray:
    if duration <= 0:
        return np.zeros(1)
    steps = min(max(math.floor(duration * FRAMES_A_SECOND + 1e-6), 1), MOST_FRAMES)
    return np.linspace(0, duration, steps + 1)


def _tracks(document: Document, animation: dict[str, Any], tree: _Subtree, label: str) -> list:
    """Return [((keys, interpolation), [(node, path, values), ...]), ...], grouped by keys.

    Exporters give hundreds of channels the same keys; each group is sampled at once.
    """
    channels, samplers = animation.get("channels"), animation.get("samplers")
    if not isinstance(channels, list) or not isinstance(samplers, list):
        raise FileError(f'{label}: needs "channels" and "samplers"')
    groups: dict[Any, list] = {}
    for channel in channels:
        target = channel.get("target") if isinstance(channel, dict) else None
        if not isinstance(target, dict):
            raise FileError(f'{label}: a channel has no "target"')
        node, path = target.get("node"), target.get("path")
        if node not in tree.place or path not in WIDTHS:
            continue
        at = channel.get("sampler")
        if type(at) is not int or not 0 <= at < len(samplers):
            raise FileError(f"{label}: a channel uses sampler {at!r} of {len(samplers)}")
        sampler = samplers[at]
        how = sampler.get("interpolation", pygltflib.ANIM_LINEAR)
        values = _values(document, sampler, how, path, label)
        groups.setdefault((sampler["input"], how, path), []).append((tree.place[node], values))
    return [
        ((_keys(document, index, label), how), [(path, n, v) for n, v in members])
        for (index, how, path), members in groups.items()
    ]


def _keys(document: Document, index: Any, label: str) -> NDArray:
    keys = read_accessor(document, index, "SCALAR", label)[:, 0]
    if keys.dtype.kind != "f" or not np.isfinite(keys).all() or (np.diff(keys) < 0).any():
        raise FileError(f"{label}: its key times must be ascending numbers of seconds")
    return keys


def _values(document: Document, sampler: Any, how: Any, path: str, label: str) -> NDArray:
    """Return the values at the keys, shape (k, width), or (k, 3, width) for a cubic spline."""
    keys = len(read_accessor(document, sampler.get("input"), "SCALAR", label))
    kind = "VEC4" if path == "rotation" else "VEC3"
    values = read_accessor(document, sampler.get("output"), kind, label)
    if how not in (
        pygltflib.ANIM_LINEAR,
        pygltflib.ANIM_STEP,
        pygltflib.ANIM_CUBICSPLINE,
    ):
        raise FileError(f"{label}: the interpolation {how!r} is none of glTF's")
    each = 3 if how == pygltflib.ANIM_CUBICSPLINE else 1
    if len(values) != keys * each:
        raise FileError(f"{label}: {keys} keys need {keys * each} values, {len(values)} are there")
    return values.reshape(keys, 3, -1) if each == 3 else values


class _Subtree:
    """The joints and all above them, numbered parents first."""

    def __init__(self, nodes: Nodes, needed: list[int]) -> None:
        wanted = set(needed)
        order = [int(i) for level in nodes.levels for i in level if int(i) in wanted]
        self.place = {node: k for k, node in enumerate(order)}
        self.parents = np.array([self.place.get(nodes.parents[i], -1) for i in order])
        self.rest = {
            "translation": nodes.translation[order],
            "rotation": nodes.rotation[order],
            "scale": nodes.scale[order],
        }
        self.local = nodes.local[order]
        depth = np.zeros(len(order), int)
        for k, parent in enumerate(self.parents):
            depth[k] = depth[parent] + 1 if parent >= 0 else 0
        self.levels = [np.flatnonzero(depth == d) for d in range(depth.max() + 1)]

    def worlds(self, tracks: list, times: NDArray, label: str) -> NDArray:
        """Return world matrices, shape (f, k, 4, 4)."""
        shape = (len(times),)
        posed = {k: np.tile(v, (*shape, 1, 1)) for k, v in self.rest.items()}
        moved = np.zeros(len(self.parents), bool)
        for (keys, how), members in tracks:
            path = members[0][0]
            at = [n for _, n, _ in members]
            values = np.stack([v for _, _, v in members], axis=1)
            posed[path][:, at] = sample(keys, values.astype(np.float64), how, times, path)
            moved[at] = True
        world = np.tile(self.local, (*shape, 1, 1, 1))
        world[:, moved] = compose(
            posed["translation"][:, moved], posed["rotation"][:, moved], posed["scale"][:, moved]
        )
        for level in self.levels[1:]:
            world[:, level] = world[:, self.parents[level]] @ world[:, level]
        return world


def sample(keys: NDArray, values: NDArray, how: str, times: NDArray, path: str) -> NDArray:
    """Sample channels with common keys.

    Parameters
    ----------
    keys : array, shape (k,), seconds
    values : array, shape (k, c, width), or (k, c, 3, width) for a cubic spline
        A spline's three are in-tangent, value, out-tangent.
    how : {"LINEAR", "STEP", "CUBICSPLINE"}
    times : array, shape (f,), seconds
        Held at the first and last key outside of them.
    path : {"translation", "rotation", "scale"}

    Returns
    -------
    array, shape (f, c, width)
    """
    left = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, len(keys) - 1)
    right = np.minimum(left + 1, len(keys) - 1)
    span = keys[right] - keys[left]
    u = np.divide(times - keys[left], span, out=np.zeros(len(times)), where=span > 0)
    u = np.clip(u, 0, 1)[:, None, None]
    if how == pygltflib.ANIM_STEP:
        return values[left]
    if how == pygltflib.ANIM_CUBICSPLINE:
        return _hermite(values[left], values[right], span[:, None, None], u)
    if path == "rotation":
        return _slerp(values[left], values[right], u)
    return values[left] * (1 - u) + values[right] * u


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
