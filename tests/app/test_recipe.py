"""*Copy as Python* and *Copy as command*: running them gives the weights that the page exports."""

import os
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import cutcell
from cutcell.editing import Edits, Filled, FromFile, JointEdit, Layer, Mask, Painted
from cutcell.rig import Rig, Skeleton, TriangleMesh
from cutcell_app.document import loading
from cutcell_app.document.document import Repair
from cutcell_app.document.method import options_of
from cutcell_app.editing.correct import commands as correct
from cutcell_app.shell.export_code import copy_command, copy_script
from cutcell_app.shell.recipe import Recipe, command_of, script_of
from cutcell_app.shell.session.export import export_bound
from tests.cutcell.cli.conftest import run
from tests.viewers.arm import arm_rig

__all__ = ["run"]

CHOICES = [
    {},
    {"resolution": 12, "max_influences": 2, "threshold": 0.05},
    {"connectivity": 6, "winding_threshold": 0.4, "orient": False, "leaf": "extend"},
    {"falloff": "paper", "alpha": 0.3, "max_influences": 2},
]


@pytest.fixture
def page(session, loop, tmp_path, monkeypatch):
    """Open a file whose name needs quotes; return what is copied."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "it's an arm.glb"
    cutcell.save(path, arm_rig())
    session.state.param.update(resolution=16, graph_resolution=0)
    loading.load_files(session, [path])
    loop.run_until(lambda: session.state.rig is not None)
    correct.choose_file(session, False)
    loop.run_until(lambda: session.state.binding is not None)
    copied = []
    session.view.answer = lambda copy: copied.append(copy["text"])
    session.view.offer = lambda name, content: _written(Path(name), content)
    return session, copied


def exported(session, loop):
    """Return the content of the page's GLB, and remove a file of its name."""
    files = []
    export_bound(session, lambda *file: files.append(file))
    loop.run_until(lambda: bool(files))
    ((name, content),) = files
    Path(name).unlink(missing_ok=True)
    return name, cutcell.load(_written(Path("page.glb"), content))


def _written(path, content):
    path.write_bytes(content)
    return path


def check_same(name, expected):
    """Check that a file of this name was written with the same weights and joints."""
    actual = cutcell.load(name)
    Path(name).unlink()
    assert actual.skeleton.names == expected.skeleton.names
    np.testing.assert_array_equal(actual.skeleton.joints, expected.skeleton.joints)
    np.testing.assert_array_equal(actual.weights, expected.weights)


@pytest.mark.parametrize("choices", CHOICES)
def test_running_what_is_copied_gives_the_weights_of_the_page(page, loop, run, choices):
    session, copied = page
    session.state.param.update(**choices)
    loop.rest(session)
    name, expected = exported(session, loop)
    copy_script(session)
    exec(copied[-1], {})
    check_same(name, expected)
    copy_command(session)
    result = run(*shlex.split(copied[-1])[1:])
    assert result.exit_code == 0, result.stderr
    check_same(name, expected)
    assert session.state.message is None


def check_copies(page, loop, run):
    """Check that script and command give what the page exports; return the script."""
    session, copied = page
    loop.rest(session)
    name, expected = exported(session, loop)
    copy_command(session)
    result = run(*shlex.split(copied[-1])[1:])
    assert result.exit_code == 0, result.stderr
    check_same(name, expected)
    copy_script(session)
    exec(copied[-1], {})
    check_same(name, expected)
    return copied[-1]


def test_edits_are_read_from_the_file_that_comes_with_the_copy(page, loop, run):
    session, _ = page
    rig = session.state.rig
    names, joints = rig.skeleton.names, rig.skeleton.joints
    painted = Painted(np.array([3]), [names[2]], np.array([[1.0]]))
    correct.correct(
        session,
        Edits(
            joints={names[1]: JointEdit(position=tuple(np.add(joints[1], [0.02, 0, 0])))},
            layers=[
                Layer(FromFile(), Mask(vertices=[7, 9]), opacity=0.5),
                Layer(Filled({names[0]: 1}), Mask(part=0), opacity=0.25),
                Layer(painted),
            ],
        ),
    )
    session.state.max_influences = 2
    check_copies(page, loop, run)
    file = correct.file_name(session)
    assert file in session.state.message[1]
    assert Edits.load(file).layers == session.state.edits.layers


