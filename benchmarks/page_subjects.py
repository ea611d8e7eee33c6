"""One scene on two bare pages: in the page's own view, and in Panel's VTK pane."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import panel as pn
import pyvista as pv
import trimesh

import cutcell
from cutcell import Rig, TriangleMesh
from cutcell.rig import Clip
from cutcell_app.document.framing import camera_part
from cutcell_app.features.state import PageState
from cutcell_app.looks.pose import clip_part
from cutcell_app.widgets.view import SceneView
from cutcell_lab.benchmarks.shapes import chain
from cutcell_viewers.camera import framing
from cutcell_viewers.character import body, bones, pose_in_scene
from cutcell_viewers.description import Actor, Description
from cutcell_viewers.graph_scene import graph_scene
from cutcell_viewers.pose_scene import swing

SIZE = (800, 600)
BONES = 50
CHANGES = 6
"""Poses and fields, each unlike the one before it."""


@dataclass
class Subject:
    """One view of the scene, and how to change it; the server fills it at each visit."""

    path: str
    make: Callable[[Subject], Any]
    document: Any = None
    color: Callable[[int], None] = lambda turn: None
    move: Callable[[int], None] = lambda turn: None
    pose: Callable[[int], None] = lambda turn: None
    show_graph: Callable[[bool], None] = lambda visible: None
    play: Callable[[bool], None] = lambda playing: None

    def page(self) -> Any:
        """Return the page, on which nothing but the view is."""
        self.document = pn.state.curdoc
        return self.make(self)


@dataclass(frozen=True)
class Material:
    """The scene: 20k vertices, 50 bones, a graph."""

    rig: Rig
    scene: Description
    clip: Clip
    poses: list[np.ndarray]
    points: list[np.ndarray]
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


def character(vertices: int, joints: int = BONES) -> Rig:
    """Make a bumpy capsule with a chain of bones along it."""
    around = round(np.sqrt(vertices))
    mesh = trimesh.creation.uv_sphere(count=[around // 2, around])
    x, y, z = np.array(mesh.vertices).T
    bumps = 1 + 0.1 * np.sin(6 * z) * np.cos(5 * np.arctan2(y, x))
    surface = TriangleMesh(np.stack([x * bumps, 2 * z, -y * bumps], axis=1), mesh.faces)
    return Rig(surface, chain(surface, joints))


def material(resolution: int, vertices: int) -> Material:
    """Make the scene, and what it changes to."""
    rig = character(vertices)
    bound = cutcell.bind(rig, resolution)
    clip = swing(rig, BONES // 4, "x", 50.0)
    quarter = np.linspace(1, len(clip.times) // 4, CHANGES).astype(int)
    poses = [pose_in_scene(rig, clip.transforms[k]) for k in quarter]
    joints = np.linspace(1, BONES - 2, CHANGES).astype(int)
    fields = [_up_to_one(bound.distances.on_mesh(joint)) for joint in joints]
    rest = body(rig, bound.weights, scalars=fields[0], colormap="distance")
    assert rest.skin is not None
    points = [rest.points_in(pose).astype(np.float32) for pose in poses]
    actors = {"body": rest, **graph_scene(rig, bound.graph).actors, **bones(rig)}
    return Material(rig, Description(actors), clip, poses, points, fields)


def _up_to_one(values: np.ndarray) -> np.ndarray:
    return (values / np.nanmax(values)).astype(np.float32)


def cutcell_subject(material: Material) -> Subject:
    """Return the page's own view as a subject."""

    def make(subject: Subject) -> SceneView:
        view = SceneView(width=SIZE[0], height=SIZE[1])
        current = _with_graph(material.scene, False)

        def present(**parts: Any) -> None:
            nonlocal current
            current = replace(current, **parts)
            view.present(current)

        def put(**changed: Any) -> None:
            present(actors={**current.actors, "body": replace(current.actors["body"], **changed)})

        def play(playing: bool) -> None:
            state = PageState(rig=material.rig)
            view.send(clip=clip_part(state, material.clip) if playing else None, playing=playing)

        subject.color = lambda turn: put(scalars=material.fields[turn % CHANGES])
        subject.move = lambda turn: put(points=material.points[turn % CHANGES])
        subject.pose = lambda turn: present(pose=material.poses[turn % CHANGES])
        subject.show_graph = lambda on: present(actors=_with_graph(current, on).actors)
        subject.play = play
        view.send(camera=camera_part(framing(material.scene.bounds, SIZE[0] / SIZE[1])))
        view.present(current)
        return view

    return Subject("/ours", make)


def vtk_subject(material: Material) -> Subject:
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
        body = material.scene.actors["body"]

        def put(**changed: Any) -> None:
            # Another actor: an array edited in place makes the pane crash (debugAll), and new
            # scalars on the same points never reach its picture.
            nonlocal body
            body = replace(body, **changed)
            plotter.remove_actor(added["body"], render=False)
            added["body"] = _added(plotter, body)
            pane.param.trigger("object")

        def show_graph(on: bool) -> None:
            for actor in lines:
                actor.SetVisibility(on)
            pane.param.trigger("object")

        subject.color = lambda turn: put(scalars=material.fields[turn % CHANGES])
        subject.move = lambda turn: put(points=material.points[turn % CHANGES])
        subject.pose = subject.move  # it knows no joints
        subject.show_graph = show_graph
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


def _with_graph(scene: Description, visible: bool) -> Description:
    def with_visibility(name: str, actor: Actor) -> Actor:
        return replace(actor, visible=visible) if actor.kind == "lines" else actor

    return replace(
        scene, actors={name: with_visibility(name, a) for name, a in scene.actors.items()}
    )
