"""Options of the method: one object that all stages, commands and the page share."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from typing import Any, Literal, TypedDict, get_args

from .errors import ParameterError
from .rig.checks import (
    check_choice,
    check_flag,
    check_fraction,
    check_integer,
    check_number,
)

Connectivity = Literal[6, 26, "any"]
Leaf = Literal["point", "extend", "fit"]
Falloff = Literal["rig", "paper"]
MethodName = Literal["animation", "paper"]

CONNECTIVITIES: tuple[Connectivity, ...] = get_args(Connectivity)
LEAVES: tuple[Leaf, ...] = get_args(Leaf)
FALLOFFS: tuple[Falloff, ...] = get_args(Falloff)

MIN_RESOLUTION = 2
MAX_RESOLUTION = 1024
MAX_SAMPLES = 1000
MAX_INFLUENCES = 1024

LEAF_OF: dict[Falloff, Leaf] = {"rig": "fit", "paper": "point"}
"""The bones that each falloff is made for."""
ALPHA = 0.5
"""Default of the paper's falloff."""
RIG_JOINTS = 3
"""Nearest joints of each vertex that the falloff "rig" divides the surface among, at least: hardly
a vertex has a fourth. It follows more joints only as the surface around it does."""
PAPER_JOINTS = 8
"""Nearest joints of each vertex that distances are measured from, at least, with the paper's
falloff: a path leads through nodes that are nearer to others, and there it must not be dropped."""
RIG_REACH = 6.0
"""Times as far as its nearest joint: whatever is farther gets no weight of the falloff "rig"."""


class GraphOptions(TypedDict, total=False):
    """Options of a `Method` that `build_graph` follows, beside the resolution."""

    connectivity: Connectivity
    winding_threshold: float
    orient: bool


class DistanceOptions(TypedDict, total=False):
    """Options of a `Method` that `bone_distances` follows."""

    samples: int
    leaf: Leaf | None


class WeightOptions(TypedDict, total=False):
    """Options of a `Method` that `skinning_weights` follows."""

    falloff: Falloff
    alpha: float | None
    max_influences: int | None
    threshold: float


class Options(GraphOptions, DistanceOptions, WeightOptions):
    """All options of a `Method` beside the resolution."""


def check_resolution(resolution: Any) -> int:
    """Return how many cells a lattice has along each side."""
    why = "it counts the cells along the mesh's longest side, 64 suits most characters"
    return check_integer("resolution", resolution, MIN_RESOLUTION, MAX_RESOLUTION, why)


def _checked_alpha(alpha: Any, falloff: Falloff) -> float | None:
    if falloff == "paper":
        return check_number("alpha", ALPHA if alpha is None else alpha, 0, 1)
    if alpha is not None:
        check_number("alpha", alpha, 0, 1)
        raise ParameterError(
            f"alpha shapes the paper's falloff and has no effect with falloff={falloff!r}; "
            "leave it out, or choose falloff='paper'"
        )
    return None


