"""The options of `cutcell render` that say what is seen inside."""

from __future__ import annotations

from typing import Annotated

import typer

WHAT = "What is seen"
INSIDE = "What is seen inside: graph, distance"

FindingCode = Annotated[
    str | None,
    typer.Option(
        "--finding",
        metavar="CODE",
        help="What of cutcell diagnose is marked on the panel check.",
        rich_help_panel=WHAT,
    ),
]
Colors = Annotated[
    str | None,
    typer.Option(
        "--colors",
        metavar="WHAT",
        help="What colours the body on the panel pose: weights, plain, or materials (the file's).",
        rich_help_panel=WHAT,
    ),
]
Plane = Annotated[
    str | None,
    typer.Option(
        "--cut",
        metavar="PLANE",
        help="Cut the body across x, y or z, or by a plane that looks in a direction: degrees"
        " around the upright axis, and up. =0.4 tells where: z=0.4, 30,20=0.5.",
        rich_help_panel=INSIDE,
    ),
]
Face = Annotated[
    str | None,
    typer.Option(
        "--face",
        metavar="WHAT",
        help="On the face of the cut: distance, winding (its number), or open (graph only).",
        rich_help_panel=INSIDE,
    ),
]
Keep = Annotated[
    str | None,
    typer.Option(
        "--keep",
        metavar="WHAT",
        help="Behind the cut of a graph: half, face (of the interior), or slab=0.1.",
        rich_help_panel=INSIDE,
    ),
]
Layers = Annotated[
    str | None,
    typer.Option(
        "--layers",
        metavar="A,B,...",
        help="Of the graph: body, mesh, interior, surface, nodes.",
        rich_help_panel=INSIDE,
    ),
]
ColorBy = Annotated[
    str | None,
    typer.Option(
        "--color-by",
        metavar="WHAT",
        help="Colour edges and nodes by kind, depth, distance or component.",
        rich_help_panel=INSIDE,
    ),
]
Slice = Annotated[
    str | None,
    typer.Option(
        "--slice",
        metavar="AXIS",
        help="One slice of the lattice with its rays, such as z, or z=0.5:x, whose rays run"
        " along x: graph.",
        rich_help_panel=INSIDE,
    ),
]
Sources = Annotated[
    bool,
    typer.Option("--sources", help="Sources of the distances.", rich_help_panel=INSIDE),
]
PathFrom = Annotated[
    int | None,
    typer.Option(
        "--path",
        metavar="VERTEX",
        help="The shortest path from a vertex to the bone.",
        rich_help_panel=INSIDE,
    ),
]
Wave = Annotated[
    float | None,
    typer.Option(
        "--wave",
        metavar="PART",
        help="Distances up to this part of the greatest alone, from 0 to 1.",
        rich_help_panel=INSIDE,
    ),
]
Measures = Annotated[
    str | None,
    typer.Option(
        "--measures",
        metavar="A,B",
        help="The distance by two to four measures side by side, on the panel distance: straight, "
        "surface, voxel, 6, 26, any. R is that of --resolution.",
        rich_help_panel=INSIDE,
    ),
]
PageAddress = Annotated[
    str | None,
    typer.Option(
        "--address",
        metavar="URL",
        help="What a page shows whose address this is, seen from the same place; its character is"
        " not opened. Other options come before it.",
        rich_help_panel=WHAT,
    ),
]
FreeCamera = Annotated[
    str | None,
    typer.Option(
        "--camera",
        metavar="X,Y,Z,X,Y,Z",
        help="From where, and what is looked at, as a page's address has it.",
        rich_help_panel="How it is seen",
    ),
]
Background = Annotated[
    str,
    typer.Option(
        "--background",
        metavar="COLOUR",
        help="A ground of one colour, such as white or #f4f4f4.",
        rich_help_panel="How it is seen",
    ),
]
Transparent = Annotated[
    bool,
    typer.Option("--transparent", help="No ground: PNG.", rich_help_panel="How it is seen"),
]
Near = Annotated[
    float | None,
    typer.Option(
        "--near",
        metavar="PART",
        help="From near the bone: how much around it is seen, of the longest side, from 0.01 to 1.",
        rich_help_panel="How it is seen",
    ),
]
