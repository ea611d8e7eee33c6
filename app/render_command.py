"""The command `cutcell render`: a picture, a film or an interactive page of what the page shows."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from cutcell.cli.console import for_people, print_line, print_warnings, progress_bars
from cutcell.cli.options import (
    FILES,
    METHOD_OPTIONS,
    RigFile,
    SkeletonFile,
    chosen_method,
    with_method,
    with_options,
)
from cutcell.errors import MissingLibraryError, ParameterError
from cutcell_lab.cli.networks import Networks, offer_networks

from .render_flags import CHOICES, PICTURE, SETTINGS, WHAT

PageAddress = Annotated[
    list[str] | None,
    typer.Option(
        "--address",
        metavar="URL",
        help="Draw what a page of this address shows, from its camera. Other options come first."
        " The page's character is not opened. Given several times: the panels of a figure, from"
        " one camera.",
        rich_help_panel=WHAT,
    ),
]
Captions = Annotated[
    list[str] | None,
    typer.Option(
        "--caption",
        metavar="TEXT",
        help="Of a figure's panel; given once for each.",
        rich_help_panel=WHAT,
    ),
]
PICTURE_SIZE = (1600, 1200)
FILM_SIZE = (960, 720)
LARGEST = 8192

EPILOG = """Examples:

- `cutcell render character.glb --bone hand.L weights.png`

- `cutcell render character.glb --panel distance --bone hand.L --turntable distance.mp4`

- `cutcell render character.glb --panel graph --cut z --dark graph.png`

- `cutcell render character.glb --panel pose --clip walk --error walk.gif`

- `cutcell render character.glb --panel distance --bone hand.L --sweep wave wave.mp4`

- `cutcell render character.glb --panel compare --methods now,bone_heat,artist compare.png`

- `cutcell render character.glb --address "?panel=weights" --address "?panel=distance" figure.pdf`

