"""Scenes of what the core computes, described as plain data and drawn by PyVista.

In a notebook::

    import cutcell, cutcell_viewers
    from cutcell_viewers.weights_scene import weights_scene

    rig = cutcell.load("character.glb")
    binding = cutcell.bind(rig)
    cutcell_viewers.show(weights_scene(rig, binding.weights))
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from PIL.Image import Image
    from pyvista import Plotter

    from .camera import Camera
    from .description import Description

__all__ = ["describe", "figure", "plotter", "show"]


def show(
    description: Description,
    *,
    size: tuple[int, int] = (900, 675),
    dark: bool = False,
    camera: Camera | None = None,
    legend: bool = True,
) -> Image:
    """Draw a scene; a notebook shows the returned object.

    Parameters
    ----------
    description : Description
        As `weights_scene` and its kin return, or `cutcell_app.headless.describe`.
    size : (int, int)
        Width and height in pixels.
    dark : bool
    camera : Camera, optional
        Sees all of the scene by default.
    legend : bool

    Returns
    -------
    PIL.Image.Image

    Raises
    ------
    MissingLibraryError
        This machine has no OpenGL. Drawing in another process does not end yours.
    """
    from io import BytesIO
    from pathlib import Path
    from tempfile import TemporaryDirectory

    from PIL import Image

    from .order import Order
    from .process import draw_isolated

    theme = "dark" if dark else "light"
    with TemporaryDirectory(prefix="cutcell-show-") as folder:
        path = Path(folder) / "scene.png"
        draw_isolated(Order(description, theme, size, camera, legend=legend), path)
        return Image.open(BytesIO(path.read_bytes()))


def figure(
    descriptions: Sequence[Description],
    path: str | Path,
    *,
    captions: Sequence[str] = (),
    size: tuple[int, int] = (1200, 900),
    dark: bool = False,
    camera: Camera | None = None,
    legend: bool = True,
) -> None:
    """Draw scenes as the panels of one figure, with one camera, letters, captions and a legend.

    Parameters
    ----------
    descriptions : sequence of Description
        Up to six. Each view of a scene is a separate panel.
    path : str or Path
        Its ending selects the format: .pdf or .svg, whose text stays text, or .png.
    captions : sequence of str
        One a panel. By default the names of the views, or the titles of legends that differ.
    size : (int, int)
        Width and height of a panel's picture in pixels.
    dark : bool
    camera : Camera, optional
        Sees all of every scene by default.
    legend : bool
        Whether there are legends: a single one where all panels have the same scale.

    Raises
    ------
    ParameterError
        More than six panels, none, or another number of captions.
    FileError
        Another ending, or the file cannot be written.
    MissingLibraryError
        This machine has no OpenGL.
    """
    from cutcell.errors import ParameterError

    from .order import Order
    from .process import draw_isolated

    if not descriptions:
        raise ParameterError("a figure needs at least one scene")
    panels, theme = tuple(descriptions), "dark" if dark else "light"
    order = Order(panels[0], theme, size, camera, legend=legend)
    draw_isolated(replace(order, panels=panels, captions=tuple(captions)), path)


def plotter(
    description: Description,
    *,
    size: tuple[int, int] = (900, 675),
    dark: bool = False,
    legend: bool = True,
) -> Plotter:
    """Return a scene as a PyVista plotter, to add to it or to call its `show()`.

    Parameters
    ----------
    description : Description
        With a single view.
    size : (int, int)
        Width and height in pixels.
    dark : bool
    legend : bool

    Returns
    -------
    pyvista.Plotter
    """
    from .camera import framing
    from .palette import DARK, LIGHT
    from .plotters import add_legend
    from .process import require_opengl
    from .scene import Scene

    require_opengl()
    scene = Scene(DARK if dark else LIGHT, size, layered=False)
    scene.show(description)
    scene.set_camera(framing(description.bounds, size[0] / size[1]))
    result: Any = scene.plotter
    result.set_background(scene.theme.bottom, top=scene.theme.top)
    if legend and description.legend is not None:
        add_legend(result, description.legend, scene.theme)
    return result


def describe(plotter: Plotter) -> Description:
    """Return the scene of a PyVista plotter as one of this package.

    Parameters
    ----------
    plotter : pyvista.Plotter
        Its meshes keep their colours, colour maps, opacities and widths.

    Returns
    -------
    Description

    See Also
    --------
    cutcell_viewers.description.Actor.from_polydata : Turns one mesh into an actor.
    """
    from .plotters import describe

    return describe(plotter)
