"""The walker: a child in a hooded jumper, its hands close to its hips."""

from __future__ import annotations

import numpy as np

from .character import Bones, Character, Material, Surface, rgb
from .meshing import mesh_of, normals_of
from .motion import X, Y, Z, curve, loop, move, phase, rotate, turn, wave
from .sdf import Body, ball, chain, common, ellipsoid, half_space, round_cone, shell, torus, unit
from .weights import from_parts

COLOURS = {
    "skin": "#e8b08f",
    "lips": "#a8524a",
    "hair": "#4a3027",
    "eye": "#241a1c",
    "light": "#ffffff",
    "jumper": "#3f8f92",
    "trim": "#f2c14e",
    "shorts": "#3b4a6b",
    "sock": "#f5efe2",
    "shoe": "#d9583f",
    "sole": "#f7f1e6",
}

DOWN = unit([0.03, -1.0, 0.09])
"""Where the hanging hand points."""

FINGERS = {
    # sideways place at the knuckle, how far down, fan, lengths, radius at the root
    "index": (0.0325, 0.078, 0.13, (0.031, 0.023, 0.018), 0.0098),
    "middle": (0.0108, 0.082, 0.04, (0.034, 0.025, 0.019), 0.0102),
    "ring": (-0.0108, 0.079, -0.05, (0.031, 0.023, 0.018), 0.0098),
    "pinky": (-0.0315, 0.071, -0.15, (0.025, 0.018, 0.015), 0.0088),
}


def make() -> Character:
    """Return the walker."""
    bones, body = skeleton(), Body()
    _torso(body)
    _head(body)
    _arm(body, bones)
    _leg(body, bones)
    vertices, faces = mesh_of(
        body, np.array([-0.32, -0.02, -0.2]), np.array([0.32, 1.64, 0.26]), spacing=0.003
    )
    surface = Surface(
        vertices,
        faces,
        normals_of(body, vertices),
        from_parts(body, bones, vertices, faces),
        Material("walker"),
        np.array([rgb(COLOURS[name]) for name in body.colours(vertices)]),
    )
    return Character("Walker", bones, [surface], walk())


def skeleton() -> Bones:
    """Return the walker's joints."""
    bones = Bones()
    bones.add("hips", None, [0, 0.80, 0])
    bones.add("spine1", "hips", [0, 0.885, -0.005])
    bones.add("spine2", "spine1", [0, 0.975, -0.008])
    bones.add("chest", "spine2", [0, 1.06, -0.008])
    bones.add("neck", "chest", [0, 1.18, -0.01])
    bones.add("head", "neck", [0, 1.25, 0.0])
    bones.add("clavicle.L", "chest", [0.035, 1.135, -0.005], both=True)
    bones.add("upper_arm.L", "clavicle.L", [0.15, 1.122, -0.008], both=True)
    bones.add("forearm.L", "upper_arm.L", [0.2, 0.915, -0.016], both=True)
    bones.add("hand.L", "forearm.L", [0.209, 0.725, 0.008], both=True)
    for name, places in _fingers(bones["hand.L"]).items():
        bones.add_chain(f"{name}.L", "hand.L", places[:3], both=True)
    bones.add("thigh.L", "hips", [0.082, 0.765, 0], both=True)
    bones.add("shin.L", "thigh.L", [0.09, 0.425, 0.012], both=True)
    bones.add("foot.L", "shin.L", [0.092, 0.095, -0.022], both=True)
    bones.add("toe.L", "foot.L", [0.1, 0.03, 0.085], both=True)
    return bones


def _fingers(wrist: np.ndarray) -> dict[str, np.ndarray]:
    """Return the joints and the tip of each finger, shape (4, 3) each."""
    result = {}
    bend = np.array([-0.11, 0, 0])  # each segment leans a bit more to the palm
    for name, (side, reach, fan, lengths, _) in FINGERS.items():
        places = [wrist + DOWN * reach + Z * side]
        for k, length in enumerate(lengths):
            places.append(places[-1] + length * unit(DOWN + fan * Z + bend * (k + 0.3)))
        result[name] = np.array(places)
    thumb = [wrist + DOWN * 0.018 + Z * 0.024 + X * -0.004]
    for direction, length in zip(
        ([-0.12, -0.72, 0.72], [-0.16, -0.9, 0.5], [-0.16, -1, 0.25]),
        (0.036, 0.029, 0.023),
        strict=True,
    ):
        thumb.append(thumb[-1] + length * unit(direction))
    result["thumb"] = np.array(thumb)
    return result


