"""The lesson: every step has what it needs, asks, and shows the answer."""

import numpy as np
import pytest

from cutcell.errors import FileError
from cutcell_app.document import loading
from cutcell_app.document.selection import selected
from cutcell_app.editing.brush.strokes import select
from cutcell_app.features.flat.overlay import overlay as flat_scene
from cutcell_app.features.learn.lesson import FOLDER, KINDS, built_in, read
from cutcell_app.features.learn.overlay import overlay as lesson_card
from cutcell_app.features.learn.plots import plot_of
from cutcell_app.features.learn.steps import (
    NO_PATH,
    answer,
    branch_weights,
    choose,
    clickable,
    followed,
    go,
    leave,
    named_values,
    offer,
    painted_scores,
    pressed_offers,
)
from cutcell_app.features.learn.writing import this_view, written
from cutcell_app.features.opened import read_checked
from cutcell_app.features.scenes import resolve
from cutcell_app.features.state import PANELS
from cutcell_app.headless.lesson_page import Recording
from cutcell_app.shell.character import about
from cutcell_app.shell.session import keys
from cutcell_app.shell.session.begin import begin
from cutcell_assets import DEMOS, demo_path
from cutcell_viewers.camera import Camera
from tests.app.small import small_rig
from tests.conftest import ROOT

LESSON = built_in()
MAX_WORDS = 60


def index_of(text):
    return next(i for i, step in enumerate(LESSON.steps) if text in step.scene(True))


DIAMONDS, CAPE, TWIST, FALLOFF, RAYS, HOLES, GRAPH, SEARCH = map(
    index_of,
    (
        *("connectivity=6", "biped_cape", "turns=12", "falloff=paper"),
        *("flat=rays", "flat=winding", "flat=graph", "flat=search"),
    ),
)


def camera_of(step):
    return [float(x) for x in step.address.partition("camera=")[2].partition("&")[0].split(",")]


def seen_from(session):
    return [*session.view.camera.position, *session.view.camera.focal_point]


def test_every_step_of_the_lesson_is_short_and_names_what_the_page_has():
    demos = {demo.id for demo in DEMOS}
    assert 10 <= len(read_checked(FOLDER)) <= 12
    for step in LESSON.steps:
        text = f"{step.question} {step.text} {step.sentence}"
        assert len(text.split()) <= MAX_WORDS, step.title
        assert step.demo in demos, step.title
        assert step.picture, step.title
        assert step.notes, step.title
        assert step.answer.kind in KINDS


@pytest.mark.parametrize("index", range(len(LESSON)))
def test_a_step_asks_then_shows_its_answer(session, loop, index):
    state, step = session.state, LESSON[index]
    state.resolution = state.graph_resolution = 16
    go(session, index)
    loop.rest(session)
    assert state.message is None, state.message
    assert (state.step, state.demo) == (index, step.demo)
    assert f"panel={state.panel}" in step.address
    question = resolve(state).actors.keys()
    assert "body" in question or "body 0" in question
    assert f"step={index + 1}" in session.view.last_sent("address")
    answer(session, step.answer.expected if step.answer.kind != "paint" else "Lift")
    loop.rest(session)
    assert state.message is None, state.message
    assert "answer=" in session.view.last_sent("address")
    assert state.panel in PANELS
    for number in range(len(step.offers)):
        offer(session, number)
        loop.rest(session)
        assert pressed_offers(state)[number], list(step.offers)[number]


def test_a_step_sets_the_scene_and_can_be_left_and_taken_up(session, loop):
    state = session.state
    go(session, DIAMONDS)
    loop.run_until(lambda: state.binding is not None)
    assert (state.connectivity, state.cut_axis, state.panel) == (6, "z", "distance")
    assert state.rig.skeleton.names[state.joint] == "spine2"
    assert seen_from(session) == camera_of(LESSON[DIAMONDS])
    go(session, -1)
    assert (state.step, state.panel) == (-1, "distance")  # there was no character before it
    go(session, FALLOFF)
    assert (state.step, state.panel, state.connectivity) == (FALLOFF, "weights", "any")


