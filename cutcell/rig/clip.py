"""Clips: how the joints of a rig move, sampled when somebody looks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import assign
from ..errors import ParameterError
from .transforms import composed, relative


class Motion(Protocol):
    """Source of a clip: the channels of a file, frames, or anything else."""

    @property
    def joints(self) -> int:
        """How many joints it moves."""

    @property
    def duration(self) -> float:
        """Length in seconds."""

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the frames that show it, shape (f,), seconds, ascending from 0."""

    def sample(self, seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the skinning matrices at times (f,) from 0 to `duration`: (f, j, 4, 4)."""


@runtime_checkable
class Movable(Protocol):
    """A motion that can be adapted to joints with another rest position."""

    def moved(self, by: NDArray[np.float64]) -> Motion:
        """Return it for joints that were moved; see `Clip.moved`."""


class Derived:
    """Times and joints of something made of a motion."""

    motion: Motion

    @property
    def duration(self) -> float:
        """Length in seconds."""
        return self.motion.duration

    @property
    def joints(self) -> int:
        """How many joints it moves."""
        return self.motion.joints

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the frames that show it, shape (f,), seconds, ascending from 0.

        A file's clip has up to 30 a second and 3,600 in all.
        """
        return self.motion.times


@dataclass(frozen=True, eq=False, init=False)
class Clip(Derived):
    """A motion of a rig's joints.

    It holds what its file holds, and is sampled when it is played: `sample` does so at any times,
    `cutcell.pose.pose_at` over and over. Made from frames, it is mixed linearly between them.

    Parameters
    ----------
    name : str
    times : array_like, shape (f,), float64, optional
        Seconds, ascending from 0.
    transforms : array_like, shape (f, j, 4, 4), float64, optional
        Skinning matrices: they take a point of the rest mesh, held by one joint, to where it is
        at that time.
    motion : Motion, optional
        What to sample, in the place of frames.

    Raises
    ------
    ParameterError
        Frames that do not fit each other, or neither frames nor a motion, or both.
    """

    name: str
    motion: Motion

    def __init__(
        self,
        name: str,
        times: ArrayLike | None = None,
        transforms: ArrayLike | None = None,
        *,
        motion: Motion | None = None,
    ) -> None:
        framed = times is not None and transforms is not None
        if framed == (motion is not None) or (times is None) != (transforms is None):
            raise ParameterError("a clip needs times and transforms, or else a motion")
        assign(self, name=name, motion=motion or Frames(times, transforms))  # type: ignore[arg-type]

    @property
    def transforms(self) -> NDArray[np.float64]:
        """Skinning matrices at `times`, shape (f, j, 4, 4): 128 bytes a frame and joint.

        A file's clip is sampled again on each access.
        """
        if isinstance(self.motion, Frames):
            return self.motion.transforms
        return self.sample(self.times)

    def sample(self, seconds: ArrayLike) -> NDArray[np.float64]:
        """Return the skinning matrices at some times.

        Parameters
        ----------
        seconds : array_like, shape () or (f,), float64
            The motion stands still before 0 and after `duration`.

        Returns
        -------
        array, shape (j, 4, 4) or (f, j, 4, 4), float64

        Raises
        ------
        ParameterError
            A time that is not finite, or a clip without frames.
        CutcellError
            What the file holds leads to matrices that are not finite.
        """
        times = np.asarray(seconds, np.float64)
        if not np.isfinite(times).all():
            raise ParameterError(f"seconds must be finite numbers, not {seconds!r}")
        at = np.clip(times.reshape(-1), 0, self.duration)
        return self.motion.sample(at).reshape(*times.shape, self.joints, 4, 4)

    def moved(self, parents: NDArray[np.int32], by: NDArray[np.float64]) -> Clip:
        """Return the same motion of joints that stand elsewhere at rest.

        Each turns as before, about its new place. Where it shifts against its parent it
        shifts by as much as before.

        Parameters
        ----------
        parents : array, shape (j,), int32
        by : array, shape (j, 3), float64
            How far each was moved.
        """
        motion = self.motion
        if not isinstance(motion, Movable):
            motion = Rebased(motion, parents, parents, np.arange(len(by)), np.zeros_like(by))
        return Clip(self.name, motion=motion.moved(by))


class Frames:
    """A motion given as skinning matrices (f, j, 4, 4) at times (f,)."""

    def __init__(self, times: ArrayLike, transforms: ArrayLike) -> None:
        self.times = np.array(times, np.float64)
        self.transforms = np.array(transforms, np.float64)
        shape = self.transforms.shape
        if len(shape) != 4 or self.times.shape != shape[:1] or shape[2:] != (4, 4):
            raise ParameterError(
                f"transforms have the shape {shape}, but times, {self.times.shape}, need "
                "(f, j, 4, 4) for (f,)"
            )
        self.times.flags.writeable = self.transforms.flags.writeable = False

    @property
    def joints(self) -> int:
        """How many joints it moves."""
        return self.transforms.shape[1]

    @property
    def duration(self) -> float:
        """Length in seconds."""
        return float(self.times[-1]) if len(self.times) else 0.0

    def sample(self, seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the skinning matrices at times, mixed linearly between frames."""
        if not len(self.times):
            raise ParameterError("a clip without frames cannot be played")
        final = len(self.times) - 1
        right = np.searchsorted(self.times, seconds, side="right").clip(min(1, final), final)
        left = np.maximum(right - 1, 0)
        span = self.times[right] - self.times[left]
        # Without a span it is the end, at which several frames may stand: the last one holds.
        gone = np.divide(seconds - self.times[left], span, out=0 * span + 1, where=span > 0)
        share = gone.clip(0, 1)[:, None, None, None]
        return (1 - share) * self.transforms[left] + share * self.transforms[right]


@dataclass(frozen=True, eq=False)
class Rebased(Derived):
    """A motion adapted to other rest positions or other parents.

    A joint of that motion keeps its motion relative to its parent; others do not move against
    theirs.
    """

    motion: Motion
    before: NDArray[np.int32]  # (i,): parents of the joints of `motion`
    parents: NDArray[np.int32]  # (j,)
    origin: NDArray[np.integer]  # (j,): which joint of `motion` each one is, -1 for none
    by: NDArray[np.float64]  # (j, 3): how far each was moved

    @property
    def joints(self) -> int:
        """How many joints it moves."""
        return len(self.origin)

    def moved(self, by: NDArray[np.float64]) -> Rebased:
        """Return it for joints that were moved again."""
        if not isinstance(self.motion, Movable):
            return replace(self, by=self.by + by)
        inner, has_origin = np.zeros((len(self.before), 3)), self.origin >= 0
        inner[self.origin[has_origin]] = by[has_origin]
        return replace(self, motion=self.motion.moved(inner))

    def sample(self, seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return skinning matrices at some times, shape (f, j, 4, 4)."""
        before = relative(self.motion.sample(seconds), self.before)
        local = np.tile(np.eye(4), (len(before), len(self.origin), 1, 1))
        has_origin = self.origin >= 0
        local[:, has_origin] = before[:, self.origin[has_origin]]
        local[..., :3, 3] += self.by - np.einsum("fjab,jb->fja", local[..., :3, :3], self.by)
        return composed(local, self.parents)