def _torso(body: Body) -> None:
    cloth = {"colour": "jumper", "edge": 0.019}
    body.add(ellipsoid([0, 0.79, 0], [0.138, 0.085, 0.1]), "hips", colour="shorts", edge=0.018)
    body.add(ellipsoid([0, 0.885, 0.002], [0.117, 0.085, 0.09]), "spine1", blend=0.05, **cloth)
    body.add(ellipsoid([0, 0.975, 0.002], [0.115, 0.09, 0.09]), "spine2", blend=0.06, **cloth)
    body.add(ellipsoid([0, 1.07, -0.004], [0.126, 0.098, 0.093]), "chest", blend=0.06, **cloth)
    body.add(
        round_cone([0.03, 1.125, -0.006], [0.145, 1.12, -0.008], 0.06, 0.05),
        "clavicle.L",
        both=True,
        blend=0.04,
        **cloth,
    )
    # The jumper's hem, a roll around the hips.
    hem = common(
        shell(ellipsoid([0, 0.83, 0.001], [0.128, 0.2, 0.096]), 0.004),
        ellipsoid([0, 0.826, 0], [0.2, 0.02, 0.2]),
        0.012,
    )
    body.add(hem, "hips", blend=0.012, colour="trim", edge=0.012)
    # Collar and hood.
    body.add(
        torus([0, 1.178, -0.004], [0, 1, 0.35], 0.056, 0.019),
        "chest",
        blend=0.02,
        colour="trim",
        edge=0.012,
    )
    body.add(ellipsoid([0, 1.15, -0.09], [0.085, 0.05, 0.036]), "chest", blend=0.03, **cloth)


def _head(body: Body) -> None:
    skin = {"joint": "head", "edge": 0.013}
    body.add(
        round_cone([0, 1.15, -0.012], [0, 1.23, -0.004], 0.044, 0.04),
        "neck",
        blend=0.012,
        edge=0.013,
    )
    body.add(
        ellipsoid([0, 1.39, 0.005], [0.13, 0.132, 0.133]),
        at=np.array([0, 1.25, 0]),
        reach=0.09,
        blend=0.02,
        **skin,
    )
    body.add(
        ellipsoid([0, 1.317, 0.032], [0.094, 0.07, 0.088]),
        at=np.array([0, 1.33, 0.05]),
        reach=0.2,
        blend=0.05,
        **skin,
    )
    body.add(ball([0.056, 1.328, 0.078], 0.044), both=True, blend=0.03, **skin)
    _face(body)
    # Ears, dished.
    body.add(
        ellipsoid([0.13, 1.362, -0.004], [0.019, 0.036, 0.025]),
        both=True,
        joint="head",
        blend=0.012,
        edge=0.008,
    )
    body.add(
        ellipsoid([0.150, 1.364, 0.002], [0.011, 0.022, 0.014]),
        both=True,
        joint="head",
        blend=0.008,
        edge=0.006,
        carve=True,
    )
    _hair(body)


def _face(body: Body) -> None:
    at = {"joint": "head"}
    body.add(ellipsoid([0, 1.347, 0.142], [0.017, 0.015, 0.019]), blend=0.014, edge=0.007, **at)
    eye = ellipsoid([0.048, 1.377, 0.118], [0.019, 0.027, 0.016])
    body.add(eye, both=True, blend=0.004, edge=0.005, colour="eye", **at)
    body.colour(ball([0.053, 1.387, 0.134], 0.0065), "light", 0.0035)
    body.colour(ball([-0.043, 1.387, 0.134], 0.0065), "light", 0.0035)
    brow = chain(
        [[0.027, 1.424, 0.127], [0.052, 1.431, 0.119], [0.078, 1.421, 0.104]],
        [0.005, 0.0065, 0.004],
    )
    body.add(brow, both=True, blend=0.006, edge=0.006, colour="hair", **at)
    smile = chain(
        [
            [-0.034, 1.309, 0.117],
            [-0.018, 1.299, 0.125],
            [0, 1.296, 0.128],
            [0.018, 1.299, 0.125],
            [0.034, 1.309, 0.117],
        ],
        [0.003, 0.006, 0.0065, 0.006, 0.003],
    )
    body.add(smile, blend=0.006, edge=0.005, carve=True, **at)
    body.colour(shell(smile, 0.002), "lips", 0.005)


