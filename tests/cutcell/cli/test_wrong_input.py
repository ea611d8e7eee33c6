"""Wrong files and options: one sentence on stderr, exit code 2, nothing written."""

import re

import pytest

from tests.cutcell.cli.files import BAR, JOINTS, refused, write_obj


def cycle() -> list[dict]:
    return [
        {"name": "a", "position": [0, 0, 0], "parent": "b"},
        {"name": "b", "position": [0, 0, 1], "parent": "a"},
    ]


WRONG = {
    "no faces": ({"faces": []}, "face|triangle"),
    "nan": ({"vertices": [["nan"] * 3, *BAR[1:]]}, "finite|number"),
    "index out of range": ({"faces": [[0, 1, 99]]}, "vert"),
    "cycle": ({"joints": cycle()}, 'cycle: "[ab]" -> "[ab]" -> "[ab]"'),
    "no joints": ({"joints": []}, "no joints"),
    "joint far outside": (
        {"joints": [{**JOINTS[0], "position": [0, 0, 4000]}]},
        '"root" .* times the mesh\'s size away',
    ),
}


@pytest.mark.parametrize("command", ["bind", "graph"])
class TestWrongInput:
    def words(self, command, rig, tmp_path):
        return [command, rig, *([tmp_path / "out.glb"] if command == "bind" else [])]

    def test_missing_file(self, run, tmp_path, command):
        rig = tmp_path / "nope.glb"
        assert "no such file" in refused(run(*self.words(command, rig, tmp_path)))

    def test_text_named_glb(self, run, tmp_path, command):
        rig = tmp_path / "text.glb"
        rig.write_text("This is a letter, not a character.\n")
        assert "text.glb" in refused(run(*self.words(command, rig, tmp_path)))

    @pytest.mark.parametrize("case", WRONG)
    def test_wrong_content(self, run, tmp_path, command, case):
        changed, sentence = WRONG[case]
        rig = write_obj(tmp_path / "wrong.obj", **{"joints": JOINTS, **changed})
        reports = refused(run(*self.words(command, rig, tmp_path)))
        assert re.search(sentence, reports)
        assert re.search(r"wrong\.(obj|json)", reports)

    @pytest.mark.parametrize("resolution", [1, 10_000, -3])
    def test_resolution_out_of_range(self, run, bar, tmp_path, command, resolution):
        words = self.words(command, bar, tmp_path)
        reports = refused(run(*words, "--resolution", resolution))
        assert "resolution must be a whole number from 2 to 1,024" in reports
        assert not (tmp_path / "out.glb").exists()

    @pytest.mark.parametrize(
        ("option", "value"),
        [
            ("connectivity", 7),
            ("connectivity", "all"),
            ("winding-threshold", 1.5),
            ("samples", 0),
            ("leaf", "twig"),
        ],
    )
    def test_parameter_out_of_range(self, run, bar, tmp_path, command, option, value):
        reports = refused(run(*self.words(command, bar, tmp_path), f"--{option}", value))
        assert f"{option.replace('-', '_')} must be" in reports


@pytest.mark.parametrize(
    ("option", "value"),
    [("falloff", "steep"), ("alpha", 2), ("max-influences", 0), ("threshold", -1)],
)
def test_weights_parameter_out_of_range(run, bar, tmp_path, option, value):
    reports = refused(run("bind", bar, tmp_path / "out.glb", f"--{option}", value))
    assert f"{option.replace('-', '_')} must be" in reports
