"""Framing of a character: bounds, first bone, cameras and themes, as the view takes them."""

import re
from weakref import WeakKeyDictionary

import numpy as np

from cutcell.rig import Rig
from cutcell.runtime.display import shown_name
from cutcell_viewers.camera import Camera, framing
from cutcell_viewers.character import drawn_segments
from cutcell_viewers.palette import THEMES, Theme, to_hex

from ..server.protocol import sent
from .state import State


def bounds_of(state: State) -> np.ndarray:
    """Return the lowest and highest corner of the body at rest, shape (2, 3)."""
    rig = state.rig
    if rig not in _bounds_of_rig:
        points = rig.mesh.vertices[rig.mesh.used] @ rig.world[:3, :3].T
        points += rig.world[:3, 3]
        bounds = np.stack([points.min(axis=0), points.max(axis=0)])
        bounds.flags.writeable = False
        _bounds_of_rig[rig] = bounds
    return _bounds_of_rig[rig]


_bounds_of_rig: WeakKeyDictionary[Rig, np.ndarray] = WeakKeyDictionary()


def theme_of(state: State) -> Theme:
    """Return the theme of the state."""
    return THEMES["dark" if state.dark else "light"]


def bones_part(state: State) -> sent.Bones | None:
    """Return the bones as the view needs them for picking, or None."""
    if state.rig is None:
        return None
    start, end, joint = drawn_segments(state.rig)
    return {
        "start": start.ravel(),
        "end": end.ravel(),
        "joint": joint.astype(np.int32),
        "names": [shown_name(name) for name in state.rig.skeleton.names],
    }


def theme_part(theme: Theme) -> sent.Theme:
    """Return a theme as a message for the view."""
    card, paper = ("rgba(24,28,36,.72)", "#1b2028")
    if theme.name == "light":
        card, paper = ("rgba(255,255,255,.72)", "#ffffff")
    return {
        "top": to_hex(theme.top),
        "bottom": to_hex(theme.bottom),
        "ink": to_hex(theme.ink),
        "card": card,
        "paper": paper,
    }


def camera_part(camera: Camera) -> sent.Cameras:
    """Return a camera as a message for the view."""
    return {"position": list(camera.position), "focal_point": list(camera.focal_point)}


def camera_on_bone(
    state: State, part: float, aspect: float, direction: tuple[float, float, float]
) -> Camera:
    """Return a camera on the chosen bone at rest that sees some part of the longest side."""
    start, end, joint = drawn_segments(state.rig)
    bounds = bounds_of(state)
    of_bone = joint == state.joint
    ends = np.concatenate([start[of_bone], end[of_bone]]) if of_bone.any() else bounds
    half = part / 2 * float(np.ptp(bounds, axis=0).max())
    middle = ends.mean(axis=0)
    return framing(np.stack([middle - half, middle + half]), aspect, direction)


def first_joint(rig: Rig) -> int:
    """Return the joint to begin with: an arm if there is one, else the longest bone."""
    skeleton = rig.skeleton
    start, end, joint = drawn_segments(rig)
    if not len(joint):
        return 0  # a mesh without a skeleton
    inner = np.array([len(skeleton.children[j]) > 0 for j in joint])
    useful = skeleton.deform[joint] & inner & (skeleton.parents[joint] >= 0)
    arm = np.array([bool(_ARM.search(skeleton.names[j])) for j in joint])
    score = np.linalg.norm(end - start, axis=1) * (useful + 1e-6) * (1 + 100 * arm)
    return int(joint[np.argmax(score)])


_ARM = re.compile(r"arm", re.IGNORECASE)
