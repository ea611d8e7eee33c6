"""Messages between browser and server: each is declared, sent and listened to."""

import ast
import re

from cutcell_app.shell.session.view_parts import PARTS
from cutcell_app.widgets.modules import FOLDER
from cutcell_app.widgets.protocol import FROM_BROWSER, FROM_WIDGETS, TO_BROWSER
from tests.test_layers import ROOT

OWN_MESSAGES = {
    "curves", "flat_scene", "histogram", "inspector", "joint_tree", "lesson", "methods", "rows",
    "weights_table", "welcome",
}  # fmt: skip
"""Widgets beside the view, whose messages are theirs alone."""
SERVER = {path: path.read_text(encoding="utf-8") for path in (ROOT / "app").rglob("*.py")}
SCRIPTS = "\n".join(
    path.read_text(encoding="utf-8")
    for path in FOLDER.glob("*.js")
    if path.stem not in OWN_MESSAGES
)


WIDGETS = "\n".join((FOLDER / f"{name}.js").read_text(encoding="utf-8") for name in OWN_MESSAGES)


def words(pattern, text):
    """Return all that the groups of a pattern match."""
    return {word for result in re.finditer(pattern, text) for word in result.groups() if word}


def test_what_the_browser_sends_is_declared_and_listened_to():
    calls = " ".join(words(r"(?:send_msg|tell|ask)\(([^)]*)", SCRIPTS))
    assert words(r'type: [^",}]*"([^"]+)"(?: : "([^"]+)")?', calls) == FROM_BROWSER.keys()
    server = "\n".join(text for path, text in SERVER.items() if path.name != "protocol.py")
    heard = words(r'listen\("([^"]+)"|"(upload-\w+)":', server)
    heard |= words(r'kind == "([^"]+)"', SERVER[ROOT / "app/widgets/view.py"])
    assert heard == FROM_BROWSER.keys()


def test_what_the_widgets_send_is_declared():
    assert words(r'(?:send_msg|give)\(\{type: "([^"]+)"', WIDGETS) == FROM_WIDGETS.keys()


def test_what_the_server_sends_is_declared_and_read():
    calls = [
        node
        for text in SERVER.values()
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
        if node.func.attr in ("send", "answer")
    ]
    sent = {word.arg for call in calls for word in call.keywords if word.arg}
    widgets = SERVER[ROOT / "app/widgets/view.py"] + SERVER[ROOT / "app/widgets/changes.py"]
    sent |= words(r'message\["(\w+)"\]|_send_msg\(\{"(\w+)"|first = \{"(\w+)"', widgets)
    sent |= words(r'(?m)^ +"(\w+)": ', SERVER[ROOT / "app/document/recording.py"])
    assert sent | PARTS.keys() == TO_BROWSER.keys()
    assert words(r'"(\w+)" in message|message\.(\w+)', SCRIPTS) >= TO_BROWSER.keys()
