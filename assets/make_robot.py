"""The robot: rigid plates with air between them, and a ring around its head."""

from __future__ import annotations

import numpy as np

from .character import Bones, Character, Material, Motion, Surface
from .motion import X, Y, Z, curve, loop, move, phase, rotate, turn, wave
from .plates import Plate, barrel, box, globe, turned
from .sdf import shifted, unit
from .weights import rigid

MATERIALS = {
    "shell": Material("shell", "#efe9dc", metallic=0.1, roughness=0.45),
    "accent": Material("accent", "#f08a3e", metallic=0.1, roughness=0.4),
    "dark": Material("rubber", "#3b434f", metallic=0.2, roughness=0.6),
    "steel": Material("steel", "#9fabb8", metallic=0.6, roughness=0.35),
    "glow": Material("lamp", "#8ff0e6", roughness=0.3),
    "ring": Material("ring", "#f4c650", metallic=0.5, roughness=0.3),
}

HEAD = np.array([0, 1.40, 0.01])


class Kit:
    """Plates, each on its joint and of its material."""

    def __init__(self) -> None:
        self.plates: list[tuple[Plate, str, str]] = []

    def add(self, plate: Plate, joint: str, material: str, both: bool = False) -> None:
        """Add a plate; with `both`, its reflection too, on the right-hand joint."""
        self.plates.append((plate, joint, material))
        if both:
            self.plates.append((plate.mirrored(), joint.replace(".L", ".R"), material))


def make() -> Character:
    """Return the robot."""
    bones, kit = _skeleton(), Kit()
    _head(kit)
    _torso(kit)
    _arm(kit, bones)
    _leg(kit, bones)
    surfaces = [_surface(kit, bones, name) for name in MATERIALS]
    return Character("Robot", bones, surfaces, _march())


def _surface(kit: Kit, bones: Bones, material: str) -> Surface:
    mine = [(plate, joint) for plate, joint, name in kit.plates if name == material]
    first = np.cumsum([0, *(len(plate.vertices) for plate, _ in mine)])
    return Surface(
        np.concatenate([plate.vertices for plate, _ in mine]),
        np.concatenate([p.faces + k for (p, _), k in zip(mine, first, strict=False)]),
        np.concatenate([plate.normals() for plate, _ in mine]),
        np.concatenate([rigid(len(p.vertices), bones, joint) for p, joint in mine]),
        MATERIALS[material],
    )


def _skeleton() -> Bones:
    bones = Bones()
    bones.add("hips", None, [0, 0.66, 0])
    bones.add("spine", "hips", [0, 0.755, 0])
    bones.add("chest", "spine", [0, 0.86, 0])
    bones.add("neck", "chest", [0, 1.165, 0])
    bones.add("head", "neck", [0, 1.215, 0])
    bones.add("antenna", "head", [0, 1.60, 0.01])
    bones.add("shoulder.L", "chest", [0.17, 1.09, 0], both=True)
    bones.add("upper_arm.L", "shoulder.L", [0.302, 1.09, 0], both=True)
    bones.add("forearm.L", "upper_arm.L", [0.334, 0.885, 0], both=True)
    bones.add("hand.L", "forearm.L", [0.348, 0.655, 0.02], both=True)
    for name, place in _CLAWS.items():
        tip = shifted(place, 0, -0.055, 0)
        bones.add_chain(f"{name}.L", "hand.L", np.array([place, tip]), both=True)
    bones.add("thigh.L", "hips", [0.115, 0.61, 0], both=True)
    bones.add("shin.L", "thigh.L", [0.12, 0.355, 0.005], both=True)
    bones.add("foot.L", "shin.L", [0.125, 0.10, -0.005], both=True)
    bones.add("toe.L", "foot.L", [0.13, 0.045, 0.085], both=True)
    return bones


_CLAWS = {
    "front": (0.36, 0.575, 0.062),
    "back": (0.36, 0.575, -0.022),
    "inner": (0.317, 0.575, 0.02),
}


