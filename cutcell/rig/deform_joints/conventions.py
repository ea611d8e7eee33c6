"""Names of joints in the conventions of tools: which deform, control, mark ends or hold things."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from ..names import is_neutral, plain

NUMBER = r"( \d+)*$"
"""Numbers that tools and exporters add to a name."""


@dataclass(frozen=True)
class Convention:
    """Names of one tool: regular expressions, searched in names without sides (`plain`)."""

    tool: str
    source: str
    signs: str = ""
    needs: int = 3  # names that fit the signs, for the row to count
    controls: str = ""
    ends: str = ""  # markers at the end of a bone, unless they have child bones
    sockets: str = ""  # joints to which separate meshes are attached
    unsure: str = ""  # controls or bones, which their places decide
    bones: str = ""  # whatever the last row says
    roots: str = ""  # the root of everything; in the last row it may still be a bone
    only: bool = False  # only its bones and joints below them deform
    yields: tuple[tuple[str, str], ...] = ()  # deform unless the joint of the second name exists


CONVENTIONS = (
    Convention(
        "Rigify",
        "https://docs.blender.org/manual/en/latest/addons/rigging/rigify/",
        signs=r"^def ",
        bones=r"^def ",
        controls=r"^(org|mch|wgt|vis) ",
        only=True,
    ),
    Convention(
        "Rigify's meta-rig",
        "https://docs.blender.org/manual/en/latest/addons/rigging/rigify/metarigs.html",
        signs=r"^(spine|thigh|shin|foot|toe|heel 02|upper arm|forearm|breast|pelvis)" + NUMBER,
        needs=5,
        controls=r"^heel 02",
    ),
    Convention(
        "BlenRig",
        "https://gitlab.com/jpbouza/BlenRig",
        signs=r".\bdef" + NUMBER,
        bones=r"\bdef" + NUMBER,
        controls=r"\b(mstr|mech|str|rot|aim|proxy)" + NUMBER,
        only=True,
    ),
    Convention(
        "Auto-Rig Pro",
        "https://www.lucky3d.fr/auto-rig-pro/doc/",
        signs=r" x" + NUMBER + r"|^(arm|forearm|thigh|leg) (stretch|twist)|^c (traj|pos)$",
        controls=r"\b(ref|fk|ik|pole|nostr|scale fix|target|track|roll|bank|pivot|rot|twk)\b|"
        r"^c (traj|pos|root master|root bend|foot 01|foot heel|toes.*|stretch .*|p .*)\b|"
        r"^(foot heel|neck twist|toes 02)\b|\bbend all\b",
        bones=r"^c .*\b(thigh b|ear|skull|bend|breast|offset)\b|\b(stretch|twist)\b|"
        r"^(root|spine \d+|neck|head) x",
        yields=(
            (r"^c (.*)$", r"\1"),
            (r"^(arm|forearm|thigh|leg)$", r"\1 stretch"),
            (r"^(arm|forearm|thigh|leg) twist$", r"c \1 twist offset"),
        ),
    ),
    Convention(
        "Advanced Skeleton",
        "https://www.animationstudios.com.au/advanced-skeleton",
        signs=r" m" + NUMBER,
        bones=r"^root m" + NUMBER,
        controls=r"^(heel|fkx?|ikx?|fk offset|ik offset|un ?twist|twist ?balancer)\b",
        ends=r"\bend( m)?" + NUMBER + r"|finger 4" + NUMBER,
    ),
    Convention(
        "mGear",
        "https://mgear4.readthedocs.io/",
        signs=r"\b(c )?\d+ (\d+|end|root) jnt" + NUMBER,
        roots=r"^(global|local|world)\b",
        bones=r"\bjnt" + NUMBER,
        only=True,
    ),
    Convention(
        "3ds Max' Biped",
        "https://help.autodesk.com/view/3DSMAX/2025/ENU/",
        signs=r"\bbip \d+ (pelvis|spine|neck|head|thigh|calf|clavicle|upper arm|forearm)",
        controls=r"\bfootsteps\b",
        roots=r"\bbip( \d+)+$",
        ends=r"nub" + NUMBER,
    ),
    Convention(
        "3ds Max' CAT",
        "https://help.autodesk.com/view/3DSMAX/2025/ENU/",
        signs=r"^cat rig\b|\b(leg|arm) (platform|digit|collarbone)",
        controls=r"\b(platform|ik ?target|cat ?parent)\b",
    ),
    Convention(
        "HumanIK and Mixamo",
        "https://help.autodesk.com/view/MAYAUL/2025/ENU/",
        signs=r"^(mixamorig \d* ?)?(up leg|fore arm|toe base|hand (thumb|index) \d)" + NUMBER,
        needs=2,
        roots=r"^(character \d+ )?reference" + NUMBER,
        ends=r"(hand|foot) (thumb|index|middle|ring|pinky|extra) 4( \d+)?$",
    ),
    Convention(
        "Unreal",
        "https://dev.epicgames.com/documentation/unreal-engine/skeletons-in-unreal-engine",
        signs=r"^(upperarm|lowerarm|clavicle|calf|ball|spine 0\d|ik foot|ik hand)( twist.*)?"
        + NUMBER,
        needs=4,
        controls=r"^(ik|vb)\b|^(interaction|center of mass|camera.*)" + NUMBER,
        roots=r"^root" + NUMBER,
    ),
    Convention(
        "Character Creator",
        "https://manual.reallusion.com/Character-Creator-4/",
        signs=r"^cc base ",
        bones=r"(twist|share bone|root)" + NUMBER,
        controls=r"^cc base (facial bone|pivot)",
        roots=r"^cc base bone root",
    ),
    Convention(
        "Daz",
        "https://docs.daz3d.com/",
        signs=r"^(thigh|shldr|forearm) (bend|twist)|^abdomen (lower|upper)|^metatarsals|^collar$",
        bones=r"(bend|twist)" + NUMBER,
        roots=r"^genesis",
    ),
    Convention(
        "SteamVR",
        "https://github.com/ValveSoftware/steamvr_unity_plugin",
        signs=r"^finger (thumb|index|middle|ring|pinky) (meta|aux|end|\d)",
        controls=r"\baux\b",
        roots=r"^root" + NUMBER,
    ),
    Convention(
        "VRM and VRoid",
        "https://github.com/vrm-c/vrm-specification",
        signs=r"^j (bip|sec|adj|opt) ",
        roots=r"^(root|secondary|armature)" + NUMBER,
        ends=r"\bend" + NUMBER,
        bones=r"^j ",
    ),
    Convention(
        "MikuMikuDance",  # Japanese has no spaces between words; others translate or romanise it
        "https://github.com/MMD-Blender/blender_mmd_tools",
        signs=r"全ての親|操作中心|上半身|下半身|センター|(upper|lower) ?body|parent ?node|^mother|"
        r"j[ou]+ ?han ?shin|ka ?han ?shin|subete ?no ?oya",
        needs=2,
        controls=r"(全ての|すべての|全)親|操作中心|ダミー|グルーブ|^両目|"
        r"^センター( ?\d|先|親|補助|$)|^(dummy|shadow)\b|"
        r"^(?!(tip|saki)$)((all|of|parents?|nodes?|mother|mother ?bone|parent ?node|root|master|"
        r"cent(er|re)|groove|gurubu|guruubu|senta+|view|cnt|subete|no|oya|subetenooya|sousa|"
        r"chuushin|sousachuushin|tip|saki)( |$))+$",
        ends=r"(?<!つま)(?<!爪)先"
        + NUMBER
        + r"|^(?!.*\b(hair|kami|tsuma)\b).*\b(tip|saki)"
        + NUMBER,
        unsure=r"キャンセル|肩 ?[pc]\b|\bcancel\b",
        yields=((r"^(.*)$", r"\1 d"),),  # the left leg to the left leg D, which carries its weight
    ),
    Convention(
        "Sketchfab",
        "https://sketchfab.com/developers/download-api",
        signs=r"\broot joint|^gltf created",
        needs=1,
        roots=r"\broot ?joint" + NUMBER + r"|^gltf created",
    ),
    Convention(
        "MakeHuman",
        "https://github.com/makehumancommunity/makehuman/tree/master/makehuman/data/rigs",
        signs=r"^(levator|oculi|oris|temporalis|risorius|special) \d+",
        controls=r"^(levator 0[2-4]|oculi 02|oris 0[246]|risorius 02|special 0\d|"
        r"temporalis 0[12])$",
        roots=r"^root$",
    ),
    Convention(
        "all tools",
        "https://docs.blender.org/manual/en/latest/addons/import_export/scene_gltf2.html",
        needs=0,
        controls=r"\b(pole|c(on)?tr?o?ls?|ctlr|controller|pv|tgt|goal|aim|look|lookat|gaze|"
        r"marker|dummy|damii|null?|camera|mch|wgt|trajectory|footsteps|ignore|gizmo|hitbox|npo|upv)\b|"
        r"control|ctrl|target|orient|polevector|helper|locator|tracker|"
        r"\b(heel|toes?|foot|ball|bank)\b.*\broll\b|\broll\b.*\b(heel|toes?|foot|ball|bank)\b",
        ends=r"(\b(end|site|eff|effector)|nub)"
        + NUMBER
        + r"|^(?=.*\btip\b).*\b(thumb|index|middle|ring|pinky|little|finger|toe)\b",
        unsure=r"\b(ikp?|fk|weapon|holster|props?|item)\b",
        sockets=r"socket|slot|attach",
        roots=r"\b(root|master|armature|base|global|world|origin|reference|rig|trajectory|ground)\b",
    ),
)
"""Rows of tools, and the last one with words that count everywhere."""

GENERAL = CONVENTIONS[-1]
JOINT_KINDS = ("controls", "ends", "sockets", "unsure", "roots", "bones")
COMMON_WORD = 0.75
"""Part of the names: a word that more of them have says nothing about one."""
REASONS = {
    "controls": "control, by its name",
    "ends": "end marker, by its name",
    "sockets": "holds things, by its name",
    "roots": "root, by its name",
}


def kinds_by_name(names: Sequence[str]) -> list[tuple[str, str]]:
    """Return what kind of joint each name says, a field of `Convention` or "", and why.

    The first row that has something to say about a name decides. A kind "others" means that only
    others deform. Words that most names have, as that of the armature, say nothing in the last row.
    """
    texts = [plain(name) for name in names]
    together = set(texts)
    rows = [row for row in CONVENTIONS[:-1] if _counts(row, texts)]
    counts = Counter(word for text, _ in texts for word in set(text.split()))
    kinds = []
    for name, (text, side) in zip(names, texts, strict=True):
        rare = [word for word in text.split() if counts[word] <= max(COMMON_WORD * len(names), 4)]
        kinds.append(
            ("controls", REASONS["controls"])
            if is_neutral(name)
            else _kind(rows, (text, side), " ".join(rare), together)
        )
    return kinds


def _counts(row: Convention, texts: Sequence[tuple[str, str]]) -> bool:
    """Return whether enough names fit the signs of a row."""
    return sum(bool(re.search(row.signs, text)) for text, _ in texts) >= row.needs


def _kind(
    rows: Sequence[Convention], text: tuple[str, str], rare: str, together: set[tuple[str, str]]
) -> tuple[str, str]:
    name, side = text
    for row in rows:
        by = f" in {row.tool}"
        for pattern, other in row.yields:
            if re.search(pattern, name) and (re.sub(pattern, other, name), side) in together:
                return "controls", f"control, by its name{by}: another joint deforms"
        if kind := _first(row, name):
            if kind == "bones" and row.only and re.search(GENERAL.ends, rare):
                return "ends", REASONS["ends"]
            is_root = kind == "bones" and row.only and re.search(GENERAL.roots, rare)
            return "root" if is_root else kind, REASONS.get(kind, "") + by
        if row.only and _first(GENERAL, rare) not in ("controls", "ends", "sockets"):
            return "others", f"others are marked as deforming{by}"
    kind = _first(GENERAL, rare)
    return ("root" if kind == "roots" else kind), REASONS.get(kind, "")


def _first(row: Convention, name: str) -> str:
    """Return the first kind of a row whose names a name is of, or none."""
    patterns = ((kind, getattr(row, kind)) for kind in JOINT_KINDS)
    return next((kind for kind, pattern in patterns if pattern and re.search(pattern, name)), "")
