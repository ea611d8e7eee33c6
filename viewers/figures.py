"""Figures of several panels: letters, captions and the legend are text, set by Matplotlib."""

from __future__ import annotations

import re
from dataclasses import replace
from io import BytesIO
from math import ceil
from pathlib import Path
from string import ascii_lowercase
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cutcell.errors import ParameterError
from cutcell.runtime.display import printable
from cutcell.runtime.progress import Progress
from cutcell.runtime.writing import write_all

from .description import Description, Legend, in_view
from .order import MAX_PANELS, Order, ground
from .palette import THEMES, Theme, colormap, to_hex
from .studio import Studio, box_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .camera import Camera

WIDTH = 7.2
"""Inches, the width of a printed page's text. One panel alone has half of it."""
LETTERS = 16.0
"""Letters that fit into an inch."""
BAR = 0.09
"""Height of a colour bar, in inches."""
STYLE: Any = {
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    "svg.hashsalt": "cutcell",
}
UNDATED: dict[str, dict[str, Any]] = {
    "pdf": {"CreationDate": None},
    "svg": {"Date": None},
    "png": {},
}
NUMBER = re.compile(r"([-+]?\d+(?:\.\d+)?) ?(.*)")


def draw_figure(order: Order, path: Path, progress: Progress) -> None:
    """Draw the panels of an order into a PDF, SVG or PNG; see `film.draw`."""
    from matplotlib import rc_context

    panels = [one for whole in order.panels or (order.description,) for one in _views(whole)]
    if len(panels) > MAX_PANELS:
        raise ParameterError(f"a figure has at most {MAX_PANELS} panels, not {len(panels)}")
    captions, legends = _texts(panels, order)
    plain = "white" if order.theme == "light" else to_hex(THEMES[order.theme].bottom)
    theme, clear = ground(order.theme, order.background or plain, path.suffix.lower())
    pictures = _pictures(order, [one for one, _ in panels], theme, clear, progress)
    kind, written = path.suffix[1:].lower(), BytesIO()
    ink: Any = dict.fromkeys(("text.color", "axes.labelcolor", "xtick.color"), theme.ink)
    with rc_context({**STYLE, **ink}):
        figure = _figure(pictures, captions, legends)
        figure.savefig(
            written,
            format=kind,
            dpi=300,
            metadata=UNDATED[kind],
            facecolor="none" if clear else theme.bottom,
        )
    write_all({path: written.getvalue()})


def _views(description: Description) -> list[tuple[Description, str]]:
    """Return each view of a description, with its caption."""
    count = max(len(description.views), 1)
    views = [in_view(description, k).actors for k in range(count)]
    whole = [{name: replace(actor, view=None) for name, actor in one.items()} for one in views]
    alone = [replace(description, actors=actors, views=()) for actors in whole]
    return list(zip(alone, description.views or ("",), strict=True))


def _texts(
    panels: list[tuple[Description, str]], order: Order
) -> tuple[list[str], list[Legend | None]]:
    """Return each panel's caption, and its legend; a single legend where all have one scale."""
    legends = [one.legend if order.legend else None for one, _ in panels]
    titles = [one.legend.title if one.legend else "" for one, _ in panels]
    if order.captions and len(order.captions) != len(panels):
        raise ParameterError(
            f"there are {len(order.captions)} captions for {len(panels)} panels: give one for each"
        )
    captions = list(order.captions) or [caption for _, caption in panels]
    if not any(captions) and len(set(titles)) > 1:
        captions = titles
    if len({one and replace(one, title="") for one in legends}) == 1:
        legends = legends[:1]
    hidden = set(captions) | (set(titles) if len(set(titles)) > len(legends) else set())
    return captions, [
        replace(one, title="") if one and one.title in hidden else one for one in legends
    ]


def _pictures(
    order: Order, scenes: list[Description], theme: Theme, clear: bool, progress: Progress
) -> list[NDArray[np.uint8]]:
    """Draw all panels from one camera, which sees them all if none is given."""
    pictures = []
    with Studio(scenes[0], theme, order.size, False, order.page_height, clear) as studio:
        camera = order.camera or _camera(order, scenes, studio)
        for k, scene in enumerate(scenes):
            progress("drawing", k / len(scenes))
            studio.show(scene)
            pictures.append(studio.draw(camera))
    return pictures


