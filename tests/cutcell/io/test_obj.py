"""OBJ text, read by numpy where it is regular, against a reader of words."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cutcell.io.obj import parse_obj

FORMS = ("{v}", "{v}/{t}", "{v}//{n}", "{v}/{t}/{n}")


def text(rng, forms, sep=" ", negative=False, materials=False):
    """Return an OBJ of random triangles whose corners have one of some forms each."""
    lines, counts = [], [0, 0, 0]
    for _ in range(20):
        for k, kind in enumerate(("v", "vt", "vn")):
            width = 2 if kind == "vt" else 3
            for row in rng.normal(size=(3, width)).round(3):
                lines.append(sep.join([kind, *map(str, row)]))
                counts[k] += 1
        if materials:
            lines.append(f"usemtl m{rng.integers(3)}")
        for _ in range(2):
            words = []
            for vertex in rng.choice(counts[0], 3, replace=False) + 1:
                numbers = [vertex, *(rng.integers(count) + 1 for count in counts[1:])]
                if negative:
                    numbers = [n - count - 1 for n, count in zip(numbers, counts, strict=True)]
                names = dict(zip("vtn", numbers, strict=True))
                words.append(forms[rng.integers(len(forms))].format(**names))
            lines.append(sep.join(["f", *words]))
    return "\n".join(lines) + "\n"


def by_words(content):
    """Return faces, places, normals and materials of corners, one word after the other."""
    stored = {"v": [], "vt": [], "vn": []}
    faces, places, normals, materials, material = [], [], [], [], ""
    for kind, *words in map(str.split, content.splitlines()):
        if kind in stored:
            stored[kind].append([float(word) for word in words])
        elif kind == "usemtl":
            material = words[0]
        elif kind == "f":
            corners = []
            for word in words:
                numbers = [int(part or 0) for part in [*word.split("/"), "", ""][:3]]
                tables = zip(numbers, stored.values(), strict=True)
                corners.append([n + len(table) if n < 0 else n - 1 for n, table in tables])
            at = np.array(corners)
            faces.append(at[:, 0])
            here = [stored["vt"][k] if k >= 0 else [0, 0] for k in at[:, 1]]
            places.append([[u, 1 - v] for u, v in here])
            normals.append([stored["vn"][k] if k >= 0 else [np.nan] * 3 for k in at[:, 2]])
            materials.append(material)
    return np.array(faces), np.float32(places), np.float32(normals), materials


@pytest.mark.parametrize("negative", [False, True])
@pytest.mark.parametrize("sep", [" ", "\t", "  "])
@pytest.mark.parametrize("forms", [*((form,) for form in FORMS), FORMS])
def test_all_forms_of_corners_are_read_as_words_are(forms, sep, negative):
    rng = np.random.default_rng(len(forms[0]) + negative)
    content = text(rng, forms, sep, negative, materials=True)
    result = parse_obj(content)
    faces, places, normals, materials = by_words(content)
    assert_array_equal(result.mesh.faces, faces)
    if any("t" in form for form in forms):
        assert_array_equal(result.places, places)
    if any("n" in form for form in forms):
        assert_array_equal(result.normals, normals)
    assert [result.names[k] for k in result.material] == materials


def test_colours_after_positions_are_read_if_each_vertex_has_one():
    face = "f 1 2 3\n"
    colored = "v 0 0 0 1 0 .5\nv 1 0 0 0 1 0\nv 0 1 0 nan x 1\n"
    assert_array_equal(parse_obj(colored + face).colors, [[1, 0, 0.5], [0, 1, 0], [0, 0, 1]])
    assert parse_obj(colored + "v 0 0 1\n" + face).colors is None


def test_lines_that_go_on_keep_the_numbers_of_others():
    whole = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    parted = whole.replace("f 1", "f \\\n 1").replace("v 1", "v \\\n\t1")
    assert_array_equal(parse_obj(parted).mesh.faces, parse_obj(whole).mesh.faces)
    with pytest.raises(Exception, match="line 7: vertex 9 is out of range"):
        parse_obj(parted + "f 1 2 9\n")
