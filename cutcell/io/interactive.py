"""An interactive page of a rig: in a notebook, or in the browser."""

from __future__ import annotations

import html
import webbrowser
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

from ..checks import check_number
from ..errors import MissingLibraryError
from ..rig.inputs import RigLike, as_rig
from ..runtime.notebook import is_notebook
from ..runtime.writing import write_all

__all__ = ["Page", "show"]


@dataclass(frozen=True)
class Page:
    """An interactive page that needs no server; a notebook shows it as an output.

    Parameters
    ----------
    content : str
        The HTML.
    height : int
        Of its frame in a notebook, in pixels.
    """

    content: str
    height: int = 520

    def __repr__(self) -> str:
        return f"Page({len(self.content):,} bytes)"

    def _repr_html_(self) -> str:
        """Return the page in a frame of its own."""
        style = f"width: 100%; height: {self.height}px; border: 0"
        return (
            f'<iframe sandbox="allow-scripts allow-downloads" style="{style}" '
            f'srcdoc="{html.escape(self.content)}"></iframe>'
        )

    def save(self, path: str | Path) -> None:
        """Write the HTML to a file.

        Raises
        ------
        FileError
            The file cannot be written.
        """
        write_all({Path(path): self.content.encode()})


def show(rig: RigLike, binding: Any = None, *, height: int = 520) -> Page:
    """Show a rig in a notebook, or else in the browser: weights, distances, clips and graph.

    Parameters
    ----------
    rig : Rig, (mesh, skeleton) or (vertices, faces, joints, parents)
    binding : Binding, optional
        Of the rig; computed when left out.
    height : int
        Of the frame in a notebook, in pixels.

    Returns
    -------
    Page
        It can be saved. Outside of IPython it is also opened in the browser, from a temporary file.
        In a notebook, with ``cutcell[notebook]``, it is a widget: its `joint` and `vertex` are what
        is chosen on the page, None for all joints and for no vertex. Set, they are chosen there.

    Raises
    ------
    MissingLibraryError
        ``cutcell[app]`` is not installed.
    MeshError, SkeletonError, ParameterError
        As of `bind`.
    """
    height = int(check_number("height", height, 100, 10000))
    rig = as_rig(rig)
    make = _loaded("interactive")
    if make is None:
        raise MissingLibraryError(
            "interactive pages need libraries that are not installed; "
            "install them by: pip install 'cutcell[app]'"
        )
    page = Page(make(rig, binding), height)
    if is_notebook():
        widget = _loaded("widget")
        return page if widget is None else widget(rig, page)
    with NamedTemporaryFile(suffix=".html", delete=False) as file:
        file.write(page.content.encode())
    webbrowser.open(Path(file.name).as_uri())
    return page


def _loaded(name: str) -> Any:
    """Return what the package above has by this name; None where its libraries are missing."""
    for above in entry_points(group="cutcell.pages", name=name):
        with suppress(ModuleNotFoundError):
            return above.load()
    return None
