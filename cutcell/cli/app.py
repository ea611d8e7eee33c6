"""The `cutcell` command; each command has a file of its own, but for compare.

Packages above this one add theirs by the entry point `cutcell.commands`.

Nothing heavy is imported before a command runs, so that `--help` answers at once.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .. import __version__
from .bind import EPILOG as BIND_EPILOG
from .bind import bind
from .clean import EPILOG as CLEAN_EPILOG
from .clean import clean
from .console import (
    exit_by_output,
    for_people,
    print_json,
    print_line,
    print_warnings,
    progress_bars,
)
from .dataset import dataset
from .diagnose import EPILOG as DIAGNOSE_EPILOG
from .diagnose import diagnose
from .explain import EPILOG as EXPLAIN_EPILOG
from .explain import explain
from .graph import EPILOG as GRAPH_EPILOG
from .graph import graph
from .joints import EPILOG as JOINTS_EPILOG
from .joints import joints
from .networks import networks as networks_commands
from .networks import offer_networks
from .options import Json, Networks, Quiet, Resolution

if TYPE_CHECKING:
    from ..metrics import Turned
    from ..rig.rig import Rig

app = typer.Typer(
    name="cutcell",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="""The method: *A Geodesic Cut-Cell Prior for Neural Skinning* (Ma et al. 2026).

Exit codes: 0 done; 2 wrong input, and one sentence says what; 130 stopped by Ctrl-C;
141 the reader of its output is gone.""",
)


def _print_version(wanted: bool) -> None:
    if wanted:
        print_line(f"cutcell {__version__}")
        raise typer.Exit


@app.callback()
def cutcell(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and stop."
        ),
    ] = False,
) -> None:
    """Skinning weights for any triangle mesh, from geodesic cut-cell graphs.

    A mesh and its skeleton go in, weights come out: how much each vertex follows each joint.
    The mesh may be open, of many components, or intersect itself.
    """


app.command(epilog=BIND_EPILOG)(bind)
app.command(epilog=CLEAN_EPILOG)(clean)
app.command(epilog=GRAPH_EPILOG)(graph)


@app.command(
    epilog="""Examples:

- `cutcell compare character.glb`

- `cutcell compare *.glb --methods cutcell_rig,bone_heat`  (medians, means and the worst rig)

- `cutcell compare *.glb --networks trained --methods rignet-cutcell-tiny-0,cutcell`

- `cutcell compare *.glb --plot errors.svg --markdown > errors.md`"""
)
@for_people
def compare(
    rigs: Annotated[
        list[Path], typer.Argument(metavar="RIG...", help="Characters with an artist's weights.")
    ],
    methods: Annotated[
        str | None,
        typer.Option(
            "--methods", metavar="A,B,...", help="Which methods; all that there are if left out."
        ),
    ] = None,
    networks: Networks = None,
    resolution: Resolution = 64,
    turned: Annotated[
        str,
        typer.Option(
            "--turned",
            metavar="J",
            help="Which joints the deformation error turns. deform: those that carry weight."
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
    the skins as joints turn by 30°, with the mesh scaled to one metre. Only joints to which
    the artist gave weight take part; --turned all turns the others, too. A method that fails on
    a rig says why; the others go on.
    """
    from ..baselines.compare import compare as measure
    from ..baselines.compare import comparison_markdown
    from ..baselines.compare.plot import check_plot, plot_comparison
    from ..baselines.compare.terminal import print_comparison
    from ..io import load
    from ..metrics import TURNED
    from ..rig.checks import check_choice

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


app.command(epilog=DIAGNOSE_EPILOG)(diagnose)
app.command(epilog=EXPLAIN_EPILOG)(explain)
app.command(epilog=JOINTS_EPILOG)(joints)
app.add_typer(dataset, name="dataset")
app.add_typer(networks_commands, name="networks")


for above in entry_points(group="cutcell.commands"):
    above.load()(app)


def main() -> None:
    """Run the command line."""
    # Read while numpy is loaded. Its threads for products of matrices, which are small here, wait
    # for more by running idle: a tenth of a second of a core each time, which kernels and the page
    # then lack.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    exit_by_output(app)
