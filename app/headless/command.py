"""The command `cutcell render`: a picture, a film or an interactive page of what the page shows."""

import os
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from cutcell.cli.console import for_people, print_line, print_warnings, progress_bars
from cutcell.cli.options import (
    FILES,
    METHOD_OPTIONS,
    OptionalRigFile,
    SkeletonFile,
    chosen_method,
    with_method,
    with_options,
)
from cutcell.errors import MissingLibraryError, ParameterError
from cutcell_lab.cli.networks import Networks, offer_networks

from .options import CHOICES, FIGURE, PICTURE, SETTINGS

PICTURE_SIZE = (1600, 1200)
FILM_SIZE = (960, 720)

EPILOG = """Examples:

- `cutcell render character.glb --bone hand.L weights.png`

- `cutcell render character.glb --panel distance --bone hand.L --turntable distance.mp4`

- `cutcell render character.glb --panel graph --cut z --dark graph.png`

- `cutcell render character.glb --panel pose --clip walk --error walk.gif`

- `cutcell render character.glb --panel distance --bone hand.L --sweep wave wave.mp4`

- `cutcell render character.glb --panel compare --methods now,bone_heat,artist compare.png`

- `cutcell render character.glb --address "?panel=weights" --address "?panel=distance" figure.pdf`

- `cutcell render character.glb character.html`

- `cutcell render --lesson lesson.html`"""
LESSON = "Lesson"
"""Heading of the options for it."""
INTERACTIVE = {"rig", "out", "panel", "bone", "colormap", "skeleton_file", "quiet", *METHOD_OPTIONS}
"""Parameters of the command that apply to an interactive page."""


@for_people
@with_options("choices", CHOICES)
@with_options("settings", SETTINGS)
@with_options("picture", PICTURE)
@with_options("figure", FIGURE)
@with_method()
def render(
    context: typer.Context,
    rig: OptionalRigFile = None,
    out: Annotated[
        Path | None,
        typer.Argument(
            metavar="OUT",
            help="A picture: .png or .jpg. A figure for print: .pdf or .svg. What moves is a film:"
            " .mp4 or .gif. An interactive page that needs no server: .html.",
        ),
    ] = None,
    *,
    choices: dict[str, Any],
    settings: dict[str, Any],
    picture: dict[str, Any],
    figure: dict[str, Any],
    options: dict[str, Any],
    networks: Networks = None,
    skeleton_file: SkeletonFile = None,
    lesson: Annotated[
        Path | None,
        typer.Option(
            metavar="OUT.html",
            help="Write the lesson as one file, instead of RIG and OUT.",
            rich_help_panel=LESSON,
        ),
    ] = None,
    lesson_from: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER_OR_FILE",
            help="Another lesson than the one that comes with the page.",
            rich_help_panel=LESSON,
        ),
    ] = None,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="No bars, no warnings.", rich_help_panel=FILES)
    ] = False,
) -> None:
    """Draw a character as the page shows it: a picture, a figure, a film or an interactive page.

    Weights are computed first; nothing of the character's file is changed.
    """
    scenes, orders, process = required(
        "pictures need", "cutcell_app.headless", "cutcell_viewers.order", "cutcell_viewers.process"
    )
    explicit = [name for name in context.params if _is_given(context, name)]
    if lesson is not None or lesson_from is not None:
        _write_lesson(explicit, lesson, lesson_from, quiet)
        return
    if rig is None or out is None:
        raise ParameterError(
            "a character and a file to write are missing, as in: cutcell render character.glb"
            " picture.png"
        )
    if out.suffix.lower() == ".html":
        _check_interactive(explicit)
        _write_page(rig, out, {**choices, **settings}, options, skeleton_file, quiet)
        return
    swept = choices["sweep"] is not None
    is_clip = choices["clip"] is not None and choices["time"] is None
    moves = picture["turntable"] or swept or is_clip
    addresses, captions = figure["address"] or [], figure["caption"]
    pages = [scenes.read_address(text) for text in addresses] or [({}, None)]
    is_figure = len(pages) > 1 or captions is not None
    kind = orders.check_picture_file(out, moves, len(pages) if is_figure else 0)
    size = scenes.read_size(picture["size"]) or (FILM_SIZE if moves else PICTURE_SIZE)
    drawn = scenes.Picture(**{**picture, "size": size})
    drawn.check(kind)
    from cutcell.io import load
    from cutcell.io.files import naming

    loaded = load(rig, skeleton=skeleton_file)
    offer_networks(networks, quiet)
    fields, shown = scenes.read_choices(**choices), scenes.read_settings(**settings)
    chosen = [scenes.choices_at(address, explicit, fields, shown, options) for address, _ in pages]
    with naming(rig):
        for one in chosen:
            scenes.state_of(loaded, one)  # reports a wrong name before anything long begins
    with progress_bars(quiet) as progress:
        rate = orders.FRAMES[kind] if swept else None
        frames, warnings = _describe(loaded, chosen, "resolution" in explicit, rate, progress)
        eye = next((camera for _, camera in pages if camera), None)
        order = scenes.order(loaded, frames[-1], chosen[0], drawn, eye)
        if swept:
            order = replace(order, scenes=frames)
        elif is_figure:
            order = replace(order, panels=frames, captions=tuple(captions or ()))
        process.draw_isolated(order, out, progress)
    is_print = is_figure or kind in orders.FIGURES[:2]
    about = "" if is_print else f"{size[0]} x {size[1]} pixels, "
    _report(out, about, [*loaded.warnings, *warnings], quiet)


