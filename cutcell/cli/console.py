"""Output of the commands: results on standard output, all else on standard error."""

from __future__ import annotations

import json
import logging
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from typing import Any, TypeVar

import typer
from rich.console import Console
from rich.progress import BarColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars
from rich.table import Table
from rich.text import Text

from ..errors import CutcellError, comes_from_ctrl_c
from ..runtime.display import json_safe, printable
from ..runtime.progress import Progress, silent
from ..runtime.standard_output import OutputError, checked_output

WRONG_INPUT = 2
INTERRUPTED = 130
READER_GONE = 141
"""Exit code that a shell reports for a program ended by a closed pipe."""

STAGES = {
    "compile": "Compiling, once on this machine",
    "graph": "Building the graph",
    "distances": "Finding distances",
    "weights": "Weighting",
    "checks": "Checking",
}

Command = TypeVar("Command", bound=Callable[..., Any])


def for_people(command: Command) -> Command:
    """Turn errors of the user, and a lack of memory, into one message and exit code 2."""

    @wraps(command)
    def run(*args: Any, **kwargs: Any) -> Any:
        try:
            with _compilation_shown(bool(kwargs.get("quiet"))):
                return command(*args, **kwargs)
        except CutcellError as error:
            _to_stderr("error", str(error), "bold red")
            raise typer.Exit(WRONG_INPUT) from None
        except MemoryError as error:
            why = f" ({str(error).rstrip('.')})" if str(error) else ""
            advice = "choose a lower resolution, or close other programs"
            _to_stderr("error", f"there is not enough memory{why}; {advice}", "bold red")
            raise typer.Exit(WRONG_INPUT) from None
        except (KeyboardInterrupt, SystemError) as error:
            if not comes_from_ctrl_c(error):
                raise
            _to_stderr("stopped", "by Ctrl-C", "bold yellow")
            raise typer.Exit(INTERRUPTED) from None

    return run  # type: ignore[return-value]


@contextmanager
def _compilation_shown(quiet: bool) -> Iterator[None]:
    """Print a line on standard error as functions are compiled, where no bar shows it."""
    if quiet or Console(stderr=True).is_terminal:
        yield
        return
    logger, handler = logging.getLogger("cutcell.compile"), logging.StreamHandler()
    before = logger.level, logger.propagate
    logger.setLevel(logging.INFO)
    logger.propagate = False
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(before[0])
        logger.propagate = before[1]


def exit_by_output(run: Callable[[], Any]) -> None:
    """Run a program; turn a full or closed standard output into an exit code.

    A closed pipe needs no message: its reader has read enough.
    """
    try:
        with checked_output():
            run()
    except OutputError as error:
        if error.reader_is_gone:
            sys.exit(READER_GONE)
        _to_stderr("error", f"standard output cannot be written to ({error})", "bold red")
        sys.exit(WRONG_INPUT)


@contextmanager
def progress_bars(quiet: bool = False) -> Iterator[Progress]:
    """Yield a progress callback that draws a bar for each stage while the block runs.

    Nothing is drawn where standard error is not a terminal.
    """
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield silent
        return
    stage_name = TextColumn("{task.description:<18}", markup=False)
    columns = (stage_name, BarColumn(), TimeElapsedColumn())
    with Bars(*columns, console=console, transient=True) as bars:
        tasks: dict[str, TaskID] = {}

        def report(stage: str, fraction: float) -> None:
            if stage not in tasks:
                tasks[stage] = bars.add_task(STAGES.get(stage, printable(stage)), total=1.0)
            bars.update(tasks[stage], completed=fraction)

        yield report


def print_result(
    document: Mapping[str, Any],
    title: str,
    rows: Iterable[tuple[str, str]],
    json: bool,
    quiet: bool = False,
) -> None:
    """Print the warnings of a document, and the document as JSON or as a table."""
    if not quiet:
        print_warnings(document["warnings"])
    if json:
        print_json(document)
    elif not quiet:
        print_table(title, rows)


def print_json(document: Mapping[str, Any]) -> None:
    """Print one JSON document, and nothing else, on standard output."""
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    sys.stdout.write(json_safe(text) + "\n")


def print_line(text: str) -> None:
    """Print a line on standard output."""
    sys.stdout.write(printable(text) + "\n")


def print_table(title: str, rows: Iterable[tuple[str, str]]) -> None:
    """Print pairs of a name and a text as a table on standard output."""
    heading = Text(printable(title), "bold")
    table = Table(title=heading, title_justify="left", box=None)
    table.show_header = False
    table.add_column(style="dim", no_wrap=True)
    table.add_column()
    for name, value in rows:
        table.add_row(name, Text(printable(value)))
    Console(highlight=False).print(table)


def print_warnings(warnings: Iterable[str]) -> None:
    """Print each warning on a separate line of standard error."""
    for warning in warnings:
        _to_stderr("warning", warning, "bold yellow")


def _to_stderr(label: str, message: str, style: str) -> None:
    # Soft wrapping leaves lines whole, so that a sentence can be searched for and copied.
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    console.print(Text.assemble((f"{label}:", style), f" {printable(message)}"))
