"""Inverse bind matrices that contradict the nodes of their joints.

Exporters write the identity, or the matrix of the mesh, for joints that hold no vertex. Such a
joint gets its place from its node, relative to the nearest joint above whose matrix is good. A
root or a control without such a joint above stays at the origin, where roots ordinarily are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...rig.transforms import moved

IN_PLACE = 1e-3
"""How far off a joint is still in its place. Lengths are in sizes of the character."""
ORIGIN = 1e-2
"""A joint so close to the origin of its bind space may have no matrix of its own."""
OUT_OF_PLACE, FARTHER = 0.5, 4.0
"""A matrix of a joint's own is wrong so far off, and so many times as far as those of joints that
hold vertices."""
FRAME_STRETCH, TURN = 0.1, 0.02
"""How much a frame may be stretched by a pose, and turned where there is none."""
SOFT = 0.05
"""Distance of two positions of a character at which one counts little for the other."""
LEAN = 0.15
"""How far a posed character may stand from its topmost joint, which is seldom posed."""
CONFIRMED = 0.05
"""A topmost joint that holds nothing is right if this part of the weight agrees with it."""
HIDDEN_SCALE = 1e-2
"""A joint is hidden that is so small for the largest of its skin."""
MAX_CANDIDATES = 256


@dataclass(eq=False)
class BoundSkin:
    """The joints of a skin, as they were bound and as their nodes are."""

    inverse: NDArray[np.float64]
    """(j, 4, 4): inverse bind matrices, NaN where there is none; `mend` replaces some."""
    shares: NDArray[np.float64]  # (j,): the sum of the vertices' weights on each joint
    world: NDArray[np.float64]  # (j, 4, 4): of the joints' nodes
    relative: NDArray[np.float64]
    """(j, 4, 4): from each joint's node to that of the nearest joint above."""
    parents: list[int]  # the nearest joint above, -1 for none
    order: list[int]  # the joints, parents first
    corners: NDArray[np.float64]  # (2, 3): of the box around the vertices
    nodes: list[int]  # of the joints
    has_binds: bool = True  # inverse bind matrices; without them joints are at their nodes
    mended: NDArray[np.bool_] = field(init=False)  # which joints got another matrix
    stays: dict[int, NDArray[np.float64]] = field(init=False, default_factory=dict)
    """Positions of those of them that stay where their matrix was."""
    is_trusted: NDArray[np.bool_] = field(init=False)
    """Which joints say where the character stands: those that hold vertices, unless hidden."""
    stands: NDArray[np.float64] | None = field(init=False, default=None)
    """From the bind space to the scene, at rest; None where no joint says it."""

    def __post_init__(self) -> None:
        self.mended = np.zeros(len(self.parents), bool)
        self.is_solvable = invertible(self.inverse)
        usable = np.where(self.is_solvable[:, None, None], self.inverse, np.eye(4))
        self.frames = np.linalg.inv(usable)
        self.skinning = self.world @ usable
        size = np.ptp(self.corners, axis=0).max()
        distance = np.linalg.norm(self.frames[:, :3, 3], axis=1)
        self.is_at_origin = self.is_solvable & (distance <= ORIGIN * size)
        self.is_blank = ~self.is_solvable | self.is_at_origin | self._is_repeated()
        self.is_held = (self.shares > 0) & ~np.isnan(self.inverse).all(axis=(1, 2))
        scales = np.abs(np.linalg.det(self.world[:, :3, :3])) ** (1 / 3)
        shows = (
            self.is_solvable & invertible(self.skinning) & (scales > HIDDEN_SCALE * scales.max())
        )
        trusted = self.is_held & shows
        self.is_trusted = trusted if trusted.any() else ~self.is_blank & shows
        at = self.trusted()
        if at:
            self.stands = agreed(self.skinning[at], self.votes(at), self.corners)

    def trusted(self) -> list[int]:
        """Return the joints that say where the character stands, parents first."""
        return [k for k in self.order if self.is_trusted[k]]

    def votes(self, at: list[int]) -> NDArray[np.float64]:
        """Return how much each of some trusted joints counts."""
        shares = self.shares[at]
        return shares if shares.any() else np.ones(len(at))

    def topmost(self) -> int | None:
        """Return the topmost joint whose matrix and node can be inverted and are the file's."""
        usable = self.is_solvable & ~self.mended & invertible(self.skinning)
        return next((k for k in self.order if usable[k]), None)

    def _is_repeated(self) -> NDArray[np.bool_]:
        """Return which joints without vertices share their matrix with another one, shape (j,)."""
        keys = [matrix.tobytes() for matrix in self.inverse]
        is_free = (self.shares <= 0).tolist()
        times = Counter(key for key, free in zip(keys, is_free, strict=True) if free)
        return np.array([free and times[k] > 1 for k, free in zip(keys, is_free, strict=True)])

    @property
    def scale(self) -> float:
        """How many units of the scene a unit of the bind space is."""
        return 1.0 if self.stands is None else float(np.cbrt(abs(np.linalg.det(self.stands))))

    def box(self) -> NDArray[np.float64]:
        """Return the corners of the box in the scene, shape (8, 3)."""
        grid = np.stack(np.meshgrid(*self.corners.T, indexing="ij"), axis=-1).reshape(-1, 3)
        return grid if self.stands is None else moved(grid, self.stands)

    def shifts(self) -> NDArray[np.float64]:
        """Return how far the nodes of trusted joints are from where all stands, in the scene."""
        if self.stands is None:
            return np.zeros(0)
        bound = moved(self.frames[self.is_trusted, :3, 3], self.stands)
        return np.linalg.norm(bound - self.world[self.is_trusted, :3, 3], axis=1)


