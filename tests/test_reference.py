"""Every public name has a page in the reference, docs/api.md."""

import re
from importlib import import_module

import pytest

import cutcell
import cutcell_viewers
from tests.conftest import ROOT

API = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
LISTED = re.findall(r"^   (cutcell\S*)$", API, re.MULTILINE)


def listed(path: str) -> object:
    """Return the object that an entry of the reference names."""
    module, _, name = path.rpartition(".")
    return getattr(import_module(module), name)


@pytest.mark.parametrize("package", [cutcell, cutcell_viewers], ids=lambda p: p.__name__)
def test_every_public_name_has_a_page(package):
    pages = [listed(path) for path in LISTED]
    names = [name for name in package.__all__ if name != "__version__"]
    missing = [name for name in names if not any(getattr(package, name) is page for page in pages)]
    assert missing == []
