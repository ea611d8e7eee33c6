"""Lines and points, drawn by PyVista as the page draws them (frontend/engine/stroke_shaders.js)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from .camera import VIEW_ANGLE, Camera
from .description import Actor
from .vtk_internals import (
    DECLARATIONS,
    LIGHT,
    POSITION,
    add_attribute,
    replace_in_shader,
    set_uniforms,
)

_VERTEX = """//VTK::Normal::Dec
in vec3 otherMC;
in vec2 cornerMC;
out vec2 strokeAcross;
out float strokeAlong, strokeAway, strokeFade, strokeGap;
float strokeReach(float w) {
  float spaced = strokeThick * strokeScale / w, thin = 0.5 * strokeUnit;
  strokeFade = strokeThick > 0.0 ? clamp(spaced / thin, 0.5, 1.0) : 1.0;
  strokeGap = strokeDash * strokeScale / w > 3.0 * strokeUnit ? 0.55 : 2.0;
  return strokeThick > 0.0 ? clamp(spaced, thin, 6.0 * strokePixels) : 0.5 * strokePixels + thin;
}
"""
_AWAY = """
  if (strokeDash == 0.0) {  // as near as its front: strokes in a surface are visible
    vec3 ahead = vec3(MCDCMatrix[0][3], MCDCMatrix[1][3], MCDCMatrix[2][3]);
    vec4 front = MCDCMatrix * vec4(centre - wide * gl_Position.w / strokeScale * ahead, 1.0);
    gl_Position.z = front.z / front.w * gl_Position.w;
  }
  strokeAway = 0.35 * clamp((gl_Position.w - strokeDepths.x)
    / max(strokeDepths.y - strokeDepths.x, 1e-9), 0.0, 1.0);
"""
_LINE = (
    """
  float end = cornerMC.x, side = cornerMC.y;
  vec3 a = end < 0.5 ? vertexMC.xyz : otherMC, b = end < 0.5 ? otherMC : vertexMC.xyz;
  vec4 p = MCDCMatrix * vec4(a, 1.0), q = MCDCMatrix * vec4(b, 1.0);
  float least = 1e-3 * max(abs(p.w), abs(q.w)) + 1e-6;
  float from = p.w < least && q.w > p.w ? (least - p.w) / (q.w - p.w) : 0.0;
  float to = q.w < least && p.w > q.w ? (p.w - least) / (p.w - q.w) : 1.0;
  float t = end < 0.5 ? from : to;
  vec4 start = mix(p, q, from), stop = mix(p, q, to);
  gl_Position = mix(p, q, t);
  vec2 run = (stop.xy / stop.w - start.xy / start.w) * strokeSize * 0.5;
  float far = length(run);
  vec2 way = far > 1e-4 ? run / far : vec2(1.0, 0.0);
  float wide = strokeReach(gl_Position.w);
  vec2 aside = (vec2(-way.y, way.x) * side + way * (2.0 * end - 1.0) * 0.3) * wide;
  gl_Position.xy += aside / strokeSize * 2.0 * gl_Position.w;
  vec3 centre = mix(a, b, t);
  strokeAlong = length(b - a) * t;
  strokeAcross = vec2(side, 0.0);"""
    + _AWAY
)
_POINT = (
    """
  gl_Position = MCDCMatrix * vertexMC;
  float wide = strokeReach(gl_Position.w);
  gl_Position.xy += cornerMC * wide / strokeSize * 2.0 * gl_Position.w;
  vec3 centre = vertexMC.xyz;
  strokeAlong = 0.0;
  strokeAcross = cornerMC;"""
    + _AWAY
)
_FRAGMENT = """//VTK::Normal::Dec
in vec2 strokeAcross;
in float strokeAlong, strokeAway, strokeFade, strokeGap;
"""
_LIGHTS = {
    "lines": """if (strokeDash > 0.0 && fract(strokeAlong / strokeDash) > strokeGap) { discard; }
  float light = sqrt(max(1.0 - strokeAcross.x * strokeAcross.x, 0.0));""",
    "round": """float rim = length(strokeAcross);
  if (rim > 1.0) { discard; }
  float light = sqrt(1.0 - rim * rim);""",
    "square": """float rim = max(abs(strokeAcross.x), abs(strokeAcross.y));
  float light = rim > 0.68 ? 0.25 : 1.0;""",
    "triangle": """float rim = max(-strokeAcross.y * 1.25 - 0.1,
    abs(strokeAcross.x) * 1.25 + strokeAcross.y * 0.62);
  if (rim > 0.72) { discard; }
  float light = rim > 0.5 ? 0.25 : 1.0;""",
}
_PAINT = """//VTK::Light::Impl
  %s
  gl_FragData[0].rgb = mix(strokeHaze, mix(gl_FragData[0].rgb * (0.62 + 0.38 * light),
    strokeHaze, strokeAway), strokeFade);
