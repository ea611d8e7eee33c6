"""`cutcell.show`: the interactive page in a notebook or the browser."""

import html
import re
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import urlparse

import numpy as np
import pytest

import cutcell
from cutcell.errors import MissingLibraryError, ParameterError
from cutcell.io import interactive
from tests.viewers.arm import arm_rig


@pytest.fixture
def opened(monkeypatch):
    addresses = []
    monkeypatch.setattr("webbrowser.open", addresses.append)
    monkeypatch.setattr(interactive, "is_notebook", lambda: False)
    return addresses


@pytest.fixture
def notebook(opened, monkeypatch):
    monkeypatch.setattr(interactive, "is_notebook", lambda: True)
    yield
    assert opened == []


@pytest.fixture
def missing(monkeypatch):
    """Make some libraries missing, by the names of the entry points that need them."""
    names = set()

    def load(name):
        if name in names:
            raise ModuleNotFoundError
        return next(iter(installed(group="cutcell.pages", name=name))).load()

    def entry_points(group, name):
        return [SimpleNamespace(load=lambda: load(name))]

    installed = interactive.entry_points
    monkeypatch.setattr(interactive, "entry_points", entry_points)
    return names


def framed(frame):
    return html.unescape(re.search('srcdoc="([^"]*)"', frame)[1])


def test_a_notebook_without_widgets_has_the_page_in_a_frame(notebook, missing, tmp_path):
    rig = arm_rig()
    missing.add("widget")
    page = cutcell.show(rig, cutcell.bind(rig, 16), height=300)
    frame = page._repr_html_()
    assert "height: 300px" in frame
    assert 'sandbox="allow-scripts allow-downloads"' in frame, "it cannot reach the notebook"
    page.save(tmp_path / "arm.html")
    assert framed(frame) == (tmp_path / "arm.html").read_text(encoding="utf-8")


def test_a_notebook_has_a_widget_with_joint_and_vertex(notebook, monkeypatch, tmp_path):
    rig = arm_rig()
    widget = cutcell.show(rig, cutcell.bind(rig, 16))
    assert list(widget._repr_mimebundle_()[0]) == ["text/html"], "a program runs the notebook"
    monkeypatch.setattr("cutcell_app.headless.notebook_widget.is_attended", lambda: True)
    data, _ = widget._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    widget.save(tmp_path / "arm.html")
    assert framed(data["text/html"]) == (tmp_path / "arm.html").read_text(encoding="utf-8")
    assert widget.vertex is None
    widget.joint = np.int64(2)
    with pytest.raises(ParameterError, match=r"joint.* 2"):
        widget.joint = 3
    with pytest.raises(ParameterError, match="vertex"):
        widget.vertex = len(rig.mesh.vertices)
    assert (widget.joint, widget.vertex) == (2, None)
    widget.joint = None
    widget.close()


def test_the_browser_opens_it_outside_of_a_notebook(opened):
    rig = arm_rig()
    page = cutcell.show(rig, cutcell.bind(rig, 16))
    path = Path(urlparse(opened[0]).path)
    assert path.read_text(encoding="utf-8") == page.content
    path.unlink()


def test_a_missing_app_is_named(opened, missing):
    missing.add("interactive")
    with pytest.raises(MissingLibraryError, match=r"cutcell\[app\]"):
        cutcell.show(arm_rig())