@dataclass(frozen=True)
class Method:
    """Options of the method, for any character: from the lattice to the last weight.

    `cutcell.ANIMATION` makes weights to animate with and is the default everywhere;
    `cutcell.PAPER` is the method of the paper. Wherever a method is taken, either may be given by
    its name, "animation" or "paper", and single options on top of it.

    Refinements of weights (smoothing, symmetry, locked joints) belong to one character and are
    not part of the method; see `bind`.

    Parameters
    ----------
    resolution : int
        R, lattice cells along the mesh's longest side, 2 to 1024.
    connectivity : {6, 26, "any"}
        Directions of paths inside. 6: along the axes, as in the paper. 26: along the diagonals of
        lattice cells, too. "any": at any angle, so that distances converge to geodesic ones. Voids
        of hollow bodies stay empty with 6, as in the paper; else they are filled.
    winding_threshold : float
        tau: what has at least this winding number is inside; more than 0 and less than 1.
    orient : bool
        Flip inverted faces first, and count faces once that lie on their own reverse side.
    samples : int
        N, points on each bone that distances start from, 1 to 1000.
    leaf : {"fit", "point", "extend"}, optional
        Ends of bones. "point", "extend": at the child joints; a joint without children is a
        point, or a bone along its parent's direction. "fit": fitted to the body. By default
        "fit" with the falloff "rig", "point" with "paper".
    falloff : {"rig", "paper"}
        Decrease of weight with distance. "rig": for animation. "paper": equation 1.
    alpha : float, optional
        Smoothness of the paper's falloff, 0 to 1, 0.5 when left out; the other has none.
    max_influences : int, optional
        Joints a vertex may follow, 1 to 1024; None for no limit.
    threshold : float
        Weights below it are dropped after limiting, 0 to 1.

    Raises
    ------
    ParameterError
        An option is out of its range, or has no effect.

    Examples
    --------
    >>> cutcell.PAPER.with_options(resolution=128, alpha=0.3)  # doctest: +SKIP
    >>> cutcell.bind(rig, method="paper", alpha=0.3)  # doctest: +SKIP
    """

    resolution: int = 64
    connectivity: Connectivity = "any"
    winding_threshold: float = 0.5
    orient: bool = True
    samples: int = 5
    leaf: Leaf = None  # type: ignore[assignment]
    falloff: Falloff = "rig"
    alpha: float | None = None
    max_influences: int | None = 4
    threshold: float = 0.0

    def __post_init__(self) -> None:
        falloff = check_choice("falloff", self.falloff, FALLOFFS)
        leaf = LEAF_OF[falloff] if self.leaf is None else self.leaf
        checked = {
            "resolution": check_resolution(self.resolution),
            "connectivity": check_choice("connectivity", self.connectivity, CONNECTIVITIES),
            "winding_threshold": check_fraction("winding_threshold", self.winding_threshold),
            "orient": check_flag("orient", self.orient),
            "samples": check_integer("samples", self.samples, 1, MAX_SAMPLES),
            "leaf": check_choice("leaf", leaf, LEAVES),
            "falloff": falloff,
            "alpha": _checked_alpha(self.alpha, falloff),
            "threshold": check_number("threshold", self.threshold, 0, 1),
        }
        if self.max_influences is not None:
            checked["max_influences"] = check_integer(
                "max_influences", self.max_influences, 1, MAX_INFLUENCES
            )
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def with_options(self, **options: Any) -> Method:
        """Return this method with other options.

        With another `falloff`, `leaf` and `alpha` return to its defaults unless given, too.

        Parameters
        ----------
        **options
            Any of the parameters of `Method`.

        Raises
        ------
        TypeError
            There is no such option.
        ParameterError
            An option is out of its range, or has no effect.
        """
        names = [field.name for field in fields(self)]
        for name in options:
            if name not in names:
                close = get_close_matches(name, names, n=1)
                instead = f"did you mean {close[0]!r}?" if close else f"it has {', '.join(names)}"
                raise TypeError(f"a method has no option {name!r}; {instead}")
        falloff = check_choice("falloff", options.get("falloff", self.falloff), FALLOFFS)
        if falloff != self.falloff:
            options = {"leaf": None, "alpha": None, **options}
        return replace(self, **options)

    @property
    def name(self) -> str:
        """The method's name, whatever its resolution: "animation", "paper", or else "custom"."""
        others = {
            replace(other, resolution=self.resolution): name for name, other in METHODS.items()
        }
        return others.get(self, "custom")

    @property
    def joints_needed(self) -> int | None:
        """Number of nearest joints of each vertex that distances are needed from; None: all."""
        return joints_needed(self.falloff, self.max_influences)

    @property
    def reach_needed(self) -> float:
        """Distance relative to the nearest joint's beyond which a joint gets no weight."""
        return RIG_REACH if self.falloff == "rig" else float("inf")


ANIMATION = Method()
"""Weights to animate with (docs/falloff.md): the default of `bind`."""
PAPER = Method(connectivity=6, falloff="paper", max_influences=None)
"""The paper's method: a 6-connected graph, leaf bones as points, equation 1 for all joints."""
METHODS: dict[MethodName, Method] = {"animation": ANIMATION, "paper": PAPER}
"""The methods that have names."""


def method_of(method: Method | MethodName, resolution: int | None = None, **options: Any) -> Method:
    """Return a method that is given as such or by its name, with single options on top."""
    if not isinstance(method, Method):
        method = METHODS[check_choice("method", method, METHODS)]
    if resolution is not None:
        options["resolution"] = resolution
    return method.with_options(**options) if options else method


def joints_needed(falloff: Falloff, max_influences: int | None) -> int | None:
    """Return from how many nearest joints of each vertex a falloff needs distances."""
    if max_influences is None:
        return None
    return RIG_JOINTS if falloff == "rig" else max(max_influences, PAPER_JOINTS)
