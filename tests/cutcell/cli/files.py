"""A square bar as files, right or wrong, and what a refusal must look like."""

import json
from pathlib import Path

BAR = [[x, y, z] for z in (0, 1, 2) for y in (0, 1) for x in (0, 1)]
JOINTS = [
    {"name": "root", "position": [0.5, 0.5, 0.1], "parent": None},
    {"name": "tip", "position": [0.5, 0.5, 1.9], "parent": "root"},
]


def bar_faces() -> list[list[int]]:
    """Return a square bar of two cubes, closed, wound outwards."""
    quads = [[0, 2, 3, 1], [8, 9, 11, 10]]
    for base in (0, 4):
        quads += [[base + i for i in q] for q in ([0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2])]
        quads += [[base + i for i in (1, 3, 7, 5)]]
    return [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]


def write_obj(path: Path, vertices=BAR, faces=None, joints=None) -> Path:
    faces = bar_faces() if faces is None else faces
    lines = [f"v {x} {y} {z}" for x, y, z in vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    path.write_text("\n".join(lines) + "\n")
    if joints is not None:
        path.with_suffix(".json").write_text(json.dumps({"joints": joints}))
    return path


def refused(result) -> str:
    """Return the sentence of a refusal, once it is sure that it is one."""
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert result.stderr.count("error:") == 1
    assert len(result.stderr.strip().splitlines()) == 1
    return result.stderr.strip()
