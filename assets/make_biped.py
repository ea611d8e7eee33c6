"""The walker: a child in a jumper, its hands close to its hips."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from .biped_bones import DOWN, FINGERS, finger_places, skeleton
from .biped_walk import walk
from .body import Body
from .build import closed_character
from .character import Bones, Character, Material
from .motion import Z
from .sdf import (
    Points,
    ball,
    chain,
    common,
    ellipsoid,
    half_space,
    round_cone,
    shell,
    shifted,
    torus,
    unit,
)

MATERIALS = {
    "skin": Material("skin", "#f0b48f", roughness=0.6),
    "jumper": Material("jumper", "#3a9a98", roughness=0.9),
    "trim": Material("trim", "#f4c152", roughness=0.9),
    "shorts": Material("shorts", "#3d5080", roughness=0.85),
    "hair": Material("hair", "#5b392c", roughness=0.6),
    "eye": Material("eye", "#2a1d1e", roughness=0.25),
    "light": Material("glint", "#ffffff", roughness=0.3),
    "lips": Material("lips", "#b5564c", roughness=0.5),
    "sock": Material("sock", "#f7f1e4", roughness=0.9),
    "shoe": Material("shoe", "#e0603f", roughness=0.5),
    "sole": Material("sole", "#fbf6ea", roughness=0.7),
}


@cache
def make(detail: float = 1.0) -> Character:
    """Return the walker, its triangles `detail` times as large as designed."""
    bones = skeleton()
    body = shape_around(bones)
    box = [[-0.29, -0.02, -0.24], [0.29, 1.64, 0.22]]
    return closed_character("Walker", bones, body, box, 0.003, MATERIALS, walk(), detail)


def shape_around(bones: Bones) -> Body:
    """Return the walker's body."""
    body = Body()
    _torso(body)
    _head(body)
    _arm(body, bones)
    _hand(body, bones["hand.L"])
    _leg(body, bones)
    _shoe(body, bones["foot.L"])
    return body


def _torso(body: Body) -> None:
    cloth = {"colour": "jumper", "edge": 0.019}
    trim = {"colour": "trim", "edge": 0.011}
    body.add(ellipsoid([0, 0.79, 0], [0.128, 0.08, 0.098]), "hips", colour="shorts", edge=0.018)
    body.add(ellipsoid([0, 0.885, 0.002], [0.112, 0.085, 0.09]), "spine1", blend=0.05, **cloth)
    body.add(ellipsoid([0, 0.975, 0.002], [0.110, 0.09, 0.089]), "spine2", blend=0.06, **cloth)
    body.add(ellipsoid([0, 1.065, -0.004], [0.121, 0.095, 0.092]), "chest", blend=0.06, **cloth)
    shoulder = round_cone([0.02, 1.118, -0.006], [0.128, 1.103, -0.008], 0.062, 0.046)
    body.add(shoulder, "clavicle.L", both=True, blend=0.035, **cloth)
    # The jumper's hem is a roll around the hips.
    hem = common(
        ellipsoid([0, 0.83, 0.001], [0.138, 0.25, 0.107]),
        ellipsoid([0, 0.826, 0], [0.4, 0.02, 0.4]),
        0.012,
    )
    body.add(hem, "hips", blend=0.008, **trim)
    body.add(torus([0, 1.178, -0.004], [0, 1, 0.22], 0.053, 0.0175), "chest", blend=0.012, **trim)


def _head(body: Body) -> None:
    skin: dict[str, Any] = {"joint": "head", "edge": 0.012}
    neck = round_cone([0, 1.195, -0.01], [0, 1.23, -0.004], 0.044, 0.04)
    body.add(neck, "neck", blend=0.006, edge=0.012)
    throat: dict[str, Any] = {"at": np.array([0, 1.25, 0]), "reach": 0.09}
    body.add(ellipsoid([0, 1.39, 0.005], [0.13, 0.132, 0.133]), blend=0.02, **throat, **skin)
    jaw: dict[str, Any] = {"at": np.array([0, 1.33, 0.05]), "reach": 0.2}
    body.add(ellipsoid([0, 1.317, 0.032], [0.094, 0.07, 0.088]), blend=0.05, **jaw, **skin)
    body.add(ball([0.056, 1.328, 0.078], 0.044), both=True, blend=0.03, **skin)
    # Ears, dished.
    ear: dict[str, Any] = {"joint": "head", "both": True}
    body.add(
        ellipsoid([0.131, 1.362, -0.002], [0.019, 0.036, 0.026]), blend=0.01, edge=0.008, **ear
    )
    dish = ellipsoid([0.152, 1.364, 0.005], [0.012, 0.023, 0.015])
    body.add(dish, blend=0.008, edge=0.0055, carve=True, **ear)
    _face(body)
    _hair(body)


