"""Give a mesh that has no skeleton one: a template is fitted into it."""

from collections.abc import Callable, Collection

import numpy as np
from param.parameterized import batch_call_watchers

from cutcell.editing import Edits, JointEdit
from cutcell.errors import ParameterError
from cutcell.rig import Rig, Skeleton
from cutcell.runtime.progress import Progress
from cutcell.templates import Template, fit_skeleton, names_of

from ...derive.tasks import Task
from ...document.document import put
from ...document.framing import first_joint
from ...document.session import Session
from .moving import rounded


class Fitting(Task):
    """Fits a template into the mesh, binds it, and shows its weights."""

    name, title = "fit", "a template"

    def __init__(self, session: Session, template: Template) -> None:
        self._state, self._template = session.state, template
        self._own: Rig = session.state.own

    def begin(self) -> Callable[[Progress], Skeleton]:
        """Return what fits the template."""
        if self._state.own is not self._own:
            raise ParameterError("another character was opened; choose the template again")
        mesh, graph, template = self._state.rig.mesh, self._state.graph, self._template

        def compute(progress: Progress) -> Skeleton:
            progress("fitting the skeleton", 0.0)
            return fit_skeleton(mesh, template, graph=graph, progress=progress)

        return compute

    def finish(self, result: Skeleton) -> None:
        """Add the joints of the skeleton."""
        state = self._state
        with batch_call_watchers(state):
            put(state, edits=Edits(added(state.own, result)))
            first = first_joint(state.rig)
            state.param.update(joint=first, panel="weights", joint_handle=True)

    def drop(self) -> None:
        """Show in the menu what there is."""
        self._state.param.trigger("edits")


def fit(session: Session, template: Template) -> None:
    """Fit a template into the mesh, bind it, and show its weights."""
    session.tasks.add(Fitting(session, template))


def take_out(session: Session) -> None:
    """Remove the fitted skeleton."""
    put(session.state, edits=Edits(), panel="graph")


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
