"""The skeleton of one file for the mesh of another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileError, SkeletonError
from ..rig import Clip, Rig, Skeleton
from ..rig.transforms import moved
from .files import naming
from .formats import BY_SUFFIX, described, suffixes
from .gltf.container import Document
from .gltf.influences import read_deform
from .gltf.nodes import Nodes
from .gltf.read.added_skins import has_volume
from .gltf.read.bones import BOX_MARGIN, find_bones
from .gltf.read.clips import read_clips
from .gltf.read.skins import Bind, read_bind, read_skeleton
from .weights import with_deform

SIMILAR = 0.5
"""The scene's places are chosen unless those in the bind space fit better than by this factor."""
MIN_FIT = 0.2
"""Below it the user is warned."""


class SkeletonFile(NamedTuple):
    """What a file has of a skeleton."""

    skeleton: Skeleton
    world: NDArray[np.float64] = np.eye(4)  # (4, 4): from the skeleton's space to the scene
    stored: NDArray[np.int8] | None = None  # (j,): which joints deform, see `with_deform`
    clips: Sequence[tuple[Clip, ...]] = ((), ())  # in the scene, and in the skeleton's space


def with_skeleton(rig: Rig, path: Path) -> Rig:
    """Return a mesh without joints with the skeleton and clips of a file.

    They are placed as in its scene or in its mesh's space, whichever has more joints in the mesh:
    programs differ in units and axes.
    """
    with naming(path):
        kind = path.suffix.lower()
        if kind not in suffixes("read_skeleton"):
            readable = described("read_skeleton")
            raise FileError(f'no skeleton can be read from "{kind}"; give {readable}')
        skeleton, world, stored, clips = BY_SUFFIX[kind].module.read_skeleton(path)
        if not len(skeleton.joints):
            raise SkeletonError(
                "has no joints: neither a skin, nor nodes that are bones. Give a file with an "
                "armature"
            )
    choices = _in_scene(skeleton, world), skeleton
    fits = [_fit(rig, choice) for choice in choices]
    chosen = 0 if fits[0] >= SIMILAR * fits[1] else 1
    skeleton = choices[chosen]
    warnings = list(rig.warnings)
    if fits[chosen] < MIN_FIT:
        warnings.append(
            f"the joints of {path.name} do not fit the mesh: {_extent(skeleton.joints)} for "
            f"{_extent(rig.mesh.vertices)}. Give the two files the same scale, axes and origin"
        )
    skeleton, _, notes = with_deform(rig.mesh, skeleton, None, stored)
    return replace(rig, skeleton=skeleton, clips=clips[chosen], warnings=(*warnings, *notes))


def _in_scene(skeleton: Skeleton, world: NDArray[np.float64]) -> Skeleton:
    """Return a skeleton moved by a matrix (4, 4)."""
    joints, turned = moved(skeleton.joints, world), skeleton.orientations
    if turned is not None:
        left, _, right = np.linalg.svd(world[:3, :3])
        turned = left @ right @ turned
    return replace(skeleton, joints=joints, orientations=turned)


def _fit(rig: Rig, skeleton: Skeleton) -> float:
    """Return how well joints fit a mesh: the share near it, times the ratio of sizes below one."""
    low, high = rig.mesh.bounds
    size, extent = np.linalg.norm(high - low), np.linalg.norm(np.ptp(skeleton.joints, axis=0))
    margin = BOX_MARGIN * size
    inside = (skeleton.joints >= low - margin) & (skeleton.joints <= high + margin)
    ratio = 1.0 if len(skeleton.joints) == 1 else min(extent, size) / max(extent, size)
    return float(inside.all(axis=1).mean() * ratio)


def _extent(points: NDArray[np.float64]) -> str:
    """Return the box of points (n, 3) in words."""
    low, high = points.min(axis=0), points.max(axis=0)
    corners = (" ".join(f"{x:.3g}" for x in corner) for corner in (low, high))
    return " to ".join(f"({corner})" for corner in corners)


def of_document(
    document: Document, bones: list[int] | None = None, world: NDArray | None = None
) -> SkeletonFile:
    """Return the joints of a document's skins, else its bones, which a scene lists."""
    nodes = Nodes(document)
    skins, bind = list(range(len(document.items("skins")))), Bind()
    if skins:
        bind = read_bind(document, nodes, skins, world)
    else:
        joints = find_bones(document, nodes).joints if bones is None else bones
        bind.nodes = [i for i in joints if has_volume(nodes.world[i])]
        if bones is not None:  # of a scene, whose root leads from the file's units and axes
            bind.world = nodes.world[0]
        bind.inverse = [np.linalg.inv(nodes.world[i]) @ bind.world for i in bind.nodes]
    if not bind.nodes:
        return SkeletonFile(Skeleton([], []), bind.world)  # type: ignore[arg-type]
    stored = read_deform(document, bind.skins, len(bind.nodes))
    inverse, back = np.array(bind.inverse), np.linalg.inv(bind.world)
    clips = (
        read_clips(document, nodes, bind.nodes, inverse @ back, np.eye(4)),
        read_clips(document, nodes, bind.nodes, inverse, bind.world),
    )
    return SkeletonFile(read_skeleton(nodes, bind), bind.world, stored, clips)
