"""Choose which joints carry weight."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from cutcell.deform import DeformJoints, deform_joints
from cutcell.errors import ParameterError

from .binding import bind
from .session import Session


def choose(session: Session, joints: Collection[int]) -> None:
    """Let some joints carry weight and no others, and bind again."""
    rig = session.state.rig
    deform = np.zeros(len(rig.skeleton.joints), bool)
    deform[list(joints)] = True
    if not deform.any():
        session.fail(ParameterError("no joint is left that may carry weight; keep at least one"))
        return
    if (deform == rig.skeleton.deform).all():
        return
    session.state.rig = replace(rig, skeleton=replace(rig.skeleton, deform=deform))
    bind(session)


def guess(session: Session, done: Callable[[DeformJoints], None]) -> None:
    """Guess from names and places which joints deform; `done` is called with what was found."""
    rig = session.state.rig
    session.tasks.newest("deform").do(lambda progress: deform_joints(rig.mesh, rig.skeleton), done)
