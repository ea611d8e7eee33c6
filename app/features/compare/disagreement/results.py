"""Regions where two methods differ: computed, looked at, settled."""

from typing import Any

import numpy as np
from scipy.sparse import csr_array

from cutcell.diagnosis import Finding
from cutcell.diagnosis.finding import Pose
from cutcell.geodesics import BoneDistances
from cutcell.pose import axis_rotation
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell.weights import keep_strongest
from cutcell_lab.disagreement import Disagreement, Region, disagreement
from cutcell_viewers.finding_scene import camera_on

from ....derive.derived import Derived
from ....document.framing import bounds_of
from ....document.look import set_camera
from ....document.session import Session
from ....document.side_by_side import NOW
from ....document.state import State
from ....editing.layers.commands import put_rows, recompute, take_from_file
from ....looks.methods import title_of, weights_of
from ....looks.pose import angles_of

CURRENT = "the current weights"
LAYER_METHODS = {"cutcell": "paper", "cutcell_rig": "animation"}
"""Methods of comparison that a layer can compute, by what the core calls them."""


def pair_of(state: State) -> tuple[str, str]:
    """Return the two methods whose weights are compared."""
    names = state.methods
    first = next((name for name in (state.first_method, NOW) if name in names), names[0])
    others = [name for name in names if name != first]
    second = next((name for name in (state.second_method, "artist") if name in others), others[0])
    return first, second


def called(name: str) -> str:
    """Return the name of the weights of a method in texts."""
    return {NOW: CURRENT, "artist": "the file"}.get(name, f"“{title_of(name)}”")


def unsettled(state: State) -> list[Region]:
    """Return the regions that are listed: all but those that are settled."""
    regions = () if state.disagreement is None else state.disagreement.regions
    return [one for one in regions if settling(state, one.key) not in state.settled]


def settling(state: State, key: str) -> str:
    """Return the key of a region and of the two methods."""
    return "/".join((*pair_of(state), key))


def region_of(state: State) -> Region | None:
    """Return the region that is looked at, or None."""
    regions = () if state.disagreement is None else state.disagreement.regions
    return next((one for one in regions if one.key == state.region), None)


def look_at(session: Session, key: str) -> None:
    """Mark a region, go there, and pose it as it differs most; the same again leaves it."""
    state = session.state
    state.region = "" if key == state.region else key
    region = region_of(state)
    if region is None:
        state.param.update(turns={}, moving=False, playing=False)
        return
    turn = region.turn
    direction = np.linalg.qr(state.rig.world[:3, :3])[0]
    rotation = direction @ axis_rotation(turn.axis, region.degrees) @ direction.T
    state.param.update(
        joint=region.second, turns={turn.joint: angles_of(rotation)}, moving=False, playing=False
    )
    pose = Pose(turn.joint, turn.axis, region.degrees)
    place = Finding("", "note", "", "", vertices=region.vertices, pose=pose)
    rig = state.rig.with_weights(state.binding.weights)
    camera = camera_on(rig, place, bounds_of(state), session.view.aspect / len(state.methods))
    if camera is not None:
        set_camera(session, camera)


def take(session: Session, name: str, opacity: float = 1.0) -> None:
    """Give the region that is looked at the weights of a method, or blend them with its own."""
    state, region = session.state, region_of(session.state)
    if region is None:
        return
    if name == "artist":
        take_from_file(session, region.vertices, opacity)
        return
    if name in LAYER_METHODS:
        options = {"method": LAYER_METHODS[name], "max_influences": state.max_influences}
        recompute(session, region.vertices, opacity, **options)
        return
    rows = weights_of(state, name)[region.vertices]
    total = rows.sum(axis=1)
    vertices, rows = region.vertices[total > 0], rows[total > 0] / total[total > 0, None]
    rows = opacity * rows + (1 - opacity) * state.binding.weights[vertices]
    few = keep_strongest(state.binding.distances, csr_array(rows), state.max_influences)
    put_rows(session, vertices, few.toarray())


def settle(session: Session) -> None:
    """List the region that is looked at no more; the weights stay."""
    state, region = session.state, region_of(session.state)
    if region is not None:
        settled = (*state.settled, settling(state, region.key))
        state.param.update(settled=settled, region="", turns={})


def list_all(session: Session) -> None:
    """List the settled regions again."""
    session.state.settled = ()


def _inputs(state: State) -> tuple[Any, ...] | None:
    if state.binding is None:
        return None
    names = pair_of(state)
    first, second = (_source(state, name) for name in names)
    if any(one is None or (one is not state.binding and one.weights is None)
           for one in (first, second)):  # fmt: skip
        return None
    return state.rig, state.binding.distances, first, second, names


def _source(state: State, name: str) -> Any:
    """Return the object that holds the weights of a method, or None."""
    return {NOW: state.binding, "artist": state.rig}.get(name) or state.compared.get(name)


def _disagreement(
    rig: Rig,
    distances: BoneDistances,
    first: Any,
    second: Any,
    names: tuple[str, str],
    progress: Progress,
) -> Disagreement:
    called_so = called(names[0]), called(names[1])
    weights = first.weights, second.weights
    return disagreement(rig, *weights, distances, names=called_so, progress=progress)


RESULTS = (
    Derived(
        "disagreement",
        _inputs,
        _disagreement,
        wanted=lambda state: state.panel == "compare",
        after=("binding",),
        keeps=lambda old, new: old[0] is new[0] and old[-1] == new[-1],
    ),
)
