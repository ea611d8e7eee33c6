"""Parts of VTK that PyVista does not wrap, and the names that its shaders are changed by.

An update of VTK may rename them: `tests/viewers/test_vtk_internals.py` says which.
"""

from typing import Any, Literal

import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

Stage = Literal["Vertex", "Fragment"]

DECLARATIONS = "//VTK::Normal::Dec"
POSITION = "//VTK::PositionVC::Impl"
LIGHT = "//VTK::Light::Impl"
ALPHA = "//VTK::DepthPeeling::Impl"
"""A place in VTK's shader after the image was looked up."""
MARKERS: dict[Stage, tuple[str, ...]] = {
    "Vertex": (DECLARATIONS, POSITION),
    "Fragment": (DECLARATIONS, LIGHT, ALPHA),
}
"""Marks in the shaders of polygons in whose place code is put."""


def polygon_actor(data: pv.PolyData) -> pv.Actor:
    """Return an actor whose shaders take additional attributes of points."""
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    return pv.Actor(mapper=mapper)


def replace_in_shader(drawn: Any, stage: Stage, marker: str, code: str, early: bool = True) -> None:
    """Put code in place of a marker, before or after VTK's own replacements."""
    add = getattr(drawn.GetShaderProperty(), f"Add{stage}ShaderReplacement")
    add(marker, early, code, False)


def set_uniforms(drawn: Any, stage: Stage, **values: float | tuple[float, ...]) -> None:
    """Set numbers and vectors that the code in a shader declares by use."""
    uniforms = getattr(drawn.GetShaderProperty(), f"Get{stage}CustomUniforms")()
    for name, value in values.items():
        if isinstance(value, tuple):
            getattr(uniforms, f"SetUniform{len(value)}f")(name, value)
        else:
            uniforms.SetUniformf(name, value)


def add_attribute(drawn: Any, name: str) -> None:
    """Pass an array of the points to the vertex shader, as the attribute NAMEMC."""
    drawn.GetMapper().MapDataArrayToVertexAttribute(f"{name}MC", name, 0, -1)


def clip(drawn: Any, origin: NDArray, normal: NDArray) -> None:
    """Keep the side of a plane that its normal points to."""
    plane = vtkPlane(origin=tuple(origin.tolist()), normal=tuple(normal.tolist()))
    drawn.GetMapper().AddClippingPlane(plane)


def add_overlay(plotter: pv.Plotter) -> pv.Renderer:
    """Add a layer over a plotter's scene, with the same camera."""
    renderer = pv.Renderer(plotter, border=False)
    renderer.SetLayer(1)
    renderer.SetActiveCamera(plotter.renderer.GetActiveCamera())
    window: Any = plotter.render_window
    window.SetNumberOfLayers(2)
    window.AddRenderer(renderer)
    return renderer
