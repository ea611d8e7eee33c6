"""Messages between browser and server: read strictly; each is sent and has its reader."""

import re

import numpy as np
import pytest

from cutcell_app.server.protocol import received
from cutcell_app.server.protocol.reading import MessageError, read
from cutcell_app.server.protocol.received import RECEIVED
from cutcell_app.server.protocol.sent import ToBrowser
from cutcell_app.widgets.modules import FOLDER, names
from tests.test_layers import ROOT

# TypeScript checks that scripts send what is declared, mypy that the server does.
SCRIPTS = "\n".join((FOLDER / name).read_text(encoding="utf-8") for name in names(".js"))
SERVER = "\n".join(
    path.read_text(encoding="utf-8")
    for path in (ROOT / "app").rglob("*.py")
    if path.parent.name != "messages"
)


@pytest.mark.parametrize("kind", RECEIVED.values(), ids=lambda kind: kind.type)
def test_each_message_is_sent_by_a_script_and_read_by_the_server(kind):
    assert re.search(rf'type: [^",}}]*("[^"]+" : )?"{kind.type}"', SCRIPTS)
    assert re.search(rf"(listen\(|case |, |ask: ){kind.__name__}\b", SERVER)


def test_each_part_of_a_message_to_the_browser_is_read():
    read_parts = set(re.findall(r'(?:"(?=\w+" in message)|message\.)(\w+)', SCRIPTS))
    assert read_parts >= ToBrowser.__annotations__.keys()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"type": "pick", "joint": 2.0, "more": 1}, received.Pick(2)),
        ({"type": "pick-vertex", "vertex": 2}, received.PickVertex(2, view=0)),
        ({"type": "lasso", "vertices": np.array([1, 2]), "mode": ""}, received.Lasso([1, 2], "")),
        ({"type": "override", "weights": [[1, 1]]}, received.Override([(1, 1.0)])),
        ({"type": "override", "weights": None}, received.Override(None)),
        ({"type": "answer", "value": 3}, received.Answer(3)),
        ({"type": "move-cut", "origin": [0, 0, 0], "normal": (0, 0, 1)},
         received.MoveCut((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))),
    ],
)  # fmt: skip
def test_a_message_is_read(data, message):
    assert read(data) == message


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        ({}, "its type"),
        ({"type": ["pick"]}, "its type"),
        ({"type": "pick"}, "pick has no joint"),
        ({"type": "pick", "joint": "2"}, "pick.joint"),
        ({"type": "pick", "joint": 2.5}, "pick.joint"),
        ({"type": "pick", "joint": True}, "pick.joint"),
        ({"type": "pick", "joint": float("inf")}, "pick.joint"),
        ({"type": "time", "time": float("nan")}, "time.time"),
        ({"type": "time", "time": 10**400}, "time.time"),
        ({"type": "play", "on": 1}, "play.on"),
        ({"type": "act", "act": None}, "act.act"),
        ({"type": "move-cut", "origin": [0, 0], "normal": [0, 0, 1]}, "move-cut.origin"),
        ({"type": "lasso", "vertices": "123", "mode": ""}, "lasso.vertices"),
        ({"type": "upload-begin", "files": [{"name": "a.glb"}]}, "upload-begin.files"),
        ({"type": "upload-piece", "index": 0, "data": 10**12}, "upload-piece.data"),
    ],
)
def test_a_malformed_message_is_refused(data, problem):
    with pytest.raises(MessageError, match=problem):
        read(data)