def mend(skins: Sequence[BoundSkin]) -> None:
    """Give joints without vertices whose matrix contradicts their node another one."""
    if not skins:
        return
    boxes = np.concatenate([skin.box() for skin in skins])
    size = float(np.ptp(boxes, axis=0).max())
    if not size:  # skins without a mesh
        places = np.concatenate([skin.world[:, :3, 3] for skin in skins])
        size = float(np.ptp(places, axis=0).max()) or 1.0
    shifts = np.concatenate([skin.shifts() for skin in skins]) / size
    for skin in skins:
        if skin.is_trusted.any():
            _mend(skin, size / (skin.scale or 1.0), shifts)


def _mend(skin: BoundSkin, size: float, shifts: NDArray[np.float64]) -> None:
    """Mend a skin of a size; `shifts` are those of all trusted joints, in sizes."""
    below = _first_below(skin)
    shift = float(shifts.max())
    far = _far_limit(skin, size, shift)
    is_good = skin.is_held | ~skin.is_blank
    has_children = np.zeros(len(is_good), bool)
    has_children[[parent for parent in skin.parents if parent >= 0]] = True
    for k in skin.order:
        parent = skin.parents[k]
        is_below_good = parent >= 0 and bool(is_good[parent])
        is_good[k] |= is_below_good
        if skin.is_held[k]:
            continue
        if is_below_good:
            frame = skin.frames[parent] @ skin.relative[k]
        else:
            assert skin.stands is not None
            stands = skin.skinning[below[k]] if below[k] >= 0 else skin.stands
            frame = np.linalg.inv(stands) @ skin.world[k]
        tolerance = IN_PLACE if is_below_good else max(SOFT, 2 * shift)
        tolerance = tolerance if skin.is_blank[k] else far
        if skin.is_solvable[k] and not _contradicts(skin, k, frame, size, shift, tolerance):
            continue
        if not is_below_good and skin.is_at_origin[k] and (parent >= 0 or has_children[k]):
            skin.stays[k] = skin.frames[k, :3, 3].copy()
        if not invertible(frame):  # it is scaled to nothing, to be hidden
            frame = frame.copy()
            frame[:3, :3] = skin.frames[parent][:3, :3] if is_below_good else np.eye(3)
        skin.frames[k], skin.mended[k] = frame, True
        skin.inverse[k] = np.linalg.inv(frame)


def _first_below(skin: BoundSkin) -> list[int]:
    """Return for each joint the first trusted one below it, -1 for none."""
    first = [-1] * len(skin.parents)
    for k in skin.order:
        above = skin.parents[k]
        while skin.is_trusted[k] and above >= 0 and first[above] < 0:
            first[above] = k
            above = skin.parents[above]
    return first


