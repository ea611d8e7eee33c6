"""`cutcell.show`: the interactive page in a notebook or the browser."""

import html
import re
import sys
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import urlparse

import pytest

import cutcell
from cutcell.errors import MissingLibraryError
from tests.viewers.arm import arm_rig


@pytest.fixture
def opened(monkeypatch):
    addresses = []
    monkeypatch.setattr("webbrowser.open", addresses.append)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    return addresses


def test_a_notebook_has_the_page_in_a_frame(opened, monkeypatch, tmp_path):
    rig = arm_rig()
    monkeypatch.setattr(sys.modules["IPython"], "get_ipython", object)
    page = cutcell.show(rig, cutcell.bind(rig, 16), height=300)
    frame = page._repr_html_()
    assert "height: 300px" in frame
    page.save(tmp_path / "arm.html")
    content = (tmp_path / "arm.html").read_text(encoding="utf-8")
    assert html.unescape(re.search('srcdoc="([^"]*)"', frame).group(1)) == content
    assert opened == []


def test_the_browser_opens_it_outside_of_a_notebook(opened):
    rig = arm_rig()
    page = cutcell.show(rig, cutcell.bind(rig, 16))
    path = Path(urlparse(opened[0]).path)
    assert path.read_text(encoding="utf-8") == page.content
    path.unlink()


def test_a_missing_app_is_named(opened, monkeypatch):
    def load():
        raise ModuleNotFoundError

    entries = [SimpleNamespace(load=load)]
    monkeypatch.setattr("cutcell.io.interactive.entry_points", lambda group: entries)
    with pytest.raises(MissingLibraryError, match=r"cutcell\[app\]"):
        cutcell.show(arm_rig())
