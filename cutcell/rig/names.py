"""Names of joints: how they are compared, and which words mark controls and end markers."""

from __future__ import annotations

import re
import unicodedata


def folded(name: str) -> str:
    """Return a name as names are compared: in lower case, without full-width and such forms."""
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def is_neutral(name: str) -> bool:
    """Return whether a name is that of Blender's stand-in for vertices without weights."""
    return bool(_NEUTRAL.fullmatch(folded(name)))


_NEUTRAL = re.compile(r"neutral_bone([_.]\d+| \(\d+\))?")
"""The joint to which Blender's glTF exporter gives such vertices; several may be numbered."""


def _set(text: str) -> frozenset[str]:
    return frozenset(text.split())


END_WORDS = _set("end nub site effector eff")
"""Last word of an end marker: Blender's and Sketchfab's `_end`, 3ds Max' `Nub`, BVH's `End Site`,
Softimage's `eff`."""
CONTROL_WORDS = _set(
    "pole target ctrl ctl control controller pv polevector goal aim lookat locator marker helper "
    "dummy damii null camera mch tracker trajectory footsteps"
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
UNSURE = _set("ik ikp fk cancel weapon holster prop props item")
"""Words of a joint that either moves skin itself or only controls another joint."""
SOCKET_PARTS = ("socket", "slot", "attach")
"""Words of a joint that things are hung on, which are meshes of their own."""
FOOT_ROLLS = _set("heel toe toes foot ball bank")
"""With "roll": a pivot of a foot control. An arm's roll joint moves skin."""
DIGITS = _set("thumb index middle ring pinky little finger toe")
FOURTH = re.compile(r"Hand(Thumb|Index|Middle|Ring|Pinky)4$")
ROOT_WORDS = _set("root master armature base global world origin reference rig trajectory ground")

# MikuMikuDance (MMD). Its names are Japanese, translated ("upper body") or romanised. Japanese has
# no spaces between words.
MMD_CONTROLS = re.compile(
    r"全ての親|すべての親|全親|操作中心|ダミー|グルーブ|^センター(\d|先|親|補助|$)"
)
"""Root of everything, view centre, dummy, groove and centre."""
MMD_CANCELS = re.compile(r"キャンセル|肩[pc]")
"""Joints that undo the turn of another, at whose place they stand."""
MMD_TIP = re.compile(r"(?<!つま)(?<!爪)先[\W\d_]*(?:[lr左右][\W\d_]*)?$")
"""A tip (先), but not a toe (つま先)."""
MMD_BODY = re.compile(
    r"全ての親|操作中心|上半身|下半身|(upper|lower) ?body|parent ?node|"
    r"j[ou]+ ?han ?shin|ka ?han ?shin"
)
"""Names that tell a rig of MMD: root, view centre, upper and lower body."""
MMD_CONTROL_WORDS = _set(
    "all of parent parents node mother motherbone parentnode root master center centre sentaa "
    "senta groove guruubu gurubu view cnt subete no oya subetenooya sousa chuushin sousachuushin"
)
"""Words of the same controls in translated and romanised rigs of MMD; elsewhere a centre may be a
bone."""
MMD_TIPS, MMD_NO_TIPS = _set("tip saki"), _set("hair kami tsuma")
"""Last word of a tip there, and words of what is none: hair, and a toe (tsuma saki)."""
SIDES = _set("l r left right")


def words(name: str) -> list[str]:
    """Split a name into Latin words in lower case: head, top, end of `mixamorig:HeadTop_End_06`."""
    return re.findall(r"[a-z]+", _spaced(name))


def _spaced(name: str) -> str:
    """Return a name without name spaces, folded, with spaces where capitals begin a word."""
    name = re.split(r"[:|]", unicodedata.normalize("NFKC", name))[-1]
    return folded(re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", name))


def is_of_mmd(name: str) -> bool:
    """Return whether a name is one that only rigs of MikuMikuDance have."""
    return bool(MMD_BODY.search(_spaced(name).replace("_", " ")))


def is_mmd_control(name: str) -> bool:
    """Return whether a name is that of a control in a rig of MikuMikuDance that was translated."""
    parts = set(words(name))
    return bool(parts - MMD_TIPS) and parts <= MMD_CONTROL_WORDS | MMD_TIPS


def is_mmd_tip(name: str) -> bool:
    """Return whether a name is that of a tip in a rig of MikuMikuDance that was translated."""
    parts = [word for word in words(name) if word not in SIDES]
    return bool(parts) and parts[-1] in MMD_TIPS and MMD_NO_TIPS.isdisjoint(parts)


def is_end_marker(name: str) -> bool:
    """Return whether a name is that of a marker at the end of a bone."""
    found = words(name)
    if found and (found[-1] in END_WORDS or found[-1].endswith("nub")):
        return True
    return bool(MMD_TIP.search(_spaced(name)))


def is_fingertip(name: str) -> bool:
    """Return whether a name is that of the tip of a finger or toe, the fourth joint in Mixamo."""
    found = words(name)
    return ("tip" in found and not DIGITS.isdisjoint(found)) or bool(
        FOURTH.search(unicodedata.normalize("NFKC", name))
    )


def is_control(name: str) -> bool:
    """Return whether a name is that of a control."""
    found = words(name)
    if is_neutral(name) or MMD_CONTROLS.search(_spaced(name)):
        return True
    if not CONTROL_WORDS.isdisjoint(found) or any(p in w for w in found for p in CONTROL_PARTS):
        return True
    return "roll" in found and not FOOT_ROLLS.isdisjoint(found)


def may_be_control(name: str) -> bool:
    """Return whether a name is that of a control or of a bone: a foot moved by IK is either."""
    return not UNSURE.isdisjoint(words(name)) or bool(MMD_CANCELS.search(_spaced(name)))


def is_socket(name: str) -> bool:
    """Return whether a name is that of a joint that things are attached to."""
    return any(part in word for word in words(name) for part in SOCKET_PARTS)


def is_root(name: str) -> bool:
    """Return whether a name is that of the root of everything."""
    return not ROOT_WORDS.isdisjoint(words(name))
