"""The interactive page as a widget of a notebook, which Python reads and steers."""

from pathlib import Path
from typing import Any

import anywidget
import traitlets

from cutcell.checks import check_integer
from cutcell.io.interactive import Page
from cutcell.rig import Rig
from cutcell.runtime.notebook import is_attended

from ..document.framing import first_joint
from ..widgets.modules import FOLDER


class PageWidget(anywidget.AnyWidget):
    """A page in a notebook; `joint` and `vertex` follow the choices on it, and set them.

    Attributes
    ----------
    joint : int or None
        None: all joints.
    vertex : int or None
        None: no vertex.

    Raises
    ------
    ParameterError
        A joint or a vertex that the rig does not have.
    """

    _esm = FOLDER / "one_file/notebook.js"
    content = traitlets.Unicode().tag(sync=True)  # empty until it is shown to a person
    height = traitlets.Int().tag(sync=True)
    joint = traitlets.Any(None).tag(sync=True)
    vertex = traitlets.Any(None).tag(sync=True)

    def __init__(self, rig: Rig, page: Page) -> None:
        self.page = page
        self.counts = {"joint": len(rig.skeleton.joints), "vertex": len(rig.mesh.vertices)}
        joint = first_joint(rig)
        super().__init__(height=page.height, joint=joint)

    @traitlets.validate("joint", "vertex")
    def _checked(self, proposal: Any) -> int | None:
        name, value = proposal["trait"].name, proposal["value"]
        return None if value is None else check_integer(name, value, 0, self.counts[name] - 1)

    def save(self, path: str | Path) -> None:
        """Write the page to a file; see `cutcell.Page`."""
        self.page.save(path)

    def _repr_mimebundle_(self, **options: Any) -> Any:
        """Return the widget, and the page alone for viewers of the notebook that have no widgets.

        A notebook that a program runs gets the page alone: converted to HTML, a widget would need
        scripts from elsewhere, and would be empty offline.
        """
        alone = {"text/html": self.page._repr_html_()}
        if not is_attended():
            return alone, {}
        self.content = self.page.content
        bundle: Any = super()._repr_mimebundle_(**options)
        data, metadata = bundle
        return {**data, **alone}, metadata
