"""The laboratory's commands, one file each."""

import typer

from . import compare, dataset, dataset_audit, evaluate, networks, sweep


def add_commands(app: typer.Typer) -> None:
    """Add them to the command line."""
    app.command(epilog=compare.EPILOG)(compare.compare)
    app.command(epilog=evaluate.EPILOG)(evaluate.evaluate)
    app.command(epilog=sweep.EPILOG)(sweep.sweep)
    dataset.dataset.command(epilog=dataset_audit.EPILOG)(dataset_audit.audit)
    app.add_typer(dataset.dataset, name="dataset")
    app.add_typer(networks.networks, name="networks")
