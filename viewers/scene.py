"""A description drawn by PyVista: the one scene that pictures are made from."""

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

from .camera import VIEW_ANGLE, Camera, framing
from .description import Actor, Cut, Description
from .lighting import LIGHTS, shading
from .palette import BODY, LIGHT, Theme, colormap, to_bytes
from .skin import moved, squared_apart, turned
from .textured import ALPHA_KNOWN, CUT_OUT, DITHERED, pieces, texture

PICTURE_WIDTH = 1.5
"""How many times as wide lines and points are in a picture, which has more pixels than a page."""


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
    pixel_ratio : float
        How many pixels of the picture are one pixel of the page, in which widths are given.
    layered : bool
        Whether overlays are a layer over the scene. PyVista's own windows and exports know one
        layer: overlays are drawn nearer to the eye there.
    """

    def __init__(
        self,
        theme: Theme = LIGHT,
        size: tuple[int, int] = (1200, 900),
        fine: bool = False,
        pixel_ratio: float = PICTURE_WIDTH,
        layered: bool = True,
    ) -> None:
        # Occlusion takes the place of multisampling: four times the pixels smooth edges.
        self._scale = 2 if fine else 1
        self._pixel_ratio = pixel_ratio * self._scale
        window = [self._scale * side for side in size]
        self.plotter = pv.Plotter(off_screen=True, window_size=window, lighting="none")
        if not fine:
            self.plotter.enable_anti_aliasing("msaa", multi_samples=8)
        self._overlay = _add_overlay(self.plotter) if layered else self.plotter.renderer
        self.theme = theme
        for position, intensity in LIGHTS:
            light = pv.Light(position=position, light_type="camera light", intensity=intensity)
            self.plotter.add_light(light)
            if layered:
                self._overlay.AddLight(light)
        self._names: dict[str, list[pv.Actor]] = {}
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

    def look(self, camera: Camera) -> None:
        """Place the camera."""
        view = self.plotter.camera
        view.position, view.focal_point, view.up = camera.position, camera.focal_point, camera.up
        view.view_angle = VIEW_ANGLE
        view.SetWindowCenter(-camera.centre[0], -camera.centre[1])

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
        pixels = plotter.screenshot(None, return_img=True, transparent_background=True)
        if self._scale == 1:
            return pixels
        height, width = pixels.shape[0] // self._scale, pixels.shape[1] // self._scale
        return np.asarray(Image.fromarray(pixels).resize((width, height), Image.Resampling.BOX))

    def close(self) -> None:
        """Free the window."""
        self.plotter.close()

    def _renderer(self, actor: pv.Actor) -> pv.Renderer:
        return self._overlay if self._overlay.HasViewProp(actor) else self.plotter.renderer

    def _parts(self, actor: Actor, description: Description) -> Iterator[pv.Actor]:
        """Return what an actor is drawn as: in materials, a part for each image."""
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
        _paint(drawn, actor, self._pixel_ratio, description.front)
        if actor.clipped and description.cut is not None:
            for plane in cut_planes(description.cut, actor.slab):
                mapper.AddClippingPlane(pv._vtk.vtkPlane(**plane))
        (self._overlay if actor.overlay else self.plotter.renderer).AddActor(drawn)
        if actor.overlay and self._overlay is self.plotter.renderer:
            mapper.SetResolveCoincidentTopologyToPolygonOffset()
            mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(0, OVERLAY_OFFSET)
            mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0, OVERLAY_OFFSET)
        return drawn


OVERLAY_OFFSET = -26_000
"""Of 65,536 steps of depth: how much nearer overlays are drawn where there is one layer."""
OCCLUSION_RADIUS = 0.06
"""How far away what darkens a corner may be, in the scene's longest side."""


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
    (points, normals), cells = _posed(actor, pose), actor.cells
    if actor.dash > 0 and actor.scalars is None and actor.colors is None:
        points, cells = _dashes(points[cells], actor.dash)
    data: Any = pv.PolyData()
    data.points = points
    cells = np.insert(cells, 0, cells.shape[1], axis=1).ravel()
    setattr(data, {"surface": "faces", "lines": "lines", "points": "verts"}[actor.kind], cells)
    if normals is not None:
        data.point_data.active_normals = normals
    if actor.colors is not None:
        data.point_data["colors"] = actor.colors
    elif actor.scalars is not None:
        data.point_data["values"] = _values(actor, pose)
    return data


def _dashes(ends: NDArray, dash: float) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Return the dashes of segments (m, 2, 3): a little more than half of each piece is drawn."""
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1)
    count = np.maximum(np.ceil(length / dash), 1).astype(int)
    of = np.repeat(np.arange(len(ends)), count)
    first = (np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)) * dash
    part = np.stack([first, np.minimum(first + 0.55 * dash, length[of])], axis=1)
    part /= np.maximum(length[of], 1e-300)[:, None]
    points = start[of, None] + part[:, :, None] * along[of, None]
    cells = np.arange(2 * len(of), dtype=np.int32).reshape(-1, 2)
    return points.reshape(-1, 3).astype(np.float32), cells


def _values(actor: Actor, pose: NDArray[np.float64] | None) -> Any:
    if pose is None or actor.apart is None or actor.skin is None:
        return actor.scalars
    squared = squared_apart(actor.points, actor.skin, actor.apart.skin, pose)
    return (actor.apart.unit * squared).astype(np.float32)


def _paint(drawn: pv.Actor, actor: Actor, pixel_ratio: float, front: float | None) -> None:
    appearance = drawn.prop
    appearance.color, appearance.opacity, appearance.line_width = (
        actor.color,
        actor.opacity,
        actor.width,
    )
    appearance.ambient, appearance.diffuse = shading(actor)
    appearance.lighting = actor.kind == "surface" and not actor.hull
    appearance.point_size = actor.width * pixel_ratio
    appearance.render_points_as_spheres = actor.kind == "points" and actor.form == "round"
    if actor.kind == "lines":
        # Not as tubes: VTK gets the depth of many wrong, and they vanish behind the body.
        appearance.line_width = actor.width * pixel_ratio
    if actor.kind == "points" and actor.form != "round":
        shader = drawn.GetShaderProperty()
        shader.AddFragmentShaderReplacement("//VTK::Color::Impl", True, _FORMS[actor.form], False)
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
        mapper.interpolate_before_map = True
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
    if actor.kind == "lines":
        # Lines on a surface lie in it: pull them a little towards the eye.
        mapper.SetResolveCoincidentTopologyToPolygonOffset()
        mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0, -4)


_RIMMED = """//VTK::Color::Impl
  vec2 across = vec2(2.0 * gl_PointCoord.x - 1.0, 1.0 - 2.0 * gl_PointCoord.y);
  float rim = %s;
  if (rim > %s) { discard; }
  if (rim > %s) { ambientColor *= 0.72; diffuseColor *= 0.72; }
"""
_FORMS = {
    "square": _RIMMED % ("max(abs(across.x), abs(across.y))", "0.9", "0.62"),
    "triangle": _RIMMED
    % ("max(-across.y * 1.25 - 0.1, abs(across.x) * 1.25 + across.y * 0.62)", "0.72", "0.5"),
}
"""How points that are no balls are painted: as on the page (scripts/stroke_shaders.js)."""


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