"""
_CORNERS = {
    "lines": ((0, -1), (1, -1), (0, 1), (1, 1)),
    "points": ((-1, -1), (1, -1), (-1, 1), (1, 1)),
}
"""Corners of the two triangles of each: end and side of a line, or offset from a point."""


def stroke_data(
    actor: Actor, points: NDArray[np.float32]
) -> tuple[pv.PolyData, NDArray[np.integer]]:
    """Return two triangles for each line or point, and the point of each corner."""
    ends = np.asarray(actor.cells)
    corners = np.array(_CORNERS[actor.kind], np.float32)
    end = np.zeros(4, int) if actor.kind == "points" else corners[:, 0].astype(int)
    of = ends[:, end].ravel()
    other = ends[:, ends.shape[1] - 1 - end].ravel()
    first = 4 * np.arange(len(ends))[:, None, None]
    faces = (first + np.array([[0, 1, 2], [2, 1, 3]])).reshape(-1, 3)
    corners_of: Any = points[of]
    data: Any = pv.PolyData.from_regular_faces(corners_of, faces)
    data.point_data["other"] = points[other]
    data.point_data["corner"] = np.tile(corners, (len(ends), 1))
    return data, of


def shade_strokes(drawn: Any, actor: Actor, haze: tuple[float, ...], pixel: float) -> None:
    """Make the shader widen the triangles of `stroke_data` into strokes.

    Parameters
    ----------
    drawn : pyvista.Actor
        From `polygon_actor`.
    actor : Actor
    haze : tuple of float
        The colour of distant strokes.
    pixel : float
        Pixels of the picture per pixel of the page.
    """
    add_attribute(drawn, "other")
    add_attribute(drawn, "corner")
    lines = actor.kind == "lines"
    light = _LIGHTS["lines" if lines else actor.form]
    replace_in_shader(drawn, "Vertex", DECLARATIONS, _VERTEX)
    replace_in_shader(drawn, "Vertex", POSITION, _LINE if lines else _POINT)
    replace_in_shader(drawn, "Fragment", DECLARATIONS, _FRAGMENT)
    replace_in_shader(drawn, "Fragment", LIGHT, _PAINT % light, early=False)
    set_uniforms(drawn, "Fragment", strokeDash=actor.dash, strokeHaze=haze)
    set_uniforms(
        drawn,
        "Vertex",
        strokeDash=actor.dash,
        strokeThick=actor.thick,
        strokeUnit=pixel,
        strokePixels=actor.width * pixel,
    )
    see_strokes(drawn, (100, 100), (0.0, 1.0))


def see_strokes(drawn: Any, size: tuple[int, int], depths: tuple[float, float]) -> None:
    """Set the size of the picture and the range of depths for strokes."""
    scale = size[1] / (2 * np.tan(np.radians(VIEW_ANGLE / 2)))
    set_uniforms(drawn, "Vertex", strokeSize=size, strokeScale=scale, strokeDepths=depths)


def depths(camera: Camera, bounds: NDArray[np.float64]) -> tuple[float, float]:
    """Return the nearest and the farthest distance of a box ahead of the eye."""
    ahead = np.array(camera.focal_point) - np.array(camera.position)
    ahead /= np.linalg.norm(ahead)
    middle = float((bounds.mean(axis=0) - camera.position) @ ahead)
    half = float(np.abs(ahead) @ np.ptp(bounds, axis=0)) / 2
    return middle - half, middle + half