def test_the_file_s_weights_as_the_base_are_in_the_script_itself(page, loop, run):
    session, _ = page
    correct.choose_file(session, True)
    script = check_copies(page, loop, run)
    assert "cutcell.Edits(base='file')" in script


def test_a_file_that_holds_layers_is_bound_over_the_weights_below_them(page, loop, run):
    session, _ = page
    rig, own = session.state.rig, session.state.own
    painted = Painted(np.array([3]), [rig.skeleton.names[2]], np.array([[1.0]]))
    correct.correct(session, Edits(base="file", layers=[Layer(painted)]))
    loop.rest(session)
    files = []
    export_bound(session, lambda *file: files.append(file))
    loop.run_until(lambda: bool(files))
    loading.load_files(session, [_written(Path("layered.glb"), files[0][1])])
    loop.run_until(lambda: session.state.own is not own)
    loop.rest(session)
    correct.correct(session, replace(session.state.edits, layers=()))
    assert "with_base(rig)" in check_copies(page, loop, run)


@pytest.mark.slow
def test_a_demo_is_copied_with_the_place_of_its_file(session, loop, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    copied = []
    session.view.answer = lambda copy: copied.append(copy["text"])
    session.state.param.update(resolution=16, falloff="paper")
    loading.load_demo(session, "rabbit")
    loop.run_until(lambda: session.state.binding is not None)
    name, expected = exported(session, loop)
    copy_command(session)
    scripts = Path(sys.executable).parent
    environment = {**os.environ, "PATH": f"{scripts}{os.pathsep}{os.environ['PATH']}"}
    line = copied[-1].replace("cutcell bind", "python -m cutcell bind")
    subprocess.run(line, shell=True, check=True, env=environment, capture_output=True)
    check_same(name, expected)
    copy_script(session)
    exec(copied[-1], {})
    check_same(name, expected)


def test_only_options_that_differ_are_named():
    assert options_of(cutcell.ANIMATION) == {}
    assert options_of(cutcell.PAPER) == {"method": "paper"}
    assert options_of(cutcell.PAPER.with_options(alpha=0.2)) == {"method": "paper", "alpha": 0.2}
    method = cutcell.ANIMATION.with_options(falloff="paper", leaf="fit", resolution=32)
    assert options_of(method) == {"falloff": "paper", "leaf": "fit", "resolution": 32}
    for one in (method, cutcell.PAPER.with_options(connectivity=26, orient=False)):
        assert cutcell.method.method_of(**{"method": "animation", **options_of(one)}) == one


def test_of_several_characters_r_counts_along_the_whole_mesh():
    rig = arm_rig()
    vertices = np.concatenate([rig.mesh.vertices, np.add(rig.mesh.vertices, [9, 0, 0])])
    faces = np.concatenate([rig.mesh.faces, rig.mesh.faces + len(rig.mesh.vertices)])
    joints, count = rig.skeleton.joints, len(rig.skeleton.joints)
    parents = [*rig.skeleton.parents, *(p + count if p >= 0 else -1 for p in rig.skeleton.parents)]
    allowed = np.kron(np.eye(2), np.ones((len(rig.mesh.vertices), count))) > 0
    two = Rig(
        TriangleMesh(vertices, faces),
        Skeleton(np.concatenate([joints, np.add(joints, [9, 0, 0])]), parents),
        allowed=allowed,
    )
    recipe = Recipe(
        two, "two.glb", "", cutcell.ANIMATION, Edits(), "two.layers.json", False, "two-bound.glb"
    )
    assert "resolution=64" in script_of(recipe)
    assert "--resolution 64" in command_of(recipe)
    assert "--" not in command_of(replace(recipe, rig=rig))


def test_what_cannot_be_computed_again_is_not_copied(bound):
    state, copied = bound.state, []
    bound.view.answer = lambda copy: copied.append(copy)
    state.repair = Repair((("duplicate-faces",),), state.rig, {}, ())
    copy_script(bound)
    assert "Export the GLB" in state.message[1]
    state.param.update(repair=None, rig=None)
    copy_command(bound)
    assert (copied, state.message[0]) == ([], "info")
