"""Paint weights: strokes over the body in the view become weights of single vertices."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.errors import CutcellError, ParameterError
from cutcell.rig import TriangleMesh
from cutcell_viewers.skin import Skin

from ...document.selection import Selection, selected
from ...document.session import Session
from ...document.state import State
from ...looks.mask import mask_strengths
from ...looks.weights import painted_colors, weights_shown
from ...server.protocol import sent
from ...server.protocol.received import Paint
from ..binding.results import newest_rows
from ..compute.selected import rows_at
from ..compute.stack import locked_names, locked_weights
from ..compute.stroke import Brush, PaintSurface, Stroke
from ..correct.moving import mirror_of, plane_in_scene
from ..layers.commands import as_stored, put_rows
from ..layers.masks import NO_LAYER, put_mask, stroke_strengths
from .choices import MAX_RADIUS, MIN_RADIUS, MIN_STRENGTH

WITHOUT_JOINT = ("smooth", "select", "mask")
"""Modes in which the brush does the same to all joints."""
LARGER = 1.25
"""How many times as large the next radius is."""
STRONGER = 0.1


def watch(session: Session) -> None:
    """Connect the brush of the view to the weights."""
    follow = session.state.param.watch
    controller = BrushController(session)
    session.view.listen(Paint, controller.paint)
    follow(lambda *events: activate(session), "brush")
    follow(lambda event: activate(session) if "mask" in (event.old, event.new) else None,
           "brush_mode")  # fmt: skip
    follow(lambda event: deactivate(session) if event.new else None, "joint_handle")


def activate(session: Session) -> None:
    """Show the weights that are about to be painted, and nothing else that can be dragged."""
    state = session.state
    if not state.brush:
        return
    colors_of = state.weights_shown if state.brush_mode in WITHOUT_JOINT else "bone"
    if "mask" in (state.brush_mode, colors_of):
        colors_of = "mask" if state.brush_mode == "mask" else "bone"
    state.param.update(
        joint_handle=False, weights_of="ours", weights_shown=colors_of, pose_colors="weights",
        heat=False,
    )  # fmt: skip
    if state.rig is not None:  # before the first stroke: of a large mesh it takes seconds
        mesh = state.rig.mesh
        session.work.newest(
            "paint surface", lambda progress: _surface(session, mesh).prepare(), lambda done: None
        )


def _surface(session: Session, mesh: TriangleMesh) -> PaintSurface:
    surface: PaintSurface = session.state.memo("paint surface", (mesh,), lambda: PaintSurface(mesh))
    return surface


def deactivate(session: Session) -> None:
    """Paint no more."""
    session.state.brush = False


def toggle(session: Session) -> None:
    """Switch the brush on where weights can be painted, else off."""
    state = session.state
    if not state.open_panel.paints:
        state.panel = "weights"
    state.brush = not state.brush


def resize(session: Session, steps: int) -> None:
    """Make the brush larger, or smaller."""
    radius = session.state.brush_radius * LARGER**steps
    session.state.brush_radius = min(max(radius, MIN_RADIUS), MAX_RADIUS)


def strengthen(session: Session, steps: int) -> None:
    """Make the brush stronger, or weaker."""
    strength = round(session.state.brush_strength + STRONGER * steps, 2)
    session.state.brush_strength = min(max(strength, MIN_STRENGTH), 1.0)


def paints(state: State) -> bool:
    """Whether there are weights in sight that the brush can paint."""
    is_ready = state.rig is not None and not state.bare and state.binding is not None
    return bool(state.brush and is_ready and state.open_panel.paints and not state.playing)


def radius_of(state: State) -> float:
    """Return the radius of the brush, in the file's units."""
    return float(state.brush_radius * np.ptp(state.rig.mesh.bounds, axis=0).max())


def brush_part(state: State) -> sent.Brush | None:
    """Return the brush's size and its mirror plane; None for no brush."""
    part: sent.Brush | None = None
    if paints(state):
        scale = abs(np.linalg.det(state.rig.world[:3, :3])) ** (1 / 3)
        part = {"radius": radius_of(state) * scale, "mirror": None}
        # A pose is seldom mirrored: the other brush is elsewhere then than its image.
        posed = state.panel == "pose" and state.posed
        mirror = mirror_of(state) if state.brush_mirrored and not posed else None
        alike = state.brush_mode in WITHOUT_JOINT
        if mirror is not None and (alike or mirror.joint[state.joint] >= 0):
            part["mirror"] = plane_in_scene(state.rig.world, mirror)
    return part


def select(session: Session, chosen: NDArray[np.bool_]) -> None:
    """Limit strokes to some vertices, shape (n,), bool; not at all where there are none."""
    state = session.state
    state.brush_selection = Selection(state.rig.mesh, chosen) if chosen.any() else None


def clear_selection(session: Session) -> None:
    """Remove all limits of strokes."""
    session.state.brush_selection = None


def invert_selection(session: Session) -> None:
    """Limit strokes to what they could not change."""
    chosen = selected(session.state)
    if chosen is not None:
        select(session, ~chosen)


