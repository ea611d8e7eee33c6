"""The face of a cut: the section of the mesh, coloured by distance or winding number."""

from dataclasses import replace
from typing import Any

import numpy as np

from cutcell_viewers.description import Actor, Cut, Legend
from cutcell_viewers.distance_scene import unit_of
from cutcell_viewers.plane_section import PlaneSection
from cutcell_viewers.section_scene import body_section, field_face, section_lines, winding_face
from cutcell_viewers.short_names import short_names

from ..document.framing import bounds_of, theme_of
from ..document.state import State


def field_section(
    state: State, cut: Cut, field: Any, limits: tuple[float, float]
) -> dict[str, Actor]:
    """Return the inside of a cut in the field's colours; nothing without a field."""
    if field is None:
        return {}
    rig, graph, tau = state.rig, state.graph, state.winding_threshold
    section = _section(state, cut)
    text = f"from {short_names(rig.skeleton.names)[state.joint]} in {unit_of(rig)}: "
    face = state.memo(
        "field face",
        (section, tau, field, *limits),
        lambda: field_face(rig, graph, section, tau, field, limits, text),
    )
    lines, _ = _lines(state, cut, section, contour=False)
    return {"inside": face, **lines}


def winding_section(state: State, cut: Cut) -> tuple[dict[str, Actor], Legend]:
    """Return the winding number in the plane of a cut, and its legend."""
    section = _section(state, cut)
    face, legend = state.memo("winding face", (section,), lambda: winding_face(section))
    lines, swatches = _lines(state, cut, section, contour=True)
    return {"inside": face, **lines}, replace(legend, swatches=swatches)


def _section(state: State, cut: Cut) -> PlaneSection:
    rig, graph = state.rig, state.graph
    inputs = (rig, graph, *cut.origin, *cut.normal)
    section: PlaneSection = state.memo("section", inputs, lambda: body_section(rig, graph, cut))
    return section


def _lines(
    state: State, cut: Cut, section: PlaneSection, contour: bool
) -> tuple[dict[str, Actor], tuple[Any, ...]]:
    tau, theme = state.winding_threshold, theme_of(state)
    size = float(np.ptp(bounds_of(state), axis=0).max())
    actors: tuple[dict[str, Actor], tuple[Any, ...]] = state.memo(
        "section lines",
        (section, tau, theme.name, contour),
        lambda: section_lines(section, tau, cut, size, theme, contour),
    )
    return actors
