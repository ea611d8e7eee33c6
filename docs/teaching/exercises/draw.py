"""Draw the picture of an exercise, and print its numbers: `python draw.py 1`.

The functions are those of the exercise's stub.py, or of a file that follows the number. The picture
is written to picture.png beside that file; compare it with reference.png.
"""

import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap

matplotlib.use("Agg")
from matplotlib import pyplot as plt

FOLDER = Path(__file__).resolve().parent
WALKER = np.load(FOLDER / "walker.npz")
NAMES = WALKER["names"].tolist()
HAND = NAMES.index("hand.L")
LEFT_ARM = [NAMES.index(f"{name}.L") for name in ("upper_arm", "forearm", "hand")]
LEGS = [NAMES.index(f"{name}.{side}") for name in ("thigh", "shin") for side in "LR"]
POWER = 2

GREY = "#c9ced6"
WEIGHT = LinearSegmentedColormap.from_list(
    "weight", [GREY, "#ecc58e", "#f7a048", "#f06920", "#c02e1e", "#800e26"]
)
DISTANCE = LinearSegmentedColormap.from_list(
    "distance", ["#fff5d6", "#facd80", "#8fc68c", "#2d9e9e", "#2668a0", "#343680", "#261648"]
)


def body(axes, vertices, colors=None, title=""):
    """Draw the character from the front; `colors` are those of its vertices, (n, 3 or more)."""
    faces = WALKER["faces"]
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    order = np.argsort(corners[:, :, 2].mean(axis=1), kind="stable")
    order = order[facing[order] > 0]
    if colors is None:
        colors = np.tile(matplotlib.colors.to_rgb(GREY), (len(vertices), 1))
    shade = 0.55 + 0.45 * facing[order]
    paint = colors[faces[order]].mean(axis=1)[:, :3] * shade[:, None]
    axes.add_collection(PolyCollection(corners[order][:, :, :2], facecolors=paint,
                                       edgecolors=paint, linewidths=0.3))  # fmt: skip
    frame(axes, title)


def frame(axes, title=""):
    """Fit the axes to what they contain, without ticks."""
    axes.set_title(title, fontsize=10)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.axis("off")


def on_legs():
    """Return which vertices the artist gives to the legs, (n,)."""
    return WALKER["artist"][:, LEGS].sum(axis=1) > 0.5


def blend_skinning(stub, axes):
    """Lift the arm, and bend its elbow."""
    vertices, weights = WALKER["vertices"], WALKER["artist"]
    shoulder, elbow = WALKER["joints"][LEFT_ARM[:2]]
    for place, (lift, bend) in zip(axes, [(0, 0), (60, 0), (60, 150)], strict=True):
        matrices = np.array([np.eye(4)] * len(NAMES))
        matrices[LEFT_ARM] = stub.rotation_about(shoulder, lift)
        matrices[LEFT_ARM[1:]] = matrices[LEFT_ARM[0]] @ stub.rotation_about(elbow, bend)
        posed = stub.skin(vertices, weights, matrices)
        body(place, posed, WEIGHT(weights[:, LEFT_ARM].sum(axis=1)), f"lift {lift}°, bend {bend}°")
        both = np.abs(weights[:, LEFT_ARM[0]] - weights[:, LEFT_ARM[1]]) < 0.2
        both &= weights[:, LEFT_ARM[:2]].sum(axis=1) > 0.9
        middle = (matrices[LEFT_ARM[0]] @ [*elbow, 1])[:3]
        radius = np.linalg.norm(posed[both] - middle, axis=1).mean()
        print(f"lift {lift}°, bend {bend}°: the elbow's radius is {1000 * radius:.0f} mm")


def straight_distances(stub, axes):
    """Show the hand's weights from straight distances."""
    distances = stub.straight_distances(
        WALKER["vertices"], WALKER["starts"], WALKER["ends"], WALKER["bone_joint"], len(NAMES)
    )
    weights = stub.falloff(distances, POWER)
    body(axes[0], WALKER["vertices"], DISTANCE(distances[:, HAND]), "straight distance to the hand")
    body(axes[1], WALKER["vertices"], WEIGHT(weights[:, HAND]), "weight of the hand")
    body(axes[2], WALKER["vertices"], WEIGHT(WALKER["artist"][:, HAND]), "the artist's weight")
    follows = (weights[:, HAND] > 0.05) & on_legs()
    print(
        f"{follows.sum()} of {on_legs().sum()} vertices of the legs follow the hand by 5 % or more"
    )


