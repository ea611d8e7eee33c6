"""The options of `cutcell render`: section, flags, placeholder and help of each.

Nothing is imported here that makes `--help` slow.
"""

from typing import Any

WHAT = "Content"
INSIDE = "Inside: graph, distance"
HOW = "View"

KINDS: dict[str, Any] = {
    "": bool, "PART": float, "SECONDS": float, "VERTEX": int, "URL": list[str], "TEXT": list[str],
}  # fmt: skip
"""Types of options by their placeholders; all others are texts."""


def _rows(**options: tuple[str, str, str, str]) -> dict[str, tuple[Any, ...]]:
    """Return a table for `with_options`; an option without a value is a switch."""
    rows: dict[str, tuple[Any, ...]] = {}
    for name, (section, flags, placeholder, text) in options.items():
        kind = KINDS.get(placeholder, str)
        default = "/--no-" in flags if kind is bool else None
        rows[name] = (kind if kind is bool else kind | None, default, flags, placeholder, text,
                      section)  # fmt: skip
    return rows


# fmt: off
CHOICES = _rows(
    panel=(WHAT, "--panel -p", "PANEL",
        "As on the page: graph, distance, weights, pose, compare or check. Default: weights."),
    bone=(WHAT, "--bone -b", "NAME",
        "Whose weights or distance. Weights of all bones are mixed if left out."),
    shown=(WHAT, "--show", "WHAT",
        "Of the weights: bone, mix, dominant, count, or difference to the file's own."),
    turn=(WHAT, "--turn", "AXIS=DEGREES",
        "Turn the bone, such as z=30, on the panels pose and compare."),
    error=(WHAT, "--error", "",
        "Colour by the error against the file's own weights: pose, compare."),
    methods=(WHAT, "--methods", "A,B,...",
        "Methods side by side on the panel compare; now is what is set here."),
    finding=(WHAT, "--finding", "CODE",
        "The finding of cutcell diagnose to mark on the panel check."),
    clip=(HOW, "--clip", "NAME", "Film one of the file's motions, by name or number."),
    time=(HOW, "--time", "SECONDS", "With --clip: a picture of that moment instead of a film."),
    sweep=(HOW, "--sweep", "WHAT",
        "Film the wave as it runs from the bone to the farthest vertex, or the cut from one end of"
        " the body to the other: wave, cut."),
    dark=(HOW, "--dark", "", "On a dark ground."),
    skeleton=(HOW, "--bones/--no-bones", "", "Draw the skeleton, too."),
)
"""Fields of `Choices`."""

SETTINGS = _rows(
    blending=(WHAT, "--blending", "HOW",
        "How the joints' transforms are blended on the panels pose and compare: linear, or dual"
        " (dual quaternions)."),
    colors=(WHAT, "--colors", "WHAT",
        "Colours of the body on the panel pose: weights, plain, or materials (the file's)."),
    cut=(INSIDE, "--cut", "PLANE",
        "Cut the body across x, y or z, or by a plane that looks in a direction: degrees around"
        " the upright axis, and up. =0.4 sets the position: z=0.4, 30,20=0.5."),
    face=(INSIDE, "--face", "WHAT",
        "On the face of the cut: distance, winding (its number), or open (graph only)."),
    keep=(INSIDE, "--keep", "WHAT",
        "Behind the cut of a graph: half, face (of the interior), or slab=0.1."),
    layers=(INSIDE, "--layers", "A,B,...", "Of the graph: body, mesh, interior, surface, nodes."),
    color_by=(INSIDE, "--color-by", "WHAT",
        "Colour edges and nodes by kind, depth, distance or component."),
    slice=(INSIDE, "--slice", "AXIS",
        "One slice of the lattice with its rays, such as z, or z=0.5:x, whose rays run along x:"
        " graph."),
    sources=(INSIDE, "--sources", "", "Sources of the distances."),
    colormap=(HOW, "--colormap", "NAME",
        "Colours of distances, depths and a bone's weights: viridis, cividis, plasma, inferno,"
        " magma, turbo or gray, as Matplotlib has them."),
    path=(INSIDE, "--path", "VERTEX", "The shortest path from a vertex to the bone."),
    wave=(INSIDE, "--wave", "PART",
        "Only distances up to this part of the greatest, from 0 to 1."),
    measures=(INSIDE, "--measures", "A,B",
        "The distance by two to four measures side by side, on the panel distance: straight,"
        " surface, voxel, 6, 26, any, converged. R is that of --resolution."),
)
"""Options that `read_settings` turns into choices of the page."""

PICTURE = _rows(
    turntable=(HOW, "--turntable", "", "Film it from all around."),
    view=(HOW, "--view", "VIEW",
        "From where: front, three-quarter, left, right, back or top. If left out: the side that a"
        " finding is on, else three-quarter."),
    near=(HOW, "--near", "PART",
        "A view of the bone, of this part of the longest side, from 0.01 to 1."),
    size=(HOW, "--size", "WxH",
        "In pixels; 1600x1200 for pictures, 960x720 for films if left out."),
    camera=(HOW, "--camera", "X,Y,Z,X,Y,Z",
        "Position of the camera and its target, as in the address of a page."),
    background=(HOW, "--background", "COLOUR",
        "Background of one colour, such as white or #f4f4f4."),
    transparent=(HOW, "--transparent", "", "No background: PNG."),
    legend=(HOW, "--legend/--no-legend", "", "Write the legend on it."),
)
"""Fields of `Picture`."""

FIGURE = _rows(
    address=(WHAT, "--address", "URL",
        "Draw what a page of this address shows, from its camera. Other options come first. The"
        " page's character is not opened. Given several times: the panels of a figure, from one"
        " camera."),
    caption=(WHAT, "--caption", "TEXT", "Caption of a figure's panel; given once for each."),
)
"""Options that may be given several times."""
# fmt: on
