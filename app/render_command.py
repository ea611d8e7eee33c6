"""The command `cutcell render`: a picture or a film of what the page shows."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from cutcell.cli.console import for_people, print_line, print_warnings, progress_bars
from cutcell.cli.networks import offer_networks
from cutcell.cli.options import (
    FILES,
    Networks,
    RigFile,
    SkeletonFile,
    chosen_method,
    with_method,
)
from cutcell.errors import MissingLibraryError, ParameterError

from .render_flags import (
    WHAT,
    Background,
    ColorBy,
    Colors,
    Face,
    FindingCode,
    FreeCamera,
    Keep,
    Layers,
    Measures,
    Near,
    PageAddress,
    PathFrom,
    Plane,
    Slice,
    Sources,
    Transparent,
    Wave,
)

HOW = "How it is seen"
PICTURE_SIZE = (1600, 1200)
FILM_SIZE = (960, 720)
LARGEST = 8192

EPILOG = """Examples:

- `cutcell render character.glb --bone hand.L weights.png`

- `cutcell render character.glb --panel distance --bone hand.L --turntable distance.mp4`

- `cutcell render character.glb --panel graph --cut z --dark graph.png`

- `cutcell render character.glb --panel pose --clip walk --error walk.gif`

- `cutcell render character.glb --panel compare --methods now,bone_heat,artist compare.png`"""


@for_people
@with_method("resolution", "method", "connectivity", "winding_threshold", "orient", "leaf")
def render(
    context: typer.Context,
    rig: RigFile,
    out: Annotated[
        Path,
        typer.Argument(
            metavar="OUT", help="A picture: .png or .jpg. What moves is a film: .mp4 or .gif."
        ),
    ],
    panel: Annotated[
        str | None,
        typer.Option(
            "--panel",
            "-p",
            metavar="PANEL",
            help="As on the page: graph, distance, weights, pose, compare or check. Default:"
            " weights.",
            rich_help_panel=WHAT,
        ),
    ] = None,
    bone: Annotated[
        str | None,
        typer.Option(
            "--bone",
            "-b",
            metavar="NAME",
            help="Whose weights or distance. Weights of all bones are mixed if left out.",
            rich_help_panel=WHAT,
        ),
    ] = None,
    shown: Annotated[
        str | None,
        typer.Option(
            "--show",
            metavar="WHAT",
            help="Of the weights: bone, mix, dominant, count, or difference to the file's own.",
            rich_help_panel=WHAT,
        ),
    ] = None,
    turn: Annotated[
        str | None,
        typer.Option(
            "--turn",
            metavar="AXIS=DEGREES",
            help="Turn the bone, such as z=30, on the panels pose and compare.",
            rich_help_panel=WHAT,
        ),
    ] = None,
    error: Annotated[
        bool,
        typer.Option(
            "--error",
            help="Colour by the error against the file's own weights: pose, compare.",
            rich_help_panel=WHAT,
        ),
    ] = False,
    methods: Annotated[
        str,
        typer.Option(
            "--methods",
            metavar="A,B,...",
            help="What stands side by side on the panel compare; now is what is set here.",
            rich_help_panel=WHAT,
        ),
    ] = "",
    networks: Networks = None,
    address: PageAddress = None,
    colors: Colors = None,
    finding: FindingCode = None,
    cut: Plane = None,
    face: Face = None,
    keep: Keep = None,
    layers: Layers = None,
    color_by: ColorBy = None,
    slices: Slice = None,
    sources: Sources = False,
    path: PathFrom = None,
    wave: Wave = None,
    measures: Measures = None,
    clip: Annotated[
        str | None,
        typer.Option(
            "--clip",
            metavar="NAME",
            help="Film one of the file's motions, by name or number.",
            rich_help_panel=HOW,
        ),
    ] = None,
    time: Annotated[
        float | None,
        typer.Option(
            "--time",
            metavar="SECONDS",
            help="With --clip: a picture of that moment instead of a film.",
            rich_help_panel=HOW,
        ),
    ] = None,
    turntable: Annotated[
        bool,
        typer.Option("--turntable", help="Film it from all around.", rich_help_panel=HOW),
    ] = False,
    view: Annotated[
        str | None,
        typer.Option(
            "--view",
            metavar="VIEW",
            help="From where: front, three-quarter, left, right, back or top. If left out: the side"
            " that a finding is on, else three-quarter.",
            rich_help_panel=HOW,
        ),
    ] = None,
    near: Near = None,
    camera: FreeCamera = None,
    background: Background = "",
    transparent: Transparent = False,
    size: Annotated[
        str | None,
        typer.Option(
            "--size",
            metavar="WxH",
            help="In pixels; 1600x1200 for pictures, 960x720 for films if left out.",
            rich_help_panel=HOW,
        ),
    ] = None,
    dark: Annotated[
        bool, typer.Option("--dark", help="On a dark ground.", rich_help_panel=HOW)
    ] = False,
    skeleton: Annotated[
        bool,
        typer.Option("--bones/--no-bones", help="Draw the skeleton, too.", rich_help_panel=HOW),
    ] = True,
    legend: Annotated[
        bool,
        typer.Option("--legend/--no-legend", help="Write the legend on it.", rich_help_panel=HOW),
    ] = True,
    *,
    options: dict[str, Any],
    skeleton_file: SkeletonFile = None,
    quiet: Annotated[
        bool,
        typer.Option("--quiet", "-q", help="No bars, no warnings.", rich_help_panel=FILES),
    ] = False,
) -> None:
    """Draw a character as the page shows it, into a picture or a film.

    Weights are computed first; nothing of the character's file is changed.
    """
    scenes, film, worker = _libraries()
    moves = turntable or (clip is not None and time is None)
    film.check_picture_file(out, moves=moves)
    if transparent and background:
        raise ParameterError("a transparent picture has no background: leave one of them out")
    background = "transparent" if transparent else background
    film.ground("light", background, out.suffix.lower())
    pixels = _size(size) if size else FILM_SIZE if moves else PICTURE_SIZE
    from cutcell.io import load
    from cutcell.io.files import naming

    page = scenes.read_address(address) if address else scenes.Address()
    eye = scenes.read_camera(camera) if camera else page.camera
    if camera and (view or near):
        raise ParameterError("camera says where to look from: leave out view and near")
    method = chosen_method(
        {**options, **{n: v for n, v in page.method.items() if not _is_given(context, n)}}
    )
    loaded = load(rig, skeleton=skeleton_file)
    offer_networks(networks, quiet)
    choices = scenes.Choices(
        panel=panel or page.panel or "weights",
        bone=bone or page.bone,
        shown=shown,
        turn=_turn(turn),
        error=error,
        methods=[name.strip() for name in methods.split(",") if name.strip()] or page.methods,
        settings=page.without([name for name in context.params if _is_given(context, name)])
        | scenes.settings_of(
            colors=colors,
            layers=layers,
            color_by=color_by,
            cut=cut,
            face=face,
            keep=keep,
            slices=slices,
            sources=sources,
            path=path,
            wave=wave,
            measures=measures,
        ),
        method=method,
        finding=finding,
        clip=clip,
        time=time,
        skeleton=skeleton,
        dark=dark,
    )
    # A wrong name is refused before anything long begins.
    with naming(rig):
        scenes.check(loaded, choices, view)
    from cutcell.binding import bind

    no_skeleton = not len(loaded.skeleton.joints)
    textures = scenes.textures_for(loaded, choices)
    with progress_bars(quiet) as progress:
        binding = None if no_skeleton else bind(loaded, method=method, progress=progress)
        description = scenes.describe(
            loaded,
            choices,
            binding=binding,
            textures=textures,
            resolution=method.resolution if _is_given(context, "resolution") else None,
            progress=progress,
        )
        order = scenes.order(
            loaded,
            description,
            choices,
            size=pixels,
            view=view,
            turntable=turntable,
            legend=legend,
            near=near,
            camera=eye,
        )
        worker.draw_apart(replace(order, background=background), out, progress)
    if not quiet:
        print_warnings(
            [
                *loaded.warnings,
                *(binding.warnings if binding else ()),
                *(textures.notes if textures else ()),
            ]
        )
        print_line(f"{out}: {pixels[0]} x {pixels[1]} pixels, {_kilobytes(out)}")


def _libraries() -> tuple[Any, Any, Any]:
    try:
        from cutcell_viewers import film, worker

        from . import render as scenes
    except ModuleNotFoundError as error:
        raise MissingLibraryError(
            f"pictures need libraries that are not installed ({error.name} is missing); "
            "install them by: pip install 'cutcell[app]'"
        ) from None
    return scenes, film, worker


def _is_given(context: typer.Context, option: str) -> bool:
    source = context.get_parameter_source(option)
    return source is not None and source.name == "COMMANDLINE"


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,5})\s*[xX×]\s*(\d{1,5})", text.strip())
    sides = tuple(int(side) for side in match.groups()) if match else ()
    if not sides or not all(16 <= side <= LARGEST for side in sides):
        raise ParameterError(
            f"size must be width x height in pixels, 16 to {LARGEST} each, such as 1600x1200, "
            f'not "{text}"'
        )
    return sides[0], sides[1]


def _turn(text: str | None) -> tuple[str, float] | None:
    if text is None:
        return None
    match = re.fullmatch(r"\s*([xyzXYZ])\s*=\s*([-+]?\d+(?:\.\d*)?)\s*°?\s*", text)
    if not match:
        raise ParameterError(f'turn must be an axis and degrees, such as z=30, not "{text}"')
    return match[1].lower(), float(match[2])


def _kilobytes(path: Path) -> str:
    return f"{max(path.stat().st_size // 1000, 1):,} kB"
