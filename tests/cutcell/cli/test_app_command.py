"""`cutcell app`: what is served, and what is refused before that."""

import sys

import pytest

from tests.cutcell.cli.files import refused

pytestmark = pytest.mark.slow

PAGE = "cutcell_app.command_line._page"


def test_serves_what_it_was_asked_to(run, bar, monkeypatch):
    seen = []
    monkeypatch.setattr(PAGE, lambda: lambda *a, **k: seen.append((a, k)))
    words = ["app", bar, "--port", 5010, "--address", "0.0.0.0", "--no-show"]
    assert run(*words).exit_code == 0
    asked = {"port": 5010, "address": "0.0.0.0", "show": False, "pairs": None}
    assert seen == [((bar,), asked)]


def test_a_wrong_file_is_told_before_anything_is_served(run, monkeypatch, tmp_path):
    monkeypatch.setattr(PAGE, lambda: pytest.fail)
    assert "no such file" in refused(run("app", tmp_path / "nope.glb"))


def test_an_audit_that_is_not_there_is_told(run, tmp_path):
    told = refused(run("app", "--pairs", tmp_path, "--no-show", "--port", 0))
    assert "audit.json: there is no such file" in told


def test_says_what_to_install_where_the_page_is_missing(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "cutcell_app.serve", None)
    assert "pip install 'cutcell[app]'" in refused(run("app"))


def test_port_out_of_range(run):
    assert "from 0 to 65,535" in refused(run("app", "--port", 70_000))


def test_an_address_that_cannot_be_served(run, monkeypatch):
    def serve(*_, **__):
        raise OSError(98, "Address already in use")

    monkeypatch.setattr(PAGE, lambda: serve)
    assert "Address already in use" in refused(run("app"))
