"""How soon the page shows things, beside Panel's own VTK pane on the same scene.

python -m benchmarks.page [--rounds 5] [--markdown docs/page-speed.md]

Both stand on bare pages of one server, in one headless Chromium that draws in software. A
watch in the browser samples the canvas at every frame: what is timed ends when pixels differ.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import panel as pn
import pyvista as pv
import trimesh
from playwright.sync_api import Browser, Page, sync_playwright

import cutcell
from app.scenes.pose import clip_part
from app.state import State
from app.view import SceneView, camera_part
from cutcell import Rig, TriangleMesh
from cutcell.rig import Clip
from scripts.get_chromium import FLAGS, find
from viewers.character import body, bones, pose_in_scene
from viewers.description import Actor, Description
from viewers.graph_scene import graph_scene
from viewers.pose_scene import swing
from viewers.scene import framing
from viewers.skin import moved

from .shapes import chain
from .tables import Table, ratio, seconds
from .timing import Times

SIZE = (800, 600)
BONES = 50
PATIENCE = 90.0
OURS, THEIRS = "cutcell", "pn.pane.VTK"
WATCH = (Path(__file__).parent / "page_watch.js").read_text(encoding="utf-8")


@dataclass
class Subject:
    """One view of the scene, and how to change it; the server fills it at each visit."""

    path: str
    make: Callable[[Subject], Any]
    document: Any = None
    color: Callable[[int], None] = lambda turn: None
    move: Callable[[int], None] = lambda turn: None
    show_graph: Callable[[bool], None] = lambda shown: None
    play: Callable[[bool], None] = lambda playing: None

    def page(self) -> Any:
        """Return the page, on which nothing but the view is."""
        self.document = pn.state.curdoc
        return self.make(self)


@dataclass(frozen=True)
class Material:
    """What is shown: 20k vertices, 50 bones, a graph."""

    rig: Rig
    scene: Description
    clip: Clip
    poses: list[np.ndarray]
    fields: list[np.ndarray]

    @property
    def size(self) -> str:
        """The scene in a line."""
        lines = sum(len(a.cells) for a in self.scene.actors.values() if a.kind == "lines")
        mesh = self.rig.mesh
        return (
            f"{len(mesh.vertices):,} vertices, {len(mesh.faces):,} faces, {BONES} bones, "
            f"{lines:,} edges of the graph"
        )


def material(resolution: int, vertices: int) -> Material:
    """Make the scene: a bumpy capsule with a chain of bones along it."""
    around = round(np.sqrt(vertices))
    mesh = trimesh.creation.uv_sphere(count=[around // 2, around])
    x, y, z = np.array(mesh.vertices).T
    bumps = 1 + 0.1 * np.sin(6 * z) * np.cos(5 * np.arctan2(y, x))
    surface = TriangleMesh(np.stack([x * bumps, 2 * z, -y * bumps], axis=1), mesh.faces)
    rig = Rig(surface, chain(surface, BONES))
    bound = cutcell.bind(rig, resolution)
    clip = swing(rig, BONES // 4, "x", 50.0)
    poses = [pose_in_scene(rig, clip.transforms[k]) for k in np.linspace(1, 20, 6).astype(int)]
    joints = np.linspace(1, BONES - 2, 6).astype(int)
    fields = [_up_to_one(bound.distances.on_mesh(joint)) for joint in joints]
    actors = {
        "body": body(rig, bound.weights, scalars=fields[0], colormap="distance"),
        **graph_scene(rig, bound.graph).actors,
        "bones": bones(rig),
    }
    return Material(rig, Description(actors), clip, poses, fields)


def _up_to_one(values: np.ndarray) -> np.ndarray:
    return (values / np.nanmax(values)).astype(np.float32)


# The two subjects


def ours(material: Material) -> Subject:
    """Return the page's own view as a subject."""

    def make(subject: Subject) -> SceneView:
        view = SceneView(width=SIZE[0], height=SIZE[1])
        shown = _with_graph(material.scene, False)

        def present(**parts: Any) -> None:
            nonlocal shown
            shown = replace(shown, **parts)
            view.present(shown)

        def color(turn: int) -> None:
            values = material.fields[turn % len(material.fields)]
            recolored = replace(shown.actors["body"], scalars=values)
            present(actors={**shown.actors, "body": recolored})

        def play(playing: bool) -> None:
            state = State(rig=material.rig)
            view.tell(clip=clip_part(state, material.clip) if playing else None, playing=playing)

        subject.color, subject.play = color, play
        subject.move = lambda turn: present(pose=material.poses[turn % len(material.poses)])
        subject.show_graph = lambda on: present(actors=_with_graph(shown, on).actors)
        view.tell(camera=camera_part(framing(material.scene.bounds, SIZE[0] / SIZE[1])))
        view.present(shown)
        return view

    return Subject("/ours", make)


