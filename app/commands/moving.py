"""Move joints: by the handle in the view, by numbers, to the middle of the limb."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.binding import Binding
from cutcell.editing.correct import corrected_rig
from cutcell.editing.corrections import Corrections, JointCorrection
from cutcell.editing.symmetry import Mirror
from cutcell.errors import CutcellError, SkeletonError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_viewers.character import to_scene

from ..editing import cross_section_centre, find_joint_mirror
from ..scenes.common import bones_part
from ..state.corrections import Dragged, applied
from .binding import binding_request, binding_work, previewer
from .correct import check_alone, correct
from .session import Session

DIGITS = 6
"""Decimal places of positions in addresses, relative to the longest side of the character."""
SEEN = ["panel", "rig", "binding", "joint", "joint_handle", "mirrored"]


def watch(session: Session) -> None:
    """Connect the handle to the chosen joint, and joints to the handle."""
    follow = session.state.param.watch
    hand = Hand(session)
    session.view.listen("joint", hand.move)
    follow(lambda *events: hand.release(), ["rig", "binding", "panel"])
    follow(lambda *events: tell_bones(session), "rig")
    follow(lambda *events: show_handle(session), SEEN)


def tell_bones(session: Session) -> None:
    """Send the positions of clickable bones to the view."""
    state = session.state
    if state.rig is None:
        return
    # Compared by value: a new rig often has the same bones.
    sent, bones = session.view.last_sent("bones"), bones_part(state)
    same = sent is not None and sent["names"] == bones["names"]
    if not same or not np.array_equal(sent["start"], bones["start"]):
        session.view.send(bones=bones)


def show_handle(session: Session) -> None:
    """Send the move handle of the chosen joint and its mirror plane to the view."""
    state = session.state
    part = None
    if state.joint_handle and state.panel == "weights" and state.rig is not None and state.binding:
        at = to_scene(state.rig, state.rig.skeleton.joints[[state.joint]])[0]
        part = {"joint": state.joint, "at": at.tolist(), "mirror": None}
        mirror, partner = mirror_of(session), moves_along(session)
        if mirror is not None and partner is not None:
            part["mirror"] = plane_in_scene(state.rig.world, mirror)
    if session.view.last_sent("mover") != part:
        session.view.send(mover=part)


def plane_in_scene(world: NDArray[np.float64], mirror: Mirror) -> list[float]:
    """Return the unit normal of a mirror's plane, and its distance from 0, in the scene."""
    on = world[:3, :3] @ (mirror.position * np.eye(3)[mirror.axis]) + world[:3, 3]
    out = np.linalg.inv(world[:3, :3]).T[:, mirror.axis]
    out = out / np.linalg.norm(out)
    return [*out.tolist(), float(out @ on)]


def mirror_of(session: Session) -> Mirror | None:
    """Return each joint's mirror image in the file; None if no joint has one."""
    state = session.state

    def find() -> Mirror | None:
        try:
            return find_joint_mirror(state.rig.with_joints(state.own_skeleton.joints))
        except SkeletonError:
            return None

    skeleton = state.own_skeleton
    key = skeleton.joints.tobytes().hex() + repr(skeleton.parents.tolist())
    mirror: Mirror | None = session.memo("mirror", (state.rig.mesh, key), find)
    return mirror


def partner_of(session: Session) -> int | None:
    """Return the joint on the other side of the chosen one; None if there is none."""
    mirror, joint = mirror_of(session), session.state.joint
    partner = -1 if mirror is None else int(mirror.joint[joint])
    return None if partner in (-1, joint) else partner


def moves_along(session: Session) -> int | None:
    """Return the joint that moves along with the chosen one, or None."""
    return partner_of(session) if session.state.mirrored else None


def put(session: Session, place: ArrayLike) -> None:
    """Put the chosen joint somewhere, in the file's units, and its partner on the other side."""
    try:
        corrections = moved(session, place)
    except CutcellError as error:
        session.fail(error)
        session.state.param.trigger("corrections")  # reset the text to the position
        return
    correct(session, corrections)


def put_back(session: Session) -> None:
    """Put the chosen joint, and its partner, where the file has them."""
    state = session.state
    corrected = dict(state.corrections.joints)
    for joint in (state.joint, moves_along(session)):
        if joint is not None:
            name = state.rig.skeleton.names[joint]
            if not corrected.get(name, JointCorrection()).added:
                corrected[name] = replace(corrected.get(name, JointCorrection()), position=None)
    correct(session, replace(state.corrections, joints=corrected))


def centre(session: Session) -> None:
    """Put the chosen joint into the middle of the limb."""
    try:
        place = cross_section_centre(session.state.rig, session.state.joint)
    except CutcellError as error:
        session.fail(error)
        return
    put(session, place)


