"""A description drawn by PyVista: the one scene that pictures are made from."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

if sys.platform == "linux" and not os.environ.get("DISPLAY"):
    # Without a screen VTK first tries one, and complains; this spares it the trial.
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

import pyvista as pv

from cutcell.io.materials.face_colors import BLENDED

from .camera import PAGE_HEIGHT, VIEW_ANGLE, Camera, framing
from .description import Actor, Cut, Description
from .palette import BODY, LIGHT, Theme, colormap, to_bytes
from .skin import moved, squared_apart, turned
from .strokes import depths, see_strokes, shade_strokes, stroke_data
from .textured import ALPHA_KNOWN, CUT_OUT, DITHERED, pieces, texture


class Scene:
    """The plotter of one description; updated in place when the description changes.

    Parameters
    ----------
    theme : Theme
    size : (int, int)
        Width and height of the pictures, in pixels.
    pixel_ratio : float, optional
        How many pixels of the picture are one pixel of the page, in which widths are given.
    """

    def __init__(
        self,
        theme: Theme = LIGHT,
        size: tuple[int, int] = (1200, 900),
        pixel_ratio: float | None = None,
    ) -> None:
        self._pixel_ratio = pixel_ratio or size[1] / PAGE_HEIGHT
        self.plotter = pv.Plotter(off_screen=True, window_size=list(size), lighting="none")
        self.plotter.enable_anti_aliasing("msaa", multi_samples=8)
        self._overlay = _add_overlay(self.plotter)
        self.theme = theme
        for position, intensity in LIGHTS:
            light = pv.Light(position=position, light_type="camera light", intensity=intensity)
            self.plotter.add_light(light)
            self._overlay.AddLight(light)
        self._names: dict[str, list[pv.Actor]] = {}
        self._strokes: list[pv.Actor] = []
        self._bounds = Description().bounds
        self._images: Any = None
        self._textures: dict[tuple[int, int], pv.Texture] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """The actors that stand in the scene."""
        return tuple(self._names)

    def show(self, description: Description) -> None:
        """Make the scene what a description says, actors that are hidden left out."""
        for drawn in self._names.values():
            for one in drawn:
                self._renderer(one).RemoveActor(one)
        self._strokes, self._bounds = [], description.bounds
        if description.images is not self._images:
            self._images, self._textures = description.images, {}
        self._names = {
            name: [self._add(one, actor, description) for one in self._parts(actor, description)]
            for name, actor in description.actors.items()
            if actor.visible and len(actor.cells)
        }

    def look(self, camera: Camera) -> None:
        """Place the camera."""
        view = self.plotter.camera
        view.position, view.focal_point, view.up = camera.position, camera.focal_point, camera.up
        view.view_angle = VIEW_ANGLE
        size = tuple(self.plotter.window_size)
        for drawn in self._strokes:
            see_strokes(drawn, size, depths(camera, self._bounds))

    def render_png(self, path: str | Path | None = None) -> NDArray[np.uint8]:
        """Draw the scene.

        Parameters
        ----------
        path : str or Path, optional
            Where to write the PNG, too.

        Returns
        -------
        array, shape (height, width, 3), uint8
        """
        plotter: Any = self.plotter
        plotter.set_background(self.theme.bottom, top=self.theme.top)
        plotter.renderer.ResetCameraClippingRange()
        plotter.render_window.Render()  # a screenshot alone shows what was drawn before
        return plotter.screenshot(None if path is None else str(path), return_img=True)

    def render_clear(self) -> NDArray[np.uint8]:
        """Draw the scene on a transparent ground, shape (height, width, 4), uint8."""
        plotter: Any = self.plotter
        plotter.renderer.ResetCameraClippingRange()
        plotter.render_window.Render()
        return plotter.screenshot(None, return_img=True, transparent_background=True)

    def close(self) -> None:
        """Free the window."""
        self.plotter.close()

    def _renderer(self, actor: pv.Actor) -> pv.Renderer:
        return self._overlay if self._overlay.HasViewProp(actor) else self.plotter.renderer

    def _parts(self, actor: Actor, description: Description) -> Iterator[pv.Actor]:
        """Return what an actor is drawn as: in materials, a part for each image."""
        if actor.kind != "surface":
            mapper = pv._vtk.vtkPolyDataMapper()
            mapper.SetInputData(_dataset(actor, description.pose))
            drawn = pv.Actor(mapper=mapper)
            haze = tuple((np.add(self.theme.top, self.theme.bottom) / 2).tolist())
            shade_strokes(drawn, actor, haze, self._pixel_ratio)
            self._strokes.append(drawn)
            yield drawn
            return
        if actor.materials is None:
            yield pv.Actor(mapper=pv.DataSetMapper(_dataset(actor, description.pose)))
            return
        points, normals = _posed(actor, description.pose)
        for data, kind in pieces(points, normals, actor.cells, actor.materials):
            drawn = pv.Actor(mapper=pv.DataSetMapper(data))
            if kind[0] >= 0 and description.images is not None:
                if kind not in self._textures:
                    self._textures[kind] = texture(description.images[kind[0]], kind[1])
                drawn.texture = self._textures[kind]
            if drawn.texture is not None or kind[1] >= BLENDED:
                drawn.ForceOpaqueOn()
                shader, how = drawn.GetShaderProperty(), DITHERED if kind[1] >= BLENDED else CUT_OUT
                shader.AddFragmentShaderReplacement(ALPHA_KNOWN, False, how, False)
            yield drawn

    def _add(self, drawn: pv.Actor, actor: Actor, description: Description) -> pv.Actor:
        mapper = drawn.mapper
        _paint(drawn, actor, description.front)
        if actor.clipped and description.cut is not None:
            for plane in cut_planes(description.cut, actor.slab):
                mapper.AddClippingPlane(pv._vtk.vtkPlane(**plane))
        (self._overlay if actor.overlay else self.plotter.renderer).AddActor(drawn)
        return drawn


# A key light from the upper left and a soft fill from the right, both tied to the camera.
LIGHTS = (((-0.5, 0.7, 1.0), 0.82), ((0.9, -0.1, 0.6), 0.34))
AMBIENT, DIFFUSE = 0.16, 1.0
SOFT_AMBIENT, SOFT_DIFFUSE = 0.36, 0.75
"""Of materials: images have shadows of their own, and would be dark where light is, too."""


def render_png(
    description: Description,
    path: str | Path | None = None,
    *,
    theme: Theme = LIGHT,
    size: tuple[int, int] = (1200, 900),
    camera: Camera | None = None,
) -> NDArray[np.uint8]:
    """Draw a description once, off-screen; see `Scene.render_png`."""
    scene = Scene(theme, size)
    try:
        scene.show(description)
        scene.look(camera or framing(description.bounds, size[0] / size[1]))
        return scene.render_png(path)
    finally:
        scene.close()


def shading(actor: Actor) -> tuple[float, float]:
    """Return how much of its colour an actor has without light, and how much by light."""
    return (AMBIENT, DIFFUSE) if actor.materials is None else (SOFT_AMBIENT, SOFT_DIFFUSE)


def cut_planes(cut: Cut, slab: float) -> list[dict[str, tuple[float, ...]]]:
    """Return the planes that keep what lies behind a cut, each as origin and normal.

    What a plane keeps lies on the side that its normal points to.
    """
    origin, normal = np.array(cut.origin), np.array(cut.normal)
    planes = [{"origin": tuple(origin.tolist()), "normal": tuple((-normal).tolist())}]
    if slab > 0:
        back = origin - slab * normal
        planes.append({"origin": tuple(back.tolist()), "normal": tuple(normal.tolist())})
    return planes


def _posed(actor: Actor, pose: NDArray[np.float64] | None) -> tuple[NDArray, NDArray | None]:
    """Return an actor's points and normals in a pose."""
    points, normals = actor.points, actor.normals
    if pose is not None and actor.skin is not None:
        points = moved(points, actor.skin, pose).astype(np.float32)
        if normals is not None:
            normals = turned(normals, actor.skin, pose).astype(np.float32)
    return points, normals


