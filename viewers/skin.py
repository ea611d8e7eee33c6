"""Skinning by the largest influences of each point, and distances between two sets of weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from cutcell.pose.dual_quaternions import blended

MAX_INFLUENCES = 8
Blending = Literal["linear", "dual"]
"""Blending of matrices, or of dual quaternions."""


@dataclass(frozen=True, eq=False)
class Skin:
    """Influences of each point, blended as the page does it from the same arrays.

    Parameters
    ----------
    joints : array, shape (n, k), uint16
        The strongest of each row comes first.
    weights : array, shape (n, k), float32
        Rows sum to one, or to zero where a point stands still.
    """

    joints: NDArray[np.uint16]
    weights: NDArray[np.float32]

    @classmethod
    def of_weights(cls, weights: ArrayLike) -> Skin:
        """Return the largest influences of each row of a weight matrix (n, j), renormalised.

        There are as many as the fullest row has, at most 8.
        """
        weights = np.asarray(weights, float)
        count = int(np.clip((weights > 0).sum(axis=1).max(initial=1), 1, MAX_INFLUENCES))
        joints = np.argsort(-weights, axis=1, kind="stable")[:, :count]
        largest = np.take_along_axis(weights, joints, axis=1)
        total = largest.sum(axis=1, keepdims=True)
        largest = np.divide(largest, total, out=np.zeros_like(largest), where=total > 0)
        return cls(joints.astype(np.uint16), largest.astype(np.float32))

    @classmethod
    def rigid(cls, joints: ArrayLike) -> Skin:
        """Return a skin in which every point follows one joint, given as (n,) indices."""
        column = np.asarray(joints).astype(np.uint16)[:, None]
        return cls(column, np.ones(column.shape, np.float32))

    def subset(self, points: NDArray[np.integer]) -> Skin:
        """Return the influences of some points, shape (m,)."""
        return Skin(self.joints[points], self.weights[points])

    def move(
        self, points: ArrayLike, pose: ArrayLike, blending: Blending = "linear"
    ) -> NDArray[np.float64]:
        """Return the positions of points (n, 3) in a pose (j, 4, 4)."""
        points, matrices = np.asarray(points, float), np.asarray(pose, float)
        if blending == "dual":
            return blended(points, self.joints, self.weights, matrices)[0]
        sums = np.einsum("nk,nkab->nab", self.weights, matrices[:, :3][self.joints])
        result = np.einsum("nab,nb->na", sums[:, :, :3], points) + sums[:, :, 3]
        unweighted = self.weights.sum(axis=1) == 0
        result[unweighted] = points[unweighted]
        return result

    def turn(
        self, normals: ArrayLike, pose: ArrayLike, blending: Blending = "linear"
    ) -> NDArray[np.float64]:
        """Return unit normals, shape (n, 3), in a pose (j, 4, 4)."""
        normals, pose = np.asarray(normals, float), np.array(pose, float)
        pose[:, :3, 3] = 0
        if blending == "dual":
            turns = blended(normals, self.joints, self.weights, pose)[1]
            result = Rotation.from_quat(turns).apply(normals)
        else:
            result = self.move(normals, pose)
        length = np.linalg.norm(result, axis=1, keepdims=True)
        return result / np.where(length > 0, length, 1)


class Gap:
    """Distances between the positions that two sets of weights give to each vertex.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        At rest.
    weights, reference : array_like, shape (n, j)
        Rows sum to one, or to zero where a vertex stands still.
    unit : float
        What a distance of 1 counts as.
    blending : {"linear", "dual"}
    """

    def __init__(
        self,
        points: ArrayLike,
        weights: ArrayLike,
        reference: ArrayLike,
        unit: float = 1.0,
        blending: Blending = "linear",
    ) -> None:
        self._points, self._unit = np.asarray(points, np.float32), unit
        self._between = _with_rest(weights) - _with_rest(reference)
        is_linear = blending == "linear"
        self._skins = () if is_linear else tuple(map(Skin.of_weights, (weights, reference)))

    def lengths(self, pose: ArrayLike) -> NDArray[np.float32]:
        """Return the distances in a pose (j, 4, 4), shape (n,)."""
        if self._skins:
            first, second = (skin.move(self._points, pose, "dual") for skin in self._skins)
            return np.asarray(self._unit * np.linalg.norm(first - second, axis=1), np.float32)
        matrices = np.asarray(pose, np.float32)[:, :3].reshape(-1, 12)
        matrices = np.vstack([matrices, np.eye(3, 4, dtype=np.float32).ravel()])
        blended = (self._between @ matrices).reshape(-1, 3, 4)
        displacement = (blended[:, :, :3] @ self._points[:, :, None])[:, :, 0] + blended[:, :, 3]
        return np.asarray(self._unit * np.linalg.norm(displacement, axis=1), np.float32)


def _with_rest(weights: ArrayLike) -> NDArray[np.float32]:
    """Add a joint that never moves, which vertices without weight follow."""
    weights = np.asarray(weights, np.float32)
    return np.hstack([weights, (weights.sum(axis=1, keepdims=True) <= 0).astype(np.float32)])
