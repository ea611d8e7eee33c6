"""Give a mesh that has no skeleton one: a template is fitted into it."""

from collections.abc import Collection

import numpy as np

from cutcell.editing import Edits, JointEdit
from cutcell.rig import Rig, Skeleton
from cutcell.runtime.progress import Progress
from cutcell.templates import Template, fit_skeleton, names_of

from ...document.framing import first_joint
from ...document.session import Session
from .commands import edited_state
from .moving import rounded


def fit(session: Session, template: Template) -> None:
    """Fit a template into the mesh, bind it, and show its weights."""
    state = session.state
    mesh, graph = state.rig.mesh, state.graph

    def work(progress: Progress) -> Skeleton:
        progress("fitting the skeleton", 0.0)
        return fit_skeleton(mesh, template, graph=graph, progress=progress)

    def done(skeleton: Skeleton) -> None:
        changed = edited_state(session.state, Edits(added(state.own, skeleton)))
        changed |= {"joint": first_joint(changed["rig"]), "panel": "weights", "joint_handle": True}
        state.param.update(**changed)

    session.work.start("character", work, done)


def take_out(session: Session) -> None:
    """Remove the fitted skeleton."""
    changed = edited_state(session.state, Edits())
    session.state.param.update(**{**changed, "panel": "graph"})


def is_template(names: Collection[str], template: Template) -> bool:
    """Whether joints have just the names that a template gives them."""
    return set(names) in [set(group) for group in names_of(template)]


def added(base: Rig, skeleton: Skeleton) -> dict[str, JointEdit]:
    """Return a skeleton as the joints that are added to a mesh."""
    names = skeleton.names
    above = [names[parent] if parent >= 0 else "" for parent in skeleton.parents]
    places = rounded(base, skeleton.joints)
    return {
        name: JointEdit(added=True, position=tuple(place), parent=parent)
        for name, place, parent in zip(names, np.asarray(places).tolist(), above, strict=True)
    }