def winding_number(stub, axes):
    """Show the winding number in a section, in the same with an arm reversed, and torn."""
    section, arm, gap = WALKER["section"], WALKER["section_arm"], WALKER["section_gap"]
    reversed_arm = np.where(arm[:, None, None], section[:, ::-1], section)
    cases = {"closed": section, "one arm reversed": reversed_arm, "torn": section[~gap]}
    low, high = section.min(axis=(0, 1)) - 0.05, section.max(axis=(0, 1)) + 0.05
    x, y = (np.arange(a, b, 0.004) for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    for place, (title, segments) in zip(axes, cases.items(), strict=True):
        values = stub.winding_number(segments, points)
        image = values.reshape(len(y), len(x))
        place.imshow(image, origin="lower", cmap="PuOr_r", vmin=-1, vmax=1,
                     extent=(x[0], x[-1], y[0], y[-1]))  # fmt: skip
        place.contour(x, y, image, levels=[0.5], colors="black", linewidths=0.8)
        place.add_collection(LineCollection(segments, colors="black", linewidths=0.3))
        frame(place, title)
        area = (values > 0.5).mean() * np.prod(high - low)
        print(f"{title}: from {values.min():.2f} to {values.max():.2f}, "
              f"{1e4 * area:.0f} cm² are above one half")  # fmt: skip
    middle = section.mean(axis=(0, 1))
    print(f"crossings from the middle: {stub.signed_crossings(section, middle)}")


def dijkstra(stub, axes):
    """Show distances through the body, and the hand's weights from both distances."""
    start = WALKER["source_start"]
    through = np.empty((len(WALKER["vertices"]), len(NAMES)))
    for joint in range(len(NAMES)):
        which = slice(start[joint], start[joint + 1])
        nodes = WALKER["source_node"][which].tolist()
        sources = dict(zip(nodes, WALKER["source_distance"][which].tolist(), strict=True))
        distance, _ = stub.dijkstra(
            WALKER["edges"], WALKER["lengths"], sources, int(WALKER["node_count"])
        )
        through[:, joint] = distance[WALKER["vertex_node"]]
    body(axes[0], WALKER["vertices"], DISTANCE(through[:, HAND] / 1.6), "distance through the body")
    weights = {"straight": WALKER["straight"], "through the body": through}
    for place, (title, distances) in zip(axes[1:], weights.items(), strict=True):
        weight = 1 / np.maximum(distances, 0.001) ** POWER
        weight /= weight.sum(axis=1, keepdims=True)
        body(place, WALKER["vertices"], WEIGHT(weight[:, HAND]), f"weight of the hand, {title}")
        print(f"{title}: the arm has {stub.leak(weight, LEFT_ARM, on_legs()):.3f} "
              "of the weight on the legs")  # fmt: skip


def judging(stub, axes):
    """Show the largest errors of three candidates, and print both measures."""
    vertices, artist, motion = WALKER["vertices"], WALKER["artist"], WALKER["motion"]
    for place, name in zip(axes, "ABC", strict=True):
        weights = WALKER[f"candidate_{name}"]
        errors = stub.motion_errors(vertices, weights, artist, motion)
        posed = stub.skin(vertices, weights, motion[-1])
        difference = stub.l1(weights, artist)
        error = 1000 * stub.root_mean_square(errors)
        body(place, posed, WEIGHT(np.minimum(errors[-1] / 0.1, 1)),
             f"{name}: L1 {difference:.2f}, motion {error:.0f} mm")  # fmt: skip
        print(f"{name}: L1 {difference:.2f}, motion error {error:.1f} mm, "
              f"median {1000 * np.median(errors[-1]):.1f} mm, "
              f"largest {1000 * errors.max():.0f} mm")  # fmt: skip


EXERCISES = {
    "1": blend_skinning,
    "2": straight_distances,
    "3": winding_number,
    "4": dijkstra,
    "5": judging,
}


def draw(number, script, picture):
    """Draw the picture of an exercise with the functions of a script."""
    functions = SimpleNamespace(**runpy.run_path(str(script)))
    figure, axes = plt.subplots(1, 3, figsize=(9, 5), dpi=100, layout="constrained")
    EXERCISES[number](functions, axes)
    figure.savefig(picture)
    plt.close(figure)


def main(arguments):
    """Read the number of the exercise, and perhaps a file."""
    if not arguments or arguments[0] not in EXERCISES:
        sys.exit(f"Name an exercise, {', '.join(EXERCISES)}, and perhaps a file: python draw.py 1")
    (folder,) = FOLDER.glob(f"{arguments[0]}_*")
    script = Path(arguments[1]) if len(arguments) > 1 else folder / "stub.py"
    picture = script.with_name("picture.png")
    try:
        draw(arguments[0], script, picture)
    except NotImplementedError:
        sys.exit(f"A function in {script.name} is still empty.")
    print(f"The picture is {picture}")


if __name__ == "__main__":
    main(sys.argv[1:])
