"""Scenes of what the core computes, described as plain data and drawn by PyVista.

In a notebook::

    import cutcell, cutcell_viewers
    from cutcell_viewers.weights_scene import weights_scene

    rig = cutcell.load("character.glb")
    binding = cutcell.bind(rig)
    cutcell_viewers.show(weights_scene(rig, binding.weights))
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from PIL.Image import Image
    from pyvista import Plotter

    from .camera import Camera
    from .description import Description

__all__ = ["describe", "plotter", "show"]


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
        As `weights_scene` and its kin return, or `cutcell_app.render.describe`.
    size : (int, int)
        Width and height in pixels.
    dark : bool
    camera : Camera, optional
        Sees all of the scene when left out.
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

    from .film import Order
    from .worker import draw_apart

    theme = "dark" if dark else "light"
    with TemporaryDirectory(prefix="cutcell-show-") as folder:
        path = Path(folder) / "scene.png"
        draw_apart(Order(description, theme, size, camera, legend=legend), path)
        return Image.open(BytesIO(path.read_bytes()))


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
    from .opengl import require_opengl
    from .palette import DARK, LIGHT
    from .polydata import add_legend
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
    """Return what a PyVista plotter shows as a scene of this package.

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
    from .polydata import describe

    return describe(plotter)
