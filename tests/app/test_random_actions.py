"""Many actions in a row lead where the same actions lead one by one."""

import random
from dataclasses import replace
from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest

from cutcell.editing import Computed, FromFile, Layer, Locked, Mask
from cutcell_app.document import loading, recording
from cutcell_app.document.address import snapshot
from cutcell_app.editing.binding.recovery import is_current
from cutcell_app.editing.correct import commands as correct
from cutcell_app.editing.correct import moving
from cutcell_app.shell.session import export, keys
from cutcell_app.shell.session.begin import begin
from tests.app.loop import Loop
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
