"""Figures of several panels: pictures at their places, texts as text, files that stay the same."""

import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest
from PIL import Image

import cutcell_viewers
from cutcell.errors import FileError, ParameterError
from cutcell_viewers.description import Legend
from cutcell_viewers.figures import _range
from cutcell_viewers.film import draw
from cutcell_viewers.order import Order
from cutcell_viewers.weights_scene import weights_scene
from tests.viewers.arm import arm_rig

pytestmark = pytest.mark.slow

SIZE = (160, 120)


@pytest.fixture(scope="module")
def scenes():
    rig = arm_rig()
    return tuple(weights_scene(rig, rig.weights, joint) for joint in (0, 1, 2))


def drawn(path, panels, **options):
    draw(Order(panels[0], size=SIZE, panels=tuple(panels), **options), path)
    return path


def texts(path):
    """Return the texts of an SVG."""
    elements = re.findall(r"<text[^>]*>([^<]*)</text>", path.read_text(encoding="utf-8"))
    return [unescape(text) for text in elements]


def test_each_panel_has_a_letter_and_a_caption_and_one_scale_has_one_legend(scenes, tmp_path):
    written = texts(drawn(tmp_path / "a.svg", scenes))
    captions = ["Weight of shoulder", "Weight of elbow", "Weight of wrist"]
    assert {"a", "b", "c", *captions} <= set(written)
    assert written.count("0.2") == 1
    other = replace(scenes[1], legend=replace(scenes[1].legend, high="2 mm"))
    written = texts(drawn(tmp_path / "a.svg", [scenes[0], other]))
    assert sum(float(text) == 0 for text in written if re.fullmatch(r"[\d.]+", text)) == 2
    assert "mm" in written


def test_captions_are_written_as_they_are(scenes, tmp_path):
    names = ("$x_1$ & <b>", "_root")
    written = texts(drawn(tmp_path / "a.svg", scenes[:2], captions=names))
    assert set(names) <= set(written)
    swatch = replace(scenes[0], legend=Legend("Parts", swatches=(((1, 0, 0), "_hidden$"),)))
    assert {"_hidden$", "Parts"} <= set(texts(drawn(tmp_path / "a.svg", [swatch])))
    title = replace(scenes[0], legend=Legend("$Parts$"))
    assert "$Parts$" in texts(drawn(tmp_path / "a.svg", [title]))


@pytest.mark.parametrize("ending", ["pdf", "svg", "png"])
def test_a_figure_is_the_same_in_each_run(scenes, tmp_path, ending):
    one, other = (drawn(tmp_path / f"{name}.{ending}", scenes[:1]) for name in "ab")
    assert one.read_bytes() == other.read_bytes()
    assert b"Date" not in one.read_bytes()


def test_fonts_of_a_pdf_are_embedded_as_text(scenes, tmp_path):
    """Also in a figure of a single panel, which has no letter."""
    draw(Order(scenes[0], size=SIZE), tmp_path / "a.pdf")
    assert b"/CIDFontType2" in (tmp_path / "a.pdf").read_bytes()
    draw(Order(scenes[0], size=SIZE), tmp_path / "a.svg")
    assert "Weight of shoulder" in texts(tmp_path / "a.svg")
    assert "a" not in texts(tmp_path / "a.svg")


def test_panels_lie_at_their_places_from_one_camera(scenes, tmp_path):
    """Of four equal panels in two rows all halves and quarters are the same below the letters."""
    path = drawn(tmp_path / "a.png", [scenes[0]] * 4, legend=False)
    with Image.open(path) as picture:
        pixels = np.asarray(picture.convert("RGB")).astype(int)
    inked = np.ptp(pixels, axis=2) > 60
    height, width = inked.shape
    quarters = [inked[y : y + height // 2, x : x + width // 2] for y in (0, height // 2)
                for x in (0, width // 2)]  # fmt: skip
    shares = [one.mean() for one in quarters]
    assert min(shares) > 0.02
    assert max(shares) < 1.05 * min(shares)


def test_each_view_is_a_panel(scenes, tmp_path):
    body = scenes[0].actors["body"]
    views = {"body": replace(body, view=0), "body 1": replace(body, view=1)}
    both = replace(scenes[0], actors=views, views=("Left", "Right"))
    assert {"a", "b", "Left", "Right"} <= set(texts(drawn(tmp_path / "a.svg", [both])))
    path = drawn(tmp_path / "a.png", [both], legend=False)
    with Image.open(path) as picture:
        inked = np.ptp(np.asarray(picture.convert("RGB")).astype(int), axis=2) > 60
    halves = np.array_split(inked, 2, axis=1)
    assert halves[1].mean() > 0.9 * halves[0].mean() > 0.01


def test_numbers_of_a_legend_are_read():
    assert _range(Legend("", "error", "0", "0.55 m")) == (0, 0.55, "m")
    assert _range(Legend("", "difference", "−1", "+1")) == (-1, 1, "")
    assert _range(Legend("", "error", "0%", "100%")) == (0, 100, "%")
    assert _range(Legend("", "error", "few", "many")) is None
    assert _range(Legend("", "error", "1", "1")) is None


def test_ends_without_numbers_are_written_as_they_are(scenes, tmp_path):
    named = replace(scenes[0], legend=Legend("Influences", "count", "few", "many"))
    assert {"few", "many", "Influences"} <= set(texts(drawn(tmp_path / "a.svg", [named])))


def test_a_figure_can_be_drawn_from_python(scenes, tmp_path):
    path = tmp_path / "a.svg"
    cutcell_viewers.figure(scenes[:2], path, captions=["One", "Two"], size=SIZE, dark=True)
    assert {"One", "Two"} <= set(texts(path))


@pytest.mark.parametrize(
    ("count", "name", "captions", "error"),
    [
        (0, "a.pdf", (), ParameterError),
        (7, "a.pdf", (), ParameterError),
        (2, "a.pdf", ("One",), ParameterError),
        (2, "a.jpg", (), FileError),
        (2, "a.gif", (), FileError),
        (2, "no/a.pdf", (), FileError),
    ],
)
def test_what_is_no_figure_is_an_error(scenes, tmp_path, count, name, captions, error):
    with pytest.raises(error):
        cutcell_viewers.figure([scenes[0]] * count, tmp_path / name, captions=captions, size=SIZE)
    assert not (tmp_path / name).exists()


def test_views_count_as_panels(scenes, tmp_path):
    many = replace(scenes[0], views=tuple("abcdefg"))
    with pytest.raises(ParameterError, match="7"):
        drawn(tmp_path / "a.pdf", [many])
