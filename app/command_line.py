"""The commands that need the page or its scenes: `cutcell app` and `cutcell render`.

Panel and PyVista are imported once a command runs, so that `--help` answers at once.
"""

from pathlib import Path
from typing import Annotated

import typer

from cutcell.cli.console import for_people
from cutcell.errors import ParameterError
from cutcell_lab.cli.networks import Networks, offer_networks

from .headless.command import EPILOG, render, required


def add_commands(app: typer.Typer) -> None:
    """Add them to the command line."""
    app.command(name="app", epilog="Example: `cutcell app character.glb --port 5010`")(open_page)
    app.command(epilog=EPILOG)(render)


@for_people
def open_page(
    rig: Annotated[
        Path | None,
        typer.Argument(metavar="[RIG]", help="The file to open. Default: a demo character."),
    ] = None,
    port: Annotated[
        int,
        typer.Option(
            "--port", help="Port of the page; the next free one if it is taken, any free one if 0."
        ),
    ] = 5006,
    address: Annotated[
        str,
        typer.Option(
            "--address",
            help="Address to listen on. localhost: this machine. 0.0.0.0, or the address of one"
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
    allow_frame: Annotated[
        list[str] | None,
        typer.Option(
            "--allow-frame",
            metavar="ORIGIN",
            help="Let pages of this origin, such as https://example.org, put the page into a frame."
            " May be repeated.",
        ),
    ] = None,
    lesson: Annotated[
        Path | None,
        typer.Option(
            "--lesson",
            metavar="FOLDER_OR_FILE",
            help="Lesson of the panel Learn: Markdown files, a step each, or one file of steps.",
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
    (server,) = required("the page needs", "cutcell_app.serve")
    if rig is not None:
        from cutcell.io import load

        load(rig)  # report an invalid file here, not on an empty page
    offer_networks(networks)
    try:
        server.serve(
            rig,
            port=port,
            address=address,
            show=show,
            pairs=pairs,
            frames=allow_frame or (),
            lesson=lesson,
        )
    except OSError as error:
        raise ParameterError(
            f"the page cannot be served at {address}, port {port} ({error.strerror or error}); "
            "choose another --address or --port"
        ) from None
