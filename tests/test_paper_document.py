"""docs/paper.md: every label of the paper has a row; what a row names exists; each has a result."""

import importlib
import re
import shlex
from pathlib import Path

import pytest
import typer.main

from benchmarks.paper import PARTS
from cutcell.cli.app import app

ROOT = Path(__file__).resolve().parent.parent
TEXT = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
TEX = ROOT.parent / "shared" / "paper" / "cut-cell-prior.tex"
PACKAGES = {"viewers": "cutcell_viewers", "app": "cutcell_app"}
VERDICTS = {"yes", "partly", "no", "not tried"}
HEADS = ["paper", "what", "where", "by", "result", "agrees"]
LABELS = [
    "alg:cutcell_graph",
    "alg:cutcell_bonedist",
    "alg:data_leakage_analysis",
    "alg:dataset_deduplication",
    "equ:skinning_kernel",
    "fig:teaser",
    "fig:semantic_weights",
    "fig:meshing_time",
    "fig:voxelBinding",
    "fig:cage",
    "fig:cutCellGraph_3D",
    "fig:raySegments",
    "fig:graph_time",
    "fig:cutCellGraphGallery",
    "fig:distanceInit",
    "fig:running_time",
    "fig:cutCellSkinWithoutNetwork",
    "fig:geodesics",
    "fig:qual_rignet",
    "fig:qual_unirig",
    "fig:qual_puppeteer",
    "fig:qual_ai",
    "fig:runtime",
    "fig:gvb",
    "fig:qual_ani_rignet",
    "fig:qual_ani_unirig",
    "fig:qual_ani_puppeteer",
    "fig:robust_analyze",
    "fig:failure_case",
    "fig:axl_data_leakage",
    "tab:rignet_quantitative",
    "tab:unirig_quantitative",
    "tab:puppeteer_quantitative",
    "tab:graph_construction",
]
"""The paper's own labels of algorithms, equations, figures and tables."""


def rows() -> list[list[str]]:
    """Return the cells of every row about the paper."""
    before = TEXT[: TEXT.index("## What was printed")]
    lines = re.findall(r"^\|(.*)\|$", before, re.MULTILINE)
    cells = [[cell.strip() for cell in line.split(" | ")] for line in lines]
    return [row for row in cells if row != HEADS and not row[0].startswith("---")]


def quoted(cell: str) -> list[str]:
    return re.findall(r"`([^`]+)`", cell)


def test_every_row_has_a_result_and_a_verdict():
    assert len(rows()) > 60
    for row in rows():
        assert len(row) == len(HEADS), row
        assert row[-1] in VERDICTS, row
        assert all(row), row
        assert len(row[4]) > 10 or row[4] == "as above", row
        assert not re.search(r"[A-Z]+_[A-Z]+|TODO", row[4]), row


def test_every_label_of_the_paper_has_a_row():
    found = {label for row in rows() for label in quoted(row[0])}
    assert found == set(LABELS)
    if TEX.exists():
        declared = set(re.findall(r"\\label\{((?:alg|equ|fig|tab):[^}]+)\}", TEX.read_text()))
        assert declared == set(LABELS)


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row[0]} {row[1]}"[:70])
def test_files_and_functions_are_there(row):
    file = ""
    for name in [*quoted(row[2]), *(n for n in quoted(row[4]) if "/" in n)]:
        if "/" in name:
            file = name
            assert (ROOT / file).exists(), file
            continue
        folder, *rest = file.removesuffix(".py").split("/")
        module = importlib.import_module(".".join([PACKAGES.get(folder, folder), *rest]))
        assert hasattr(module, name), f"{file} has no {name}"


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row[0]} {row[1]}"[:70])
def test_commands_are_there(row):
    for command in quoted(row[3]):
        first, *words = shlex.split(command)
        if first == "python":
            assert words[0] == "-m"
            assert (ROOT / (words[1].replace(".", "/") + ".py")).exists()
            if words[1] == "benchmarks.paper":
                assert set(words[2:]) <= set(PARTS)
        elif first == "cutcell":
            names, options = known_to(words)
            assert {w for w in words if w.startswith("--")} <= options | {"--help"}, command
            assert names
            assert all((ROOT / w).exists() for w in words if w.startswith("assets/"))
        elif first.startswith("cutcell."):
            name = first.split("(")[0].removeprefix("cutcell.")
            assert hasattr(importlib.import_module("cutcell"), name)
        else:
            assert (ROOT / first).exists()


def known_to(words: list[str]) -> tuple[list[str], set[str]]:
    """Return the command that words name, and its options."""
    command, names = typer.main.get_command(app), []
    for word in words:
        below = getattr(command, "commands", {})
        if word not in below:
            break
        command = below[word]
        names.append(word)
    options = {option for p in command.params for option in (*p.opts, *p.secondary_opts)}
    return names, options


def test_links_lead_to_headings():
    for file, heading in re.findall(r"\]\(([\w.-]*\.md)?#([^)]+)\)", TEXT):
        text = (ROOT / "docs" / file).read_text(encoding="utf-8") if file else TEXT
        heads = [re.sub(r"[^\w\- ]", "", h).strip() for h in re.findall(r"^#+ (.*)$", text, re.M)]
        assert heading in {h.lower().replace(" ", "-") for h in heads}, f"{file}#{heading}"
