"""Origins that may put the page into a frame."""

import re
import subprocess
import sys

import pytest

from cutcell.errors import ParameterError
from cutcell_app.server.frames import check_origins, headers_of
from cutcell_app.widgets.modules import FOLDER


def test_origins_are_written_in_one_way():
    origins = ["https://Example.org", "https://example.org/", "http://[::1]:8000", "http://a:1"]
    expected = ("https://example.org", "http://[::1]:8000", "http://a:1")
    assert check_origins(origins) == expected


@pytest.mark.parametrize(
    "origin",
    [
        "", "*", "null", "example.org", "https://", "https://*", "https://*.example.org",
        "https://example.org/course", "https://example.org?a=1", "https://example.org#a",
        "https://me@example.org", "https://example.org:", "https://example.org:99999",
        "https://example.org:x", "ftp://example.org", "https://a https://b", "https://a;script-src",
        "https://a,b", "https://a\nb", "https://ex\u00e4mple.org", "https://[", "'self'",
        f"https://{'a' * 300}",
    ],
)  # fmt: skip
def test_what_is_no_origin_is_refused(origin):
    with pytest.raises(ParameterError, match=r"such as https://example\.org"):
        check_origins([origin])


def test_only_one_module_uses_the_browsers_storage():
    # It raises in frames of other sites and in sandboxes.
    scripts = [path for path in FOLDER.rglob("*.js") if path.name != "storage.js"]
    users = [path.name for path in scripts if re.search("(local|session)Storage", path.read_text())]
    assert users == []


def test_headers():
    assert headers_of([]) == {
        "Content-Security-Policy": "frame-ancestors 'self'",
        "X-Frame-Options": "SAMEORIGIN",
    }
    assert headers_of(["https://a.b"]) == {
        "Content-Security-Policy": "frame-ancestors 'self' https://a.b"
    }


@pytest.mark.slow
def test_the_command_reports_a_wrong_origin():
    words = ["app", "--no-show", "--port", "0", "--allow-frame", "https://example.org/course"]
    command = [sys.executable, "-m", "cutcell", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2
    assert "takes an origin without a path" in " ".join(done.stderr.split())
