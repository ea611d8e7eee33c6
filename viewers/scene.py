"""Drawing of a description by PyVista."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

if sys.platform == "linux" and not os.environ.get("DISPLAY"):
    # Without a screen VTK first tries one, and complains; this spares it the trial.
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

import pyvista as pv

from cutcell.io.materials.face_colors import BLENDED

from .camera import PAGE_HEIGHT, VIEW_ANGLE, Camera, framing
from .description import Actor, Description
from .lighting import LIGHTS, shading
from .palette import BODY, LIGHT, Theme, colormap, to_bytes
from .plotters import lookup_table
from .strokes import depths, see_strokes, shade_strokes, stroke_data
from .textured import cut_out, pieces, texture
from .vtk_internals import add_overlay, clip, polygon_actor


class Scene:
    """The plotter of one description; updated in place when the description changes.

    Parameters
    ----------
    theme : Theme
    size : (int, int)
        Width and height of the pictures, in pixels.
    fine : bool
        Whether corners are darkened by ambient occlusion, which takes about a second without a
        graphics card.
    pixel_ratio : float, optional
        Pixels of the picture per pixel of the page, in which widths are given.
    layered : bool
        Whether overlays are a layer over the scene. PyVista's own windows and exports have one
        layer: overlays are drawn nearer to the eye there, and lines and points plainly.
    """

    def __init__(
        self,
        theme: Theme = LIGHT,
        size: tuple[int, int] = (1200, 900),
        fine: bool = False,
        pixel_ratio: float | None = None,
        layered: bool = True,
    ) -> None:
        # Occlusion takes the place of multisampling: four times the pixels smooth edges.
        self._scale = 2 if fine else 1
        self._pixel_ratio = (pixel_ratio or size[1] / PAGE_HEIGHT) * self._scale
        window = [self._scale * side for side in size]
        self.plotter = pv.Plotter(off_screen=True, window_size=window, lighting="none")
        if not fine:
            self.plotter.enable_anti_aliasing("msaa", multi_samples=8)
        self._overlay = add_overlay(self.plotter) if layered else self.plotter.renderer
        self._layered = layered
        self.theme = theme
        for position, intensity in LIGHTS:
            light = pv.Light(position=position, light_type="camera light", intensity=intensity)
            self.plotter.add_light(light)
            if layered:
                self._overlay.AddLight(light)
        self._names: dict[str, list[pv.Actor]] = {}
        self._strokes: list[pv.Actor] = []
        self._bounds = Description().bounds
        self._images: Any = None
        self._textures: dict[tuple[int, int], pv.Texture] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """The actors of the scene."""
        return tuple(self._names)

    def show(self, description: Description) -> None:
        """Show a description, without its hidden actors."""
        for drawn in self._names.values():
            for one in drawn:
                self._renderer(one).RemoveActor(one)
        self._strokes, self._bounds = [], description.bounds
        # The pass of ambient occlusion leaves out what is translucent.
        opaque = all(a.opacity == 1 for a in description.actors.values() if a.visible)
        renderer: Any = self.plotter.renderer
        if self._scale > 1 and opaque:
            radius = OCCLUSION_RADIUS * float(np.ptp(description.bounds, axis=0).max())
            renderer.enable_ssao(radius=radius, bias=radius / 20, kernel_size=32, blur=True)
        else:
            renderer.disable_ssao()
        if description.images is not self._images:
            self._images, self._textures = description.images, {}
        self._names = {
            name: [self._add(one, actor, description) for one in self._parts(actor, description)]
            for name, actor in description.actors.items()
            if actor.visible and len(actor.cells)
        }

    def set_camera(self, camera: Camera) -> None:
        """Place the camera."""
        view = self.plotter.camera
        view.position, view.focal_point, view.up = camera.position, camera.focal_point, camera.up
        view.view_angle = VIEW_ANGLE
        view.SetWindowCenter(-camera.centre[0], -camera.centre[1])
        width, height = self.plotter.window_size
        for drawn in self._strokes:
            see_strokes(drawn, (width, height), depths(camera, self._bounds))

    def render_png(self, path: str | Path | None = None) -> NDArray[np.uint8]:
        """Draw the scene, also into a PNG if a path is given; shape (height, width, 3), uint8."""
        plotter: Any = self.plotter
        plotter.set_background(self.theme.bottom, top=self.theme.top)
        return self._screenshot(None if path is None else str(path))

    def render_clear(self) -> NDArray[np.uint8]:
        """Draw the scene on a transparent ground, shape (height, width, 4), uint8."""
        pixels = self._screenshot(None, transparent_background=True)
        if self._scale == 1:
            return pixels
        height, width = pixels.shape[0] // self._scale, pixels.shape[1] // self._scale
        return np.asarray(Image.fromarray(pixels).resize((width, height), Image.Resampling.BOX))

    def close(self) -> None:
        """Free the window."""
        self.plotter.close()

    def _screenshot(self, path: str | None, **options: Any) -> NDArray[np.uint8]:
        plotter: Any = self.plotter
        plotter.renderer.ResetCameraClippingRange()
        plotter.render_window.Render()  # a screenshot alone shows what was drawn before
        return plotter.screenshot(path, return_img=True, **options)

    def _renderer(self, actor: pv.Actor) -> pv.Renderer:
        return self._overlay if self._overlay.HasViewProp(actor) else self.plotter.renderer

    def _parts(self, actor: Actor, description: Description) -> Iterator[pv.Actor]:
        """Yield the VTK actors of an actor: with materials, one for each image."""
        if actor.kind != "surface" and self._layered:
            drawn = polygon_actor(_dataset(actor, description))
            haze = tuple((np.add(self.theme.top, self.theme.bottom) / 2).tolist())
            shade_strokes(drawn, actor, haze, self._pixel_ratio)
            self._strokes.append(drawn)
            yield drawn
            return
        if actor.materials is None:
            data = _dataset(actor, description, plain=True)
            yield pv.Actor(mapper=pv.DataSetMapper(data))
            return
        points, normals = _posed(actor, description)
        for data, kind in pieces(points, normals, actor.cells, actor.materials):
            drawn = pv.Actor(mapper=pv.DataSetMapper(data))
            if kind[0] >= 0 and description.images is not None:
                if kind not in self._textures:
                    self._textures[kind] = texture(description.images[kind[0]], kind[1])
                drawn.texture = self._textures[kind]
            if drawn.texture is not None or kind[1] >= BLENDED:
                cut_out(drawn, kind[1])
            yield drawn

    def _add(self, drawn: pv.Actor, actor: Actor, description: Description) -> pv.Actor:
        mapper = drawn.mapper
        _paint(drawn, actor, self._pixel_ratio, description.front)
        if actor.clipped and description.cut is not None:
            origin, normal = np.array(description.cut.origin), np.array(description.cut.normal)
            clip(drawn, origin, -normal)
            if actor.slab > 0:
                clip(drawn, origin - actor.slab * normal, normal)
        (self._overlay if actor.overlay else self.plotter.renderer).AddActor(drawn)
        if actor.overlay and self._overlay is self.plotter.renderer:
            mapper.SetResolveCoincidentTopologyToPolygonOffset()
            mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(0, OVERLAY_OFFSET)
            mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0, OVERLAY_OFFSET)
        return drawn


OVERLAY_OFFSET = -26_000
"""Depth offset of overlays where there is one layer, in steps of 1/65,536."""
OCCLUSION_RADIUS = 0.06
"""Radius within which surfaces darken a corner, relative to the scene's longest side."""


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
        scene.set_camera(camera or framing(description.bounds, size[0] / size[1]))
        return scene.render_png(path)
    finally:
        scene.close()


