"""The command line in this process, and a bar with two joints to give to it."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from cutcell.cli.app import app
from tests.cutcell.cli.files import JOINTS, write_obj


@pytest.fixture
def bar(tmp_path) -> Path:
    return write_obj(tmp_path / "bar.obj", joints=JOINTS)


@pytest.fixture
def run():
    runner = CliRunner(env={"COLUMNS": "120", "NO_COLOR": "1", "TERM": "dumb"})

    def invoke(*arguments):
        result = runner.invoke(app, [str(a) for a in arguments])
        if result.exception and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return invoke
