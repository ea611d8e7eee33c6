"""The commands that need the page or its scenes: `cutcell app` and `cutcell render`.

Panel and PyVista are imported once a command runs, so that `--help` answers at once.
"""

from pathlib import Path
from typing import Annotated, Any

import typer

from cutcell.cli.console import for_people
from cutcell.errors import MissingLibraryError, ParameterError
from cutcell_lab.cli.networks import Networks, offer_networks

from .render_command import EPILOG, render


def add_commands(app: typer.Typer) -> None:
    """Add them to the command line."""
    app.command(name="app", epilog="Example: `cutcell app character.glb --port 5010`")(open_page)
    app.command(epilog=EPILOG)(render)


@for_people
def open_page(
    rig: Annotated[
        Path | None,
        typer.Argument(metavar="[RIG]", help="What to open; a demo character when left out."),
    ] = None,
    port: Annotated[
        int,
        typer.Option(
            "--port",
            help="Where the page is served; the next free one if taken, any free one if 0.",
        ),
    ] = 5006,
    address: Annotated[
        str,
        typer.Option(
            "--address",
            help="What to listen on. localhost: this machine only. 0.0.0.0, or the address of one"
            " network: everyone there can use the page, without a password or encryption.",
        ),
    ] = "localhost",
    pairs: Annotated[
        Path | None,
        typer.Option(
            "--pairs",
            metavar="FOLDER",
            help="Step through the pairs that `cutcell dataset audit` found, and overrule them.",
        ),
    ] = None,
    networks: Networks = None,
    show: Annotated[
        bool, typer.Option("--show/--no-show", help="Open a browser on the page.")
    ] = True,
) -> None:
    """Open the page: look at a character, its graph, distances and weights, and move it."""
    if not 0 <= port <= 65535:
        raise ParameterError(f"port must be a whole number from 0 to 65,535, not {port}")
    serve = _page()
    if rig is not None:
        from cutcell.io import load

        load(rig)  # report an invalid file here, not on an empty page
    offer_networks(networks)
    try:
        serve(rig, port=port, address=address, show=show, pairs=pairs)
    except OSError as error:
        raise ParameterError(
            f"the page cannot be served at {address}, port {port} ({error.strerror or error}); "
            "choose another --address or --port"
        ) from None


def _page() -> Any:
    """Fetch the page, or say how to install what it needs."""
    try:
        from .serve import serve
    except ModuleNotFoundError as error:
        raise MissingLibraryError(
            f"the page needs libraries that are not installed ({error.name} is missing); "
            "install them by: pip install 'cutcell[app]'"
        ) from None
    return serve
