"""What the scripts use of Panel and Bokeh beyond their documented interface is still there."""

import re
from pathlib import Path

import bokeh
import panel
import pytest

from cutcell_app.widgets.modules import FOLDER

PANEL = Path(panel.__file__).parent / "dist/panel.min.js"
BOKEH = Path(bokeh.__file__).parent / "server/static/js/bokeh.min.js"
REACT = Path(panel.__file__).parent / "models/react_component.ts"


@pytest.mark.parametrize(
    ("path", "name"),
    [
        (PANEL, "panel.models.esm"),
        (PANEL, "ReactComponent"),
        (PANEL, "_render_code"),
        (BOKEH, "on_event("),
        (BOKEH, '"connection_lost"'),
    ],
)
def test_name_is_there(path, name):
    assert name in path.read_text(encoding="utf-8"), f"{path.name} has no {name} any more"


def test_the_lines_of_reacts_components_that_are_replaced_are_there():
    script = (FOLDER / "common/panel.js").read_text(encoding="utf-8")
    for constant in ("ECHO", "STATE"):
        line = re.search(rf'const {constant} = "(.+)"', script)[1]
        for path in (PANEL, REACT):
            written = path.read_text(encoding="utf-8")
            assert line in written, f"{path.name} has no line {line} any more: see panel.js"