def _face(body: Body) -> None:
    nose = ellipsoid([0, 1.347, 0.142], [0.017, 0.015, 0.019])
    body.add(nose, "head", blend=0.014, edge=0.007)
    eye = ellipsoid([0.048, 1.377, 0.118], [0.0195, 0.028, 0.0165])
    body.add(eye, "head", both=True, blend=0.003, edge=0.0055, colour="eye")
    for x in (0.0545, -0.0435):  # the light comes from one side, so not a reflection
        body.colour(ball([x, 1.3885, 0.134], 0.007), "light", 0.0035)
    brow = chain(
        [[0.027, 1.424, 0.127], [0.052, 1.431, 0.119], [0.078, 1.421, 0.104]],
        [0.005, 0.0065, 0.004],
    )
    body.add(brow, "head", both=True, blend=0.005, edge=0.0055, colour="hair")
    smile = chain(
        [
            [-0.036, 1.311, 0.116],
            [-0.019, 1.2995, 0.125],
            [0, 1.296, 0.128],
            [0.019, 1.2995, 0.125],
            [0.036, 1.311, 0.116],
        ],
        [0.003, 0.006, 0.0068, 0.006, 0.003],
    )
    body.add(smile, "head", blend=0.006, edge=0.005, carve=True)
    body.colour(shell(smile, 0.0015), "lips", 0.005)


def _hair(body: Body) -> None:
    hair: dict[str, Any] = {"joint": "head", "colour": "hair", "edge": 0.012}
    cap = common(
        ellipsoid([0, 1.398, -0.006], [0.143, 0.141, 0.145]),
        half_space([0, 1.447, 0.11], [0, -0.85, 0.53]),
        0.02,
    )
    body.add(cap, blend=0.006, **hair)
    locks = [
        ([[-0.05, 1.515, 0.05], [0.02, 1.493, 0.105], [0.078, 1.446, 0.111]], [0.03, 0.027, 0.007]),
        ([[-0.05, 1.51, 0.04], [-0.08, 1.47, 0.09], [-0.108, 1.422, 0.083]], [0.03, 0.023, 0.007]),
        ([[0.05, 1.51, 0.03], [0.105, 1.465, 0.065], [0.127, 1.408, 0.055]], [0.03, 0.024, 0.007]),
        ([[0, 1.52, -0.03], [0.012, 1.556, -0.045], [0.042, 1.584, -0.04]], [0.036, 0.022, 0.006]),
    ]
    for points, radii in locks:
        # Melt only at the root: the tips stay apart from the face.
        body.add(chain(points, radii), blend=0.015, at=np.array(points[0]), reach=0.11, **hair)
    tail = chain(
        [
            [0, 1.42, -0.135],
            [0, 1.425, -0.165],
            [0, 1.375, -0.19],
            [0, 1.30, -0.185],
            [0, 1.245, -0.16],
        ],
        [0.022, 0.03, 0.041, 0.03, 0.007],
    )
    root = np.array([0, 1.42, -0.15])
    body.add(tail, blend=0.012, at=root, reach=0.03, **hair)
    tie = torus([0, 1.423, -0.15], [0, 0.2, -1], 0.0265, 0.011)
    body.add(tie, "head", blend=0.004, colour="trim", edge=0.008)


def _arm(body: Body, bones: Bones) -> None:
    shoulder, elbow, wrist = (bones[f"{n}.L"] for n in ("upper_arm", "forearm", "hand"))
    sleeve = {"colour": "jumper", "both": True, "edge": 0.015}
    cuff = wrist + (elbow - wrist) * 0.2
    upper = round_cone(shoulder, elbow, 0.045, 0.0385)
    body.add(upper, "upper_arm.L", at=shoulder, reach=0.12, blend=0.045, **sleeve)
    lower = round_cone(elbow, cuff + (elbow - wrist) * 0.12, 0.0385, 0.0335)
    body.add(lower, "forearm.L", at=elbow, reach=0.08, blend=0.006, **sleeve)
    roll = torus(cuff, elbow - wrist, 0.0265, 0.0098)
    trim = {"colour": "trim", "edge": 0.008}
    body.add(roll, "forearm.L", both=True, at=cuff, reach=0.06, blend=0.006, **trim)
    skin = round_cone(cuff, wrist, 0.025, 0.0225)
    body.add(skin, "forearm.L", both=True, at=cuff, reach=0.05, blend=0.004, edge=0.009)


