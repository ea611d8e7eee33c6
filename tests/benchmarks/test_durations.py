"""Two runs of pytest are compared folder by folder."""

import sys

from benchmarks import durations
from tests.benchmarks.markdown import read_tables

BEFORE = {
    "tests.cutcell.graph.test_build": 4,
    "tests.cutcell.dataset.test_audit.TestOne": 3,
    "tests.test_wheel": 2,
    "tests.app.test_browser": 9,
}
AFTER = {
    "tests.cutcell.graph.test_build": 1,
    "tests.lab.dataset.test_audit": 3,
    "tests.test_wheel": 1,
    "tests.app.test_browser": 9,
}


def test_folders_are_compared_wherever_their_tests_were(tmp_path, monkeypatch, capsys):
    paths = []
    for name, run in (("before", BEFORE), ("after", AFTER)):
        cases = [f'<testcase classname="{test}" time="{time}"/>' for test, time in run.items()]
        paths.append(tmp_path / f"{name}.xml")
        paths[-1].write_text(f"<testsuite>{''.join(cases)}</testsuite>")
    monkeypatch.setattr(sys, "argv", ["durations", *map(str, paths)])
    durations.main()
    (rows,) = read_tables(capsys.readouterr().out).values()
    shares = {row["folder"]: row["share"] for row in rows}
    assert shares == {
        "tests/cutcell": "25%",
        "tests/lab": "100%",
        durations.NIGHTLY: "50%",
        "**all**": "56%",
        durations.BROWSER: "100%",
    }
