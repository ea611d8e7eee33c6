# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on a tube: locks, masks, undo, and each way that they can fail."""

import os
import signal
import sys
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from conftest import arm, grid, select, weights


def fails(message, operator=None, **options):
    """Assert that an operator reports an error."""
    with pytest.raises(RuntimeError, match=message):
        (operator or bpy.ops.object.cutcell_parent)(**options)


def test_a_mesh_is_parented_and_every_vertex_gets_weight(tube):
    mesh, armature = tube
    mesh.location.x, armature.location.x = 5, 5
    bpy.context.view_layer.update()
    world = np.array(mesh.matrix_world)
    assert bpy.ops.object.cutcell_parent(resolution=16) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert mesh.parent == armature
    assert [m.object for m in mesh.modifiers if m.type == "ARMATURE"] == [armature]
    assert np.allclose(mesh.matrix_world, world)
    assert np.allclose(weights(mesh).sum(axis=1), 1, atol=1e-6)
    bpy.ops.object.cutcell_parent(resolution=16)
    assert len(mesh.modifiers) == 1


def test_bones_without_deform_get_no_weight(tube):
    mesh, armature = tube
    armature.data.bones["bone1"].use_deform = False
    bpy.ops.object.cutcell_parent(resolution=16)
    assert {group.name for group in mesh.vertex_groups} == {"bone0", "bone2"}


@pytest.mark.parametrize("operator", ["cutcell_parent", "cutcell_clean"])
def test_locked_groups_stay_to_the_bit_and_others_share_the_rest(tube, operator):
    mesh, _ = tube
    bpy.ops.object.cutcell_parent(resolution=16)
    rng = np.random.default_rng(0)
    group = mesh.vertex_groups["bone1"]
    for vertex in mesh.data.vertices:
        group.add((vertex.index,), float(rng.random()), "REPLACE")
    group.lock_weight = True
    before = weights(mesh)[:, group.index]
    getattr(bpy.ops.object, operator)(resolution=16)
    after = weights(mesh)
    assert np.array_equal(after[:, group.index], before)
    if operator == "cutcell_parent":
        assert np.allclose(after.sum(axis=1), 1, atol=1e-6)


def test_masked_vertices_of_weight_paint_mode_stay(tube):
    mesh, _ = tube
    bpy.ops.object.cutcell_parent(resolution=16)
    before = weights(mesh)
    select(mesh)
    for vertex in mesh.data.vertices:
        vertex.select = vertex.co.x < 1.5
    mesh.data.use_paint_mask_vertex = True
    selected = np.array([vertex.select for vertex in mesh.data.vertices])
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    bpy.ops.object.cutcell_parent(resolution=16, influences=1)
    bpy.ops.object.mode_set(mode="OBJECT")
    after = weights(mesh)
    assert np.array_equal(after[~selected], before[~selected])
    assert ((after[selected] > 0).sum(axis=1) == 1).all()


def test_undo_restores_everything(tube):
    mesh, armature = tube
    select(mesh, armature)
    bpy.ops.object.cutcell_parent(resolution=16)
    before = weights(mesh)
    bpy.ops.ed.undo_push(message="bound")
    bpy.ops.object.cutcell_parent(resolution=16, influences=1)
    bpy.ops.ed.undo_push(message="bound again")
    mesh = bpy.data.objects["Tube"]
    assert not np.array_equal(weights(mesh), before)
    bpy.ops.ed.undo()
    assert np.array_equal(weights(bpy.data.objects["Tube"]), before)


def test_a_garment_gets_the_weights_of_the_body(tube):
    mesh, armature = tube
    bpy.ops.object.cutcell_parent(resolution=16)
    garment = grid("Coat", 3.0, radius=0.32)
    select(garment, mesh)
    assert bpy.ops.object.cutcell_transfer() == {"FINISHED"}
    assert garment.parent == armature
    names = [bone.name for bone in armature.data.bones]
    assert np.abs(weights(garment, names) - weights(mesh, names)).max() < 0.1
    assert np.allclose(weights(garment).sum(axis=1), 1, atol=1e-6)


def test_diagnosis_explains_a_vertex(tube, capfd):
    mesh, _ = tube
    bpy.ops.object.cutcell_parent(resolution=16)
    select(mesh)
    assert bpy.ops.object.cutcell_diagnose(resolution=16, vertex=5) == {"FINISHED"}
    output = capfd.readouterr().out
    assert "bone0: weight" in output
    assert "through the body" in output


def test_weights_come_back_from_a_file(tube, tmp_path):
    from bl_ext.user_default.cutcell.character import gather
    from bl_ext.user_default.cutcell.operator_base import worker

    mesh, armature = tube
    bpy.ops.object.cutcell_parent(resolution=16)
    before, path = weights(mesh), tmp_path / "rig.npz"
    arrays = gather([mesh], armature, editable=False).arrays
    for _ in worker().run("save", arrays, {"path": str(path)}, 0.1):
        pass
    bpy.ops.object.cutcell_parent(resolution=16, influences=1)
    select(mesh)
    assert bpy.ops.object.cutcell_take("EXEC_DEFAULT", filepath=str(path)) == {"FINISHED"}
    assert np.allclose(weights(mesh), before, atol=1e-6)
    mesh.data.vertices[0].co.z += 1
    fails("vertices at other places", bpy.ops.object.cutcell_take, filepath=str(path))