def test_an_answer_is_kept_and_the_camera_with_it(session, loop):
    state = session.state
    go(session, DIAMONDS)
    loop.rest(session)
    session.view.camera, session.view.at_home = arrival_camera(1), False
    answer(session, "They become rounder")
    answer(session, "They stay diamonds")  # too late
    assert state.answers == {DIAMONDS: "They become rounder"}
    assert state.resolution == 128
    assert session.view.camera == arrival_camera(1)
    go(session, FALLOFF)
    go(session, DIAMONDS)
    assert state.answers == {DIAMONDS: "They become rounder"}
    assert state.resolution == 128, "an answered step stays revealed"
    assert seen_from(session) == camera_of(LESSON[DIAMONDS])


@pytest.mark.parametrize("leaves", [leave, lambda session: loading.visit(session, "?rig=biped")])
def test_a_lesson_that_was_left_begins_anew(session, loop, leaves):
    go(session, DIAMONDS)
    loop.rest(session)
    answer(session, "")
    leaves(session)
    loop.rest(session)
    assert (session.state.step, session.state.answers) == (-1, {})
    go(session, DIAMONDS)
    loop.rest(session)
    assert session.state.answers == {}, "the next class is asked again"


def test_undo_in_the_lesson_ends_at_its_step(session, loop):
    state = session.state
    go(session, CAPE)
    loop.rest(session)
    for index in (DIAMONDS, FALLOFF):
        go(session, index)
        loop.rest(session)
        assert not session.history.can_undo
    state.alpha = 0.3
    assert "alpha=0.3" in session.view.last_sent("address")
    assert session.history.can_undo
    keys.act(session, "undo")
    assert (state.alpha, state.step, state.panel) == (0, FALLOFF, "weights")
    assert not session.history.can_undo


def arrival_camera(x):
    return Camera((x, 2, 3), (0, 1, 0))


@pytest.mark.parametrize("value", ["x" * 500, float("nan"), float("inf"), [1, 2], None, True])
def test_a_strange_answer_is_a_short_text(session, loop, value):
    go(session, DIAMONDS)
    loop.rest(session)
    answer(session, value)
    assert len(str(session.state.answers[DIAMONDS])) <= 200
    assert session.state.message is None


def test_numbers_in_the_text_and_buttons_set_choices_of_the_step_alone(session, loop):
    go(session, FALLOFF)
    loop.rest(session)
    state = session.state
    assert list(named_values(state)) == ["alpha"]
    assert named_values(state)["alpha"]["value"] == 0
    choose(session, "alpha", 0.25)
    assert state.alpha == 0.25
    assert not any(pressed_offers(state)[:3])
    choose(session, "alpha", 7)
    choose(session, "alpha", "x&panel=pose")
    choose(session, "resolution", 100)
    offer(session, 99)
    assert (state.alpha, state.resolution, state.panel) == (0.25, 64, "weights")
    offer(session, 2)
    assert pressed_offers(state) == [False, False, True, False]


def test_a_link_to_a_step_alone_sets_its_scene(session, loop):
    query = f"?panel=learn&step={DIAMONDS + 1}"
    loading.arrive(session, query)
    state = session.state
    loop.run_until(lambda: state.binding is not None)
    assert (state.step, state.demo, state.panel) == (DIAMONDS, "biped", "learn")
    assert (state.connectivity, state.cut_axis, state.answers) == (6, "z", {})
    assert seen_from(session) == camera_of(LESSON[DIAMONDS])
    assert not session.history.can_undo


def test_a_link_with_an_answer_shows_the_answer_and_starts_the_presentation(session, loop):
    loading.arrive(session, "?step=2&answer=0.3&stage&resolution=16")
    state = session.state
    loop.run_until(lambda: state.binding is not None)
    assert (state.answers, state.staged) == ({1: 0.3}, True)
    assert state.measures == ["straight", "any"]
    assert state.resolution == 16
    assert "answer=0.3&stage=1" in session.view.last_sent("address")


