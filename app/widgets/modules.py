"""The browser's half of the page: the modules and styles of `frontend/`, and where they are served.

Their address tells what they hold, so that no browser takes an older version for them.
"""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from panel.custom import JSComponent

from ..server.protocol.reading import read
from ..server.protocol.received import Message

FOLDER = Path(__file__).parents[1] / "frontend"


def names(suffix: str) -> list[str]:
    """Return the files with a suffix, as paths from the folder."""
    return sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob(f"*{suffix}"))


def _version() -> str:
    """Return a hash of all scripts and styles."""
    content = b"".join(
        name.encode() + (FOLDER / name).read_bytes() for name in names(".js") + names(".css")
    )
    return hashlib.sha256(content).hexdigest()[:12]


ADDRESS = f"scripts-{_version()}"
"""Address of the folder, relative to the page."""

STATIC = {ADDRESS: str(FOLDER)}
"""For `guard`, or for `panel.serve(static_dirs=...)`."""


def script(name: str) -> str:
    """Return a module for Panel that is rendered by one of `frontend/`."""
    # Panel evaluates it from a blob, from where no path leads to the other modules.
    return f"""
export async function render(given) {{
  const module = await import(new URL("{ADDRESS}/{name}.js", document.baseURI).href)
  return module.render(given)
}}"""


def head() -> str:
    """Return what the page's head needs: all modules, and what runs before Panel draws anything."""
    # A browser fetches them at once, while the page is still loading.
    links = "".join(f'<link rel="modulepreload" href="{ADDRESS}/{name}">' for name in names(".js"))
    return f'{links}<script type="module" src="{ADDRESS}/common/panel.js"></script>'


def style(name: str) -> str:
    """Return the rules of one of the .css files of `frontend/`."""
    return (FOLDER / f"{name}.css").read_text(encoding="utf-8")


class Widget(JSComponent):
    """A widget of the page's own, which receives the messages of its script."""

    def _handle_msg(self, data: dict[str, Any]) -> None:
        self.receive(read(data))

    def receive(self, message: Message) -> None:
        """Do what a message says; ignore those of other widgets."""


class Clickable(Widget):
    """A widget of the page's own that is clicked, as a button is."""

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        self._act: Callable[[Any], Any] = lambda value: None

    def on_click(self, act: Callable[[Any], Any]) -> None:
        """Call a function with what each click reports."""
        self._act = act

    def click(self, value: Any) -> None:
        """Report a click."""
        self._act(value)