def _posed(actor: Actor, description: Description) -> tuple[NDArray, NDArray | None]:
    """Return an actor's points and normals in the description's pose."""
    pose, blending = description.pose, description.blending
    points, normals = actor.points_in(pose, blending).astype(np.float32), actor.normals
    if pose is not None and actor.skin is not None and normals is not None:
        normals = actor.skin.turn(normals, pose, blending).astype(np.float32)
    return points, normals


def _dataset(actor: Actor, description: Description, plain: bool = False) -> pv.PolyData:
    points, normals = _posed(actor, description)
    every: Any = slice(None)
    if plain:
        data: Any = pv.PolyData()
        data.points = points
        cells = np.insert(actor.cells, 0, actor.cells.shape[1], axis=1).ravel()
        setattr(data, {"surface": "faces", "lines": "lines", "points": "verts"}[actor.kind], cells)
    else:
        data, every = stroke_data(actor, points)
    if normals is not None:
        data.point_data.active_normals = normals
    if actor.colors is not None:
        data.point_data["colors"] = actor.colors[every]
    elif actor.scalars is not None:
        data.point_data["values"] = _values(actor, description)[every]
    return data


def _values(actor: Actor, description: Description) -> Any:
    pose, blending = description.pose, description.blending
    if pose is None or actor.apart is None or actor.skin is None:
        return actor.scalars
    between = actor.skin.move(actor.points, pose, blending)
    between -= actor.apart.skin.move(actor.points, pose, blending)
    return (actor.apart.unit * np.linalg.norm(between, axis=1)).astype(np.float32)


def _paint(drawn: pv.Actor, actor: Actor, pixel_ratio: float, front: float | None) -> None:
    appearance = drawn.prop
    appearance.color, appearance.opacity = actor.color, actor.opacity
    strokes = actor.kind != "surface"
    appearance.ambient, appearance.diffuse = (1.0, 0.0) if strokes else shading(actor)
    appearance.lighting = not strokes and not actor.hull
    appearance.show_edges, appearance.edge_opacity = actor.edges, 0.4
    appearance.line_width = appearance.point_size = actor.width * pixel_ratio
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
        if actor.follows_wavefront and front is not None:
            table = behind_front(table, actor.limits, front)
        mapper.lookup_table = lookup_table(table)
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