@pytest.mark.parametrize("query", ["step=2&answer=x", "step=99", "step=0", "step=two", "stage=2"])
def test_a_link_to_a_step_or_answer_that_there_is_not_says_so(session, loop, query):
    loading.arrive(session, f"?{query}&rig=robot&resolution=16")
    loop.run_until(lambda: session.state.binding is not None)
    assert query.rpartition("&")[2] in session.state.message[1]
    assert not session.state.answers


def test_a_link_of_a_person_in_the_lesson_brings_back_what_they_made_of_it(session, loop):
    go(session, DIAMONDS)
    loop.run_until(lambda: session.state.binding is not None)
    answer(session, "They stay diamonds")
    session.state.param.update(connectivity="any", panel="learn", resolution=16)
    query = session.view.last_sent("address")
    again = begin(loop)
    loading.arrive(again, query)
    loop.run_until(lambda: again.state.binding is not None)
    assert (again.state.step, again.state.panel, again.state.resolution) == (DIAMONDS, "learn", 16)
    assert (again.state.connectivity, again.state.answers) == ("any", session.state.answers)
    again.close()


def test_the_flat_scene_answers_a_step_that_asks_for_it(session, loop):
    flat = flat_scene(session)
    go(session, RAYS)
    loop.rest(session)
    assert flat.task == "open"
    flat._handle_msg({"type": "answer", "value": "1"})
    flat._handle_msg({"type": "answer", "value": "0"})  # too late
    assert (session.state.answers, flat.task) == ({RAYS: "1"}, "done")
    go(session, FALLOFF)
    flat._handle_msg({"type": "answer", "value": "1"})  # the step asks for something else
    assert FALLOFF not in session.state.answers


@pytest.mark.parametrize(("step", "before"), [(GRAPH, HOLES), (SEARCH, GRAPH)])
def test_a_step_that_asks_shows_one_section_and_not_that_of_the_step_before(
    session, loop, step, before
):
    go(session, before)
    loop.rest(session)
    answer(session, "")
    loop.rest(session)
    sections = []
    session.state.param.watch(lambda event: sections.append(event.new), "flat_data")
    go(session, step)
    loop.rest(session)
    assert [bool(one) for one in sections] == [False, True]


def test_the_text_of_a_character_does_not_answer_the_step(session, loop):
    go(session, CAPE)
    loop.rest(session)
    assert about(session.state) == ""
    answer(session, "")
    loop.rest(session)
    assert "No path" in about(session.state)


def test_a_plot_shows_the_clicked_vertex_once_the_step_is_answered(session, loop):
    session.state.resolution = 16
    card = lesson_card(session)
    go(session, FALLOFF)
    loop.rest(session)
    assert card.now["plot"] is None
    answer(session, "A half")
    loop.rest(session)
    first = card.now["plot"]
    assert len(first["marks"]) > 1
    session.state.vertex = 0
    assert card.now["plot"] not in (None, first)


@pytest.mark.parametrize(("alpha", "twice"), [(0.0, 1 / 4), (1.0, 1 / 16)])
def test_joints_of_a_vertex_lie_on_the_curve_of_the_falloff(session, loop, alpha, twice):
    session.state.resolution = 16
    go(session, FALLOFF)
    loop.rest(session)
    answer(session, "")
    session.state.alpha = alpha
    loop.rest(session)
    plot = plot_of(session.state, "falloff")
    x, y = np.transpose(plot["curve"]["points"])
    assert plot["twice"] == [2 * x[0], pytest.approx(twice)]
    assert x.min() == plot["marks"][0]["at"][0]
    for mark in plot["marks"]:
        assert np.interp(mark["at"][0], x, y) == pytest.approx(mark["at"][1], abs=0.01)
    session.state.falloff = "rig"
    loop.rest(session)
    animation = plot_of(session.state, "falloff")
    assert animation["curve"]["name"] != plot["curve"]["name"]
    assert animation["curve"]["points"][0][0] == x[0], "distances stay"
    assert animation["twice"][1] < 1e-6


