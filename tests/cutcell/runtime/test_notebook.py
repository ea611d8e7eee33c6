"""Whether a notebook runs, and for whom."""

import sys
from types import SimpleNamespace

import pytest

from cutcell.runtime.notebook import is_attended, is_notebook


def runs_in(monkeypatch, shell):
    """Let IPython have a shell."""
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))


def kernel(content):
    """Return a shell whose kernel runs a request with a content."""
    return SimpleNamespace(kernel=SimpleNamespace(get_parent=lambda: {"content": content}))


def test_a_script_is_no_notebook(monkeypatch):
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    assert not is_notebook()
    assert not is_attended()


def test_a_program_that_imports_ipython_is_no_notebook(monkeypatch):
    runs_in(monkeypatch, None)
    assert not is_notebook()
    assert not is_attended()


@pytest.mark.parametrize(
    ("shell", "attended"),
    [
        (kernel({"allow_stdin": True}), True),
        (kernel({"allow_stdin": False}), False),
        (kernel({}), True),
        (SimpleNamespace(kernel=None), True),
        (SimpleNamespace(), True),
    ],
    ids=["front end", "nbclient", "silent kernel", "another kernel", "terminal"],
)
def test_a_person_can_answer_input(monkeypatch, shell, attended):
    runs_in(monkeypatch, shell)
    assert is_notebook()
    assert is_attended() is attended