def _far_limit(skin: BoundSkin, size: float, shift: float) -> float:
    """Return the distance beyond which a stored matrix of a joint is wrong."""
    limit = max(OUT_OF_PLACE, FARTHER * shift)
    stored = np.flatnonzero(~skin.is_held & ~skin.is_blank)
    if skin.stands is None or not len(stored):
        return limit
    bound = moved(skin.frames[stored, :3, 3], skin.stands)
    off = np.linalg.norm(bound - skin.world[stored, :3, 3], axis=1) / (size * skin.scale)
    # Where many are off, these nodes are in no pose of the bound character.
    return limit if (off > limit).sum() <= skin.is_trusted.sum() / 2 else np.inf


def _contradicts(
    skin: BoundSkin, k: int, frame: NDArray, size: float, shift: float, tolerance: float
) -> bool:
    """Return whether a joint's matrix is not what its node says, `frame` (4, 4), nor a pose."""
    bound = skin.frames[k]
    off = np.linalg.norm(frame[:3, 3] - bound[:3, 3]) / size
    if off > tolerance:
        return True
    if not skin.is_blank[k] or not invertible(frame):
        return False
    change = np.linalg.solve(frame[:3, :3], bound[:3, :3])
    stretch = np.abs(np.linalg.svd(change, compute_uv=False) - 1).max()
    turn = np.abs(change - np.eye(3)).max()
    return bool(stretch > FRAME_STRETCH or (turn > TURN and shift <= ORIGIN))


@np.errstate(over="ignore")  # the box may have no extent
def rest_world(
    matrices: NDArray, shares: NDArray, topmost: NDArray | None, is_control: bool, corners: NDArray
) -> NDArray[np.float64]:
    """Return the one of matrices (j, 4, 4) on which most of the vertices' weight (j,) agrees.

    Without a majority, in a pose, the topmost joint's (4, 4) is taken if it is much the same. A
    control above all is believed if the feet, say, agree with it.
    """
    chosen = agreed(matrices, shares, corners)
    if topmost is None:
        return chosen
    parts = [
        shares[apart(matrices, one, corners) <= ORIGIN].sum() / shares.sum()
        for one in (topmost, chosen)
    ]
    if is_control and parts[0] >= CONFIRMED:
        return topmost
    if parts[1] >= 0.5:
        return chosen
    return topmost if apart(topmost[None], chosen, corners)[0] <= LEAN else chosen


@np.errstate(over="ignore")
def agreed(matrices: NDArray, shares: NDArray, corners: NDArray) -> NDArray[np.float64]:
    """Return the one of matrices (j, 4, 4) with which most shares (j,) agree in moving a box."""
    heaviest = np.sort(np.argsort(-shares, kind="stable")[:MAX_CANDIDATES])
    near = [np.exp(-apart(matrices, matrices[k], corners) / SOFT) for k in heaviest.tolist()]
    scores = np.array([(shares * one).sum() for one in near])
    first = int(np.flatnonzero(scores >= scores.max() * (1 - IN_PLACE))[0])
    return matrices[heaviest[first]]


def apart(matrices: NDArray, other: NDArray, corners: NDArray) -> NDArray[np.float64]:
    """Return how far matrices move a box (2, 3) from where another moves it, in its sizes, (j,)."""
    box = np.eye(4)
    box[:3, :3] = np.diag(np.maximum(np.ptp(corners, axis=0) / 2, np.finfo(float).tiny))
    box[:3, 3] = corners.mean(axis=0)
    placed, reference = (matrices @ box)[:, :3], (other @ box)[:3]
    sizes = np.linalg.norm(placed[..., :3], axis=(1, 2))
    sizes = np.maximum(np.maximum(sizes, np.linalg.norm(reference[:, :3])), np.finfo(float).tiny)
    return np.linalg.norm(placed - reference, axis=(1, 2)) / sizes


def invertible(matrices: NDArray) -> NDArray[np.bool_]:
    """Return which matrices, shape (..., 4, 4), can be inverted."""
    linear = matrices[..., :3, :3]
    with np.errstate(over="ignore", invalid="ignore"):
        size = np.linalg.norm(linear, axis=-2).prod(axis=-1)
        finite = np.isfinite(matrices).all(axis=(-2, -1)) & np.isfinite(size)
        return finite & (size > 0) & (np.abs(np.linalg.det(linear)) > 1e-9 * size)
