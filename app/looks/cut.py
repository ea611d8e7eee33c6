"""Move and turn the cutting plane: by its handles in the view, or towards the eye."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutcell_viewers.graph_scene import box_across

from ..document.framing import bounds_of
from ..document.session import Session
from ..document.state import State
from ..server.protocol.received import MoveCut
from ..server.protocol.sent import Box
from .character import cut_of


def watch(session: Session) -> None:
    """Connect the plane to its handles, which exist while there is a plane."""
    session.view.listen(MoveCut, lambda message: put(session, message.origin, message.normal))


def plane_part(state: State) -> Box | None:
    """Return the box of the plane that can be dragged, or None."""
    sliced = state.panel == "graph" and state.slicing
    is_cut = state.open_panel.cuts and state.cut_across != "off"
    is_shown = state.rig is not None and is_cut and not sliced
    return {"box": bounds_of(state).tolist()} if is_shown else None


def put(session: Session, origin: ArrayLike, normal: ArrayLike) -> None:
    """Lay the plane through a point; one that is turned becomes free."""
    state = session.state
    cut = None if state.rig is None else cut_of(state)
    out = np.asarray(normal, float)
    length = float(np.linalg.norm(out))
    if cut is None or not np.isfinite(length) or length < 1e-9:
        return
    out /= length
    turned: dict[str, Any] = {}
    if float(out @ np.array(cut.normal)) < 1 - 1e-6:
        turned = {"cut_axis": "free", **angles_of(out)}
    middle, half = box_across(bounds_of(state), out)
    along = float((np.asarray(origin, float) - middle) @ out) / max(2 * half, 1e-12)
    state.param.update(cut_position=float(np.clip(0.5 + along, 0, 1)), **turned)


def face_the_eye(session: Session) -> None:
    """Turn the plane so that one looks straight at its face."""
    camera = session.view.camera
    if session.state.rig is None or camera is None:
        return
    ahead = np.subtract(camera.position, camera.focal_point)
    session.state.param.update(cut_axis="free", **angles_of(ahead / np.linalg.norm(ahead)))


def angles_of(direction: ArrayLike) -> dict[str, float]:
    """Return the angles of a plane that looks in a direction of length 1."""
    x, y, z = np.asarray(direction, float)
    yaw = float(np.degrees(np.arctan2(x, z)))
    pitch = float(np.degrees(np.arcsin(np.clip(y, -1, 1))))
    return {"cut_yaw": round(yaw, 2), "cut_pitch": round(pitch, 2)}
