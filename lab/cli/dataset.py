"""The commands `cutcell dataset ...`: from an archive of rigs to training data."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from cutcell.cli.console import for_people, print_json, print_table, print_warnings
from cutcell.cli.options import FILES, METHOD, Json, Quiet, Resolution, chosen_method
from cutcell.runtime.display import printable

WORK = "Workers"
FEW = 5
"""Failures that are printed; the report has all."""

dataset = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help="Prepare rigs for training: split, bind, audit, export and generate them.",
    epilog="`docs/dataset.md` describes all steps from a download to training data.",
)

Inputs = Annotated[
    list[Path],
    typer.Argument(
        metavar="IN...",
        help="Files and folders of rigs: what `bind` reads, RigNet's folders obj and rig_info, "
        "UniRig's raw_data.npz, Puppeteer's HDF5.",
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Address of a Dask scheduler, tcp://HOST:PORT. Default: this machine only.",
        rich_help_panel=WORK,
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(
        "--workers",
        help="Assets at a time on this machine. Default: one per core.",
        rich_help_panel=WORK,
    ),
]


@dataset.command(
    epilog="""Example:

- `cutcell dataset split articulation_xlv2.npz rigs`"""
)
@for_people
def split(
    archive: Annotated[
        Path, typer.Argument(metavar="ARCHIVE", help="Articulation-XL 2.0 as it is published.")
    ],
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Output folder, with one file per asset.")
    ],
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Split ARCHIVE into one npz file per asset, without running pickled code.

    Only arrays, texts and numbers are read. Other assets are left out and reported. A split
    that was stopped can be resumed by the same command.
    """
    from ..dataset.read.archive import split as divide

    with counting("Splitting", quiet or json) as step:
        done = divide(archive, folder, lambda asset: step(asset.index + 1, None, asset.name))
    if not quiet:
        print_warnings(list(done.refused.values()))
    if json:
        print_json({"written": done.written, "kept": done.kept, "refused": dict(done.refused)})
    elif not quiet:
        rows = {"written": done.written, "there before": done.kept, "left out": len(done.refused)}
        print_table(f"{archive.name} -> {folder}", [(k, f"{v:,}") for k, v in rows.items()])