def test_a_button_opens_another_character_and_leaving_restores_the_first(session, loop):
    state = session.state
    loading.arrive(session, "?rig=robot&panel=weights&resolution=16")
    loop.run_until(lambda: state.binding is not None)
    go(session, HOLES)
    loop.rest(session)
    answer(session, "")
    loop.rest(session)
    offer(session, 2)
    loop.run_until(lambda: state.rig.name == "biped_soup", 60)
    assert (state.step, state.flat, pressed_offers(state)) == (
        HOLES,
        "winding",
        [False, False, True],
    )
    go(session, -1)
    loop.run_until(lambda: state.rig.name == "robot", 60)


def test_teachers_are_sent_to_steps_that_there_are():
    text = (ROOT / "docs" / "teaching" / "index.md").read_text(encoding="utf-8")
    table = text.partition("| Question | Answer | Step |")[2].partition("## ")[0]
    rows = [line.split("|") for line in table.splitlines() if line.startswith("| ")]
    assert len(rows) == 12
    for row in rows:
        steps = [int(number) for number in row[-2].split(",")]
        assert all(1 <= number <= len(LESSON) for number in steps), row[1]


def test_two_steps_at_once_show_the_last(session, loop):
    go(session, CAPE)
    go(session, 0)
    loop.run_until(lambda: session.state.binding is not None)
    assert (session.state.step, session.state.rig.name) == (0, "biped")
    go(session, CAPE)
    loop.run_until(lambda: session.state.rig.name == "biped_cape", 60)
    assert session.state.step == CAPE


def test_leaving_brings_back_the_character_the_choices_the_camera_and_undo(session, loop):
    state = session.state
    loading.arrive(session, "?rig=robot&panel=weights&resolution=24&camera=1,2,3,0,1,0")
    loop.run_until(lambda: state.binding is not None)
    state.alpha = 0.3
    past = session.history
    go(session, CAPE)
    loop.run_until(lambda: state.binding is not None and state.demo == "biped_cape")
    go(session, FALLOFF)
    go(session, -1)
    loop.run_until(lambda: state.rig.name == "robot" and state.binding is not None)
    assert (state.step, state.panel, state.resolution, state.alpha) == (-1, "weights", 24, 0.3)
    assert session.history is past
    assert past.can_undo


def test_a_character_that_a_person_opens_in_the_lesson_stays_when_it_is_left(session, loop):
    state = session.state
    loading.arrive(session, "?rig=robot&panel=weights&resolution=16")
    loop.run_until(lambda: state.binding is not None)
    go(session, CAPE)
    loop.run_until(lambda: state.rig.name == "biped_cape", 60)
    loading.load_files(session, [demo_path("rabbit")])
    loop.run_until(lambda: state.rig.name == "rabbit", 60)
    go(session, -1)
    loop.rest(session)
    assert (state.step, state.rig.name) == (-1, "rabbit")
    assert session.source == "~"
    assert "loading" not in state.stage


def test_back_and_forward_return_to_steps_with_their_scenes_and_answers(session, loop):
    """The browser's buttons name an address that the page made, with or without a step."""
    state = session.state
    before = "?rig=robot&panel=weights&bone=hips&resolution=16"
    asked = "?rig=biped_cape&panel=distance&bone=chest&resolution=16&step=12"
    for query, step in ((before, -1), (asked, 11), (f"{asked}&answer=x", 11), (asked, 11)):
        session.view._handle_msg({"type": "visit", "query": query})
        loop.rest(session)
        assert state.rig.name == ("robot" if step < 0 else "biped_cape")
        assert state.step == step
        assert state.panel == ("weights" if step < 0 else "distance")
        assert state.answers == ({11: "x"} if "answer" in query else {})


