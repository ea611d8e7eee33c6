"""The command `cutcell compare`: methods measured against the artist's weights."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutcell.cli.console import for_people, print_json, print_warnings, progress_bars
from cutcell.cli.options import Json, Quiet, Resolution

from .networks import Networks, offer_networks

if TYPE_CHECKING:
    from cutcell.rig import Rig

    from ..metrics import Turned

EPILOG = """Examples:

- `cutcell compare character.glb`

- `cutcell compare *.glb --methods cutcell_rig,bone_heat`  (medians, means and the worst rig)

- `cutcell compare *.glb --networks trained --methods rignet-cutcell-tiny-0,cutcell`

- `cutcell compare *.glb --plot errors.svg --markdown > errors.md`"""


@for_people
def compare(
    rigs: Annotated[
        list[Path], typer.Argument(metavar="RIG...", help="Characters with an artist's weights.")
    ],
    methods: Annotated[
        str | None,
        typer.Option("--methods", metavar="A,B,...", help="Methods to compare; all by default."),
    ] = None,
    networks: Networks = None,
    resolution: Resolution = 64,
    turned: Annotated[
        str,
        typer.Option(
            "--turned",
            metavar="J",
            help="Joints that the deformation error turns. deform: joints that carry weight."
            " all: every joint of the skeleton, as in the paper.",
        ),
    ] = "deform",
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print Markdown, with a table for each measure.")
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option(
            "--plot", metavar="FILE", help="Draw the errors of all methods: .png, .svg or .pdf."
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Bind characters by several methods and measure each against the artist's weights.

    L1 is the paper's weight error, cm² its deformation error: the squared distance between
    the skins as joints turn by 30°, with the mesh scaled to one metre. By default only joints
    with artist weights turn; --turned all turns the others, too. If a method fails on a rig, the
    table shows the reason.
    """
    from cutcell.checks import check_choice
    from cutcell.io import load

    from ..baselines.compare import compare as measure
    from ..baselines.compare import comparison_markdown
    from ..baselines.compare.plot import check_plot, plot_comparison
    from ..baselines.compare.terminal import print_comparison
    from ..metrics import TURNED

    if plot is not None:
        check_plot(plot)
    which: Turned = check_choice("turned", turned, TURNED)
    offer_networks(networks, quiet)
    names = None if methods is None else [name.strip() for name in methods.split(",")]
    warnings: list[str] = []

    def load_each() -> Iterator[Rig]:
        for path in rigs:
            loaded = load(path)
            warnings.extend(f"{path.name}: {text}" for text in loaded.warnings)
            yield loaded

    with progress_bars(quiet) as progress:
        comparison = measure(
            load_each(), names, resolution=resolution, turned=which, progress=progress
        )
    if not quiet:
        print_warnings(warnings)
    if plot is not None:
        plot_comparison(comparison, plot)
    if json:
        print_json(comparison.to_dict())
    elif markdown:
        print(comparison_markdown(comparison))
    else:
        print_comparison(comparison)