def _camera(order: Order, scenes: list[Description], studio: Studio) -> Camera:
    corners = np.concatenate([box_of(scene, [scene.pose]) for scene in scenes])
    box = np.stack([corners.min(axis=0), corners.max(axis=0)])
    return studio.camera(order.direction, box)


def _figure(
    pictures: list[NDArray[np.uint8]], captions: list[str], legends: list[Legend | None]
) -> Figure:
    """Return a figure with a panel for each picture, and the legends below."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    count = len(pictures)
    columns = count if count < 4 else ceil(count / 2)
    rows, width = ceil(count / columns), WIDTH if count > 1 else WIDTH / 2
    height, across = pictures[0].shape[:2]
    inches = rows * (width / columns * height / across + 0.25)
    inches += max(map(_height, legends)) * (1 if len(legends) == 1 else rows)
    figure: Any = Figure((width, inches), layout="compressed")
    figure.get_layout_engine().set(h_pad=0.07)
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False)
    for place in axes.flat:
        place.axis("off")
    for k, picture in enumerate(pictures):
        place = axes.flat[k]
        place.imshow(picture, interpolation="none")
        place.set_title(_wrapped(captions[k], width / columns - 0.4), parse_math=False)
        if count > 1:
            place.set_title(ascii_lowercase[k], loc="left", fontsize=9, fontweight="bold")
    if len(legends) == 1:
        _add_legend(figure, figure, axes, legends[0], width)
    else:
        for place, legend in zip(axes.flat, legends, strict=False):
            _add_legend(figure, place, place, legend, width / columns)
    return figure


def _add_legend(
    figure: Figure, owner: Any, places: Any, legend: Legend | None, width: float
) -> None:
    """Add a legend below some panels, which are some inches wide; the figure or one owns it."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize
    from matplotlib.patches import Patch

    if legend is None:
        return
    title = _wrapped(legend.title, width)
    if legend.colormap:
        numbers = _range(legend)
        low, high, unit = numbers or (0.0, 1.0, "")
        shades = ListedColormap(colormap(legend.colormap) / 255)
        values = ScalarMappable(Normalize(low, high), shades)
        style: dict[str, Any] = {
            "location": "bottom",
            "shrink": 0.6,
            "aspect": 0.6 * width / BAR,
            "pad": 0.02,
        }
        bar: Any = figure.colorbar(values, ax=places, **style)
        bar.outline.set_visible(False)
        if numbers is None:
            bar.set_ticks([low, high], labels=[legend.low, legend.high])
        bar.set_label(", ".join(part for part in (title, unit) if part), parse_math=False)
        title = ""
    if legend.swatches or title:
        colors = [Patch(color=color) for color, _ in legend.swatches]
        place: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, 0)}
        if owner is figure:
            place = {"loc": "outside lower center"}
        # Texts are set below: Matplotlib leaves out those that begin with an underscore.
        box = owner.legend(colors, [""] * len(colors), frameon=False, **place)
        box.set_title(title)
        box.get_title().set_parse_math(False)
        for label, (_, text) in zip(box.get_texts(), legend.swatches, strict=True):
            label.set(text=_wrapped(text, width - 0.6), parse_math=False)


def _wrapped(text: str, width: float) -> str:
    """Return a text whose lines fit into some inches."""
    return "\n".join(wrap(printable(text), int(width * LETTERS)))


def _range(legend: Legend) -> tuple[float, float, str] | None:
    """Return the numbers at the ends of a colour map and their unit; None if there are none."""
    ends = [NUMBER.fullmatch(text.replace("−", "-")) for text in (legend.low, legend.high)]
    if ends[0] is None or ends[1] is None or not float(ends[0][1]) < float(ends[1][1]):
        return None
    return float(ends[0][1]), float(ends[1][1]), ends[1][2]


def _height(legend: Legend | None) -> float:
    """Return about how many inches a legend needs."""
    return 0.0 if legend is None else 0.2 * len(legend.swatches) + 0.6 * bool(legend.colormap)
