"""The prior by the interface that networks call today: `voxel_skin` of UniRig and SkinTokens.

Distances run through the cut-cell graph in place of a grid of voxels; falloff, units and results
are those of the original.
"""

from __future__ import annotations

import hashlib
import io
import os
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import check_choice, check_number
from .errors import ParameterError
from .geodesics import bone_distances
from .graph import build_graph
from .method import ALPHA, PAPER, Method, MethodName, method_of
from .rig import Skeleton, TriangleMesh
from .runtime.sources import PACKAGE, source_digest
from .runtime.writing import write_all
from .weights.paper_kernel import paper_kernel

__all__ = ["VertexGroupVoxelSkin", "voxel_skin"]

Mode = Literal["square", "exp"]

LEAST_DISTANCE = 1e-6
"""Smallest distance, in half longest sides, as in the original."""
STEEPNESS = 20.0
"""Factor of the exponential falloff, as in the original."""


def voxel_skin(
    grid: int | None = None,
    grid_coords: ArrayLike | None = None,
    joints: ArrayLike = (),
    vertices: ArrayLike = (),
    faces: ArrayLike = (),
    alpha: float = ALPHA,
    link_dis: float = 1e-5,
    grid_query: int = 27,
    vertex_query: int = 27,
    grid_weight: float = 3.0,
    voxel_size: float | None = None,
    mode: Mode = "square",
    parents: Sequence[int | None] | NDArray[np.integer] | None = None,
    *,
    method: Method | MethodName = PAPER,
    cache: str | os.PathLike[str] | None = None,
) -> NDArray[np.floating]:
    """Compute the prior of a network: weights by distances through the cut-cell graph.

    It takes the arguments of `voxel_skin` of UniRig and SkinTokens by the same names and returns
    the same kind of weights.

    Parameters
    ----------
    grid, grid_coords, link_dis, grid_query, vertex_query, grid_weight, voxel_size
        Accepted and ignored: the cut-cell graph needs no voxels.
    joints : array_like, shape (J, 3)
    vertices : array_like, shape (N, 3)
        In [-1, 1], as the original wants them: centred, and divided by half of the longest side.
        Any other units work, but `alpha` counts distances in the units of the vertices.
    faces : array_like, shape (F, 3)
    alpha : float
        Smoothness of the falloff, 0 to 1; see `mode`.
    mode : "square" or "exp"
        With a distance d and the largest distance m: (1 / ((1 - alpha) d + alpha d^2))^2, equation
        1 of the paper without its division by the diagonal; or exp(-20 d / m).
    parents : sequence of int or None, shape (J,), optional
        Index of the parent of each joint; -1 or None for a root. With it a joint's bones lead to
        its children; without it joints are points.
    method : Method, "animation" or "paper"
        Resolution and connectivity of the graph; the falloff is that of `mode`.
    cache : path, optional
        Folder of earlier results, keyed by all arguments that count and by cutcell's code. Any
        number of processes may share it.

    Returns
    -------
    array, shape (N, J)
        Rows sum to one. float64 if `vertices` or `joints` are float64, else float32.

    Raises
    ------
    ParameterError
        `alpha` or `mode` is out of its range, or `faces` is missing.
    MeshError, SkeletonError
        The arrays are no mesh or no skeleton; the sentence says why.
    FileError
        The cache cannot be written.

    References
    ----------
    Paper section 3.2 and equation 1; Dionne and de Lasa 2013 for the falloff.

    Examples
    --------
    >>> skin *= cutcell.priors.voxel_skin(  # doctest: +SKIP
    ...     joints=joints, vertices=vertices, faces=faces, parents=parents)
    >>> skin /= skin.sum(axis=1, keepdims=True)  # doctest: +SKIP
    """
    check_choice("mode", mode, get_args(Mode))
    alpha = check_number("alpha", alpha, 0, 1)
    method = method_of(method)
    given = np.asarray(vertices), np.asarray(joints)
    mesh = TriangleMesh(np.asarray(given[0], np.float64), np.asarray(faces))
    skeleton = Skeleton(np.asarray(given[1], np.float64), _parents(parents, len(given[1])))
    is_double = np.float64 in (given[0].dtype, given[1].dtype)
    dtype: type[np.floating] = np.float64 if is_double else np.float32
    if cache is None:
        return _prior(mesh, skeleton, method, alpha, mode).astype(dtype)
    path = Path(cache) / f"{_digest(mesh, skeleton, method, alpha, mode, dtype)}.npy"
    stored = _stored(path, (len(mesh.vertices), len(skeleton.joints)))
    if stored is not None:
        return stored
    prior = _prior(mesh, skeleton, method, alpha, mode).astype(dtype)
    packed = io.BytesIO()
    np.save(packed, prior)
    write_all({path: packed.getvalue()})
    return prior


