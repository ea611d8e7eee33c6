"""What the names of joints say: exporters and riggers mark end markers and controls by words."""

from __future__ import annotations

import re


def _set(text: str) -> frozenset[str]:
    return frozenset(text.split())


END_WORDS = _set("end nub site effector eff")
"""Last word of an end marker: Blender's and Sketchfab's `_end`, 3ds Max' `Nub`, BVH's `End Site`,
Softimage's `eff`."""
CONTROL_WORDS = _set(
    "pole target ctrl ctl control controller pv polevector goal aim lookat locator marker helper "
    "dummy null camera mch tracker trajectory footsteps"
)
"""Words of a joint that animators handle, and that moves other joints."""
CONTROL_PARTS = (
    "control",
    "ctrl",
    "target",
    "orient",
    "polevector",
    "helper",
    "locator",
    "tracker",
)
"""The same inside longer words, as in `LEGCONTROL`."""
UNSURE = _set("ik fk weapon holster prop props item")
"""Words of a joint that either moves skin itself or only stands for another joint."""
SOCKET_PARTS = ("socket", "slot", "attach")
"""Words of a joint that things are hung on, which are meshes of their own."""
FOOT_ROLLS = _set("heel toe toes foot ball bank")
"""With "roll": a pivot of a foot control. An arm's roll joint moves skin."""
DIGITS = _set("thumb index middle ring pinky little finger toe")
FOURTH = re.compile(r"Hand(Thumb|Index|Middle|Ring|Pinky)4$")
ROOT_WORDS = _set("root master armature base global world origin reference rig trajectory ground")


def words(name: str) -> list[str]:
    """Split a joint's name into words in lower case, without name spaces and numbers.

    `mixamorig:HeadTop_End_06` gives head, top, end.
    """
    name = re.split(r"[:|]", name)[-1]
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", name)
    return re.findall(r"[a-z]+", name.lower())


def is_end_marker(name: str) -> bool:
    """Return whether a name is that of a marker at the end of a bone."""
    found = words(name)
    return bool(found) and (found[-1] in END_WORDS or found[-1].endswith("nub"))


def is_fingertip(name: str) -> bool:
    """Return whether a name is that of the tip of a finger or toe.

    In the names of HumanIK and Mixamo the fourth joint of a finger is its tip.
    """
    found = words(name)
    return ("tip" in found and not DIGITS.isdisjoint(found)) or bool(FOURTH.search(name))


def is_control(name: str) -> bool:
    """Return whether a name is that of a control."""
    found = words(name)
    if not CONTROL_WORDS.isdisjoint(found) or any(p in w for w in found for p in CONTROL_PARTS):
        return True
    return "roll" in found and not FOOT_ROLLS.isdisjoint(found)


def may_be_control(name: str) -> bool:
    """Return whether a name is that of a control or of a bone: a foot moved by IK is either."""
    return not UNSURE.isdisjoint(words(name))


def is_marked_deforming(name: str) -> bool:
    """Return whether a name is that of a bone that deforms by Rigify's convention, `DEF-spine`."""
    return words(name)[:1] == ["def"]


def is_socket(name: str) -> bool:
    """Return whether a name is that of a joint that things are attached to."""
    return any(part in word for word in words(name) for part in SOCKET_PARTS)


def is_root(name: str) -> bool:
    """Return whether a name is that of the root of everything."""
    return not ROOT_WORDS.isdisjoint(words(name))
