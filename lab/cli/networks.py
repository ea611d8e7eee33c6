"""The commands `cutcell networks ...`: training networks that predict weights."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from cutcell.cli.console import for_people, print_json, print_table, print_warnings
from cutcell.cli.options import FILES, Json, Quiet, Resolution

from .dataset import counting

Networks = Annotated[
    list[Path] | None,
    typer.Option(
        "--networks",
        metavar="FOLDER",
        help="Trained networks to compare with: a folder of `cutcell networks train`, or a folder"
        " of such folders (needs cutcell[networks]). May be given several times.",
    ),
]
networks = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help="Train networks that predict weights (needs cutcell[networks]).",
    epilog="`docs/networks.md` describes the heads, the priors and the results.",
)


def offer_networks(folders: Sequence[Path] | None, quiet: bool = False) -> None:
    """Add trained networks to the methods of this command; see `trained_networks`."""
    if not folders:
        return
    from ..baselines import METHODS
    from ..networks import trained_networks

    warnings: list[str] = []
    METHODS.update(trained_networks(folders, warnings.append))
    if not quiet:
        print_warnings(warnings)


@networks.callback()
def _networks() -> None:
    """Keep `train` a subcommand although it is the only one."""


@networks.command(
    epilog="""Examples:

- `cutcell networks train trained --head rignet --prior cutcell --data rigs`

- `cutcell networks train trained --head rignet --prior cutcell --data rigs --epochs 200`  (goes on)

- `cutcell networks train big --head unirig --prior bind --data store --size small --points 1024`"""
)
@for_people
def train(
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder for network.pt and log.csv.")],
    head: Annotated[str, typer.Option("--head", metavar="H", help="rignet, unirig or puppeteer.")],
    data: Annotated[
        list[Path],
        typer.Option(
            "--data",
            metavar="IN",
            help="Rigs with weights to learn from: files, folders, or stores of `dataset bind`."
            " May be given several times.",
        ),
    ],
    prior: Annotated[
        str,
        typer.Option(
            "--prior",
            metavar="P",
            help="Input of the network: none, visibility (RigNet's own), voxel_unirig,"
            " voxel, cutcell (the paper's), cutcell_any (paths at any angle) or bind.",
        ),
    ] = "cutcell",
    size: Annotated[
        str,
        typer.Option("--size", metavar="S", help="tiny, small or full (as published)."),
    ] = "tiny",
    seed: Annotated[int, typer.Option("--seed", help="Seed of all random choices.")] = 0,
    epochs: Annotated[
        int, typer.Option("--epochs", help="Number of passes over the rigs, in total.")
    ] = 40,
    points: Annotated[
        int, typer.Option("--points", help="Points per rig and epoch, at least 16.")
    ] = 256,
    resolution: Resolution = 64,
    augment: Annotated[
        bool,
        typer.Option(
            "--augment/--no-augment",
            help="Omit joints and parts, pose rigs and vary the sampling at random.",
        ),
    ] = False,
    cache: Annotated[
        Path | None,
        typer.Option(
            "--cache",
            metavar="FOLDER",
            help="Cache of prepared priors. Default: the user's cache.",
            rich_help_panel=FILES,
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Train a network on rigs and the weights of their artists.

    The network is saved after each epoch, so training that was stopped can be resumed by the same
    command. A GPU is used if there is one. On a CPU results are reproducible.
    """
    from ..networks import Recipe, Samples
    from ..networks.torch_required import check_torch

    check_torch()
    from ..networks.training import train as learn

    recipe = Recipe(head, size, prior, seed, points, resolution, augment)
    warnings: list[str] = []
    samples = Samples(
        data, prior=prior, points=4 * points, resolution=resolution, cache=cache
    ).load(warnings.append)
    if not quiet:
        print_warnings(warnings)
    losses: list[float] = []
    with counting("Training", quiet or json) as step:

        def record(epoch: int, loss: float) -> None:
            losses.append(loss)
            step(epoch, epochs, f"loss {loss:.4f}")

        learn(recipe, samples, epochs, out, record)
    last = losses[-1] if losses else None
    if json:
        print_json({"output": str(out), "rigs": len(samples), "epochs": epochs, "loss": last})
    elif not quiet:
        rows = [("head", head), ("prior", prior), ("rigs", f"{len(samples):,}")]
        rows += [
            ("epochs", f"{epochs:,}"),
            ("loss", "as before" if last is None else f"{last:.4f}"),
        ]
        print_table(str(out), rows)
