"""Options of the method: one object that all stages, commands and the page share.

Each option is declared once, as a field of `Method`, and named by the stage that follows it. The
command line, the page and the fingerprints read the declarations.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Annotated, Any, Literal, TypedDict, get_args, get_type_hints

from .animation import declaration as animation
from .checks import assign, check_choice
from .errors import ParameterError
from .options import Flag, Option, Share, Whole

Connectivity = Literal[6, 26, "any"]
Leaf = Literal["point", "extend", "fit"]
Falloff = Literal["rig", "paper"]
MethodName = Literal["animation", "paper"]

LEAVES: tuple[Leaf, ...] = get_args(Leaf)
FALLOFFS: tuple[Falloff, ...] = get_args(Falloff)

MAX_RESOLUTION = 1024
_CELLS = "it counts the cells along the mesh's longest side, 64 suits most characters"

LEAF_OF: dict[Falloff, Leaf] = {animation.FALLOFF: animation.LEAF, "paper": "point"}
"""The bones that each falloff is made for."""
ALPHA = 0.5
"""Default of the paper's falloff."""
PAPER_JOINTS = 8
"""Nearest joints of each vertex that distances are measured from, at least, with the paper's
falloff: a path leads through nodes that are nearer to others, and there it must not be dropped."""


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


STAGE_OPTIONS: dict[str, tuple[str, ...]] = {
    "graph": ("resolution", *GraphOptions.__annotations__),
    "distances": tuple(DistanceOptions.__annotations__),
    "weights": tuple(WeightOptions.__annotations__),
}
"""The options that each stage follows: its fingerprint holds their values."""


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

    resolution: Annotated[int, Option(
        Whole(2, MAX_RESOLUTION, _CELLS), "R",
        "Rays along the longest side of the mesh. More rays separate close parts better, but take"
        " more time and memory.",
        "Resolution R", short="-r",
    )] = 64  # fmt: skip
    connectivity: Annotated[Connectivity, Option(
        {"6 axes": 6, "26 diagonals": 26, "Any angle": "any"}, "C",
        "Directions of paths inside. 6: along the axes, as in the paper. 26: also along diagonals."
        " any: at any angle, so that distances are geodesic.",
        "Paths inside run along",
    )] = animation.CONNECTIVITY  # fmt: skip
    winding_threshold: Annotated[float, Option(
        Share(strictly=True), "T",
        "Winding number from which a point is inside, between 0 and 1. Lower values fill more of an"
        " open mesh.",
        "Winding threshold τ", slider=(0.01, 0.99, 0.01),
    )] = 0.5  # fmt: skip
    orient: Annotated[bool, Option(
        Flag(), "",
        "Treat inverted faces as flipped, or use all faces as they are in the file.",
        "Flip inverted faces",
    )] = True  # fmt: skip
    samples: Annotated[int, Option(Whole(1, 1000), "N", "Number of sources along each bone.")] = 5
    leaf: Annotated[Leaf, Option(
        {"Points": "point", "Extended": "extend", "Fitted": animation.LEAF}, "L",
        "End of each bone. point, extend: at the child joints; a joint without children is a point,"
        " or continues along its parent's direction. fit: from the shape of the body.",
        "Leaf bones",
    )] = None  # type: ignore[assignment]  # fmt: skip
    falloff: Annotated[Falloff, Option(
        {"Animation": animation.FALLOFF, "Paper": "paper"}, "F",
        "Decrease of weight with distance. rig: for animation. paper: the paper's kernel (its"
        " equation 1), a soft feature of the distance.",
        "Falloff",
    )] = animation.FALLOFF  # fmt: skip
    alpha: Annotated[float | None, Option(
        Share(), "A",
        "Shape of the paper's falloff, 0 to 1: 0 is linear in the distance, 1 quadratic.",
        "Smoothness α", slider=(0, 1, 0.01), none="",
    )] = None  # fmt: skip
    max_influences: Annotated[int | None, Option(
        Whole(1, 1024), "K",
        "Maximum number of joints per vertex: a number, or all. Game engines read 4, so that glTF"
        " files get no more unless it is given.",
        "Max influences", none="all",
    )] = 4  # fmt: skip
    threshold: Annotated[float, Option(
        Share(), "W", "Weights below this are dropped, and the rest is scaled to sum to 1.",
        "Ignore weights below", slider=(0, 0.3, 0.005),
    )] = 0.0  # fmt: skip

    def __post_init__(self) -> None:
        falloff = OPTIONS["falloff"].check("falloff", self.falloff)
        if self.leaf is None:
            assign(self, leaf=LEAF_OF[falloff])
        if self.alpha is None and falloff == "paper":
            assign(self, alpha=ALPHA)
        for name, option in OPTIONS.items():
            assign(self, **{name: option.check(name, getattr(self, name))})
        if self.alpha is not None and falloff != "paper":
            raise ParameterError(
                f"alpha shapes the paper's falloff and has no effect with falloff={falloff!r}; "
                "leave it out, or choose falloff='paper'"
            )

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
        for name in options:
            if name not in OPTIONS:
                close = get_close_matches(name, OPTIONS, n=1)
                instead = f"did you mean {close[0]!r}?" if close else f"it has {', '.join(OPTIONS)}"
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
        return animation.REACH if self.falloff == animation.FALLOFF else float("inf")


OPTIONS: dict[str, Option] = {
    name: hint.__metadata__[0] for name, hint in get_type_hints(Method, include_extras=True).items()
}
"""The declaration of each option."""
ANIMATION = Method()
"""Weights to animate with (docs/falloff.md): the default of `bind`."""
PAPER = Method(connectivity=6, falloff="paper", max_influences=None)
"""The paper's method: a 6-connected graph, leaf bones as points, equation 1 for all joints."""
METHODS: dict[MethodName, Method] = {"animation": ANIMATION, "paper": PAPER}
"""The methods that have names."""


def check_resolution(resolution: Any) -> int:
    """Return how many cells a lattice has along each side."""
    return int(OPTIONS["resolution"].check("resolution", resolution))


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
    if falloff == animation.FALLOFF:
        return animation.NEAREST_JOINTS
    return max(max_influences, PAPER_JOINTS)
