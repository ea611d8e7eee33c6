"""The `cutcell` command; each subcommand has its own file.

Packages above this one add subcommands by the entry point `cutcell.commands`.

Nothing heavy is imported before a command runs, so that `--help` answers at once.
"""

from __future__ import annotations

import os
from importlib.metadata import entry_points
from typing import Annotated

import typer

from .. import __version__
from . import bind, clean, diagnose, explain, graph, joints, transfer, weights
from .console import exit_by_output, print_line

app = typer.Typer(
    name="cutcell",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="""The method: *A Geodesic Cut-Cell Prior for Neural Skinning* (Ma et al. 2026).

Exit codes: 0 success; 2 wrong input, explained in one sentence; 130 stopped by Ctrl-C;
141 the reader of the output is gone.""",
)


def _print_version(requested: bool) -> None:
    if requested:
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

    The input is a mesh and its skeleton, the output the weight of each joint at each vertex. The
    mesh may be open, have many components, or intersect itself.
    """


for module in (bind, clean, transfer, weights, graph, diagnose, explain, joints):
    command = module.__name__.rpartition(".")[2]
    app.command(epilog=module.EPILOG)(getattr(module, command))

for above in entry_points(group="cutcell.commands"):
    above.load()(app)


def main() -> None:
    """Run the command line."""
    # Read while numpy is loaded. Its threads for products of matrices, which are small here, wait
    # for more by running idle: a tenth of a second of a core each time, which kernels and the page
    # then lack.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    exit_by_output(app)
