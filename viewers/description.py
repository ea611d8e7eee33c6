"""Description of a scene as plain data: named actors, a pose, a cut. Nothing here draws."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from cutcell.io.materials.face_colors import FaceColors
from cutcell.runtime.repr import Summarized

from .palette import BODY, REPLACEABLE, Color
from .skin import Blending, Skin

if TYPE_CHECKING:
    from pyvista import DataSet


@dataclass(frozen=True, eq=False)
class Apart:
    """A second skin, to colour points by the distance between their positions in both.

    Parameters
    ----------
    skin : Skin
    unit : float
        The value of a length of 1 in the scene.
    """

    skin: Skin
    unit: float = 1.0


@dataclass(frozen=True, eq=False)
class Reading:
    """Value shown for the point under the pointer.

    Parameters
    ----------
    text : str
        The label before the value.
    values : array, shape (n,) or (m,), float32, optional
        One for each point of a surface, or for each cell of lines; the actor's scalars by default.
    names : tuple of str
        Names that the value is an index into.
    percent : bool
        Whether the value is a share, shown in percent.
    unit : float
        Factor of the value.
    """

    text: str = ""
    values: NDArray[Any] | None = None
    names: tuple[str, ...] = ()
    percent: bool = False
    unit: float = 1.0

    def __post_init__(self) -> None:
        _convert(self, "values", np.float32)


@dataclass(frozen=True, eq=False)
class Actor:
    """One thing in a scene.

    Parameters
    ----------
    kind : {"surface", "lines", "points"}
    points : array, shape (n, 3), float32
        At rest, in the scene's space, where y is up.
    cells : array, shape (m, 3), (m, 2) or (m, 1), int32
        Triangles, segments or points, by the kind.
    normals : array, shape (n, 3), float32, optional
        At rest. Without them a surface is shaded flat.
    color : tuple of float
        Used where neither `colors` nor `scalars` are given.
    colors : array, shape (n, 3), uint8, optional
        A colour for each point.
    scalars : array, shape (n,), float32, optional
        A value for each point, shown through `colormap` between `limits`.
    materials : FaceColors, optional
        Colours of the faces of a surface instead, by the description's `images`.
    skin : Skin, optional
        Joints that the points follow; without it they stand still.
    apart : Apart, optional
        In a pose, the scalars are the distances between the positions by `skin` and by this.
    width : float
        Of lines and points, in pixels of the screen, from far.
    thick : float
        Their radius in the scene, where that is more on the screen, up to six times as much.
    dash : float
        Length of a dash of lines and the gap after it, in the scene; 0 for none.
    form : {"round", "square", "triangle"}
        Of points.
    view : int, optional
        The scene's view that shows it; all of them by default.
    overlay : bool
        Drawn over all that is no overlay, as bones are.
    behind : bool
        Gives way where it coincides with another surface.
    closed : bool
        Whether the surface hides its inside: its back need not be drawn.
    edges : bool
        Whether the edges of a surface's triangles are drawn on it.
    hull : bool
        Only faces that look away are drawn: an outline of the enclosed parts.
    clipped : bool
        Whether the scene's cut clips it.
    slab : float
        Depth behind the cut that is kept; 0 keeps all.
    reading : Reading, optional
        Value shown where the pointer rests on it.
    follows_wavefront : bool
        Whether only scalars up to the description's `front` are coloured.
    """

    kind: Literal["surface", "lines", "points"]
    points: NDArray[Any]
    cells: NDArray[Any]
    normals: NDArray[Any] | None = None
    color: Color = BODY
    colors: NDArray[np.uint8] | None = None
    scalars: NDArray[Any] | None = None
    colormap: str = "weight"
    limits: tuple[float, float] = (0.0, 1.0)
    materials: FaceColors | None = None
    opacity: float = 1.0
    width: float = 1.0
    thick: float = 0.0
    dash: float = 0.0
    form: Literal["round", "square", "triangle"] = "round"
    visible: bool = True
    overlay: bool = False
    behind: bool = False
    closed: bool = False
    edges: bool = False
    hull: bool = False
    clipped: bool = True
    slab: float = 0.0
    skin: Skin | None = None
    apart: Apart | None = None
    view: int | None = None
    reading: Reading | None = None
    follows_wavefront: bool = False

    def __post_init__(self) -> None:
        for name in ("points", "normals", "scalars"):
            _convert(self, name, np.float32)
        _convert(self, "cells", np.int32)

    @classmethod
    def solid(cls, points: NDArray[Any], faces: NDArray[Any], **settings: Any) -> Actor:
        """Return a surface that no cut clips."""
        return cls("surface", points, faces, **{"clipped": False, **settings})

    @classmethod
    def segments(cls, ends: NDArray[Any], **settings: Any) -> Actor:
        """Return lines between pairs of points, shape (s, 2, 3), that no cut clips."""
        cells = np.arange(2 * len(ends)).reshape(-1, 2)
        return cls("lines", ends.reshape(-1, 3), cells, **{"clipped": False, **settings})

    @classmethod
    def dots(cls, points: NDArray[Any], **settings: Any) -> Actor:
        """Return points that no cut clips."""
        cells = np.arange(len(points))[:, None]
        return cls("points", points, cells, **{"clipped": False, **settings})

    def points_in(
        self, pose: NDArray[np.float64] | None, blending: Blending = "linear"
    ) -> NDArray[Any]:
        """Return the points in a pose of the joints, shape (n, 3); at rest for None."""
        if pose is None or self.skin is None:
            return self.points
        return self.skin.move(self.points, pose, blending)

    @classmethod
    def from_polydata(cls, mesh: DataSet, scalars: str | None = None, **settings: Any) -> Actor:
        """Return a PyVista mesh as an actor.

        Parameters
        ----------
        mesh : pyvista.DataSet
            Its surface, if it is not a `pyvista.PolyData`.
        scalars : str, optional
            An array of its points or cells: colours if it has bytes in three or four columns,
            else values, or vectors for their lengths.
        **settings
            Other parameters of an actor, such as `colormap` or `opacity`.

        Returns
        -------
        Actor
        """
        from .polydata import arrays_of

        return cls(**{**arrays_of(mesh, scalars), **settings})


@dataclass(frozen=True)
class Cut:
    """A plane that clips the side its normal points to."""

    origin: tuple[float, float, float]
    normal: tuple[float, float, float]


@dataclass(frozen=True)
class Legend:
    """The title, colour map and numbers at its ends that explain the colours.

    Instead of a map, or below it, there may be `swatches`: colours and their meanings.
    """

    title: str
    colormap: str = ""
    low: str = ""
    high: str = ""
    swatches: tuple[tuple[Color, str], ...] = ()


@dataclass(frozen=True, eq=False, repr=False)
class Description(Summarized):
    """A whole scene.

    Parameters
    ----------
    actors : dict of str to Actor
    pose : array, shape (j, 4, 4), float64, optional
        Skinning matrices in the scene's space; None at rest.
    cut : Cut, optional
    legend : Legend, optional
    views : tuple of str
        Captions of the views side by side under one camera; a single view has none.
    front : float, optional
        Scalars above it are grey on the actors that follow the wavefront.
    images : array, shape (k, s, s, 4), uint8, optional
        Images of the actors' `materials`; see `materials.Textures`.
    blending : {"linear", "dual"}
        Of the pose's matrices, or of their dual quaternions.
    """

    actors: dict[str, Actor] = field(default_factory=dict)
    pose: NDArray[np.float64] | None = None
    cut: Cut | None = None
    legend: Legend | None = None
    views: tuple[str, ...] = ()
    front: float | None = None
    images: NDArray[np.uint8] | None = None
    blending: Blending = "linear"

    @property
    def _summary(self) -> dict[str, Any]:
        return {
            "actors": tuple(self.actors),
            "views": self.views,
            "legend": self.legend.title if self.legend else None,
            "is_posed": self.pose is not None,
            "is_cut": self.cut is not None,
        }

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of all actors at rest but overlays, shape (2, 3).

        Bones, which are overlays, may reach far out of the body.
        """
        points = [a.points for a in self.actors.values() if len(a.points) and not a.overlay]
        if not points:
            return np.array([[-1.0, -1, -1], [1, 1, 1]])
        low = np.min([p.min(axis=0) for p in points], axis=0)
        return np.stack([low, np.max([p.max(axis=0) for p in points], axis=0)]).astype(float)


def _convert(owner: object, name: str, kind: type[np.generic]) -> None:
    """Set an array of a frozen dataclass to its own type; arrays of that type stay the same."""
    array = getattr(owner, name)
    if array is not None:
        object.__setattr__(owner, name, np.ascontiguousarray(array, kind))


def with_colormap(description: Description, name: str) -> Description:
    """Return a scene whose weights, distances and depths have the colours of another map."""
    if name == "default":
        return description
    actors, legend = dict(description.actors), description.legend
    for key, actor in actors.items():
        if actor.scalars is not None and actor.colormap in REPLACEABLE:
            actors[key] = replace(actor, colormap=f"{actor.colormap}:{name}")
    if legend is not None and legend.colormap in REPLACEABLE:
        legend = replace(legend, colormap=f"{legend.colormap}:{name}")
    return replace(description, actors=actors, legend=legend)


def in_view(description: Description, view: int) -> Description:
    """Return a scene with the actors of one of its views alone."""
    actors = {k: a for k, a in description.actors.items() if a.view in (None, view)}
    return replace(description, actors=actors)
