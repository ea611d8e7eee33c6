"""Names that would obey nobody, as they are shown on terminals, in tables and in JSON."""

import csv
import json
import unicodedata
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from cutcell.cli.console import print_json, print_line, print_table, print_warnings, progress_bars
from cutcell.rig import Rig, Skeleton, TriangleMesh
from cutcell.runtime.display import (
    MAX_LETTERS,
    json_safe,
    printable,
    shown_name,
)
from cutcell_app.files.table_export import save_numbers, spreadsheet_cell
from cutcell_app.server.messages import without_folders
from cutcell_lab.baselines.compare.markdown import comparison_markdown
from cutcell_lab.baselines.compare.scores import Comparison, MethodScore, RigScore
from cutcell_lab.baselines.compare.terminal import comparison_table
from cutcell_lab.metrics import Turn
from cutcell_viewers.short_names import short_names

NASTY = {
    "colour": "\x1b[31mred\x1b[0m",
    "title": "\x1b]0;owned\x07",
    "c1": "a\x9b31mb",
    "bell": "\x07\x08\x7f",
    "lines": "a\r\nb\u2028c\u2029d\x85e",
    "direction": "a\u202egpj.exe\u2066\u200e",
    "surrogate": "a\ud800b",
    "zero width": "a\u200bb\ufeff\u2060",
    "markup": "[red]x[/red][link=file:///etc/passwd]y[/link][/]\\[b]",
}


def hidden(text):
    """Return what of a text a terminal would obey or not show."""
    bad = [c for c in text if unicodedata.category(c) in ("Cc", "Cf", "Cs", "Zl", "Zp")]
    return [c for c in bad if c not in "\u200c\u200d"]


@pytest.mark.parametrize("name", NASTY)
def test_nothing_is_hidden_and_it_is_one_line(name):
    assert not hidden(printable(NASTY[name]))


@given(st.text(st.characters()))
def test_whatever_it_holds(text):
    shown = printable(text)
    assert not hidden(shown)
    shown.encode()  # it can be written in UTF-8


@pytest.mark.parametrize(
    "name", ["hand.L", "骨", "يد", "कृष्ण", "👩\u200d🚀", "mixamorig:Hips", "a b"]
)
def test_what_people_write_stays(name):
    assert printable(name) == shown_name(name) == spreadsheet_cell(name) == name


def test_long_names_are_cut():
    assert len(shown_name("a" * 10**6)) == MAX_LETTERS
    assert shown_name("a" * 10**6).endswith("a…")


