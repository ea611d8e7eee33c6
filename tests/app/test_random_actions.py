"""Many actions in a row lead where the same actions lead one by one."""

import random
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import cutcell
from cutcell.editing import Computed, FromFile, Layer, Locked, Mask
from cutcell_app.document import loading, opening, recording
from cutcell_app.document.address import snapshot
from cutcell_app.document.document import applied
from cutcell_app.document.method import effective, method_of
from cutcell_app.document.opening import Request
from cutcell_app.document.session import Session
from cutcell_app.editing.binding import recovery
from cutcell_app.editing.binding.recovery import is_current
from cutcell_app.editing.brush.strokes import clear_selection, select
from cutcell_app.editing.correct import commands as correct
from cutcell_app.editing.correct import moving, templates
from cutcell_app.editing.layers.masks import MASKS
from cutcell_app.editing.select import bones, saved
from cutcell_app.features.check import results as check
from cutcell_app.features.learn import steps
from cutcell_app.features.learn.lesson import read
from cutcell_app.files.reading import load_with_materials
from cutcell_app.shell.export_code import recipe_of
from cutcell_app.shell.session import export, keys
from cutcell_app.shell.session.begin import begin
from tests.app.loop import Loop
from tests.app.test_bare import bare_arm
from tests.app.test_document import everything, faulty_arm, same
from tests.viewers.arm import arm_rig

RIGS = (arm_rig(), arm_rig())
CHOICES = {
    "resolution": (12, 16),
    "falloff": ("rig", "paper"),
    "leaf": ("point", "fit"),
    "max_influences": (2, 4, 8),
    "alpha": (0.3, 0.7),
    "panel": ("graph", "distance", "weights", "pose", "check", "compare"),
    "joint": (0, 1, 2),
    "vertex": (None, 7),
    "explain": (False, True),
    "heat": (False, True),
    "edge_colors": ("kind", "distance"),
    "beside_straight": (False, True),
    "beside_6": (False, True),
    "weights_shown": ("bone", "mix"),
}


def choose(session, rng, files):
    name = rng.choice(list(CHOICES))
    setattr(session.state, name, rng.choice(CHOICES[name]))


def correct_something(session, rng, files):
    state = session.state
    names = state.rig.skeleton.names
    layers = [
        Layer(Computed(gain={rng.choice(names): 1.5})),
        Layer(FromFile(), Mask(part=0)),
        Layer(Computed({"resolution": 10}), Mask(vertices=[1, 2, 3]), opacity=0.5),
        Layer(Locked([rng.choice(names)])),
    ]
    some = [layer for layer in layers if rng.random() < 0.4]
    base = rng.choice(("computed", "file"))
    correct.correct(session, replace(state.edits, layers=some, base=base))


def move(session, rng, files):
    state = session.state
    moving.put(session, state.rig.skeleton.joints[state.joint] + rng.choice((0.01, -0.01)))


def swap_bones(session, rng, files):
    names = session.state.rig.skeleton.names
    session.state.other_bone = rng.choice(names)
    rng.choice((bones.swap, bones.replace_bone))(session)


def change_mask(session, rng, files):
    state = session.state
    state.layer = rng.randrange(len(state.edits.layers)) if state.edits.layers else None
    select(session, np.arange(len(state.rig.mesh.vertices)) % rng.randint(2, 5) == 0)
    MASKS[rng.choice(list(MASKS))](session)
    state.message = None
    clear_selection(session)


def save_selection(session, rng, files):
    select(session, np.arange(len(session.state.rig.mesh.vertices)) % rng.randint(2, 5) == 0)
    saved.save(session, rng.choice("ab"))
    rng.choice((saved.forget, clear_selection))(session)
    clear_selection(session)


def export_something(session, rng, files):
    export.export_numbers(session, "weights", "npz", lambda *file: files.append(file))


def undo(session, rng, files):
    keys.act(session, rng.choice(("undo", "undo", "redo")))


def open_another(session, rng, files):
    loading.show_rig(session, rng.choice(RIGS))


ACTIONS = (
    *[choose] * 12,
    *[correct_something] * 3,
    *[move] * 2,
    swap_bones,
    change_mask,
    save_selection,
    export_something,
    undo,
    open_another,
)