def theirs(material: Material) -> Subject:
    """Return Panel's VTK pane as a subject: the same actors, drawn by PyVista."""

    def make(subject: Subject) -> pn.pane.VTK:
        plotter = pv.Plotter(off_screen=True, window_size=list(SIZE))
        plotter.disable_anti_aliasing()
        added = {name: _added(plotter, a) for name, a in material.scene.actors.items()}
        lines = [added[name] for name in added if name.endswith("edges")]
        for actor in lines:
            actor.SetVisibility(False)
        camera = framing(material.scene.bounds, SIZE[0] / SIZE[1])
        plotter.camera_position = [camera.position, camera.focal_point, camera.up]
        pane = pn.pane.VTK(plotter.render_window, width=SIZE[0], height=SIZE[1])
        shown = material.scene.actors["body"]

        def put(**changed: Any) -> None:
            # Another actor: an array edited in place makes the pane crash (debugAll), and new
            # scalars on the same points never reach its picture.
            nonlocal shown
            shown = replace(shown, **changed)
            plotter.remove_actor(added["body"], render=False)
            added["body"] = _added(plotter, shown)
            pane.param.trigger("object")

        def color(turn: int) -> None:
            put(scalars=material.fields[turn % len(material.fields)])

        def move(turn: int) -> None:
            rest, pose = material.scene.actors["body"], material.poses[turn % len(material.poses)]
            assert rest.skin is not None
            put(points=moved(rest.points, rest.skin, pose).astype(np.float32))

        def show_graph(on: bool) -> None:
            for actor in lines:
                actor.SetVisibility(on)
            pane.param.trigger("object")

        subject.color, subject.move, subject.show_graph = color, move, show_graph
        return pane

    return Subject("/theirs", make)


def _added(plotter: Any, actor: Actor) -> Any:
    data: Any = pv.PolyData()
    data.points = actor.points
    cells = np.insert(actor.cells, 0, actor.cells.shape[1], axis=1).ravel()
    setattr(data, "faces" if actor.kind == "surface" else "lines", cells)
    if actor.scalars is None:
        return plotter.add_mesh(data, color=actor.color, lighting=actor.kind == "surface",
                                render=False, reset_camera=False)  # fmt: skip
    data.point_data["values"] = actor.scalars
    return plotter.add_mesh(
        data, scalars="values", cmap="viridis", clim=[0, 1], show_scalar_bar=False,
        render=False, reset_camera=False,
    )  # fmt: skip


def _with_graph(scene: Description, shown: bool) -> Description:
    def seen(name: str, actor: Actor) -> Actor:
        return replace(actor, visible=shown) if actor.kind == "lines" else actor

    return replace(scene, actors={name: seen(name, a) for name, a in scene.actors.items()})


# Measuring


@contextmanager
def served(subjects: Sequence[Subject], port: int) -> Iterator[str]:
    """Serve the subjects from a thread of this process; give the address."""
    server = pn.serve(
        {subject.path: subject.page for subject in subjects},
        port=port, threaded=True, show=False, verbose=False,
        websocket_origin=f"localhost:{port}", websocket_max_message_size=2**28,
    )  # fmt: skip
    try:
        yield f"http://localhost:{port}"
    finally:
        server.stop()


class Visitor:
    """A browser's page with one subject, and the watch over its canvas."""

    def __init__(self, browser: Browser, url: str, subject: Subject) -> None:
        self.page: Page = browser.new_page(viewport={"width": 860, "height": 660})
        self.page.add_init_script(WATCH)
        self.subject = subject
        begin = time.time()
        self.page.goto(url + subject.path)
        self.first_picture = self._wait("watch.painted") - begin

    def _wait(self, what: str) -> float:
        """Return when something came to be, in seconds of the machine's clock."""
        handle = self.page.wait_for_function(what, timeout=1000 * PATIENCE, polling=20)
        return float(handle.json_value()) / 1000

    def seen_after(self, change: Callable[[], None]) -> float:
        """Return the seconds from a change in Python to changed pixels."""
        self.page.evaluate("watch.settle()")
        self.page.evaluate("watch.expect()")
        begun: list[float] = []

        def act() -> None:
            begun.append(time.time())
            change()

        self.subject.document.add_next_tick_callback(act)
        seen = self._wait("watch.changed")
        return seen - begun[0]

    def orbit(self, steps: int = 40) -> list[float]:
        """Drag over the canvas; return the seconds between frames."""
        self.page.evaluate("watch.stop()")
        x, y = SIZE[0] / 2, SIZE[1] / 2
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + 8, y)
        self.page.evaluate("watch.count()")
        for step in range(steps):
            self.page.mouse.move(x + 8 + 5 * step, y + 2 * step)
        frames = self.page.evaluate("watch.counted()")
        self.page.mouse.up()
        self.page.wait_for_timeout(500)
        return [frame / 1000 for frame in frames]

    def play(self, for_seconds: float) -> tuple[float, float]:
        """Play a motion; return the script seconds a frame, and the seconds a frame."""
        self.page.evaluate("watch.stop()")
        self.subject.document.add_next_tick_callback(lambda: self.subject.play(True))
        self.page.wait_for_function("__cutcell.report().playing")
        self.page.wait_for_timeout(1500)
        client = self.page.context.new_cdp_session(self.page)
        client.send("Performance.enable")
        before = self._script(client)
        self.page.wait_for_timeout(1000 * for_seconds)
        after = self._script(client)
        self.subject.document.add_next_tick_callback(lambda: self.subject.play(False))
        self.page.wait_for_function("!__cutcell.report().playing")
        frames = after["frames"] - before["frames"]
        script = (after["ScriptDuration"] - before["ScriptDuration"]) / frames
        return script, (after["Timestamp"] - before["Timestamp"]) / frames

    def _script(self, client: Any) -> dict[str, float]:
        told = client.send("Performance.getMetrics")["metrics"]
        frames = self.page.evaluate("__cutcell.report().frames")
        return {**{one["name"]: one["value"] for one in told}, "frames": frames}


