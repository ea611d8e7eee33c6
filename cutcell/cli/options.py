"""The options that commands share, each explained where `--help` shows it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from ..method import Method

METHOD = "The method"
JOINTS = "Which joints carry weight"
TOUCH = "Touching up"
FILES = "Files and output"

RigFile = Annotated[
    Path,
    typer.Argument(
        metavar="RIG",
        help="A character: .glb, .gltf or .vrm; .fbx; .usd, .usda, .usdc or .usdz (needs"
        " cutcell[usd]); RigNet's .obj with .txt; Articulation-XL's .npz; or a"
        " mesh (.obj, .ply, .stl, .off) with a skeleton in a .json beside it.",
    ),
]
SkeletonFile = Annotated[
    Path | None,
    typer.Option(
        "--skeleton",
        metavar="FILE",
        help="The skeleton (.json) of a mesh, where it does not stand beside it under its name.",
        rich_help_panel=FILES,
    ),
]
Networks = Annotated[
    list[Path] | None,
    typer.Option(
        "--networks",
        metavar="FOLDER",
        help="Trained networks to compare with: a folder of `cutcell networks train`, or one that"
        " holds several (needs cutcell[networks]). May be given several times.",
    ),
]
TemplateName = Annotated[
    str | None,
    typer.Option(
        "--template",
        metavar="T",
        help="Fit a skeleton into a mesh that has none: biped, quadruped, hand, snake or chain.",
        rich_help_panel=FILES,
    ),
]
Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON document.", rich_help_panel=FILES)
]
Quiet = Annotated[
    bool,
    typer.Option("--quiet", "-q", help="No bars, no table, no warnings.", rich_help_panel=FILES),
]
How = Annotated[
    str,
    typer.Option(
        "--method",
        metavar="M",
        help="What the options below are when left out. animation: made to animate with."
        " paper: just as in the paper.",
        rich_help_panel=METHOD,
    ),
]
Resolution = Annotated[
    int,
    typer.Option(
        "--resolution",
        "-r",
        metavar="R",
        help="Rays along the longest side of the mesh. More: close parts are kept apart, more"
        " time and memory.",
        rich_help_panel=METHOD,
    ),
]
Connectivity = Annotated[
    str | None,
    typer.Option(
        "--connectivity",
        metavar="C",
        help="How paths run inside. 6: along the axes, as in the paper. 26: along diagonals too."
        " any: at any angle, so that distances are geodesic. Left out: any; 6 by the method"
        " paper.",
        show_default=False,
        rich_help_panel=METHOD,
    ),
]
WindingThreshold = Annotated[
    float,
    typer.Option(
        "--winding-threshold",
        metavar="T",
        help="Winding number from which a point is inside, 0 to 1. Lower fills more of an"
        " open mesh.",
        rich_help_panel=METHOD,
    ),
]
Orient = Annotated[
    bool,
    typer.Option(
        "--orient/--no-orient",
        help="Take faces that are inside out as turned round, or all faces as the file has them.",
        rich_help_panel=METHOD,
    ),
]
Samples = Annotated[
    int,
    typer.Option(
        "--samples",
        metavar="N",
        help="Points along each bone that distances start from.",
        rich_help_panel=METHOD,
    ),
]
Leaf = Annotated[
    str | None,
    typer.Option(
        "--leaf",
        metavar="L",
        help="Where bones end. point, extend: at the child joints; a joint without children is a"
        " point, or goes on along its parent's direction. fit: where the body says. Left out:"
        " fit; point with the falloff paper.",
        show_default=False,
        rich_help_panel=METHOD,
    ),
]
Falloff = Annotated[
    str | None,
    typer.Option(
        "--falloff",
        metavar="F",
        help="How weight falls with distance. rig: made to animate with. paper: the paper's kernel"
        " (its equation 1), a soft feature of the distance. Left out: rig; paper by the method"
        " paper.",
        show_default=False,
        rich_help_panel=METHOD,
    ),
]
Alpha = Annotated[
    float | None,
    typer.Option(
        "--alpha",
        metavar="A",
        help="Of the falloff paper alone, 0 to 1: 0 linear in the distance, 1 quadratic. Left"
        " out: 0.5.",
        show_default=False,
        rich_help_panel=METHOD,
    ),
]
MaxInfluences = Annotated[
    str | None,
    typer.Option(
        "--max-influences",
        metavar="K",
        help="Most joints a vertex may follow: a number, or all. 4 is what game engines read."
        " Left out: 4; all by the method paper, but 4 in glTF files.",
        show_default=False,
        rich_help_panel=METHOD,
    ),
]
Threshold = Annotated[
    float,
    typer.Option(
        "--threshold",
        metavar="W",
        help="Weights below this are dropped and the rest made to sum to 1 again.",
        rich_help_panel=METHOD,
    ),
]
Deform = Annotated[
    list[str] | None,
    typer.Option(
        "--deform",
        metavar="JOINT",
        help="A joint that may carry weight though the file, or the guess, says no. * stands for"
        " any letters. May be given several times.",
        rich_help_panel=JOINTS,
    ),
]
NoDeform = Annotated[
    list[str] | None,
    typer.Option(
        "--no-deform",
        metavar="JOINT",
        help="A joint that shall carry none, such as '*_IK'. May be given several times.",
        rich_help_panel=JOINTS,
    ),
]
Fresh = Annotated[
    bool,
    typer.Option(
        "--fresh",
        help="Forget the file's weights: guess from names and places which joints carry some."
        " `cutcell joints` shows the guess.",
        rich_help_panel=JOINTS,
    ),
]
CorrectionsFile = Annotated[
    Path | None,
    typer.Option(
        "--corrections",
        metavar="FILE",
        help="What is corrected (.json): joints moved, without weight, locked or of another reach; "
        "parts glued to joints; weights of single vertices.",
        rich_help_panel=TOUCH,
    ),
]
Smoothing = Annotated[
    int,
    typer.Option(
        "--smoothing",
        metavar="N",
        help="Average the weights along mesh edges N times.",
        rich_help_panel=TOUCH,
    ),
]
Symmetric = Annotated[
    bool,
    typer.Option(
        "--symmetric",
        help="Give left and right the same weights, where the mesh is mirrored.",
        rich_help_panel=TOUCH,
    ),
]
Lock = Annotated[
    list[str] | None,
    typer.Option(
        "--lock",
        metavar="JOINT",
        help="A joint that keeps the file's own weights; the rest is filled in. May be given"
        " several times.",
        rich_help_panel=TOUCH,
    ),
]


def chosen_method(name: str, **options: Any) -> Method:
    """Return the method of that name with the given options, which may be texts."""
    from ..method import METHODS, method_of
    from ..rig.checks import check_choice

    given = {key: value for key, value in options.items() if value is not None}
    for key in ("connectivity", "max_influences"):
        if isinstance(text := given.get(key), str) and text.isdecimal():
            given[key] = int(text)
    if given.get("max_influences") == "all":
        given["max_influences"] = None
    return method_of(check_choice("method", name, METHODS), **given)
