"""An interactive page in one file: the messages of the page's server, recorded for each joint.

The page's own scripts draw them, in a browser without a server (frontend/one_file/standalone.js).
"""

import base64
import gzip
import html
import json
import posixpath
import re
from dataclasses import replace
from functools import partial
from string import Template
from typing import Any

import numpy as np
from numpy.typing import NDArray
from panel.io.resources import DIST_DIR

from cutcell import Binding, bind
from cutcell.checks import check_choice
from cutcell.geodesics import FALLBACK_REASONS
from cutcell.rig import Rig
from cutcell.runtime.display import shown_name
from cutcell.runtime.progress import Progress, silent
from cutcell_viewers.camera import framing
from cutcell_viewers.character import bones
from cutcell_viewers.description import Description, Legend
from cutcell_viewers.distance_scene import unit_of
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.lighting import LIGHTS
from cutcell_viewers.marks import vertex_mark
from cutcell_viewers.palette import COLORMAPS, THEMES, to_hex
from cutcell_viewers.skin import Skin
from cutcell_viewers.weights_scene import MIXED

from ..document.framing import bones_part, bounds_of, camera_part, first_joint, theme_part
from ..document.state import State
from ..editing.binding.bound import build_shown
from ..editing.correct.joints import in_order
from ..features.inspector.facts import MAX_DISTANCES, MAX_WEIGHTS
from ..features.scenes import following, resolve
from ..features.state import PageState
from ..files.table_export import settings_of
from ..looks.components import components
from ..looks.pose import clip_part, gizmo_part
from ..widgets.changes import changes
from ..widgets.modules import FOLDER, names, style
from ..widgets.view import SceneView
from .packed import Packed

VIEWS = ("weights", "distance", "graph")
"""Panels that the page can show, by name."""
MAX_CLIP_NUMBERS = 2**21
"""Largest size of all clips, so that long motions do not outweigh the character."""
IMPORT = re.compile(r'from "(\.\.?/[\w/]+\.js)"')
BY_NAME = re.compile(r'from "cutcell/([\w/]+\.js)"')
STYLES = "common/styles.js"


def interactive_page(
    rig: Rig,
    binding: Binding | None = None,
    *,
    joint: int | None = None,
    view: str = "weights",
    colormap: str = "default",
    title: str = "",
    caption: str = "",
    progress: Progress = silent,
) -> str:
    """Return a page that shows a character without a server, as the text of an HTML file.

    Parameters
    ----------
    rig : Rig
    binding : Binding, optional
        Of the rig; computed when left out.
    joint : int, optional
        The joint that is chosen at first; the number of joints means all of them.
    view : {"weights", "distance", "graph"}
        The view that is shown at first.
    colormap : str
        Of weights, distances and depths: one of `palette.COLORMAPS`.
    title : str
        Of the page; the rig's name when left out.
    caption : str
        Text above the character.
    progress : callable
        See `cutcell.runtime.progress`.

    Raises
    ------
    ParameterError
        No such view or colour map.
    SkeletonError
        A mesh without a skeleton.
    """
    check_choice("view", view, VIEWS)
    check_choice("colormap", colormap, COLORMAPS)
    rig.require_joints()
    binding = bind(rig, progress=progress) if binding is None else binding
    packed = Packed()
    scenes = packed.plain(_record(rig, binding, colormap, progress))
    scenes |= {"view": view, "joint": first_joint(rig) if joint is None else joint}
    scenes["settings"] = settings_of(binding)
    content = f"<aside>{html.escape(caption)}</aside>\n<p>Loading the character …</p>"
    title = title or shown_name(rig.name) or "character"
    return page_in_one_file("one_file/standalone", title, content, packed, scenes)


def page_in_one_file(
    script: str, title: str, content: str, packed: Packed, scenes: dict[str, Any]
) -> str:
    """Return a page without a server: its content, scripts, vtk.js and recorded scenes."""
    template = Template((FOLDER / "one_file/page.html").read_text(encoding="utf-8"))
    return template.substitute(
        script=script,
        title=html.escape(title),
        style=style(script),
        content=content,
        modules=json.dumps({"imports": _modules(script)}),
        vtk=_compressed(_vtk()),
        arrays=_compressed(packed.content),
        scenes=_compressed(json.dumps(scenes).encode()),
    )


def _record(rig: Rig, binding: Binding, colormap: str, progress: Progress) -> dict[str, Any]:
    """Return all messages of the page: of each joint, view and clip."""
    complete = binding.distances.of_all_joints(progress)
    state = PageState(rig=rig, binding=replace(binding, distances=complete))
    state.colormap = colormap
    limit = MAX_CLIP_NUMBERS // max(len(rig.clips), 1)
    clips = [(shown_name(clip.name), clip_part(state, clip, limit)) for clip in rig.clips]
    return {
        "first": {
            "lights": LIGHTS,
            "bones": bones_part(state),
            "camera": camera_part(framing(bounds_of(state), 1.2)),
        },
        "themes": [theme_part(THEMES[name]) for name in ("light", "dark")],
        "graph": _graph(state, progress),
        "box": bounds_of(state).tolist(),
        **_joints(state, progress),
        "clips": [{"name": name, "clip": part} for name, part in clips if part],
        "mark": _message(Description({"vertex": vertex_mark(rig, 0, binding.weights)})),
        **_facts(rig, binding, complete.joint),
    }