def after(seed, waits, monkeypatch):
    """Return a session after 200 actions, waiting after each, after some, or after none."""
    clock = count(1000.0, 60.0)  # undo joins what follows within moments
    monkeypatch.setattr(recording, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    rng, pauses, loop, files = random.Random(seed), random.Random(-seed), Loop(), []
    session = begin(loop)
    session.state.param.update(resolution=12, graph_resolution=0, beside_resolution=16)
    loading.show_rig(session, RIGS[0])
    for _ in range(200):
        rng.choice(ACTIONS)(session, rng, files)
        if pauses.random() < waits:
            loop.rest(session)
        else:
            loop.run_for(0)
    loop.run_until(lambda: not session.work.busy and not session.exports)
    return session, files


WEIGHTS = {
    "open_demo": 1, "open_file": 1, "open_bad_file": 1, "back": 1, "travel": 5, "repair": 1,
    "meanwhile": 2, "template": 1, "step": 1, "render": 1, "edit": 6, "choose": 3, "cancel": 2,
}  # fmt: skip
"""How often a person does what, beside the others."""


@dataclass
class Person:
    """A person at a page, and what they have at hand."""

    session: Session
    loop: Loop
    rng: random.Random
    folder: Path
    files: list = field(default_factory=list)
    addresses: list[str] = field(default_factory=list)

    def open_demo(self):
        loading.load_demo(self.session, self.rng.choice(("robot", "rabbit", "octopus")))

    def open_file(self):
        loading.load_files(self.session, [self.folder / "arm.glb"])

    def open_bad_file(self):
        loading.load_files(self.session, [self.folder / "bad.glb"])

    def back(self):
        gone = ["?rig=~gone&bone=wrist&resolution=16", "?rig=nobody"]
        loading.visit(self.session, self.rng.choice([*self.addresses, *gone]))

    def travel(self):
        keys.act(self.session, self.rng.choice(("undo", "undo", "redo")))

    def repair(self):
        findings = self.session.state.diagnosis
        codes = [] if findings is None else [one.code for one in findings.findings if one.repair]
        if codes:
            check.repair(self.session, self.rng.sample(codes, self.rng.randint(1, len(codes))))
        elif self.rng.random() < 0.5:
            check.take_back(self.session)

    def template(self):
        if self.session.state.bare and self.session.state.graph is not None:
            templates.fit(self.session, "chain")

    def step(self):
        steps.go(self.session, self.rng.choice((0, 1, -1)))

    def render(self):
        export.export_picture(self.session, lambda *file: self.files.append(file))

    def edit(self):
        if not self.session.state.bare and self.session.state.binding is not None:
            action = self.rng.choice(
                (correct_something, move, swap_bones, change_mask, save_selection)
            )
            action(self.session, self.rng, self.files)

    def choose(self):
        name = self.rng.choice([name for name in CHOICES if name != "joint"])
        setattr(self.session.state, name, self.rng.choice(CHOICES[name]))

    def cancel(self):
        """Begin something that opens a character, and cancel it."""
        before = everything(self.session)
        self.rng.choice((self.open_file, self.open_demo, self.back, self.travel))()
        if self.session.tasks.running:
            recovery.cancel(self.session)
            self.loop.rest(self.session)
            assert same(everything(self.session), before)

    def meanwhile(self):
        """Edit while a repair runs."""
        self.repair()
        self.edit()

    def act(self):
        """Do something, and wait."""
        name = self.rng.choices([*WEIGHTS], [*WEIGHTS.values()])[0]
        getattr(self, name)()
        self.loop.run_until(lambda: not self.session.work.busy and not self.session.exports)
        return name

    def check(self):
        """Check that page, file, command and address say the same."""
        state, session = self.session.state, self.session
        text = (state.message or ("", ""))[1]
        assert "Unexpected" not in text
        assert (state.busy, session.tasks.running, session.exports) == (False, "", [])
        agree(state.rig, applied(state.own, state.repair, state.edits))
        assert session.source == (f"demo {state.demo}" if state.demo else "~")
        if state.bare or state.binding is None:
            return
        assert is_current(session)
        weights, got = state.binding.weights, []
        options = effective(method_of(state))
        core = cutcell.bind(state.rig, edits=state.edits, **options)
        np.testing.assert_allclose(weights, core.weights, rtol=0, atol=1e-9)
        export.export_bound(session, lambda *file: got.append(file))
        self.loop.run_until(lambda: bool(got))
        path = self.folder / "exported.glb"
        path.write_bytes(got[0][1])
        agree(cutcell.load(path), state.rig.with_weights(weights), 1e-4)
        if state.repair is None or not state.repair.codes:
            recipe = recipe_of(session)
            assert (recipe.rig, recipe.demo, recipe.edits) == (state.rig, state.demo, state.edits)
            assert recipe.method == cutcell.Method(**options)
        address = recording.query(session)
        self.addresses = [*self.addresses[-5:], f"?{address}"]
        other = begin(self.loop)
        try:
            other.paths = session.paths
            other.state.lesson = state.lesson
            loading.arrive(other, address, Request("~"))
            self.loop.run_until(lambda: not other.work.busy)
            agree(other.state.rig, state.rig)
            assert other.state.edits == state.edits
            np.testing.assert_allclose(other.state.binding.weights, weights, rtol=0, atol=1e-9)
        finally:
            other.close()


def agree(one, other, tolerance=0.0):
    """Check that two rigs have the same faces, joints and weights."""
    assert one.skeleton.names == other.skeleton.names
    assert len(one.mesh.faces) == len(other.mesh.faces)
    np.testing.assert_allclose(one.skeleton.joints, other.skeleton.joints, atol=tolerance)
    if one.weights is not None:
        np.testing.assert_allclose(one.weights, other.weights, atol=tolerance)


STEP = "---\ntitle: T\nquestion: Q\naddress: {}\nanswer: {{kind: vertex}}\n---\n"


@pytest.fixture
def person(monkeypatch, tmp_path, loop, request):
    """Let a person act whose demos and files are arms, of which some are faulty or bare."""
    demos = {"robot": arm_rig(), "rabbit": faulty_arm(), "octopus": bare_arm()}
    cutcell.save(tmp_path / "arm.glb", faulty_arm())
    (tmp_path / "bad.glb").write_text("no character")
    (tmp_path / "steps.md").write_text(
        STEP.format("rig=robot&panel=weights&resolution=12")
        + STEP.format("rig=rabbit&panel=graph&resolution=12")
    )
    monkeypatch.setattr(opening, "demo_rig", demos.get)
    monkeypatch.setattr(opening, "read", lambda path, check: load_with_materials(path))
    monkeypatch.setattr(export, "draw_isolated", lambda order, path, report: path.touch())
    monkeypatch.setattr(export, "in_process", lambda act, *args, check, ended: act(*args))
    clock = count(1000.0, 60.0)
    monkeypatch.setattr(recording, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    session = begin(loop)
    session.state.param.update(resolution=12, graph_resolution=0, beside_resolution=16)
    session.state.lesson = read(tmp_path / "steps.md")
    loading.load_demo(session, "robot")
    loop.rest(session)
    yield Person(session, loop, random.Random(request.param[0]), tmp_path)
    session.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("person", "actions"),
    [((1,), 40), *(pytest.param((seed,), 200, marks=pytest.mark.nightly) for seed in range(2, 7))],
    indirect=["person"],
)
def test_page_file_command_and_address_always_say_the_same(person, actions):
    done = []
    for _ in range(actions):
        done.append(person.act())
        try:
            person.check()
        except AssertionError as error:
            error.add_note(f"after {len(done)} actions, the last of them {done[-6:]}")
            raise


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.nightly)])
def test_hurry_changes_nothing(seed, monkeypatch):
    calm, files = after(seed, 1.0, monkeypatch)
    try:
        for waits in (0.0, 0.3):
            hasty, more = after(seed, waits, monkeypatch)
            try:
                state, expected = hasty.state, calm.state
                assert snapshot(state) == snapshot(expected)
                assert not state.busy
                assert not state.computing
                assert is_current(hasty)
                assert hasty.exports == []
                np.testing.assert_allclose(
                    state.binding.weights, expected.binding.weights, rtol=0, atol=1e-9
                )
                assert state.measured.keys() == expected.measured.keys()
                assert (state.explanation is None) == (expected.explanation is None)
                assert len(more) <= len(files)
            finally:
                hasty.close()
    finally:
        calm.close()