def test_paint_is_scored_by_what_the_branch_moves(session, loop):
    state = session.state
    go(session, 0)
    loop.rest(session)
    assert (state.brush, state.brush_mode, state.pose_colors) == (True, "select", "plain")
    assert not state.brush_mirrored, "the other side would count against the score"
    moves = branch_weights(state, "upper_arm.L") > 0.5
    assert moves.any()
    painted = moves.copy()
    painted[np.flatnonzero(moves)[::2]] = False
    select(session, painted)
    answer(session, "Lift")
    assert state.answers[0] == pytest.approx(painted.sum() / moves.sum())
    assert not state.brush
    assert (state.panel, state.compare_field) == ("compare", "branch")
    loop.rest(session)
    scores = painted_scores(state)
    assert list(scores) == list(resolve(state).views) == list(LESSON[0].captions.values())
    straight, through_the_body = scores.values()
    assert straight < through_the_body <= 1


@pytest.mark.parametrize("way", ["next", "leave", "back", "unanswered"])
def test_paint_stays_on_its_step(session, loop, way):
    state = session.state
    loading.arrive(session, "?rig=biped&panel=weights&resolution=16")
    loop.rest(session)
    before = np.arange(len(state.rig.mesh.vertices)) < 9
    select(session, before)
    state.param.update(brush=True, brush_mode="smooth", brush_radius=0.1)
    address = session.view.last_sent("address")
    go(session, 0)
    loop.rest(session)
    assert selected(state) is None, "what was selected before the lesson is no paint of its step"
    assert state.brush_mode == "select"
    select(session, branch_weights(state, "upper_arm.L") > 0.5)
    if way != "unanswered":
        answer(session, "Lift")
    if way == "leave":
        go(session, -1)
    elif way == "back":
        session.view._handle_msg({"type": "visit", "query": address})
    else:
        go(session, FALLOFF)
    loop.rest(session)
    if way == "leave":
        assert (state.brush, state.brush_mode, state.brush_radius) == (True, "smooth", 0.1)
        assert np.array_equal(selected(state), before)
    else:
        assert selected(state) is None
        assert not state.brush


def test_a_click_answers_where_a_step_asks_for_one(session, loop, tmp_path):
    file = tmp_path / "click.md"
    step = "---\ntitle: T\nquestion: Q\naddress: panel=weights\nanswer: {{kind: {}}}\n---\n"
    file.write_text("".join(step.format(kind) for kind in ("vertex", "joint")))
    state = session.state
    state.lesson = read(file)
    state.resolution = 16
    loading.show_rig(session, small_rig())
    loop.rest(session)
    names = state.rig.skeleton.names
    go(session, 0)
    state.joint = 1
    assert not state.answers
    state.vertex = 3
    assert state.answers == {0: names[state.weights[3].argmax()]}
    go(session, 1)
    assert 1 not in state.answers, "the scene chooses a joint, too"
    state.joint = 0 if state.joint else 1
    assert state.answers[1] == names[state.joint]


def test_a_click_on_the_cape_answers_that_no_path_leads_there(session, loop):
    state = session.state
    state.resolution = 16
    go(session, CAPE)
    loop.run_until(lambda: state.binding is not None and state.demo == "biped_cape")
    unreached = state.binding.distances.fallback != 0
    assert 0 < unreached.sum() < len(unreached)
    names, answers = clickable(state), followed(state)
    assert {names[index] for index in answers[unreached]} == {NO_PATH}
    assert NO_PATH not in {names[index] for index in answers[~unreached]}
    assert names[answers[0]] == state.rig.skeleton.names[state.weights[0].argmax()]
    state.vertex = int(unreached.argmax())
    assert state.answers[CAPE] in LESSON[CAPE].answer.expected