@pytest.mark.skipif(sys.platform == "win32", reason="the program is a shell script")
def test_the_page_is_opened_on_the_character(tube, tmp_path, extension):
    bpy.ops.object.cutcell_parent(resolution=16)
    program = tmp_path / "cutcell"
    program.write_text(f'#!/bin/sh\nls -l "$2" > {tmp_path}/opened\n')
    program.chmod(0o755)
    preferences = bpy.context.preferences.addons[extension].preferences
    preferences.program = str(program)
    assert bpy.ops.object.cutcell_open() == {"FINISHED"}
    preferences.program = str(tmp_path / "missing")
    fails("pip install", bpy.ops.object.cutcell_open)


def test_two_objects_are_bound_together(tube):
    mesh, armature = tube
    other = grid("Other", 3.0)
    other.location.y = 2
    bpy.context.view_layer.update()
    select(mesh, other, armature)
    bpy.ops.object.cutcell_parent(resolution=32)
    for obj in (mesh, other):
        assert np.allclose(weights(obj).sum(axis=1), 1, atol=1e-6)


def test_negative_scale_and_shape_keys_change_no_weight(tube):
    mesh, _ = tube
    bpy.ops.object.cutcell_parent(resolution=16)
    before = weights(mesh)
    mesh.data.transform(((1, 0, 0, 0), (0, -1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)))
    mesh.scale.y = -1
    mesh.shape_key_add(name="Basis")
    key = mesh.shape_key_add(name="Raised", from_mix=False)
    for point in key.data:
        point.co.z += 1
    key.value = 1.0
    bpy.context.view_layer.update()
    bpy.ops.object.cutcell_parent(resolution=16)
    assert np.allclose(weights(mesh), before, atol=1e-6)
    assert [key.name for key in mesh.data.shape_keys.key_blocks] == ["Basis", "Raised"]


def test_what_cannot_be_bound_is_reported(tube):
    mesh, armature = tube
    empty = bpy.data.objects.new("Empty", bpy.data.meshes.new("Empty"))
    bpy.context.collection.objects.link(empty)
    select(empty, armature)
    fails('"Empty" has no faces')
    bare = bpy.data.objects.new("Bare", bpy.data.armatures.new("Bare"))
    bpy.context.collection.objects.link(bare)
    select(mesh, bare)
    fails('"Bare" has no bones')
    select(mesh)
    fails("one armature")
    select(armature)
    fails("No mesh is selected")
    twin = bpy.data.objects.new("Twin", mesh.data)
    bpy.context.collection.objects.link(twin)
    select(mesh, twin, armature)
    fails("share one mesh")
    armature.parent = mesh
    select(mesh, armature)
    fails("Loop in parents")
    armature.parent = None
    mesh.modifiers.new("Armature", "ARMATURE").object = armature
    fails("have no weights", bpy.ops.object.cutcell_clean)
    assert not mesh.vertex_groups
    assert mesh.parent is None


def test_linked_meshes_are_reported(tube, tmp_path):
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, target):
        target.objects = ["Tube"]
    bpy.context.collection.objects.link(target.objects[0])
    select(target.objects[0], arm())
    fails("is linked from")


@pytest.mark.skipif(sys.platform == "win32", reason="processes are stopped by signals")
def test_a_killed_worker_changes_nothing_and_the_next_job_starts_another(tube):
    from bl_ext.user_default.cutcell.operator_base import worker

    mesh, _ = tube
    bpy.ops.object.cutcell_parent(resolution=16)
    before = weights(mesh)
    process = worker().process
    os.kill(process.pid, signal.SIGSTOP)  # so that the job cannot end before
    steps = worker().run("bind", {}, {}, 0.1)
    next(steps)
    os.kill(process.pid, signal.SIGKILL)
    with pytest.raises(Exception, match="worker process ended"):
        for _ in steps:
            pass
    assert np.array_equal(weights(mesh), before)
    assert bpy.ops.object.cutcell_parent(resolution=16) == {"FINISHED"}


@pytest.fixture
def modal(tube):
    """Return what runs an operator as the window does, its reports and its events."""
    from bl_ext.user_default.cutcell.character import gather
    from bl_ext.user_default.cutcell.operator_base import WorkerOperator

    reports, removed = [], []

    class Operator(WorkerOperator):
        bl_label = "Operator"
        _timer = "timer"

        def report(self, kind, text):
            reports.append((*kind, text))

        def request(self, context):
            options = {"method": "animation", "options": {"resolution": 16}}
            return "bind", gather(tube[:1], tube[1]).arrays, options

        def finish(self, context, arrays, result):
            return "Bound"

    manager = SimpleNamespace(event_timer_remove=removed.append)
    workspace = SimpleNamespace(status_text_set=lambda text: None)
    context = SimpleNamespace(window_manager=manager, workspace=workspace)
    operator = Operator()
    operator._job = operator._steps(context, 0.01)

    def send(kind):
        return operator.modal(context, SimpleNamespace(type=kind, value="PRESS"))

    return send, reports, removed


def test_in_the_window_a_job_ends_with_a_message_and_without_its_timer(modal):
    send, reports, removed = modal
    assert send("LEFTMOUSE") == {"RUNNING_MODAL"}  # nothing can be edited meanwhile
    assert send("MIDDLEMOUSE") == {"PASS_THROUGH"}
    while (state := send("TIMER")) == {"RUNNING_MODAL"}:
        pass
    assert (state, reports, removed) == ({"FINISHED"}, [("INFO", "Bound")], ["timer"])


def test_escape_cancels(modal):
    from bl_ext.user_default.cutcell.operator_base import worker

    send, reports, removed = modal
    assert send("TIMER") == {"RUNNING_MODAL"}
    assert send("ESC") == {"CANCELLED"}
    assert worker().process is None
    assert reports[0][0] == "WARNING"
    assert removed == ["timer"]