def _head(kit: Kit) -> None:
    radius = 0.19
    kit.add(globe(radius, 0.36, 1.0, 32).moved(HEAD), "head", "shell")
    kit.add(globe(radius * 0.97, -0.28, 0.31, 32).moved(HEAD), "head", "dark")
    kit.add(globe(radius, -0.86, -0.33, 32).moved(HEAD), "head", "shell")
    for side in (1, -1):
        look = unit([0.42 * side, 0.03, 1])
        eye = barrel(0.043, 0.04, 0.016, 0.006, 20)
        place = HEAD + look * (radius * 0.97 + 0.013)
        frame = [unit(np.cross(look, Y)), look, np.cross(unit(np.cross(look, Y)), look)]
        kit.add(eye.turned(frame).moved(place), "head", "glow")
    ear = barrel(0.05, 0.042, 0.03, 0.01, 20)
    kit.add(ear.along([0.2, 1.405, 0.01], [0.24, 1.405, 0.01]), "head", "accent", both=True)
    kit.add(barrel(0.028, 0.02, 0.03).moved([0, 1.608, 0.01]), "antenna", "accent")
    kit.add(barrel(0.007, 0.007, 0.075, 0.003, 10).moved([0, 1.668, 0.01]), "antenna", "steel")
    kit.add(globe(0.026, sides=16).moved([0, 1.737, 0.01]), "antenna", "glow")
    # The ring floats: nothing is nearer to it than a hand's breadth.
    ring = turned([[0.315, -0.006], [0.39, -0.006], [0.39, 0.006], [0.315, 0.006]], 0.004, 56)
    tilt = np.array([unit([1, 0.26, 0]), unit([-0.26, 1, 0.2]), [0, 0, 0]])
    tilt[2] = unit(np.cross(tilt[0], tilt[1]))
    tilt[1] = np.cross(tilt[2], tilt[0])
    kit.add(ring.turned(tilt).moved(shifted(HEAD, 0, 0.012, 0)), "head", "ring")