- `cutcell render character.glb character.html`"""
INTERACTIVE = {"rig", "out", "panel", "bone", "skeleton_file", "quiet", *METHOD_OPTIONS}
"""Parameters of the command that an interactive page follows."""


@for_people
@with_options("choices", CHOICES)
@with_options("settings", SETTINGS)
@with_options("picture", PICTURE)
@with_method()
def render(
    context: typer.Context,
    rig: RigFile,
    out: Annotated[
        Path,
        typer.Argument(
            metavar="OUT",
            help="A picture: .png or .jpg. A figure for print: .pdf or .svg. What moves is a film:"
            " .mp4 or .gif. An interactive page that needs no server: .html.",
        ),
    ],
    *,
    choices: dict[str, Any],
    settings: dict[str, Any],
    picture: dict[str, Any],
    options: dict[str, Any],
    networks: Networks = None,
    address: PageAddress = None,
    caption: Captions = None,
    skeleton_file: SkeletonFile = None,
    quiet: Annotated[
        bool,
        typer.Option("--quiet", "-q", help="No bars, no warnings.", rich_help_panel=FILES),
    ] = False,
) -> None:
    """Draw a character as the page shows it: a picture, a figure, a film or an interactive page.

    Weights are computed first; nothing of the character's file is changed.
    """
    scenes, film, worker = _libraries()
    given = [name for name in context.params if _is_given(context, name)]
    if out.suffix.lower() == ".html":
        _check_interactive(given)
        _write_page(rig, out, choices=choices, options=options, skeleton=skeleton_file, quiet=quiet)
        return
    swept = choices["sweep"] is not None
    moves = (
        picture["turntable"] or swept or (choices["clip"] is not None and choices["time"] is None)
    )
    pages = [scenes.read_address(text) for text in address or []] or [scenes.Address()]
    is_figure = len(pages) > 1 or caption is not None
    kind = film.check_picture_file(out, moves, len(pages) if is_figure else 0)
    scenes.check_picture(**picture, kind=kind)
    size = _size(picture.pop("size")) or (FILM_SIZE if moves else PICTURE_SIZE)
    from cutcell.io import load
    from cutcell.io.files import naming

    loaded = load(rig, skeleton=skeleton_file)
    offer_networks(networks, quiet)
    choices["turn"] = _turn(choices["turn"])
    names = [name.strip() for name in choices["methods"].split(",") if name.strip()]
    chosen = []
    for page in pages:
        of_page = {
            "panel": choices["panel"] or page.panel or "weights",
            "bone": choices["bone"] or page.bone,
            "methods": names or page.methods,
        }
        shown = page.without(given) | scenes.settings_of(**settings)
        method = chosen_method(
            {**options, **{name: v for name, v in page.method.items() if name not in given}}
        )
        chosen.append(scenes.Choices(**{**choices, **of_page}, settings=shown, method=method))
    # A wrong name is refused before anything long begins.
    with naming(rig):
        for one in chosen:
            scenes.check(loaded, one, picture["view"])
    with progress_bars(quiet) as progress:
        frames, warnings = _describe(
            loaded,
            chosen,
            "resolution" in given,
            film.FRAMES.get(kind) if swept else None,
            progress,
        )
        eye = next((page.camera for page in pages if page.camera), None)
        order = scenes.order(loaded, frames[-1], chosen[0], size=size, eye=eye, **picture)
        if swept:
            order = replace(order, scenes=frames)
        elif is_figure:
            order = replace(order, panels=frames, captions=tuple(caption or ()))
        worker.draw_apart(order, out, progress)
    if not quiet:
        print_warnings([*loaded.warnings, *warnings])
        pixels = "" if is_figure or kind in film.FIGURES[:2] else f"{size[0]} x {size[1]} pixels, "
        print_line(f"{out}: {pixels}{_kilobytes(out)}")


def _describe(
    rig: Any, chosen: list[Any], has_resolution: bool, rate: int | None, progress: Any
) -> tuple[tuple[Any, ...], list[str]]:
    """Return the scene of each of some choices, or all scenes of a sweep, and what to warn of."""
    from cutcell.editing import bind

    from . import render as scenes

    described: list[Any] = []
    bindings: dict[Any, Any] = {}
    warnings: list[str] = []
    for one in chosen:
        method, textures = one.method, scenes.textures_for(rig, one)
        if method not in bindings and len(rig.skeleton.joints):
            bindings[method] = bind(rig, method=method, progress=progress)
            warnings += bindings[method].warnings
        computed: dict[str, Any] = {
            "binding": bindings.get(method),
            "resolution": method.resolution if has_resolution else None,
            "progress": progress,
        }
        if rate is not None:
            described += scenes.describe_sweep(rig, one, rate, **computed)
        else:
            described.append(scenes.describe(rig, one, textures=textures, **computed))
        warnings += textures.notes if textures else ()
    return tuple(described), list(dict.fromkeys(warnings))


def _write_page(
    rig: Path,
    out: Path,
    *,
    choices: dict[str, Any],
    options: dict[str, Any],
    skeleton: Path | None,
    quiet: bool,
) -> None:
    from cutcell.editing import bind
    from cutcell.io import load
    from cutcell.io.files import naming
    from cutcell.rig.checks import check_choice
    from cutcell.runtime.writing import check_place, write_all

    from .render import find_bone
    from .standalone.page import VIEWS, interactive_page

    check_place(out)
    view = check_choice("panel", choices["panel"] or "weights", VIEWS)
    method, loaded = chosen_method(options), load(rig, skeleton=skeleton)
    with naming(rig):
        loaded.require_joints()
        joint = None if choices["bone"] is None else find_bone(loaded, choices["bone"])
    with progress_bars(quiet) as progress:
        binding = bind(loaded, method=method, progress=progress)
        page = interactive_page(loaded, binding, joint=joint, view=view, progress=progress)
        write_all({out: page.encode()})
    if not quiet:
        print_warnings([*loaded.warnings, *binding.warnings])
        print_line(f"{out}: an interactive page, {_kilobytes(out)}")


def _check_interactive(given: list[str]) -> None:
    """Raise an error for an option that an interactive page does not follow."""
    flags = {name: row[2].split()[0] for name, row in (CHOICES | SETTINGS | PICTURE).items()}
    for name in given:
        if name not in INTERACTIVE:
            raise ParameterError(
                f"{flags.get(name, f'--{name}')} does not apply to an interactive page, which has"
                " controls of its own: leave it out"
            )


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


def _size(text: str | None) -> tuple[int, int] | None:
    if not text:
        return None
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