def _hand(body: Body, wrist: Points) -> None:
    skin = {"both": True, "edge": 0.0078}
    across = unit(Z - DOWN * DOWN[2])
    frame = np.array([np.cross(DOWN, across), DOWN, across])
    middle = wrist + DOWN * 0.052
    palm = ellipsoid(middle, [0.0195, 0.055, 0.047], frame)
    body.add(palm, "hand.L", at=wrist, reach=0.06, blend=0.03, **skin)
    fingers = finger_places(wrist)
    for name, (_, _, _, _, radius) in FINGERS.items():
        # The back of the hand runs out into the knuckles.
        knuckle = fingers[name][0]
        root = wrist + DOWN * 0.028 + (knuckle - wrist) * Z * 0.6
        bone = round_cone(root, knuckle, 0.0142, radius * 1.06)
        body.add(bone, "hand.L", at=middle, reach=0.066, blend=0.02, **skin)
    for name, places in fingers.items():
        thumb = name == "thumb"
        radii = np.array([1.12 * 0.0138, 0.0132, 0.0122, 0.0103])
        if not thumb:
            radii = FINGERS[name][4] * np.array([1.0, 0.95, 0.89, 0.76])
        for k in range(3):
            segment = round_cone(places[k], places[k + 1], radii[k], radii[k + 1])
            reach, blend = (0.012, 0.003) if k else (0.04, 0.022) if thumb else (0.018, 0.012)
            body.add(
                segment,
                f"{name}{k + 1}.L",
                both=True,
                at=places[k],
                reach=reach,
                blend=blend,
                edge=0.0066,
            )


def _leg(body: Body, bones: Bones) -> None:
    hip, knee, ankle = (bones[f"{n}.L"] for n in ("thigh", "shin", "foot"))
    hem = hip + (knee - hip) * 0.8
    shorts = {"colour": "shorts", "both": True}
    thigh = round_cone(shifted(hip, 0, -0.035, 0), hem, 0.077, 0.067)
    body.add(thigh, "thigh.L", at=hip, reach=0.14, blend=0.04, edge=0.018, **shorts)
    roll = torus(hem, hip - knee, 0.0595, 0.0115)
    body.add(roll, "thigh.L", at=hem, reach=0.09, blend=0.008, edge=0.011, **shorts)
    skin = {"both": True, "edge": 0.015}
    body.add(
        round_cone(hem, knee, 0.053, 0.047), "thigh.L", at=hem, reach=0.08, blend=0.004, **skin
    )
    shin = round_cone(knee, shifted(ankle, 0, 0.03, 0), 0.047, 0.034)
    body.add(shin, "shin.L", at=knee, reach=0.08, blend=0.006, **skin)
    calf = ellipsoid([0.089, 0.31, -0.02], [0.039, 0.1, 0.043])
    body.add(calf, "shin.L", at=np.array([0.089, 0.31, -0.01]), reach=0.15, blend=0.03, **skin)
    sock = {"both": True, "colour": "sock", "at": shifted(ankle, 0, 0.05, 0), "reach": 0.2}
    tube = round_cone(ankle, shifted(ankle, -0.0005, 0.062, 0.005), 0.0375, 0.0385)
    body.add(tube, "shin.L", blend=0.004, edge=0.012, **sock)
    roll = torus(shifted(ankle, -0.0008, 0.085, 0.008), [0, 1, -0.1], 0.0335, 0.0115)
    body.add(roll, "shin.L", blend=0.006, edge=0.009, **sock)


def _shoe(body: Body, ankle: Points) -> None:
    ground = half_space([0, 0, 0], [0, -1, 0])
    floor = half_space([0, 0.02, 0], [0, 1, 0])
    place = {"at": shifted(ankle, 0.004, -0.05, 0.05), "reach": 0.25, "both": True}
    upper = {"colour": "shoe", "edge": 0.013, **place}
    back = round_cone([0.091, 0.045, -0.042], [0.099, 0.04, 0.085], 0.046, 0.043)
    front = ellipsoid([0.102, 0.038, 0.112], [0.05, 0.047, 0.066])
    body.add(common(back, ground, 0.012), "foot.L", blend=0.01, **upper)
    instep = round_cone(shifted(ankle, 0, 0.006, 0.002), [0.096, 0.06, 0.03], 0.0425, 0.037)
    body.add(instep, "foot.L", blend=0.03, **upper)
    body.add(common(front, ground, 0.012), "toe.L", blend=0.025, **upper)
    for shape, joint in ((back, "foot.L"), (front, "toe.L")):
        sole = common(common(shell(shape, 0.007), floor, 0.008), ground, 0.008)
        body.add(sole, joint, blend=0.004, colour="sole", edge=0.0075, **place)
    tongue = shifted(ankle, 0, 0.028, 0.002)
    rim = torus(tongue, [0, 1, -0.12], 0.034, 0.0095)
    body.add(rim, "foot.L", blend=0.008, **upper)