def test_errors_over_the_resolution_are_measured_once_a_step_shows_them(session, loop):
    state = session.state
    go(session, DIAMONDS)
    loop.rest(session)
    assert plot_of(state, "error") is None, "they would give the answer away"
    answer(session, "They stay diamonds")
    loop.rest(session)
    axes, _, any_angle = plot_of(state, "error")["curves"]
    for (n, of_axes), (same, of_any) in zip(axes["points"], any_angle["points"], strict=True):
        assert n == same
        assert of_axes > 4 * of_any
    choose(session, "connectivity", "any")
    loop.rest(session)
    assert plot_of(state, "error")["at"] == state.resolution == 128
    offer(session, 1)
    loop.rest(session)
    assert state.panel == "graph"
    assert plot_of(state, "error") is None, "of another bone"
    offer(session, 0)
    loop.rest(session)
    assert plot_of(state, "error") is not None


def test_the_present_view_is_written_as_a_step_that_reads_back(session, loop, tmp_path):
    state = session.state
    state.resolution = 16
    loading.show_rig(session, small_rig(), character="~abc")
    loop.rest(session)
    go(session, FALLOFF)
    loop.rest(session)
    state.param.update(panel="weights", alpha=0.25)
    session.view.camera, session.view.at_home = arrival_camera(1), True
    step = this_view(session)
    assert step.address.endswith("&camera=1,2,3,0,1,0"), "also where the page begins with it"
    file = tmp_path / "01-new.md"
    file.write_text(written(step), encoding="utf-8")
    assert "button" not in file.read_text(encoding="utf-8"), "a choice has none"
    (again,) = read_checked(tmp_path).steps
    assert again == step
    assert "alpha=0.25" in again.address
    assert "step=" not in again.address
    assert "rig=biped" in again.address


@pytest.mark.parametrize("panel", ["graph", "distance", "weights", "pose", "compare", "check"])
def test_a_view_of_each_panel_is_saved_as_a_step(session, loop, tmp_path, monkeypatch, panel):
    state, saved = session.state, {}
    monkeypatch.setattr(session.view, "offer", saved.__setitem__)
    keys.act(session, "step")
    assert not saved, "there is no view without a character"
    state.resolution = 16
    loading.show_rig(session, small_rig())
    state.panel = panel
    loop.rest(session)
    keys.act(session, "step")
    ((name, content),) = saved.items()
    (tmp_path / name).write_bytes(content)
    address = read_checked(tmp_path)[0].address
    assert f"panel={panel}" in address
    assert "camera=" in address


def test_a_link_names_the_step_only_while_its_panels_are_shown(session, loop):
    go(session, DIAMONDS)
    loop.rest(session)
    answer(session, "They stay diamonds")
    state = session.state
    for panel, is_shown in (("graph", True), ("learn", True), ("pose", False), ("distance", True)):
        state.panel = panel
        link, address = session.view.last_sent("link"), session.view.last_sent("address")
        assert ("step=" in link, "answer=" in link) == (is_shown, is_shown), panel
        assert f"panel={panel}" in link
        assert "step=" in address, "the browser's Back leads to steps"


@pytest.mark.parametrize("step", LESSON.steps, ids=lambda step: step.title)
def test_a_step_is_written_and_read_unchanged(step, tmp_path):
    file = tmp_path / "a.md"
    file.write_text(written(step), encoding="utf-8")
    assert read(file).steps == (step,)


