"""Description of a scene as plain data: named actors, a pose, a cut. Nothing here draws."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from cutcell.io.materials.face_colors import FaceColors
from cutcell.runtime.repr import Summarized

from .palette import BODY, Color
from .skin import Skin

if TYPE_CHECKING:
    from pyvista import DataSet


@dataclass(frozen=True, eq=False)
class Apart:
    """A second skin, to colour points by how far it takes them from where the first does.

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
        One for each point of a surface, or for each cell of lines; the actor's scalars when
        left out.
    names : tuple of str
        Where there are any, the value is an index into these.
    percent : bool
        Whether the value is a share, shown in percent.
    unit : float
        What a value of 1 is in the unit that is shown.
    """

    text: str = ""
    values: NDArray[np.float32] | None = None
    names: tuple[str, ...] = ()
    percent: bool = False
    unit: float = 1.0


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
        What colours the faces of a surface instead, by the description's `images`.
    skin : Skin, optional
        How the points follow the joints; without it they stand still.
    apart : Apart, optional
        While there is a pose, the scalars are the distances between where `skin`
        and this one take each point.
    width : float
        Of lines and points, in pixels of the screen, from far.
    thick : float
        Their radius in the scene, where that is more on the screen, up to six times as much.
    dash : float
        Lines are dashed: the length of a dash and the gap after it, in the scene; 0 for none.
    form : {"round", "square", "triangle"}
        Of points.
    view : int, optional
        Which of the scene's views shows it; all of them when left out.
    overlay : bool
        Drawn over all that is no overlay, as bones are.
    behind : bool
        Gives way where it coincides with another surface.
    closed : bool
        Whether the surface has an inside, which is not seen: its back need not be drawn.
    edges : bool
        Whether the edges of a surface's triangles are drawn on it.
    hull : bool
        Only faces that look away are drawn: an outline of what it encloses.
    clipped : bool
        Whether the scene's cut clips it.
    slab : float
        Keep only what lies less than this far behind the cut; 0 keeps all.
    reading : Reading, optional
        Value shown where the pointer rests on it.
    film : bool
        Whether only scalars up to the description's `front` are coloured.
    """

    kind: Literal["surface", "lines", "points"]
    points: NDArray[np.float32]
    cells: NDArray[np.int32]
    normals: NDArray[np.float32] | None = None
    color: Color = BODY
    colors: NDArray[np.uint8] | None = None
    scalars: NDArray[np.float32] | None = None
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
    film: bool = False

    @classmethod
    def from_polydata(cls, mesh: DataSet, scalars: str | None = None, **settings: Any) -> Actor:
        """Return a PyVista mesh as an actor.

        Parameters
        ----------
        mesh : pyvista.DataSet
            Of anything but `pyvista.PolyData` the surface is taken.
        scalars : str, optional
            An array of its points or cells: colours if it holds bytes in three or four columns,
            else values, of vectors their lengths.
        **settings
            Other parameters of an actor, such as `colormap` or `opacity`.

        Returns
        -------
        Actor
        """
        from .polydata import actor_of

        return actor_of(mesh, scalars, **settings)


@dataclass(frozen=True)
class Cut:
    """A plane that clips the side its normal points to."""

    origin: tuple[float, float, float]
    normal: tuple[float, float, float]


@dataclass(frozen=True)
class Legend:
    """How to read the colours: the title, the map and the numbers at its two ends.

    Instead of a map, or below it, there may be `swatches`: a colour and its meaning.
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
        Where each joint takes the points it holds, in the scene's space; None at rest.
    cut : Cut, optional
    legend : Legend, optional
    views : tuple of str
        Captions of the views that stand side by side under one camera; a single view has
        none.
    front : float, optional
        Scalars above it are left grey on the actors that are part of the film.
    images : array, shape (k, s, s, 4), uint8, optional
        Images of the actors' `materials`; see `materials.Textures`.
    """

    actors: dict[str, Actor] = field(default_factory=dict)
    pose: NDArray[np.float64] | None = None
    cut: Cut | None = None
    legend: Legend | None = None
    views: tuple[str, ...] = ()
    front: float | None = None
    images: NDArray[np.uint8] | None = None

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
        """Lowest and highest corner of all that is to be seen whole, at rest, shape (2, 3).

        That is all but what is drawn over the scene: bones may reach far out of the body, those
        above all that move nothing.
        """
        points = [a.points for a in self.actors.values() if len(a.points) and not a.overlay]
        if not points:
            return np.array([[-1.0, -1, -1], [1, 1, 1]])
        low = np.min([p.min(axis=0) for p in points], axis=0)
        return np.stack([low, np.max([p.max(axis=0) for p in points], axis=0)]).astype(float)


def in_view(description: Description, view: int) -> Description:
    """Return a scene with the actors of one of its views alone."""
    actors = {k: a for k, a in description.actors.items() if a.view in (None, view)}
    return replace(description, actors=actors)
