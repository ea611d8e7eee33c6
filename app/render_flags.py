"""The options of `cutcell render`: type, default, flags, placeholder, help and section of each."""

from typing import Any

WHAT = "What is seen"
INSIDE = "What is seen inside: graph, distance"
HOW = "How it is seen"

Flags = dict[str, tuple[Any, Any, str, str, str, str]]

CHOICES: Flags = {
    "panel": (
        str | None, None, "--panel -p", "PANEL",
        "As on the page: graph, distance, weights, pose, compare or check. Default: weights.", WHAT,
    ),
    "bone": (
        str | None, None, "--bone -b", "NAME",
        "Whose weights or distance. Weights of all bones are mixed if left out.", WHAT,
    ),
    "shown": (
        str | None, None, "--show", "WHAT",
        "Of the weights: bone, mix, dominant, count, or difference to the file's own.", WHAT,
    ),
    "turn": (
        str | None, None, "--turn", "AXIS=DEGREES",
        "Turn the bone, such as z=30, on the panels pose and compare.", WHAT,
    ),
    "error": (
        bool, False, "--error", "",
        "Colour by the error against the file's own weights: pose, compare.", WHAT,
    ),
    "methods": (
        str, "", "--methods", "A,B,...",
        "What stands side by side on the panel compare; now is what is set here.", WHAT,
    ),
    "finding": (
        str | None, None, "--finding", "CODE",
        "What of cutcell diagnose is marked on the panel check.", WHAT,
    ),
    "clip": (
        str | None, None, "--clip", "NAME",
        "Film one of the file's motions, by name or number.", HOW,
    ),
    "time": (
        float | None, None, "--time", "SECONDS",
        "With --clip: a picture of that moment instead of a film.", HOW,
    ),
    "sweep": (
        str | None, None, "--sweep", "WHAT",
        "Film the wave as it runs from the bone to the farthest vertex, or the cut from one end of"
        " the body to the other: wave, cut.", HOW,
    ),
    "dark": (bool, False, "--dark", "", "On a dark ground.", HOW),
    "skeleton": (bool, True, "--bones/--no-bones", "", "Draw the skeleton, too.", HOW),
}  # fmt: skip
"""Fields of `render.Choices`."""

SETTINGS: Flags = {
    "colors": (
        str | None, None, "--colors", "WHAT",
        "What colours the body on the panel pose: weights, plain, or materials (the file's).", WHAT,
    ),
    "cut": (
        str | None, None, "--cut", "PLANE",
        "Cut the body across x, y or z, or by a plane that looks in a direction: degrees around"
        " the upright axis, and up. =0.4 tells where: z=0.4, 30,20=0.5.", INSIDE,
    ),
    "face": (
        str | None, None, "--face", "WHAT",
        "On the face of the cut: distance, winding (its number), or open (graph only).", INSIDE,
    ),
    "keep": (
        str | None, None, "--keep", "WHAT",
        "Behind the cut of a graph: half, face (of the interior), or slab=0.1.", INSIDE,
    ),
    "layers": (
        str | None, None, "--layers", "A,B,...",
        "Of the graph: body, mesh, interior, surface, nodes.", INSIDE,
    ),
    "color_by": (
        str | None, None, "--color-by", "WHAT",
        "Colour edges and nodes by kind, depth, distance or component.", INSIDE,
    ),
    "slice": (
        str | None, None, "--slice", "AXIS",
        "One slice of the lattice with its rays, such as z, or z=0.5:x, whose rays run along x:"
        " graph.", INSIDE,
    ),
    "sources": (bool, False, "--sources", "", "Sources of the distances.", INSIDE),
    "path": (
        int | None, None, "--path", "VERTEX",
        "The shortest path from a vertex to the bone.", INSIDE,
    ),
    "wave": (
        float | None, None, "--wave", "PART",
        "Distances up to this part of the greatest alone, from 0 to 1.", INSIDE,
    ),
    "measures": (
        str | None, None, "--measures", "A,B",
        "The distance by two to four measures side by side, on the panel distance: straight,"
        " surface, voxel, 6, 26, any, converged. R is that of --resolution.", INSIDE,
    ),
}  # fmt: skip
"""Options that `render.settings_of` reads."""

PICTURE: Flags = {
    "turntable": (bool, False, "--turntable", "", "Film it from all around.", HOW),
    "view": (
        str | None, None, "--view", "VIEW",
        "From where: front, three-quarter, left, right, back or top. If left out: the side that a"
        " finding is on, else three-quarter.", HOW,
    ),
    "near": (
        float | None, None, "--near", "PART",
        "From near the bone: how much around it is seen, of the longest side, from 0.01 to 1.", HOW,
    ),
    "size": (
        str | None, None, "--size", "WxH",
        "In pixels; 1600x1200 for pictures, 960x720 for films if left out.", HOW,
    ),
    "camera": (
        str | None, None, "--camera", "X,Y,Z,X,Y,Z",
        "From where, and what is looked at, as in the address of a page.", HOW,
    ),
    "background": (
        str, "", "--background", "COLOUR",
        "Background of one colour, such as white or #f4f4f4.", HOW,
    ),
    "transparent": (bool, False, "--transparent", "", "No background: PNG.", HOW),
    "legend": (bool, True, "--legend/--no-legend", "", "Write the legend on it.", HOW),
}  # fmt: skip
"""Options that are passed to `render.order`."""