@dataclass(frozen=True)
class VertexGroupVoxelSkin:
    """The vertex group `voxel_skin` of UniRig and SkinTokens, through the cut-cell graph.

    Parameters
    ----------
    grid, link_dis, grid_query, vertex_query, grid_weight
        Accepted and ignored.
    alpha, mode, cache
        See `voxel_skin`.
    bones : bool
        Whether a joint's bones lead to its children, by the `parents` of an asset; by default
        joints are points, as in the original.
    """

    grid: int = 64
    alpha: float = ALPHA
    link_dis: float = 1e-5
    grid_query: int = 27
    vertex_query: int = 27
    grid_weight: float = 3.0
    mode: Mode = "square"
    bones: bool = False
    cache: str | None = None

    @classmethod
    def parse(cls, **kwargs: Any) -> VertexGroupVoxelSkin:
        """Read the entries of a network's configuration that have a field of this name."""
        return cls(**{one.name: kwargs[one.name] for one in fields(cls) if one.name in kwargs})

    def get_vertex_group(self, asset: Any) -> dict[str, NDArray[np.floating]]:
        """Compute the prior of an asset.

        Parameters
        ----------
        asset : object
            Has `vertices`, `faces` and `joints`, in any units, and `parents` for bones.

        Returns
        -------
        dict
            "voxel_skin": array, shape (N, J).

        Raises
        ------
        ParameterError
            The asset lacks one of them.
        MeshError, SkeletonError
            The arrays are no mesh or no skeleton.
        """
        for name in ("vertices", "faces", "joints", *(["parents"] if self.bones else [])):
            if getattr(asset, name, None) is None:
                raise ParameterError(f"the asset has no {name}; the prior needs them")
        vertices, joints = np.asarray(asset.vertices), np.asarray(asset.joints)
        cube = TriangleMesh(np.asarray(vertices, np.float64), np.asarray(asset.faces)).cube
        centre, half = cube.low + cube.size * (0.5 - cube.offset), cube.size / 2

        def normalized(points: NDArray[np.floating]) -> NDArray[np.floating]:
            return ((np.asarray(points, np.float64) - centre) / half).astype(points.dtype)

        skin = voxel_skin(
            joints=normalized(joints),
            vertices=normalized(vertices),
            faces=asset.faces,
            alpha=self.alpha,
            mode=self.mode,
            parents=asset.parents if self.bones else None,
            cache=self.cache,
        )
        return {"voxel_skin": skin}


def _prior(
    mesh: TriangleMesh, skeleton: Skeleton, method: Method, alpha: float, mode: Mode
) -> NDArray[np.float64]:
    """Compute the prior, (n, j)."""
    graph = build_graph(mesh, method.resolution, method=method)
    every = len(skeleton.joints)
    measured = bone_distances(graph, skeleton, method=method, nearest_joints=every, within=np.inf)
    distance = measured.joint * graph.lattice.size
    largest = distance[np.isfinite(distance)].max()
    distance = np.clip(distance, LEAST_DISTANCE, max(largest, LEAST_DISTANCE))
    if mode == "square":
        return paper_kernel(distance, 1.0, alpha)
    skin = np.exp((distance.min(axis=0) - distance) * (STEEPNESS / max(largest, LEAST_DISTANCE)))
    return (skin / skin.sum(axis=0)).T


def _parents(parents: Any, joints: int) -> NDArray[np.int64] | list[int]:
    """Return the parents of joints (j,), -1 for roots; None stands for a root, too."""
    if parents is None:
        return np.full(joints, -1)
    return [-1 if parent is None else int(parent) for parent in parents]


def _digest(mesh: TriangleMesh, skeleton: Skeleton, *options: Any) -> str:
    """Hash all that a prior depends on."""
    digest = hashlib.blake2b(digest_size=16)
    for array in (mesh.vertices, mesh.faces, skeleton.joints, skeleton.parents):
        digest.update(f"{array.shape} {array.dtype}".encode() + np.ascontiguousarray(array).data)
    digest.update(f"{options} {source_digest(PACKAGE)}".encode())
    return digest.hexdigest()


def _stored(path: Path, shape: tuple[int, int]) -> NDArray[np.floating] | None:
    """Read an earlier result; None if there is none, or it is damaged."""
    try:
        prior = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return None
    return prior if isinstance(prior, np.ndarray) and prior.shape == shape else None