def _describe(
    rig: Any, chosen: list[Any], has_resolution: bool, rate: int | None, progress: Any
) -> tuple[tuple[Any, ...], list[str]]:
    """Return the scene of each of some choices, or all scenes of a sweep, and the warnings."""
    from cutcell.binding import bind

    from .. import headless as scenes

    described: list[Any] = []
    bindings: dict[Any, Any] = {}
    warnings: list[str] = []
    for one in chosen:
        method, textures = one.method, scenes.textures_for(rig, one)
        if method not in bindings and len(rig.skeleton.joints):
            resolution = method.resolution if has_resolution else None
            bindings[method] = bind(rig, resolution, method=method, progress=progress)
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
    choices: dict[str, Any],
    options: dict[str, Any],
    skeleton: Path | None,
    quiet: bool,
) -> None:
    from cutcell.binding import bind
    from cutcell.checks import check_choice
    from cutcell.io import load
    from cutcell.io.files import naming
    from cutcell.runtime.writing import check_place, write_all
    from cutcell_viewers.palette import COLORMAPS

    from . import bone_index
    from .interactive import VIEWS, interactive_page

    check_place(out)
    view = check_choice("panel", choices["panel"] or "weights", VIEWS)
    colormap = check_choice("colormap", choices["colormap"] or "default", COLORMAPS)
    method, loaded = chosen_method(options), load(rig, skeleton=skeleton)
    with naming(rig):
        loaded.require_joints()
        joint = None if choices["bone"] is None else bone_index(loaded, choices["bone"])
    with progress_bars(quiet) as progress:
        binding = bind(loaded, options["resolution"], method=method, progress=progress)
        page = interactive_page(
            loaded, binding, joint=joint, view=view, colormap=colormap, progress=progress
        )
        write_all({out: page.encode()})
    _report(out, "an interactive page, ", [*loaded.warnings, *binding.warnings], quiet)


def _write_lesson(explicit: list[str], out: Path | None, source: Path | None, quiet: bool) -> None:
    from cutcell.runtime.writing import check_place, write_all

    from ..features.opened import read_checked
    from .lesson_page import lesson_page

    if out is None or out.suffix.lower() != ".html":
        raise ParameterError("a lesson is written to a page: --lesson lesson.html")
    if unused := set(explicit) - {"lesson", "lesson_from", "quiet"}:
        raise ParameterError(
            f"--lesson takes no other choices: leave out {', '.join(sorted(unused))}"
        )
    check_place(out)
    lesson = None if source is None else read_checked(source)
    with progress_bars(quiet) as progress:
        page = lesson_page(lesson, progress=progress)
        write_all({out: page.encode()})
    _report(out, "the lesson, ", [], quiet)


def _report(out: Path, about: str, warnings: list[str], quiet: bool) -> None:
    if not quiet:
        print_warnings(warnings)
        print_line(f"{out}: {about}{max(out.stat().st_size // 1000, 1):,} kB")


def _check_interactive(explicit: list[str]) -> None:
    """Raise an error for an option that does not apply to an interactive page."""
    flags = {name: row[2].split()[0] for name, row in (CHOICES | SETTINGS | PICTURE).items()}
    for name in explicit:
        if name not in INTERACTIVE:
            raise ParameterError(
                f"{flags.get(name, f'--{name}')} does not apply to an interactive page, which has"
                " controls of its own: leave it out"
            )


def required(users: str, *modules: str) -> list[Any]:
    """Import modules that need the libraries of `cutcell[app]`."""
    if os.path.expanduser("~") == "~":  # Bokeh cannot be imported without a home folder
        os.environ["HOME"] = "/nonexistent"
    try:
        return [import_module(name) for name in modules]
    except ModuleNotFoundError as error:
        raise MissingLibraryError(
            f"{users} libraries that are not installed ({error.name} is missing); "
            "install them by: pip install 'cutcell[app]'"
        ) from None


def _is_given(context: typer.Context, option: str) -> bool:
    source = context.get_parameter_source(option)
    return source is not None and source.name == "COMMANDLINE"
