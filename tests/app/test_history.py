"""The address, undo, reset, keys, and files that are kept for whoever comes back."""

from dataclasses import replace

import pytest

import cutcell
from cutcell import Edits
from cutcell.rig import TriangleMesh
from cutcell_app.derive.jobs import Gate
from cutcell_app.document import loading
from cutcell_app.document.address import first_clip, from_query, to_query
from cutcell_app.document.document import TOGETHER, Document, History
from cutcell_app.document.framing import first_joint
from cutcell_app.document.loading import GONE
from cutcell_app.document.opening import Request
from cutcell_app.document.side_by_side import standard
from cutcell_app.editing.correct import commands as correct
from cutcell_app.features.check.results import repair
from cutcell_app.features.compare.results import choose
from cutcell_app.features.state import PageState
from cutcell_app.shell.session import keys
from cutcell_app.shell.session.begin import begin
from cutcell_assets import demo_path
from tests.viewers.arm import arm_rig


def upload(session, path):
    """Give a file to a page as its browser does."""
    receiver, data = loading.receiver(session), path.read_bytes()
    files = [{"name": path.name, "size": len(data)}]
    for message in (
        {"type": "upload-begin", "files": files},
        {"type": "upload-piece", "index": 0, "data": data},
        {"type": "upload-end"},
    ):
        assert receiver.answer(message) == {"ok": True}


def document(**choices):
    return Document("", None, None, None, Edits(), choices)


def said(session):
    return session.view._parts["address"]


def test_an_address_brings_back_what_was_chosen():
    rig = arm_rig()
    state = PageState(
        rig=rig, demo="robot", joint=1, panel="graph", resolution=48, surface_edges=True
    )
    state.param.update(cut_axis="y", cut_position=0.25, turns={1: (0, 0, 30), 0: (0, 0, 0)})
    state.param.update(clip=first_clip(rig), methods=standard(rig))  # as when it was opened
    query = to_query(state, camera=[1, 2, 3, 0, 0.5, 0])
    choices, arrival, problems = from_query(query, PageState())
    assert problems == []
    assert arrival == {
        "rig": "robot",
        "bone": rig.skeleton.names[1],
        "turns": {1: (0, 0, 30)},
        "camera": [1, 2, 3, 0, 0.5, 0],
    }
    other = PageState(
        rig=rig, demo="robot", joint=1, turns=arrival["turns"], clip=state.clip,
        methods=state.methods, **choices,
    )  # fmt: skip
    assert to_query(other, camera=arrival["camera"]) == query


@pytest.mark.parametrize(("old", "new"), [("geodesics", "distance"), ("diagnosis", "check")])
def test_addresses_with_the_former_names_of_panels_open(old, new):
    for name in (old, new):
        choices, _, problems = from_query(f"panel={name}", PageState())
        assert (choices["panel"], problems) == (new, [])


def test_what_is_ones_own_or_of_the_moment_is_not_in_the_address():
    state = PageState(demo="robot", dark=True, moving=True, playing=True, busy=True, stage="graph")
    state.node = 7
    assert to_query(state) == "rig=robot&panel=weights"


@pytest.mark.parametrize(
    "query",
    ["resolution=many", "panel=kitchen", "thin=yes", "turns=1:2", "camera=1,2,3",
     "methods=magic", "methods=now,euclidean,voxel,artist,bbw", "minus=magic", "minus=now,artist",
     "methods=now", "clip=walk", "camera=nan,0,0,0,0,0", "turns=a:1,2,3", "cut_position=7", "x=1",
     "resolution=1e99"],
)  # fmt: skip
def test_what_an_address_says_wrongly_is_named(query):
    choices, arrival, problems = from_query(query, PageState())
    assert (choices, arrival) == ({}, {})
    assert problems == [query]


def test_a_link_opens_as_it_was_shared(session, loop):
    loading.arrive(session, "?rig=robot&panel=graph&bone=hand.L&resolution=16&kitchen=1")
    loop.run_until(lambda: session.state.binding is not None)
    assert session.state.demo == "robot"
    assert session.state.rig.skeleton.names[session.state.joint] == "hand.L"
    assert session.state.binding.graph.lattice.resolution == 16
    assert "kitchen=1" in session.state.message[1]
    assert "bone=hand.L" in said(session)


def test_a_comparison_opens_as_it_was_shared(session, loop):
    query = "?rig=robot&panel=compare&compare_field=all&methods=voxel,euclidean&minus=euclidean"
    loading.arrive(session, query + "&resolution=16&clip=-1")
    loop.run_until(lambda: len(session.state.compared) == 2, 60)
    state = session.state
    assert (state.methods, state.minus) == (["voxel", "euclidean"], "euclidean")
    assert state.compare_field == "all"
    assert state.clip == -1
    for part in ("methods=voxel,euclidean", "minus=euclidean", "compare_field=all", "clip=-1"):
        assert part in said(session)
    loading.show_rig(session, arm_rig())  # what was chosen holds for the next character, too
    assert (state.methods, state.minus) == (["voxel", "euclidean"], "euclidean")
    keys.reset(session)
    assert (state.methods, state.minus) == (["now", "artist", "euclidean"], "")
    assert "methods" not in said(session)


def test_a_difference_to_the_files_own_weights_is_shared_without_naming_the_methods(session):
    session.state.resolution = 16
    loading.show_rig(session, arm_rig(), minus="artist")
    assert session.state.methods == ["now", "artist", "euclidean"]
    assert session.state.minus == "artist"
    assert not session.history.can_undo


