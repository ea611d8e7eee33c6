"""`cutcell diagnose`: findings for people and for scripts, and a repaired copy."""

import json
import re

import numpy as np
import pytest

import cutcell
from cutcell_assets import demo_path
from tests.cutcell.cli.files import BAR, JOINTS, bar_faces, refused, write_obj
from tests.cutcell.io.gltf.gltf_builder import FACES, column


@pytest.fixture
def flipped(tmp_path):
    """Save a column with some of its faces inside out."""
    faces = FACES.copy()
    faces[:6] = faces[:6, ::-1]
    return column(faces=faces).save(tmp_path / "flipped.glb")


def test_nothing_is_said_of_a_sound_rig(run, bar):
    assert run("diagnose", bar, "-r", 16).stdout == "bar.obj: nothing found\n"
    document = json.loads(run("diagnose", bar, "-r", 16, "--json").stdout)
    assert document["findings"] == []
    assert document["repair"] is None


def test_findings_are_told_to_people_and_to_scripts(run, tmp_path):
    path = write_obj(tmp_path / "open.obj", faces=bar_faces()[2:], joints=JOINTS)
    words = run("diagnose", path, "-r", 16).stdout
    assert words.startswith("open.obj: 1 note\nnote    Open rims\n")
    assert "1 open rim with 4 edges: the surface is not closed there." in words
    document = json.loads(run("diagnose", path, "-r", 16, "--json").stdout)
    assert document["counts"] == {"error": 0, "warning": 0, "note": 1}
    (finding,) = document["findings"]
    assert (finding["code"], finding["vertices"]) == ("rims", [0, 1, 2, 3])


def test_fix_saves_a_repaired_copy(run, flipped, tmp_path):
    out = tmp_path / "fixed.glb"
    document = json.loads(run("diagnose", flipped, "-r", 16, "--json", "--fix", out).stdout)
    assert document["findings"][0]["code"] == "inverted-faces"
    assert document["repair"]["codes"] == ["inverted-faces"]
    assert {result["severity"] for result in document["repair"]["findings"]} <= {"note"}
    before = flipped.read_bytes()
    words = run("diagnose", flipped, "-r", 16, "--fix", tmp_path / "again.glb").stdout
    assert re.search("before: 1 warning.*; after: (1 note|nothing found)", words)
    assert flipped.read_bytes() == before
    for name in ("fixed.glb", "again.glb"):
        again = cutcell.load(tmp_path / name)
        assert not cutcell.build_graph(again.mesh, 16).inverted.any()
        assert np.array_equal(again.mesh.vertices, cutcell.load(flipped).mesh.vertices)


def test_where_nothing_can_be_repaired_nothing_is_written(run, bar, tmp_path):
    out = tmp_path / "fixed.glb"
    words = run("diagnose", bar, "-r", 16, "--fix", out).stdout
    assert "nothing to repair: fixed.glb was not written" in words
    assert not out.exists()


def test_what_cannot_be_loaded_is_a_finding_with_exit_code_2(run, tmp_path):
    joints = [{**JOINTS[0], "parent": "tip"}, JOINTS[1]]
    path = write_obj(tmp_path / "bar.obj", BAR, joints=joints)
    shown = run("diagnose", path, "--fail-on", "error")
    assert shown.exit_code == 2
    assert '"root" -> "tip" -> "root"' in shown.stdout
    reports = run("diagnose", path, "--json")
    assert reports.exit_code == 2
    assert json.loads(reports.stdout)["findings"][0]["code"] == "cyclic-joints"


def test_fail_on_exits_with_1_for_findings_at_least_as_severe(run, bar, flipped):
    shown = run("diagnose", flipped, "-r", 16)
    assert (shown.exit_code, shown.stdout.count("warning")) == (0, 2)  # in the heading and below
    failed = run("diagnose", flipped, "-r", 16, "--fail-on", "warning")
    assert (failed.exit_code, failed.stdout) == (1, shown.stdout)
    assert run("diagnose", flipped, "-r", 16, "--fail-on", "error").exit_code == 0
    assert run("diagnose", bar, "-r", 16, "--fail-on", "warning").exit_code == 0
    document = run("diagnose", flipped, "-r", 16, "--fail-on", "warning", "--json")
    assert document.exit_code == 1
    assert json.loads(document.stdout)["counts"]["warning"] == 1


def test_fail_on_judges_the_repaired_copy_where_one_was_written(run, flipped, tmp_path):
    out = tmp_path / "fixed.glb"
    for more in ((), ("--json",)):
        fixed = run("diagnose", flipped, "-r", 16, "--fix", out, "--fail-on", "warning", *more)
        assert fixed.exit_code == 0
    assert out.is_file()
    sheet = write_obj(
        tmp_path / "sheet.obj", [[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]], JOINTS
    )
    for severity in ("error", "warning"):
        out = tmp_path / f"{severity}.glb"
        judged = run("diagnose", sheet, "-r", 16, "--fix", out, "--fail-on", severity)
        assert "was not written" in judged.stdout
        assert judged.exit_code == 1


def test_wrong_arguments_are_refused(run, bar, tmp_path):
    assert "there is no such file" in refused(run("diagnose", tmp_path / "none.glb"))
    assert "resolution" in refused(run("diagnose", bar, "-r", 1))
    assert ".stl" in refused(run("diagnose", demo_path("biped"), "--fix", tmp_path / "out.stl"))
    assert "'error', 'warning'" in refused(run("diagnose", bar, "--fail-on", "note"))