def _hair(body: Body) -> None:
    hair = {"joint": "head", "colour": "hair", "edge": 0.012}
    cap = common(
        ellipsoid([0, 1.398, -0.006], [0.143, 0.141, 0.145]),
        half_space([0, 1.447, 0.11], [0, -0.85, 0.53]),
        0.02,
    )
    body.add(cap, blend=0.008, **hair)
    locks = [
        ([[-0.05, 1.515, 0.05], [0.02, 1.493, 0.105], [0.075, 1.447, 0.112]], [0.03, 0.026, 0.006]),
        ([[-0.05, 1.51, 0.04], [-0.08, 1.47, 0.09], [-0.105, 1.425, 0.085]], [0.03, 0.022, 0.006]),
        ([[0.05, 1.51, 0.03], [0.105, 1.465, 0.065], [0.125, 1.41, 0.055]], [0.03, 0.024, 0.006]),
        ([[0, 1.52, -0.03], [0.012, 1.556, -0.045], [0.04, 1.582, -0.04]], [0.036, 0.022, 0.005]),
        ([[0.06, 1.29, -0.1], [0.055, 1.255, -0.1], [0.05, 1.232, -0.082]], [0.035, 0.022, 0.006]),
        ([[0, 1.29, -0.115], [0, 1.25, -0.11], [0, 1.222, -0.09]], [0.035, 0.024, 0.006]),
        (
            [[-0.06, 1.29, -0.1], [-0.055, 1.255, -0.1], [-0.05, 1.232, -0.082]],
            [0.035, 0.022, 0.006],
        ),
    ]
    for points, radii in locks:
        # Melt only at the root: the tips stay apart from face and neck.
        body.add(chain(points, radii), blend=0.015, at=np.array(points[0]), reach=0.11, **hair)


def _arm(body: Body, bones: Bones) -> None:
    shoulder, elbow, wrist = (bones[f"{n}.L"] for n in ("upper_arm", "forearm", "hand"))
    sleeve = {"colour": "jumper", "both": True, "edge": 0.015}
    cuff = wrist + (elbow - wrist) * 0.22
    body.add(
        round_cone(shoulder, elbow, 0.049, 0.041),
        "upper_arm.L",
        at=shoulder,
        reach=0.12,
        blend=0.05,
        **sleeve,
    )
    body.add(
        round_cone(elbow, cuff, 0.041, 0.036),
        "forearm.L",
        at=elbow,
        reach=0.08,
        blend=0.02,
        **sleeve,
    )
    body.add(
        torus(cuff, elbow - wrist, 0.027, 0.0125),
        "forearm.L",
        both=True,
        at=cuff,
        reach=0.06,
        blend=0.01,
        colour="trim",
        edge=0.009,
    )
    body.add(
        round_cone(cuff, wrist, 0.027, 0.0225),
        "forearm.L",
        both=True,
        at=cuff,
        reach=0.05,
        blend=0.006,
        edge=0.009,
    )
    _hand(body, wrist)


def _hand(body: Body, wrist: np.ndarray) -> None:
    skin = {"both": True, "edge": 0.0075}
    across = unit(Z - DOWN * float(DOWN @ Z))
    frame = np.array([np.cross(DOWN, across), DOWN, across])
    middle = wrist + DOWN * 0.047
    body.add(
        ellipsoid(middle, [0.0185, 0.05, 0.043], frame),
        "hand.L",
        at=wrist,
        reach=0.06,
        blend=0.03,
        **skin,
    )
    fingers = _fingers(wrist)
    for name, (_, _, _, _, radius) in FINGERS.items():
        # The back of the hand runs out into the knuckles.
        body.add(
            round_cone(
                wrist + DOWN * 0.025 + (fingers[name][0] - wrist) * Z * 0.6,
                fingers[name][0],
                0.013,
                radius * 1.08,
            ),
            "hand.L",
            at=middle,
            reach=0.06,
            blend=0.02,
            **skin,
        )
    for name, places in fingers.items():
        radius = 0.0125 if name == "thumb" else FINGERS[name][4]
        radii = radius * np.array([1.12 if name == "thumb" else 1.0, 0.95, 0.88, 0.74])
        for k in range(3):
            at, reach = places[k], (0.035 if name == "thumb" else 0.017) if k == 0 else 0.012
            body.add(
                round_cone(places[k], places[k + 1], radii[k], radii[k + 1]),
                f"{name}{k + 1}.L",
                at=at,
                reach=reach,
                blend=(0.02 if name == "thumb" else 0.012) if k == 0 else 0.004,
                both=True,
                edge=0.0062,
            )


