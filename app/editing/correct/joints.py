"""The joints of the character as a tree: colours, shares of the skin, edits."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.editing import JointEdit
from cutcell.rig.deform_joints import DeformJoints
from cutcell.rig.mesh import vertex_shares
from cutcell.runtime.display import shown_name
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.palette import to_hex
from cutcell_viewers.short_names import short_names

from ...document.state import State
from ..compute.stack import locked_names

STRAY = 0.002
"""Share of the skin: a joint that holds more in the file is no control, whatever its name."""


def shares_of(state: State) -> tuple[NDArray | None, NDArray | None]:
    """Return which part of the skin each joint holds, shape (j,): as computed, and in the file."""
    rig, binding = state.rig, state.binding
    count = state.memo("vertex shares", (rig.mesh,), lambda: vertex_shares(rig.mesh))
    shares = state.memo(
        "file's shares",
        (rig.mesh, rig.weights),
        lambda: None if rig.weights is None else count @ rig.weights,
    )
    if binding is None:
        return None, shares
    return state.memo("shares", (rig.mesh, binding.rows), lambda: binding.rows.T @ count), shares


def joint_rows(state: State, guess: DeformJoints | None) -> list[dict[str, Any]]:
    """Return the rows of the tree, parents before their children.

    These are "joint", "name", "short", "level" (0 for a root), "color", "control" (whether it moves
    bones, or nothing, rather than skin), "doubtful" (whether it may be one, in a file without
    weights), "why" it is so, "carries" (whether it may carry weight), "changed" (whether that was
    edited), "ours" and "file" (shares of the skin, or None), "locked", "gain" and "radius". The
    guess is None as long as it is not known.
    """
    rig = state.rig
    skeleton = rig.skeleton
    colors = state.memo("colors", (rig,), lambda: colors_of(rig))
    computed, original = shares_of(state)
    shorts = state.memo("short names", (skeleton,), lambda: short_names(skeleton.names))
    rows, locked = [], set(locked_names(state.edits))
    for joint in in_order(skeleton):
        name = skeleton.names[joint]
        one = state.edits.joints.get(name, JointEdit())
        reach = state.edits.reach
        holds = 0.0 if original is None else float(original[joint])
        control = guess is not None and not guess.deform[joint] and holds < STRAY
        doubtful = guess is not None and original is None and bool(guess.doubtful[joint])
        rows.append(
            {
                "joint": joint,
                "name": shown_name(name),
                "short": shorts[joint],
                "level": int(skeleton.depth[joint]),
                "color": to_hex(tuple(colors[joint])),
                "control": control,
                "doubtful": doubtful,
                "why": guess.reason[joint] if guess and (control or doubtful) else "",
                "carries": bool(skeleton.deform[joint]),
                "changed": one.deform is not None,
                "ours": None if computed is None else float(computed[joint]),
                "file": None if original is None else float(original[joint]),
                "locked": name in locked,
                "gain": reach.gain.get(name, 1.0),
                "radius": reach.radius.get(name),
            }
        )
        if not rows[-1]["why"] and original is not None and not holds and not rows[-1]["carries"]:
            rows[-1]["why"] = "no weight in the file"
    return rows


def in_order(skeleton: Any) -> list[int]:
    """Return the joints in depth-first order."""
    ordered: list[int] = []
    waiting = np.flatnonzero(skeleton.parents < 0)[::-1].tolist()
    while waiting:
        joint = waiting.pop()
        ordered.append(joint)
        waiting += skeleton.children[joint][::-1].tolist()
    return ordered