@dataset.command(
    epilog="""Examples:

- `cutcell dataset bind rigs store`

- `cutcell dataset bind rigs store --scheduler tcp://10.0.0.1:8786`  (a cluster)

- `cutcell dataset bind rigs store --method animation --precision float16`"""
)
@for_people
def bind(
    paths: Annotated[list[Path], typer.Argument(metavar="IN... OUT", help="Rigs, then the store.")],
    method: Annotated[
        str,
        typer.Option(
            "--method",
            metavar="M",
            help="animation: weights for animation. paper: as in the paper.",
            rich_help_panel=METHOD,
        ),
    ] = "paper",
    resolution: Resolution = 64,
    precision: Annotated[
        str, typer.Option("--precision", help="float32 or float16.", rich_help_panel=FILES)
    ] = "float32",
    bones: Annotated[
        bool,
        typer.Option(
            "--bones/--no-bones",
            help="Include distances of single bones, which RigNet needs.",
            rich_help_panel=METHOD,
        ),
    ] = True,
    scheduler: Scheduler = None,
    workers: Workers = None,
    processes: Annotated[
        bool,
        typer.Option(
            "--processes",
            help="Use processes as Dask workers on this machine.",
            rich_help_panel=WORK,
        ),
    ] = False,
    time_limit: Annotated[
        float,
        typer.Option("--time-limit", help="Maximum seconds per asset.", rich_help_panel=WORK),
    ] = 600.0,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compute distances, weights and metrics of every rig in IN, and save them in the store OUT.

    Assets that are already in OUT are skipped, so a run that was stopped can be resumed. An asset
    that crashes, hangs or needs too much memory does not affect the others. The report is
    OUT/report.html, the list of all assets OUT/manifest.parquet.
    """
    from ..dataset.audit.report import bind_counts, write_bind_report
    from ..dataset.bind.binding import bind_all
    from ..dataset.read.store import Parameters

    *inputs, out = two_or_more(paths, "rigs and the store, such as: bind rigs store")
    how = chosen_method({"method": method, "resolution": resolution})
    parameters = Parameters(how, precision, bones)  # type: ignore[arg-type]
    with counting("Binding", quiet or json) as step:
        report = bind_all(
            inputs,
            out,
            parameters,
            scheduler=scheduler,
            workers=workers,
            processes=processes,
            time_limit=time_limit,
            report=step,
        )
    write_bind_report(report, out / "report.html")
    if json:
        print_json(
            {
                "store": str(out),
                "assets": len(report.rows),
                "bound": report.bound,
                "known": report.known,
                "failed": report.failures,
                "damaged": report.damaged,
                "stretched": report.stretched,
                "seconds": round(report.seconds, 3),
            }
        )
    elif not quiet:
        print_warnings(
            f"{name}: its file in the store was damaged, and it was bound again"
            for name in report.damaged
        )
        print_failures(report.failures)
        print_stretched(report.stretched)
        print_table(str(out), bind_counts(report).items())


@dataset.command(
    epilog="""Examples:

- `cutcell dataset export store rignet_data --format rignet`

- `cutcell dataset export store train.h5 --format puppeteer`

- `cutcell dataset export store train.parquet --format parquet`"""
)
@for_people
def export(
    store: Annotated[Path, typer.Argument(metavar="STORE", help="Made by `dataset bind`.")],
    out: Annotated[
        Path,
        typer.Argument(metavar="OUT", help="Output folder, or the file of Puppeteer or Parquet."),
    ],
    kind: Annotated[
        str, typer.Option("--format", metavar="F", help="rignet, unirig, puppeteer or parquet.")
    ],
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write STORE in the format of the training code of RigNet, UniRig or Puppeteer, or Parquet.

    The result replaces RigNet's volumetric geodesics or UniRig's voxel_skin, or adds `prior` to
    Puppeteer's HDF5. Parquet has a row for each asset.
    """
    from ..dataset.export import export as write

    done = 0

    def one(name: str) -> None:
        nonlocal done
        done += 1
        step(done, None, name)

    with counting("Exporting", quiet or json) as step:
        count = write(store, out, kind, one)
    if json:
        print_json({"output": str(out), "format": kind, "assets": count})
    elif not quiet:
        print_table(str(out), [("format", kind), ("assets", f"{count:,}")])


def two_or_more(paths: list[Path], what: str) -> list[Path]:
    """Return the paths of a command that needs at least an input and an output."""
    from cutcell.errors import ParameterError

    if len(paths) < 2:
        raise ParameterError(f"give {what}")
    return paths


def print_failures(failures: dict[str, str]) -> None:
    """Print the first failures, and how many more there are."""
    _print_first([f"{name}: {why}" for name, why in failures.items()], "failed")


def print_stretched(shares: dict[str, float]) -> None:
    """Print the characters of which most stretches as joints turn, and how many more there are."""
    part = "of the surface stretches or shrinks to more than twice when joints turn"
    _print_first([f"{name}: {share:.0%} {part}" for name, share in shares.items()], "stretch")


def _print_first(lines: list[str], verb: str) -> None:
    print_warnings(lines[:FEW])
    if len(lines) > FEW:
        print_warnings([f"and {len(lines) - FEW:,} more {verb}; the report lists all"])


Step = Callable[[int, int | None, str], Any]


@contextmanager
def counting(what: str, quiet: bool) -> Iterator[Step]:
    """Yield a function that shows the number done, the total and the remaining time."""
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda done, count, name: None
        return
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.fields[name]}", markup=False),
    )
    with Progress(*columns, console=console, transient=True) as bars:
        task = bars.add_task(what, total=None, name="")

        def step(done: int, count: int | None, name: str) -> None:
            bars.update(task, completed=done, total=count, name=printable(name)[-40:])

        yield step