def _leg(body: Body, bones: Bones) -> None:
    hip, knee, ankle = (bones[f"{n}.L"] for n in ("thigh", "shin", "foot"))
    hem = hip + (knee - hip) * 0.8
    body.add(
        round_cone(hip, hem, 0.083, 0.072),
        "thigh.L",
        both=True,
        at=hip,
        reach=0.15,
        blend=0.04,
        colour="shorts",
        edge=0.018,
    )
    body.add(
        torus(hem, hip - knee, 0.064, 0.0125),
        "thigh.L",
        both=True,
        at=hem,
        reach=0.09,
        blend=0.01,
        colour="shorts",
        edge=0.012,
    )
    body.add(
        round_cone(hem, knee, 0.057, 0.05),
        "thigh.L",
        both=True,
        at=hem,
        reach=0.08,
        blend=0.008,
        edge=0.015,
    )
    body.add(
        round_cone(knee, ankle + [0, 0.03, 0], 0.05, 0.036),
        "shin.L",
        both=True,
        at=knee,
        reach=0.08,
        blend=0.015,
        edge=0.015,
    )
    body.add(
        ellipsoid([0.092, 0.3, -0.022], [0.041, 0.1, 0.044]),
        "shin.L",
        both=True,
        at=np.array([0.092, 0.3, -0.01]),
        reach=0.15,
        blend=0.03,
        edge=0.015,
    )
    body.add(
        torus(ankle + [0, 0.065, 0.004], [0, 1, -0.1], 0.032, 0.0145),
        "shin.L",
        both=True,
        at=ankle + [0, 0.065, 0],
        reach=0.08,
        blend=0.012,
        colour="sock",
        edge=0.01,
    )
    _shoe(body, bones)


def _shoe(body: Body, bones: Bones) -> None:
    ankle, toe = bones["foot.L"], bones["toe.L"]
    ground = half_space([0, 0, 0], [0, -1, 0])
    floor = half_space([0, 0.02, 0], [0, 1, 0])
    shoe = {"both": True, "edge": 0.013}
    at = {"at": ankle + [0.004, -0.05, 0.05], "reach": 0.25}
    back = round_cone([0.093, 0.045, -0.042], [0.1, 0.04, 0.085], 0.047, 0.044)
    front = ellipsoid([0.103, 0.036, 0.112], [0.051, 0.046, 0.068])
    body.add(common(back, ground, 0.012), "foot.L", blend=0.02, colour="shoe", **at, **shoe)
    body.add(
        round_cone(ankle + [0, 0.01, 0.002], [0.097, 0.06, 0.03], 0.041, 0.036),
        "foot.L",
        blend=0.03,
        colour="shoe",
        **at,
        **shoe,
    )
    body.add(common(front, ground, 0.012), "toe.L", blend=0.025, colour="shoe", **at, **shoe)
    for shape, joint in ((back, "foot.L"), (front, "toe.L")):
        sole = common(common(shell(shape, 0.007), floor, 0.008), ground, 0.008)
        body.add(
            sole, joint, blend=0.008, colour="sole", at=at["at"], reach=0.25, both=True, edge=0.011
        )
    del toe


def walk() -> "Motion":
    """Return a walk on the spot, two steps in 1.2 seconds."""
    motion = loop("walk", 1.2, 30)
    t = phase(motion)
    move(motion, "hips", 0.012 * wave(t, 0.02), 0.014 * wave(t, 0.12, 2) - 0.012, 0)
    rotate(motion, "hips", turn(Y, 6 * wave(t, 0.25)), turn(Z, 2.5 * wave(t, 0.02)))
    rotate(motion, "spine1", turn(Y, -4 * wave(t, 0.25)), turn(X, 2.5))
    rotate(motion, "spine2", turn(Y, -4 * wave(t, 0.25)), turn(Z, -2.5 * wave(t, 0.02)))
    rotate(motion, "chest", turn(Y, -4 * wave(t, 0.25)), turn(X, 1.5 * wave(t, 0.3, 2)))
    rotate(motion, "head", turn(Y, 5 * wave(t, 0.25)), turn(X, -3 + 1.5 * wave(t, 0.2, 2)))
    for side, late in (("L", 0.0), ("R", 0.5)):
        sign = 1 if side == "L" else -1
        thigh = curve(t, [-27, -20, -6, 8, 20, 16, -12, -30], late)
        shin = curve(t, [5, 16, 10, 6, 22, 56, 58, 22], late)
        foot = curve(t, [-14, 2, 0, -6, 8, 18, -2, -12], late)
        toe = curve(t, [-4, 0, 0, -6, -26, -4, 0, -4], late)
        rotate(motion, f"thigh.{side}", turn(X, thigh))
        rotate(motion, f"shin.{side}", turn(X, shin))
        rotate(motion, f"foot.{side}", turn(X, foot))
        rotate(motion, f"toe.{side}", turn(X, toe))
        swing = wave(t, 0.25 + late)  # the arm goes with the other leg
        rotate(motion, f"clavicle.{side}", turn(Y, sign * 0 - 3 * swing))
        rotate(motion, f"upper_arm.{side}", turn(X, -3 - 24 * swing), turn(Z, sign * 4))
        rotate(motion, f"forearm.{side}", turn(X, -20 - 14 * wave(t, 0.3 + late)))
        rotate(motion, f"hand.{side}", turn(X, -4 - 6 * wave(t, 0.38 + late)))
        for name in FINGERS:
            for k in (1, 2, 3):
                rotate(motion, f"{name}{k}.{side}", turn(Z, -sign * (10 + 2 * k)))
    return motion