def _torso(kit: Kit) -> None:
    kit.add(barrel(0.07, 0.055, 0.035).moved([0, 1.19, 0]), "neck", "dark")
    kit.add(box([0.195, 0.145, 0.125], 0.05).moved([0, 1.015, 0]), "chest", "shell")
    kit.add(box([0.115, 0.075, 0.012], 0.011, 0.05).moved([0, 1.03, 0.143]), "chest", "dark")
    for k, material in enumerate(("glow", "accent", "ring")):
        lamp = barrel(0.019, 0.016, 0.012, 0.004, 14).turned([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
        kit.add(lamp.moved([-0.06 + 0.06 * k, 1.055, 0.166]), "chest", material)
    kit.add(box([0.08, 0.012, 0.006], 0.005, 0.04).moved([0, 1.0, 0.165]), "chest", "steel")
    kit.add(box([0.13, 0.105, 0.045], 0.025).moved([0, 1.03, -0.178]), "chest", "accent")
    for side in (1, -1):
        kit.add(barrel(0.03, 0.036, 0.07).moved([0.065 * side, 0.875, -0.185]), "chest", "steel")
    kit.add(barrel(0.105, 0.12, 0.034).moved([0, 0.842, 0]), "chest", "dark")
    kit.add(barrel(0.105, 0.105, 0.034).moved([0, 0.80, 0]), "spine", "steel")
    kit.add(barrel(0.12, 0.105, 0.034).moved([0, 0.758, 0]), "spine", "dark")
    kit.add(box([0.155, 0.052, 0.105], 0.035).moved([0, 0.68, 0]), "hips", "shell")
    kit.add(box([0.055, 0.035, 0.012], 0.01).moved([0, 0.685, 0.122]), "hips", "accent")


def _arm(kit: Kit, bones: Bones) -> None:
    shoulder, elbow, hand = (bones[f"{n}.L"] for n in ("upper_arm", "forearm", "hand"))
    collar = barrel(0.045, 0.04, 0.022, 0.006)
    kit.add(collar.along([0.21, 1.09, 0], [0.234, 1.09, 0]), "shoulder.L", "dark", both=True)
    kit.add(globe(0.058).moved(shifted(shoulder, 0.008, 0, 0)), "upper_arm.L", "steel", both=True)
    kit.add(_cap().along(elbow, shoulder, 1.04), "upper_arm.L", "accent", both=True)
    kit.add(
        barrel(0.043, 0.053, 0.1).along(elbow, shoulder, 0.46), "upper_arm.L", "shell", both=True
    )
    kit.add(globe(0.04).moved(elbow), "forearm.L", "steel", both=True)
    kit.add(barrel(0.068, 0.047, 0.165).along(hand, elbow, 0.45), "forearm.L", "shell", both=True)
    band = turned([[0.071, -0.015], [0.083, -0.015], [0.081, 0.015], [0.069, 0.015]], 0.005, 28)
    kit.add(band.along(hand, elbow, 0.25), "forearm.L", "accent", both=True)
    kit.add(
        box([0.042, 0.034, 0.062], 0.022, 0.05).moved(shifted(hand, 0.004, -0.033, 0)),
        "hand.L",
        "dark",
        both=True,
    )
    for name, place in _CLAWS.items():
        knuckle, tip = bones[f"{name}1.L"], bones[f"{name}2.L"]
        first = box([0.017, 0.026, 0.0175], 0.008, 0.04)
        kit.add(first.moved((knuckle + tip) / 2), f"{name}1.L", "shell", both=True)
        lean = np.array([0.341 - place[0], 0, 0.02 - place[2]])
        end = tip + lean * 0.4 - Y * 0.055
        claw = barrel(0.006, 0.0175, 0.05, 0.004, 12)
        kit.add(claw.along(end, tip, 0.45), f"{name}2.L", "steel", both=True)


def _cap() -> Plate:
    """Return a bowl, open below: a shoulder's armour."""
    angle = np.radians(np.linspace(8, 90, 8))
    outer = 0.092 * np.column_stack([np.cos(angle), np.sin(angle)])
    inner = 0.074 * np.column_stack([np.cos(angle), np.sin(angle)])
    profile = np.round(np.concatenate([inner[::-1], outer]), 9)
    profile[[0, -1], 0] = 0
    return turned(profile, 0.0, 28)


def _leg(kit: Kit, bones: Bones) -> None:
    hip, knee, ankle, toe = (bones[f"{n}.L"] for n in ("thigh", "shin", "foot", "toe"))
    kit.add(globe(0.05).moved(shifted(hip, 0, -0.038, 0)), "thigh.L", "steel", both=True)
    kit.add(barrel(0.055, 0.072, 0.105).along(knee, hip, 0.435), "thigh.L", "shell", both=True)
    kit.add(globe(0.046).moved(knee), "shin.L", "steel", both=True)
    guard = box([0.038, 0.042, 0.011], 0.01, 0.04)
    kit.add(guard.moved(shifted(knee, 0, 0.002, 0.064)), "shin.L", "accent", both=True)
    kit.add(barrel(0.088, 0.056, 0.15).along(ankle, knee, 0.5), "shin.L", "shell", both=True)
    kit.add(
        barrel(0.04, 0.04, 0.03).moved(shifted(ankle, 0, 0.018, 0)), "foot.L", "dark", both=True
    )
    kit.add(
        box([0.068, 0.042, 0.088], 0.026).moved([0.128, 0.046, -0.018]),
        "foot.L",
        "accent",
        both=True,
    )
    kit.add(
        box([0.072, 0.034, 0.046], 0.026).moved(shifted(toe, 0, -0.007, 0.04)),
        "toe.L",
        "shell",
        both=True,
    )


def _march() -> Motion:
    """Return a stiff, cheerful march of two steps."""
    motion = loop("march", 1.4, 28)
    t = phase(motion)
    move(motion, "hips", 0.015 * wave(t, 0.02), 0.012 * wave(t, 0.10, 2) - 0.010, 0)
    rotate(motion, "hips", turn(Z, 3 * wave(t, 0.02)))
    rotate(motion, "spine", turn(Y, -8 * wave(t, 0.25)))
    rotate(motion, "chest", turn(Z, -4 * wave(t, 0.02)), turn(Y, -4 * wave(t, 0.25)))
    rotate(motion, "head", turn(Y, 12 * wave(t, 0.3)), turn(Z, 5 * wave(t, 0.1)))
    rotate(motion, "antenna", turn(X, 10 * wave(t, 0.2, 2)), turn(Z, 12 * wave(t, 0.35)))
    for side, sign, late in (("L", 1, 0.0), ("R", -1, 0.5)):
        rotate(
            motion, f"thigh.{side}", turn(X, curve(t, [-30, -18, 0, 12, 16, -14, -50, -48], late))
        )
        rotate(motion, f"shin.{side}", turn(X, curve(t, [12, 10, 2, 2, 14, 48, 66, 38], late)))
        rotate(motion, f"foot.{side}", turn(X, curve(t, [2, 6, -2, -12, -12, 6, -8, -2], late)))
        rotate(motion, f"toe.{side}", turn(X, curve(t, [0, 0, 0, -4, -22, -4, 0, 0], late)))
        swing = wave(t, 0.25 + late)
        rotate(motion, f"upper_arm.{side}", turn(X, -4 - 26 * swing), turn(Z, sign * 4))
        rotate(motion, f"forearm.{side}", turn(X, -34 - 18 * swing))
        for name in _CLAWS:
            axis = {"front": X, "back": -X, "inner": Z}[name] * (sign if name == "inner" else 1)
            rotate(motion, f"{name}1.{side}", turn(axis, -10 - 10 * wave(t, late, 2)))
            rotate(motion, f"{name}2.{side}", turn(axis, 8))
    return motion
