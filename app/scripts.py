"""The browser's half of the page, put together from the files in `js/`."""

from __future__ import annotations

from pathlib import Path


def script(*names: str) -> str:
    """Return the named files of `js/` as one module, in that order."""
    folder = Path(__file__).parent / "js"
    return "\n".join((folder / f"{name}.js").read_text(encoding="utf-8") for name in names)
