"""Move joints: by the handle in the view, by numbers, to the middle of the limb."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.editing import Edits, JointEdit
from cutcell.editing.symmetry import Mirror
from cutcell.errors import CutcellError, SkeletonError
from cutcell.rig import Rig
from cutcell_viewers.character import to_scene

from ...document.document import applied
from ...document.session import Session
from ...document.state import State
from ...server.protocol.received import MoveJoint
from ...server.protocol.sent import Knob
from ..compute.limb import cross_section_centre
from ..compute.mirror import joint_mirror
from .commands import check_alone, correct

DIGITS = 6
"""Decimal places of positions in addresses, relative to the longest side of the character."""


def watch(session: Session) -> None:
    """Connect the handle to the chosen joint, and joints to the handle."""
    follow = session.state.param.watch
    controller = JointController(session)
    session.view.listen(MoveJoint, controller.move)
    follow(lambda *events: controller.release(), ["rig", "binding", "panel"])


def handle_part(state: State) -> Knob | None:
    """Return the move handle of the chosen joint, with its mirror plane, or None."""
    if state.rig is None or not state.joint_handle or state.panel != "weights":
        return None
    if state.binding is None:
        return None
    at = to_scene(state.rig, state.rig.skeleton.joints[[state.joint]])[0]
    part: Knob = {"joint": state.joint, "at": at.tolist(), "mirror": None}
    mirror, partner = mirror_of(state), moves_along(state)
    if mirror is not None and partner is not None:
        part["mirror"] = plane_in_scene(state.rig.world, mirror)
    return part


def plane_in_scene(world: NDArray[np.float64], mirror: Mirror) -> list[float]:
    """Return the unit normal of a mirror's plane, and its distance from 0, in the scene."""
    on = world[:3, :3] @ (mirror.position * np.eye(3)[mirror.axis]) + world[:3, 3]
    out = np.linalg.inv(world[:3, :3]).T[:, mirror.axis]
    out = out / np.linalg.norm(out)
    return [*out.tolist(), float(out @ on)]


def mirror_of(state: State) -> Mirror | None:
    """Return each joint's mirror image in the file; None if no joint has one."""

    def find() -> Mirror | None:
        try:
            return joint_mirror(state.rig.with_joints(state.own_skeleton.joints))
        except SkeletonError:
            return None

    skeleton = state.own_skeleton
    key = repr((skeleton.joints.tobytes(), skeleton.parents.tolist(), skeleton.names,
                state.rig.skeleton.deform.tolist(), state.rig.partners))  # fmt: skip
    mirror: Mirror | None = state.memo("mirror", (state.rig.mesh, key), find)
    return mirror


def partner_of(state: State) -> int | None:
    """Return the joint on the other side of the chosen one; None if there is none."""
    mirror, joint = mirror_of(state), state.joint
    partner = -1 if mirror is None else int(mirror.joint[joint])
    return None if partner in (-1, joint) else partner


def moves_along(state: State) -> int | None:
    """Return the joint that moves along with the chosen one, or None."""
    return partner_of(state) if state.mirrored else None


def put(session: Session, place: ArrayLike) -> None:
    """Put the chosen joint somewhere, in the file's units, and its partner on the other side."""
    try:
        edits = moved(session, place)
    except CutcellError as error:
        session.refuse(error)
        return
    correct(session, edits)


def put_back(session: Session) -> None:
    """Put the chosen joint, and its partner, where the file has them."""
    state = session.state
    edited = dict(state.edits.joints)
    for joint in (state.joint, moves_along(state)):
        if joint is not None:
            name = state.rig.skeleton.names[joint]
            if not edited.get(name, JointEdit()).added:
                edited[name] = replace(edited.get(name, JointEdit()), position=None)
    correct(session, replace(state.edits, joints=edited))


def centre(session: Session) -> None:
    """Put the chosen joint into the middle of the limb."""
    try:
        place = cross_section_centre(session.state.rig, session.state.joint)
    except CutcellError as error:
        session.fail(error)
        return
    put(session, place)


def moved(session: Session, place: ArrayLike) -> Edits:
    """Return the edits with the chosen joint somewhere, and its partner mirrored."""
    state, joint = session.state, session.state.joint
    places = {joint: np.asarray(place, float)}
    mirror, partner = mirror_of(state), moves_along(state)
    if mirror is not None and partner is not None:
        other = places[joint].copy()
        other[mirror.axis] = 2 * mirror.position - other[mirror.axis]
        places[partner] = other
    digits = digits_of(state.rig)
    edited = dict(state.edits.joints)
    for one, at in places.items():
        check_alone(state.rig.skeleton, one)
        name, rest = state.rig.skeleton.names[one], state.own_skeleton.joints[one]
        before = edited.get(name, JointEdit())
        same = np.array_equal(np.round(at, digits), np.round(rest, digits))
        position = tuple(round(x, digits) for x in at.tolist())
        edited[name] = replace(before, position=None if same and not before.added else position)
    edits = replace(state.edits, joints=edited)
    applied(state.own, state.repair, edits)
    return edits


def rounded(rig: Rig, places: ArrayLike) -> NDArray[np.float64]:
    """Return places, shape (k, 3), with as many digits as edits keep."""
    return np.round(np.asarray(places, float), digits_of(rig))


def digits_of(rig: Rig) -> int:
    """Return how many digits behind the point places of a character have."""
    size = float(np.ptp(rig.mesh.bounds, axis=0).max())
    return DIGITS - int(np.floor(np.log10(size)))


class JointController:
    """Moves joints as the handle in the view is dragged."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._holds = False

    def move(self, message: MoveJoint) -> None:
        """Show the character with the chosen joint moved; take its position when it is done."""
        session, state = self._session, self._session.state
        if state.binding is None or message.joint != state.joint:
            return
        back = np.linalg.inv(state.rig.world)
        place = back[:3, :3] @ np.asarray(message.position) + back[:3, 3]
        try:
            edits = moved(session, place)
            rig = applied(state.own, state.repair, edits)
        except CutcellError as error:
            self.release()
            session.fail(error)
            session.view.send(mover=session.view.last_sent("mover"))  # where it was before
            return
        if not message.done:
            if session.engine.is_fresh("bound"):  # else the last position is about to be bound
                state.moved = rig, edits  # the bones follow at once
            return
        if state.moved is not None:
            state.moved = rig, edits
        self._take(edits)

    def release(self) -> None:
        """End the preview: the edits are shown again."""
        if not self._holds:
            self._session.state.moved = None

    def _take(self, edits: Edits) -> None:
        state = self._session.state
        before, self._holds = state.edits, True  # keep the preview until it is bound
        try:
            correct(self._session, edits)
        finally:
            self._holds = False
        if state.edits == before:
            self.release()