def test_methods_that_a_character_does_not_offer_are_left_out(session):
    session.state.resolution = 16
    loading.show_rig(
        session, arm_rig().with_weights(None), methods=["now", "artist"], minus="artist"
    )
    assert (session.state.methods, session.state.minus) == (["now", "euclidean"], "")


def test_the_choice_of_methods_can_be_undone(session):
    loading.show_rig(session, arm_rig())
    state, act = session.state, lambda name: keys.act(session, name)
    choose(session, "voxel", True)
    state.minus = "euclidean"
    assert state.methods == ["now", "artist", "euclidean", "voxel"]
    act("undo")
    assert state.minus == ""
    act("undo")
    assert state.methods == ["now", "artist", "euclidean"]
    act("redo")
    act("redo")
    assert (len(state.methods), state.minus) == (4, "euclidean")


def test_an_uploaded_character_is_there_again_while_it_is_kept(session, loop, tmp_path):
    path = tmp_path / "mine.glb"
    path.write_bytes(demo_path("robot").read_bytes())
    session.state.resolution = 16
    upload(session, path)
    loop.run_until(lambda: session.state.binding is not None)
    query = said(session)
    assert f"rig=~{session.uploads.key}" in query
    session.close()
    again = begin(loop)
    loading.arrive(again, query)
    loop.run_until(lambda: again.state.rig is not None)
    assert again.uploads.key == session.uploads.key or again.uploads.key in query
    again.close()


def test_a_file_that_is_dropped_while_the_page_loads_wins_over_its_address(loop, tmp_path):
    gate = Gate(loop)
    session = begin(gate)
    loading.arrive(session, "?rig=robot&bone=hand.L&camera=1,2,3,0,1,0&resolution=16")
    path = tmp_path / "mine.glb"
    path.write_bytes(demo_path("octopus").read_bytes())
    upload(session, path)
    gate.open()
    loop.run_until(lambda: session.state.binding is not None)
    expected = cutcell.load(demo_path("octopus"))
    assert len(session.state.rig.mesh.vertices) == len(expected.mesh.vertices)
    assert session.state.joint == first_joint(session.state.rig)
    assert (session.state.demo, session.view.at_home) == ("", True)
    session.close()


def test_an_address_of_a_file_that_is_gone_says_so(session, loop):
    session.state.resolution = 16
    loading.arrive(session, "?rig=~gone&bone=head", Request("demo robot"))
    loop.run_until(lambda: session.state.message is not None)
    assert session.state.message == ("info", GONE)
    assert session.state.joint == first_joint(session.state.rig), "the bone is of another character"


def test_undo_and_redo():

    def go(by):
        history.go(by, history.peek(by))
        return history.now.choices

    history = History(document(a=1, panel="x"))
    history.note(document(a=2, panel="x"), 0)
    history.note(document(a=3, panel="x"), TOGETHER / 2)  # one drag of a slider
    history.note(document(a=3, panel="y"), 5)  # going elsewhere is no step
    history.note(document(a=4, panel="y"), 9)
    assert go(-1) == {"a": 3, "panel": "y"}
    assert go(-1) == {"a": 1, "panel": "x"}
    assert history.peek(-1) is None
    assert go(1) == {"a": 3, "panel": "y"}
    history.note(document(a=7, panel="y"), 20)
    assert not history.can_redo


def test_keys(session, loop):
    session.state.resolution = 16
    loading.show_rig(session, arm_rig())
    loop.run_until(lambda: session.state.binding is not None)
    state, act = session.state, lambda name: keys.act(session, name)
    first = state.joint
    act("next")
    assert state.joint == (first + 1) % len(state.rig.skeleton.names)
    act("previous")
    assert state.joint == first
    act("parent")
    act("child")
    state.cut_axis = "x"
    act("undo")
    assert state.cut_axis == "auto"
    act("redo")
    assert state.cut_axis == "x"
    act("play")
    assert (state.panel, state.moving, state.playing) == ("pose", True, True)
    act("play")
    assert not state.playing
    act("reset")
    assert (state.cut_axis, state.turns, state.moving) == ("auto", {}, False)
    act("dance")


def test_the_choice_of_joints_that_deform_can_be_undone(bound, loop):
    before = bound.state.rig
    correct.choose_deform(bound, [0, 1])
    loop.rest(bound)
    assert bound.state.binding.weights[:, 2].max() == 0
    keys.act(bound, "undo")
    assert bound.state.rig is before
    assert bound.view.last_sent("able") == [False, True]
    loop.rest(bound)
    assert bound.state.binding.weights[:, 2].max() > 0
    keys.act(bound, "redo")
    loop.rest(bound)
    assert bound.state.binding.weights[:, 2].max() == 0
    assert bound.view.last_sent("able") == [True, False]


def test_a_repair_can_be_undone(session, loop):
    rig = arm_rig()
    faces = rig.mesh.faces.copy()
    faces[::7] = faces[::7, ::-1]
    spoiled = replace(rig, mesh=TriangleMesh(rig.mesh.vertices, faces))
    session.state.resolution = 16
    loading.show_rig(session, spoiled)
    loop.run_until(lambda: session.state.diagnosis is not None)
    code = next(finding.code for finding in session.state.diagnosis.findings if finding.repair)
    repair(session, [code])
    loop.run_until(lambda: session.state.rig is not spoiled and not session.work.busy)
    repaired, done = session.state.rig, session.state.repair
    keys.act(session, "undo")
    assert (session.state.rig, session.state.repair) == (spoiled, None)
    assert not session.history.can_undo
    loop.rest(session)
    keys.act(session, "redo")
    assert (session.state.rig, session.state.repair) == (repaired, done)
    loop.rest(session)
    assert session.state.binding is not None
