"""Texts of the page: short, but for the tour."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MAX_WORDS = 20
FOLDERS = ("derive", "document", "features", "files", "server", "shell", "widgets")


def texts(path):
    """Return the strings of a module, but for its docstrings and markup."""
    tree = ast.parse(path.read_text())
    nodes = list(ast.walk(tree))
    silent = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
    silent |= {
        id(part) for node in nodes if isinstance(node, ast.JoinedStr) for part in node.values
    }
    for node in nodes:
        if id(node) in silent:
            continue
        if isinstance(node, ast.JoinedStr):
            parts = [part.value if isinstance(part, ast.Constant) else "x" for part in node.values]
            yield "".join(parts)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def test_no_text_of_the_page_has_more_than_twenty_words():
    paths = [path for name in FOLDERS for path in (ROOT / "app" / name).rglob("*.py")]
    result = [(path.name, text) for path in paths for text in texts(path)]
    scripts = (ROOT / "app" / "frontend").rglob("*.js")
    quoted = re.compile(r'"([^"\n]*)"')
    result += [(p.name, text) for p in scripts for text in quoted.findall(p.read_text())]
    assert len(result) > 1000
    long = [
        (name, text) for name, text in result if "<" not in text and len(text.split()) > MAX_WORDS
    ]
    assert long == []
