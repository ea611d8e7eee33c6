"""The command line, as the tests of the core's commands run it."""

from tests.cutcell.cli.conftest import bar, run

__all__ = ["bar", "run"]