@pytest.mark.parametrize("name", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", " =1", "\r\n=1", "＝1"])
def test_a_name_is_no_formula(name):
    assert spreadsheet_cell(name).startswith("'")


def test_a_csv_holds_neither_formulas_nor_more_lines(tmp_path):
    names = ("=cmd|' /C calc'!A0", "a\nb,c", "\x1b[31m", 'x"y', "hips")
    corners = np.eye(3)
    rig = Rig(TriangleMesh(corners, [[0, 1, 2]]), Skeleton(np.zeros((5, 3)), [-1] * 5, names))
    path = tmp_path / "weights.csv"
    save_numbers(path, rig, weights=np.zeros((3, 5)))
    text = path.read_text(encoding="utf-8")
    rows = list(csv.reader(text.splitlines()))
    assert len(rows) == 4
    assert rows[0] == ["vertex", f"'{names[0]}", "a\\nb,c", "\\x1b[31m", 'x"y', "hips"]


def test_shared_prefixes_of_joints_are_dropped_and_long_names_cut_in_the_middle():
    bare = ["Hips", "Spine", "Head", "Neck"]
    full = ["Armature", *(f"mixamorig:{name}" for name in bare)]
    assert short_names(full) == ["Armature", *bare]
    more = ["L Thigh", "R Thigh", "Spine", "Head"]
    assert short_names(["_rootJoint", *(f"Bip001 {name}" for name in more)]) == [
        "_rootJoint",
        *more,
    ]
    for whole in (["hand.L", "hand.R"], ["Bone.001", "Bone.002", "Bone.003"], [], ["a"]):
        assert short_names(whole) == whole
    long = [f"a_{'very_' * 20}long_joint_{side}" for side in "LR"]
    assert all(len(name) <= 36 and "…" in name for name in short_names(long))
    assert [name[-1] for name in short_names(long)] == ["L", "R"]


@given(st.lists(st.text("ab:_|. ", max_size=40), unique=True))
def test_short_names_stay_different(names):
    assert len(set(short_names(names))) == len(names)


@given(st.dictionaries(st.text(st.characters()), st.text(st.characters())))
def test_json_means_the_same(document):
    text = json_safe(json.dumps(document, indent=2, ensure_ascii=False))
    assert json.loads(text) == document
    assert not hidden(text.replace("\n", ""))


class TestConsole:
    """Neither control characters nor rich's markup are obeyed."""

    text = "".join(NASTY.values())

    def check(self, told):
        assert not hidden(told.replace("\n", ""))
        assert "[link=file" in told, "markup is text"

    def test_errors_and_warnings(self, capsys):
        print_warnings([self.text])
        self.check(capsys.readouterr().err)

    def test_tables(self, capsys, monkeypatch):
        monkeypatch.setenv("COLUMNS", "1000")
        print_table(self.text, [("mesh", self.text)])
        self.check(capsys.readouterr().out)

    def test_json(self, capsys):
        print_json({"name": self.text})
        reports = capsys.readouterr().out
        assert not hidden(reports.replace("\n", ""))
        assert json.loads(reports) == {"name": self.text}

    def test_lines(self, capsys):
        print_line(self.text)
        self.check(capsys.readouterr().out)

    def test_bars(self, capsys, monkeypatch):
        monkeypatch.setenv("FORCE_COLOR", "1")
        monkeypatch.setenv("COLUMNS", "1000")
        with progress_bars() as report:
            report("\x1b]0;owned\x07[red]x[/red]", 0.5)
        reports = capsys.readouterr().err
        assert "\x1b]0" not in reports
        assert "[red]x" in reports


class TestFolders:
    @pytest.mark.parametrize(
        ("text", "left"),
        [
            ("/tmp/cutcell-x/abc/rig.glb: is empty", "rig.glb: is empty"),
            ("No such file: '/home/ann/rigs/a.bin'", "No such file: 'a.bin'"),
            ("C:\\Users\\ann\\a.glb: no", "a.glb: no"),
            ("(/a/b/c.py, line 3)", "(c.py, line 3)"),
            ("12 km/h and 1/2 or Armature/Hips", "12 km/h and 1/2 or Armature/Hips"),
            ("see https://example.org/a/b", "see https://example.org/a/b"),
            ("rig.glb: has no joints", "rig.glb: has no joints"),
        ],
    )
    def test_only_the_names_of_files_are_told(self, text, left):
        assert without_folders(text) == left

    def test_folders_with_spaces_are_known_by_name(self):
        folder = Path("/home/Jane Doe/my rigs")
        reports = without_folders(f"{folder}/sub/a.glb: is empty", [Path("/"), folder])
        assert reports == "a.glb: is empty"


def test_a_comparison_of_nasty_names(capsys, monkeypatch):
    name = TestConsole.text + "|"
    turn = Turn(0, name, "x", 1.0, 1.0)
    scores = (
        MethodScore(
            "euclidean", values={"l1": 1.0, "deformation": 1.0, "seconds": 1.0}, worst=(turn,)
        ),
        MethodScore("bone_heat", failed=name),
    )
    rig = RigScore(name, 3, 2, 0, 0, scores)
    for rigs in ((rig,), (rig, rig)):
        comparison = Comparison(rigs, ("euclidean", "bone_heat"))
        console = Console(width=1000, highlight=False)
        with console.capture() as reports:
            console.print(comparison_table(comparison, 1000))
        assert not hidden(reports.get().replace("\n", ""))
        assert "[red]x" in reports.get()
        assert not hidden(comparison_markdown(comparison).replace("\n", ""))
