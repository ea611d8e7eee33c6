"""docs/paper.md: every label of the paper has a row; what a row names exists; each has a result."""

import importlib
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import typer.main

import cutcell
from benchmarks.paper import PARTS
from cutcell.cli.app import app

ROOT = Path(__file__).resolve().parent.parent
TEXT = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
TEX = ROOT.parent / "shared" / "paper" / "cut-cell-prior.tex"
PACKAGES = {"app": "cutcell_app", "lab": "cutcell_lab", "viewers": "cutcell_viewers"}
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
    result = {label for row in rows() for label in quoted(row[0])}
    assert result == set(LABELS)
    if TEX.exists():
        declared = set(re.findall(r"\\label\{((?:alg|equ|fig|tab):[^}]+)\}", TEX.read_text()))
        assert declared == set(LABELS)


def test_files_and_functions_are_there():
    missing = [
        (row[0], file, name)
        for row in rows()
        for file, name in named_by(row)
        if not (hasattr(module_of(file), name) if name else (ROOT / file).exists())
    ]
    assert missing == []


def named_by(row: list[str]) -> Iterator[tuple[str, str]]:
    """List the files of a row, and the functions behind each of them."""
    file = ""
    for name in [*quoted(row[2]), *(n for n in quoted(row[4]) if "/" in n)]:
        file = name if "/" in name else file
        yield file, "" if "/" in name else name


def module_of(file: str) -> ModuleType:
    folder, *rest = file.removesuffix(".py").split("/")
    return importlib.import_module(".".join([PACKAGES.get(folder, folder), *rest]))


def test_commands_are_there():
    commands = [command for row in rows() for command in quoted(row[3])]
    assert len(commands) > 20
    assert [command for command in commands if not is_there(command)] == []


def is_there(command: str) -> bool:
    first, *words = shlex.split(command)
    if first == "python":
        module = ROOT / (words[1].removeprefix("cutcell_").replace(".", "/") + ".py")
        parts = set(words[2:]) if words[1] == "benchmarks.paper" else set()
        return words[0] == "-m" and module.exists() and parts <= set(PARTS)
    if first == "cutcell":
        names, options = known_to(words)
        unknown = {w for w in words if w.startswith("--")} - options - {"--help"}
        files = [ROOT / w for w in words if w.startswith("assets/")]
        return bool(names) and not unknown and all(file.exists() for file in files)
    if first.startswith("cutcell."):
        return hasattr(cutcell, first.split("(")[0].removeprefix("cutcell."))
    return (ROOT / first).exists()


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