def _graph(state: State, progress: Progress) -> list[dict[str, Any]]:
    """Return the scene of the graph in a light and a dark theme."""
    state.param.update(panel="graph", skeleton=False)
    state.resolution = state.graph.lattice.resolution
    state.connectivity = state.graph.connectivity
    state.winding_threshold = state.graph.winding_threshold
    state.graph_resolution = min(state.graph_resolution, state.resolution)
    if state.graph_inputs is not None:
        state.easy_graph = build_shown(state.graph_inputs, progress)
    scenes, skin = [], Skin.of_weights(state.weights)
    for dark in (False, True):
        state.dark = dark
        scene = resolve(state)
        # Cards are of vertices alone: a click goes through nodes to the body.
        actors = {name: replace(actor, reading=None) for name, actor in scene.actors.items()}
        actors["body"] = replace(actors["body"], skin=skin)
        scenes.append(_message(replace(scene, actors=actors)))
    state.param.update(skeleton=True, dark=False)
    return scenes


def _joints(state: State, progress: Progress) -> dict[str, list[Any]]:
    """Return each joint's weights, distances and rings; the last weights are of all joints."""
    count = len(state.rig.skeleton.joints)
    weights, distances, rings = [], [], []
    for joint in range(count):
        progress("writing the page", joint / count)
        state.param.update(panel="pose", weights_shown="bone", joint=joint)
        weights.append(_message(resolve(state)))
        rings.append(gizmo_part(state))
        state.panel = "distance"
        distances.append(_message(following(state)))
    return {"weights": [*weights, _mixed(state)], "distance": distances, "rings": rings}


def _mixed(state: State) -> dict[str, Any]:
    """Return the weights of all joints, while no joint is chosen."""
    state.param.update(panel="pose", weights_shown="mix")
    scene, rig = resolve(state), state.rig
    actors = {**scene.actors, **bones(rig, colors=colors_of(rig))}
    return _message(replace(scene, actors=actors, legend=Legend(MIXED)))


def _message(scene: Description) -> dict[str, Any]:
    """Return the message that shows a scene in an empty view."""
    return changes(Description(), scene, set())


def _facts(rig: Rig, binding: Binding, distances: NDArray[np.float64]) -> dict[str, Any]:
    """Return the content of the cards of all vertices; see `vertex_facts`."""
    component, sizes = components(binding.graph)
    skeleton, colors = rig.skeleton, colors_of(rig)
    near = np.argsort(distances, axis=0, kind="stable")[:MAX_DISTANCES].T
    near_distances = binding.graph.lattice.size * np.take_along_axis(distances, near.T, axis=0).T
    heavy = np.argsort(-binding.weights, axis=1, kind="stable")[:, :MAX_WEIGHTS]
    return {
        "joints": [
            {"joint": joint, "name": shown_name(name), "color": to_hex(tuple(colors[joint]))}
            for joint, name in enumerate(skeleton.names)
        ],
        "order": [(joint, int(skeleton.depth[joint])) for joint in in_order(skeleton)],
        "vertices": {
            "heavy": heavy.astype(np.uint16),
            "weights": np.take_along_axis(binding.weights, heavy, axis=1),
            "near": near.astype(np.uint16),
            "distances": np.where(np.isfinite(near_distances), near_distances, 0),
            "finite": np.isfinite(near_distances).sum(axis=1).astype(np.uint8),
            "component": component,
            "fallback": binding.distances.fallback,
        },
        "sizes": sizes.tolist(),
        "reasons": FALLBACK_REASONS,
        "unit": unit_of(rig),
    }


def _modules(script: str) -> dict[str, str]:
    """Return a script and all that it imports by name, as data URLs."""
    sources = {STYLES: _styles()}
    waiting = [f"{script}.js"]
    while waiting:
        name = waiting.pop()
        if name not in sources:
            source = (FOLDER / name).read_text(encoding="utf-8")
            sources[name] = IMPORT.sub(partial(_by_name, name), source)
            waiting += BY_NAME.findall(sources[name])
    return {f"cutcell/{name}": _data(name, source) for name, source in sources.items()}


def _by_name(importer: str, match: re.Match[str]) -> str:
    """Return an import by the name that a page in one file gives the module: it has no folders."""
    return f'from "cutcell/{posixpath.normpath(posixpath.join(importer, "..", match[1]))}"'


def _styles() -> str:
    """Return the module `styles` with the rules in it instead of their addresses."""
    rules = {name: (FOLDER / name).read_text(encoding="utf-8") for name in names(".css")}
    return f"""const rules = {json.dumps(rules)}
export const stylesheet = (name) =>
  () => Object.assign(document.createElement("style"), {{textContent: rules[name]}})"""


def _data(name: str, script: str) -> str:
    script += f"\n//# sourceURL=cutcell/{name}"  # errors name the script, not all of its text
    return f"data:text/javascript;base64,{base64.b64encode(script.encode()).decode()}"


def _vtk() -> bytes:
    """Return vtk.js as Panel's server sends it, without the address of its source map."""
    path = DIST_DIR / SceneView.vtk_url.partition("panel/")[2]
    return path.read_bytes().partition(b"//# sourceMappingURL")[0]


def _compressed(content: bytes | bytearray) -> str:
    return base64.b64encode(gzip.compress(content, mtime=0)).decode()