GOOD = """---
title: T
question: Q
address: panel=graph
answer: {kind: number, expected: 1}
---
"""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "bad.md has no|begins with front matter"),
        ("no front matter", "begins with front matter"),
        ("---\ntitle: T\n", "begins with front matter"),
        ("---\ntitle: [\n---\n", r"bad.md, line \d+: no valid YAML"),
        ("---\n- a\n---\n", "line 2: front matter must be"),
        ("---\ntitle: T\nquestion: Q\n---\n", "address: is missing"),
        (GOOD.replace("title: T", "titel: T"), "line 2, titel: there is no such key"),
        (GOOD.replace("title: T", "title: 3"), "line 2, title: must be a text"),
        (GOOD.replace("title: T", "title: ''"), "line 2, title: is missing"),
        (GOOD.replace("number", "essay"), "line 5, answer.kind: must be one of"),
        (GOOD.replace("expected: 1", "expected: x"), "line 5, answer.expected: must be a number"),
        (GOOD.replace("{kind: number, expected: 1}", "yes please"), "line 5, answer: must be"),
        (GOOD.replace("number, expected: 1", "choice"), "line 5, answer.options: .* two options"),
        (GOOD.replace("number, expected: 1", "choice, options: [Yes, No]"), "line 5, .* in quotes"),
        (
            GOOD.replace("number, expected: 1", 'choice, options: ["Yes", "No"], expected: Yes'),
            "line 5, answer.expected: .* in quotes",
        ),
        (GOOD.replace("answer:", "offers: {Yes: panel=pose}\nanswer:"), "line 5, .* in quotes"),
        (GOOD.replace("panel=graph", "kitchen=1"), "line 4, address: .* have kitchen=1"),
        (GOOD + GOOD.replace("panel=graph", "panel=x"), "line 10, address: .* have panel=x"),
        (GOOD.replace("answer:", "offers: {A: panel=no}\nanswer:"), "line 5, offers.A: "),
        (GOOD.replace("answer:", "offers: {A: 3}\nanswer:"), "line 5, offers.A: "),
        (GOOD.replace("answer:", "plot: pie\nanswer:"), "line 5, plot: must be one of"),
        ("\xff\xfe", None),
    ],
)
def test_a_wrong_step_names_file_line_and_key(tmp_path, text, message):
    file = tmp_path / "bad.md"
    file.write_text(text, encoding="latin-1" if message is None else "utf-8")
    with pytest.raises(FileError, match=message or "cannot be read"):
        read_checked(file)


def test_recorded_steps_have_the_cameras_and_the_motions_of_their_addresses(tmp_path):
    """A step without a camera begins with the whole character, whatever was seen before it."""
    scenes = [
        "panel=pose&camera=1,2,3,0,1,0",
        "panel=compare&methods=artist,euclidean&playing=1",
        "panel=distance&wave=1&playing=1",
        "panel=weights&camera=3,2,1,0,1,0",
    ]
    file = tmp_path / "cameras.md"
    steps = (GOOD.replace("panel=graph", f"rig=rabbit&resolution=16&{one}") for one in scenes)
    file.write_text("".join(steps))
    recording = Recording(read(file))
    try:
        for index in range(len(scenes)):
            recording.record(index)
    finally:
        recording.recorder.close()
    for scene, record in zip(scenes, recording.records, strict=True):
        wanted = scene.partition("camera=")[2]
        for view in record["views"].values():
            message = view["messages"][0]
            now = message["camera"].get("now")
            seen = [] if now is None else [*now["position"], *now["focal_point"]]
            assert seen == ([float(x) for x in wanted.split(",")] if wanted else [])
            assert bool(message.get("playing")) == ("compare" in scene)
            assert bool(message.get("animation")) == ("wave" in scene)


def test_a_lesson_is_a_folder_or_one_file_of_steps(tmp_path):
    for name in ("02-b.md", "01-a.md"):
        (tmp_path / name).write_text(GOOD.replace("title: T", f"title: {name}"))
    (tmp_path / "readme.txt").write_text("no step")
    assert [step.title for step in read_checked(tmp_path).steps] == ["01-a.md", "02-b.md"]
    both = tmp_path / "both.md"
    both.write_text(GOOD + "One.\n\nTwo\nlines.\n" + GOOD)
    assert [step.text for step in read_checked(both).steps] == ["One.\n\nTwo lines.", ""]
    (tmp_path / "empty").mkdir()
    for missing in (tmp_path / "none.md", tmp_path / "empty"):
        with pytest.raises(FileError, match=missing.name):
            read_checked(missing)


def test_the_guess_of_the_path_is_scored_by_its_measured_length(session, loop):
    go(session, 1)
    loop.rest(session)
    answer(session, 0.2)
    loop.rest(session)
    captions = " ".join(resolve(session.state).views)
    expected = LESSON[1].answer.expected
    assert f"{expected:.3g}" in captions