class BrushController:
    """Paints as the pointer passes over the body.

    Parameters
    ----------
    session : Session
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._stroke: Stroke | None = None
        self._rows: Any = None
        self._selects: bool | None = None
        self._selected: NDArray[np.bool_] | None = None
        self._erases: bool | None = None
        self._mask: NDArray[np.float64] | None = None

    def paint(self, message: Paint) -> None:
        """Continue a stroke, show its effect on the weights, and adopt it when it ends."""
        session, state = self._session, self._session.state
        if message.first:
            self._begin(message.mode)
        stroke = self._stroke
        if stroke is None or state.binding is None or self._rows is not newest_rows(state):
            self._stroke = None
            session.view.answer(painted={"gone": True})
            return
        points = np.asarray(message.points).reshape(-1, 6)
        corners = points[:, :3].astype(np.intp)
        if len(points) and 0 <= corners.min() <= corners.max() < len(state.rig.mesh.vertices):
            stroke.pass_over(corners, points[:, 3:])
        if self._selects is not None:
            self._select(stroke, message)
            return
        if self._mask is not None:
            self._paint_mask(stroke, message)
            return
        if message.cancelled:
            self._stroke = None
            vertices = stroke.touched()
            self._show(vertices, rows_at(self._rows, vertices))
            return
        vertices, rows = stroke.painted() if message.done else stroke.continued()
        rows = as_stored(rows, rows_at(self._rows, vertices))  # as they will be in the scene
        self._show(vertices, self._seen(vertices, rows))
        if message.done:
            self._stroke = None
            self._take(vertices, rows)
            try:
                stroke.check_unlocked()
            except CutcellError as error:
                session.fail(error)

    def _begin(self, mode: str | None) -> None:
        session, state = self._session, self._session.state
        self._stroke = None
        if not paints(state):
            return
        mesh = state.rig.mesh
        surface = _surface(session, mesh)
        self._selects, self._mask, within = None, None, selected(state)
        new_mode: Any = mode or state.brush_mode
        if state.brush_mode == "select":
            self._selects, self._selected = mode != "subtract", within
            new_mode, within = "smooth", None
        if state.brush_mode == "mask":
            self._mask, self._erases, new_mode = mask_strengths(state), mode == "subtract", "smooth"
            if self._mask is None:
                session.fail(ParameterError(NO_LAYER))
                return
        self._rows = newest_rows(state)
        try:
            brush = Brush(radius_of(state), new_mode, state.brush_strength, state.brush_value)
            self._stroke = Stroke(
                surface,
                state.rig,
                self._rows,
                state.joint,
                brush,
                mirror=mirror_of(state) if state.brush_mirrored else None,
                locked=locked_names(state.edits),
                max_influences=state.max_influences,
                within=within,
                locked_weights=locked_weights(state.edits, state.rig, state.binding.graph),
            )
        except CutcellError as error:
            session.fail(error)

    def _select(self, stroke: Stroke, message: Paint) -> None:
        """Add the touched vertices to the selection from before the stroke, or subtract them."""
        session, before = self._session, self._selected
        count = len(session.state.rig.mesh.vertices)
        chosen = np.zeros(count, np.bool_) if before is None else before.copy()
        if not message.cancelled:
            chosen[stroke.touched()] = self._selects
        select(session, chosen)
        session.view.answer(painted={})
        if message.cancelled or message.done:
            self._stroke = None

    def _paint_mask(self, stroke: Stroke, message: Paint) -> None:
        """Raise or lower the strengths of the chosen layer's mask."""
        assert self._mask is not None
        vertices, cover = stroke.covered()
        strengths = self._mask.copy()
        if not message.cancelled:
            goal = 0.0 if self._erases else 1.0
            strengths[vertices] += cover * (goal - strengths[vertices])
        scalars = strengths[vertices].astype(np.float32)
        shown: Any = {"vertices": vertices.astype(np.uint32)}
        if weights_shown(self._session.state) == "mask":
            shown["scalars"] = scalars
        self._session.view.answer(painted=shown)
        if message.cancelled or message.done:
            self._stroke = None
        if message.done and not message.cancelled:
            put_mask(self._session, strengths)

    def _seen(self, vertices: NDArray, rows: NDArray) -> NDArray:
        """Return rows as they are seen where the layer that they go into has a mask."""
        strengths = stroke_strengths(self._session.state, vertices)
        if strengths is None:
            return rows
        before = rows_at(self._rows, vertices)
        return np.asarray(before + strengths[:, None] * (rows - before))

    def _show(self, vertices: NDArray, rows: NDArray) -> None:
        colors = painted_colors(self._session.state, vertices, rows)
        message: Any = {"vertices": vertices.astype(np.uint32)}
        message |= {name: np.ascontiguousarray(values).ravel() for name, values in colors.items()}
        if self._session.state.panel == "pose" and len(vertices):
            skin = Skin.of_weights(rows)
            influences = {"joints": skin.joints.ravel(), "weights": skin.weights.ravel()}
            message |= {**influences, "count": skin.joints.shape[1]}
        self._session.view.answer(painted=message)

    def _take(self, vertices: NDArray, rows: NDArray) -> None:
        session, state = self._session, self._session.state
        before, edits = rows_at(self._rows, vertices), state.edits
        put_rows(session, vertices, rows)
        if state.edits == edits:
            self._show(vertices, before)