def moved(session: Session, place: ArrayLike) -> Corrections:
    """Return the corrections with the chosen joint somewhere, and its partner mirrored.

    Raises
    ------
    CutcellError
        It cannot be there.
    """
    state, joint = session.state, session.state.joint
    places = {joint: np.asarray(place, float)}
    mirror, partner = mirror_of(session), moves_along(session)
    if mirror is not None and partner is not None:
        other = places[joint].copy()
        other[mirror.axis] = 2 * mirror.position - other[mirror.axis]
        places[partner] = other
    digits = digits_of(state.rig)
    corrected = dict(state.corrections.joints)
    for one, at in places.items():
        check_alone(state.rig.skeleton, one)
        name, rest = state.rig.skeleton.names[one], state.own_skeleton.joints[one]
        before = corrected.get(name, JointCorrection())
        same = np.array_equal(np.round(at, digits), np.round(rest, digits))
        position = (
            None if same and not before.added else tuple(round(x, digits) for x in at.tolist())
        )
        corrected[name] = replace(before, position=position)
    corrections = replace(state.corrections, joints=corrected)
    corrected_rig(state.own, corrections)
    return corrections


def rounded(rig: Rig, places: ArrayLike) -> NDArray[np.float64]:
    """Return places, shape (k, 3), with as many digits as corrections keep."""
    return np.round(np.asarray(places, float), digits_of(rig))


def digits_of(rig: Rig) -> int:
    """Return how many digits behind the point places of a character have."""
    size = float(np.ptp(rig.mesh.bounds, axis=0).max())
    return DIGITS - int(np.floor(np.log10(size)))


class Hand:
    """Moves joints as the handle in the view is dragged.

    Parameters
    ----------
    session : Session
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._holds = False
        self._binds = False
        self._bound: Binding | None = None
        self._preview: Any = None

    def move(self, message: dict[str, Any]) -> None:
        """Show the character with the chosen joint somewhere; take it when it is let go.

        Parameters
        ----------
        message : dict
            The number of the "joint", its "position" in the scene, and whether it is "done".
        """
        session, state = self._session, self._session.state
        if state.binding is None or int(message["joint"]) != state.joint:
            return
        back = np.linalg.inv(state.rig.world)
        place = back[:3, :3] @ np.asarray(message["position"], float) + back[:3, 3]
        try:
            corrections = moved(session, place)
        except CutcellError as error:
            self.release()
            session.fail(error)
            session.view.send(
                mover=session.view.last_sent("mover")
            )  # back from where it was dragged
            return
        if message.get("done"):
            self._take(corrections)
        else:
            self._show(corrections)

    def release(self) -> None:
        """Show again what the corrections tell."""
        if not self._holds and self._session.state.dragged is not None:
            self._session.tasks.newest("moving").cancel()
            self._session.state.dragged = self._bound = self._preview = None

    def _take(self, corrections: Corrections) -> None:
        state = self._session.state
        if state.dragged is not None:
            rig = applied(state.own, corrections)
            state.dragged = replace(state.dragged, rig=rig)
        before, self._holds = state.corrections, True  # keep the preview until it is bound
        try:
            correct(self._session, corrections)
        finally:
            self._holds = False
        if state.corrections == before:
            self.release()

    def _show(self, corrections: Corrections) -> None:
        """Show about what the weights will be, and when the hand rests what they are."""
        state = self._session.state
        if not self._session.binder.is_for(binding_request(state)):
            return  # the last position is about to be bound
        rig = applied(state.own, corrections)
        before = state.binding if state.dragged is None else state.dragged.binding
        self._begin(rig, corrections)
        state.dragged = Dragged(rig, before)  # the bones follow at once

    def _begin(self, rig: Rig, corrections: Corrections) -> None:
        """Bind off the page's thread: first nearly, and exactly after a pause."""
        session, state = self._session, self._session.state
        newest = session.tasks.newest("moving")
        if self._binds:  # the hand did not rest after all, and colours must not wait for that
            newest.cancel()
            self._binds = False
        exact = binding_work(state, rig, corrections, state.binding.graph)

        def done(binding: Binding) -> None:
            if state.dragged is not None:
                state.dragged = Dragged(state.dragged.rig, binding)

        def wholly(progress: Progress) -> Binding:
            return exact(progress)[1]

        if rig.allowed is not None:  # vertices at one place may follow different joints
            newest.do(wholly, done)
            return
        if self._bound is not state.binding:
            self._bound, self._preview = state.binding, previewer(state)
        preview = self._preview

        def resting(progress: Progress) -> Binding:
            self._binds = True
            return wholly(progress)

        newest.do(lambda progress: preview(rig, corrections), done)
        session.tasks.after_a_pause(lambda: newest.do(resting, done) if state.dragged else None)