def tables(options: argparse.Namespace) -> list[Table]:
    """Measure; return what is printed."""
    scene = material(options.resolution, options.vertices)
    subjects = {OURS: ours(scene), THEIRS: theirs(scene)}
    taken: dict[str, dict[str, list[float]]] = {}
    moves: dict[str, list[float]] = {}
    chromium = find()
    with (
        served(list(subjects.values()), options.port) as url,
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=chromium, args=list(FLAGS))
        for turn in range(options.rounds):
            for name, subject in subjects.items():
                _visit(Visitor(browser, url, subject), name, turn, options, taken, moves)
        browser.close()
    return [_sooner(scene, taken), _moving(moves)]


def _visit(
    visitor: Visitor,
    name: str,
    turn: int,
    options: argparse.Namespace,
    taken: dict[str, dict[str, list[float]]],
    moves: dict[str, list[float]],
) -> None:
    def note(what: str, value: float) -> None:
        taken.setdefault(what, {}).setdefault(name, []).append(value)

    subject = visitor.subject
    note("first picture", visitor.first_picture)
    for graph in (False, True):
        beside = ", graph shown" if graph else ""
        if graph:
            note("graph shown", visitor.seen_after(lambda: subject.show_graph(True)))
        for k in range(options.changes):
            note(f"new scalars{beside}", visitor.seen_after(lambda k=k: subject.color(k + 1)))
        for k in range(options.changes):
            note(f"new points{beside}", visitor.seen_after(lambda k=k: subject.move(k + 1)))
    moves.setdefault(f"{name}: a frame while turning, graph shown", []).extend(visitor.orbit())
    if name == OURS:
        for graph in (True, False):
            beside = ", graph shown" if graph else ""
            if not graph:
                visitor.seen_after(lambda: subject.show_graph(False))
            script, frame = visitor.play(options.play)
            moves.setdefault(f"{name}: script a frame while playing{beside}", []).append(script)
            moves.setdefault(f"{name}: a frame while playing{beside}", []).append(frame)
    visitor.page.close()


def _sooner(scene: Material, taken: dict[str, dict[str, list[float]]]) -> Table:
    table = Table(
        "Until it is seen",
        ["", OURS, THEIRS, "sooner by"],
        f"{scene.size}; {SIZE[0]}x{SIZE[1]} pixels. From the change in Python, or from asking "
        "for the address, to changed pixels: medians, the range in brackets, in turn.",
    )
    for what, by in taken.items():
        one, other = Times(tuple(by[OURS])), Times(tuple(by[THEIRS]))
        table.add(what, one, other, ratio(other.median / one.median))
    return table


def _moving(moves: dict[str, list[float]]) -> Table:
    table = Table(
        "While things move",
        ["", "median", "nine in ten below"],
        "Drawn in software: a graphics card takes the frame's larger part away.",
    )
    for what, values in sorted(moves.items()):
        table.add(what, seconds(float(np.median(values))), seconds(float(np.quantile(values, 0.9))))
    return table


def arguments(given: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.page", description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--changes", type=int, default=5)
    parser.add_argument("--play", type=float, default=6.0, help="seconds of motion")
    parser.add_argument("--resolution", type=int, default=72)
    parser.add_argument("--vertices", type=int, default=20000)
    parser.add_argument("--port", type=int, default=5131)
    parser.add_argument("--markdown", type=Path)
    return parser.parse_args(given)


def main(given: Sequence[str] | None = None) -> None:
    """Print the tables."""
    options = arguments(given)
    text = "\n\n".join(table.markdown() for table in tables(options)) + "\n"
    print(text, end="")
    if options.markdown:
        options.markdown.write_text(text)


if __name__ == "__main__":
    main()
