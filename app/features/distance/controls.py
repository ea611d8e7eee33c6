"""Distance: how far the chosen bone is, through the body."""

from ...document.session import Session
from ...document.state import State
from ...looks.controls import CUTTING
from ...looks.measures import MAX_MEASURES, MEASURES
from ...widgets import controls as ui

NO_FIELD = "This bone does not deform the mesh, so it has no distance field."
PATH = "Click the body to draw the shortest path from there to the bone."
SOURCES = "Graph nodes nearest to the bone. Each starts at its straight distance to the bone."
SIDE_BY_SIDE = (
    "Up to four, on one scale. The last four use the cut-cell graph. Click the body to draw "
    "the paths."
)


def _one(state: State) -> bool:
    """Return whether there is one view only."""
    return not state.measures


def _measure(name: str) -> ui.Control:
    """Return the switch of a measure, of which four at most can be on."""
    return ui.switch(
        name, disabled=lambda s: not getattr(s, name) and len(s.measures) >= MAX_MEASURES
    )


def _play(session: Session) -> None:
    session.state.param.update(wave=True, animating=not session.state.animating)


CONTROLS = ui.column(
    ui.intro("Distance to the selected bone, along the shortest path through the body."),
    ui.section(
        "",
        ui.caption(NO_FIELD, visible=ui.weightless),
        ui.column(
            CUTTING,
            ui.choice("cut_face", visible=lambda s: s.cut_axis not in ("auto", "off")),
            visible=_one,
        ),
        ui.select("colormap", "Colour map", margin=(10, 0, 4, 0)),
        top=8,
    ),
    ui.section(
        "Shown with it",
        ui.switch("path"),
        ui.caption(PATH, visible=lambda s: s.path and s.vertex is None),
        ui.column(
            ui.switch("starts"), ui.caption(SOURCES, visible=lambda s: s.starts), visible=_one
        ),
    ),
    ui.section(
        "Wavefront",
        ui.switch("wave"),
        ui.slider("front", visible=lambda s: s.wave and not s.animating),
        ui.play_button(_play, " the wave", "animating"),
    ),
    ui.section(
        "Measures side by side",
        ui.caption(SIDE_BY_SIDE),
        [_measure(f"beside_{name}") for name in MEASURES],
        ui.choice("beside_resolution", visible=lambda s: not _one(s)),
    ),
)