def _dataset(actor: Actor, pose: NDArray[np.float64] | None) -> pv.PolyData:
    points, normals = _posed(actor, pose)
    every: Any = slice(None)
    if actor.kind == "surface":
        data: Any = pv.PolyData.from_regular_faces(points, actor.cells)
    else:
        data, every = stroke_data(actor, points)
    if normals is not None:
        data.point_data.active_normals = normals
    if actor.colors is not None:
        data.point_data["colors"] = actor.colors[every]
    elif actor.scalars is not None:
        data.point_data["values"] = _values(actor, pose)[every]
    return data


def _values(actor: Actor, pose: NDArray[np.float64] | None) -> Any:
    if pose is None or actor.apart is None or actor.skin is None:
        return actor.scalars
    squared = squared_apart(actor.points, actor.skin, actor.apart.skin, pose)
    return (actor.apart.unit * squared).astype(np.float32)


def _paint(drawn: pv.Actor, actor: Actor, front: float | None = None) -> None:
    appearance = drawn.prop
    appearance.color, appearance.opacity = actor.color, actor.opacity
    strokes = actor.kind != "surface"
    appearance.ambient, appearance.diffuse = (1.0, 0.0) if strokes else shading(actor)
    appearance.lighting = not strokes and not actor.hull
    appearance.show_edges, appearance.edge_opacity = actor.edges, 0.4
    appearance.interpolation = "flat" if actor.normals is None else "phong"
    mapper = drawn.mapper
    by_color = actor.colors is not None or actor.materials is not None
    mapper.scalar_visibility = by_color or actor.scalars is not None
    if by_color:
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray("colors")
        mapper.SetColorModeToDirectScalars()
    elif actor.scalars is not None:
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray("values")
        mapper.SetInterpolateScalarsBeforeMapping(True)
        table = colormap(actor.colormap)
        if actor.film and front is not None:
            table = behind_front(table, actor.limits, front)
        opaque = np.full((len(table), 1), 255, np.uint8)
        mapper.lookup_table = pv.LookupTable(values=np.hstack([table, opaque]))
        mapper.scalar_range = actor.limits
    if actor.hull:
        appearance.culling = "front"
    if actor.behind:
        mapper.SetResolveCoincidentTopologyToPolygonOffset()
        mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(2, 30)


def behind_front(
    table: NDArray[np.uint8], limits: tuple[float, float], front: float
) -> NDArray[np.uint8]:
    """Return a colour table that is the body's grey for values above the front."""
    values = np.linspace(*limits, len(table))
    return np.where(values[:, None] <= front, table, to_bytes(BODY)).astype(np.uint8)


def _add_overlay(plotter: pv.Plotter) -> pv.Renderer:
    renderer = pv.Renderer(plotter, border=False)
    renderer.SetLayer(1)
    renderer.SetActiveCamera(plotter.renderer.GetActiveCamera())
    window: Any = plotter.render_window
    window.SetNumberOfLayers(2)
    window.AddRenderer(renderer)
    return renderer
