"""`cutcell app`: what is served, and what is refused before that."""

import sys
from types import SimpleNamespace

import pytest

from tests.cutcell.cli.files import refused

pytestmark = pytest.mark.slow


def serve_by(monkeypatch, serve):
    """Let the command serve the page by another function."""
    server = SimpleNamespace(serve=serve)
    monkeypatch.setattr("cutcell_app.command_line.required", lambda *names: [server])


def test_serves_what_it_was_asked_to(run, bar, monkeypatch):
    seen = []
    serve_by(monkeypatch, lambda *a, **k: seen.append((a, k)))
    words = ["app", bar, "--port", 5010, "--address", "0.0.0.0", "--no-show"]
    assert run(*words).exit_code == 0
    asked = {"port": 5010, "address": "0.0.0.0", "show": False, "pairs": None}
    asked |= {"lesson": None, "frames": ()}
    assert seen == [((bar,), asked)]


def test_a_wrong_file_is_told_before_anything_is_served(run, monkeypatch, tmp_path):
    serve_by(monkeypatch, pytest.fail)
    assert "no such file" in refused(run("app", tmp_path / "nope.glb"))


def test_a_wrong_lesson_is_refused_before_the_page_is_served(run, tmp_path):
    (tmp_path / "01.md").write_text("---\ntitle: T\n---\n")
    reports = refused(run("app", "--lesson", tmp_path, "--no-show", "--port", 0))
    assert "01.md, line 2, question: is missing" in reports


def test_an_audit_that_is_not_there_is_told(run, tmp_path):
    reports = refused(run("app", "--pairs", tmp_path, "--no-show", "--port", 0))
    assert "audit.json: there is no such file" in reports


def test_says_what_to_install_where_the_page_is_missing(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "cutcell_app.serve", None)
    assert "pip install 'cutcell[app]'" in refused(run("app"))


def test_port_out_of_range(run):
    assert "from 0 to 65,535" in refused(run("app", "--port", 70_000))


def test_an_address_that_cannot_be_served(run, monkeypatch):
    def serve(*_, **__):
        raise OSError(98, "Address already in use")

    serve_by(monkeypatch, serve)
    assert "Address already in use" in refused(run("app"))
