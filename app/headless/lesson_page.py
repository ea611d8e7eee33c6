"""The lesson in one file: its scenes are recorded, and the page's own scripts play them."""

from __future__ import annotations

import base64
import html
import io
import json
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cutcell_viewers
from cutcell.runtime.progress import Progress, silent
from cutcell_viewers.lighting import LIGHTS
from cutcell_viewers.palette import THEMES

from ..document.framing import theme_part
from ..features.flat.overlay import flat_colors
from ..features.learn.lesson import Lesson, Step, built_in
from ..features.learn.plots import plot_of
from ..features.learn.steps import (
    answer,
    branch_weights,
    clickable,
    followed,
    go,
    named_values,
    offer,
    pressed_offers,
)
from ..looks.methods import shown_title, weights_of
from .interactive import page_in_one_file
from .packed import Packed
from .recorder import Recorder

STOPS: dict[str, tuple[Any, ...]] = {
    "alpha": (0.0, 0.25, 0.5, 0.75, 1.0),
    "connectivity": (6, 26, "any"),
    "resolution": (20, 32, 64, 128),
    "graph_resolution": (20, 32, 64, 128),
    "beside_resolution": (16, 32, 64, 128),
    "winding_threshold": (0.1, 0.3, 0.5, 0.7, 0.9),
}
"""Recorded values of choices that the text of a step names."""
THUMBNAIL = (640, 480)
QUALITY = 80
ROW = """<li><img src="data:image/jpeg;base64,{picture}" alt="{alt}" width="640" height="480">
<h2>{number}. {title}</h2><p>{question}</p><p class="sentence">{sentence}</p></li>"""


def lesson_page(lesson: Lesson | None = None, *, progress: Progress = silent) -> str:
    """Return a lesson as the text of an HTML file, which needs no server.

    Parameters
    ----------
    lesson : Lesson, optional
        The lesson that comes with the page when left out.
    progress : callable
        See `cutcell.runtime.progress`.

    Raises
    ------
    CutcellError
        A character of a step cannot be read or bound.
    """
    lesson = lesson or built_in()
    recording, rows = Recording(lesson), []
    try:
        for index, step in enumerate(lesson.steps):
            progress("recording the lesson", index / len(lesson))
            recording.record(index)
            rows.append(_row(index, step, recording.picture))
    finally:
        recording.recorder.close()
    packed = Packed()
    scenes = packed.plain(
        {
            "steps": [step.to_json() for step in lesson.steps],
            "lights": LIGHTS,
            "themes": [theme_part(THEMES[name]) for name in ("light", "dark")],
            "records": recording.records,
            "sections": recording.sections,
            "colors": recording.flat_colors(),
        }
    )
    content = f'<p>Loading the lesson …</p>\n<ol class="handout">{"".join(rows)}</ol>'
    return page_in_one_file("one_file/lesson_page", lesson[0].title, content, packed, scenes)


def _row(index: int, step: Step, picture: str) -> str:
    texts = {name: html.escape(getattr(step, name)) for name in ("title", "question", "sentence")}
    return ROW.format(number=index + 1, picture=picture, alt=html.escape(step.picture), **texts)


class Recording:
    """Records of all steps: the view before and after the answer, of each button and number."""

    def __init__(self, lesson: Lesson) -> None:
        self.recorder = Recorder()
        self.records: list[dict[str, Any]] = []
        self.sections: list[Any] = []
        self._section_of: dict[str, int] = {}
        self.recorder.session.state.lesson = lesson
        self.picture = ""  # of the last answer, in base64

    def record(self, index: int) -> None:
        """Record a step."""
        session = self.recorder.session
        step = session.state.lesson[index]
        go(session, index)
        views = {"ask": self._view()}
        answer(session, "")
        views["show"] = self._view()
        self.picture = self._draw()
        for number in range(len(step.offers)):
            offer(session, number)
            views[f"offer {number}"] = self._view()
        go(session, index)
        self.recorder.rest()
        for choices in self._variants(step):
            session.state.param.update(**choices)
            views["&".join(f"{name}={value}" for name, value in choices.items())] = self._view()
        self.records.append({"views": views, **self._answers(step)})

    def _variants(self, step: Step) -> Iterator[dict[str, Any]]:
        """Yield all recorded values of the choices that the text names."""
        named = dict.fromkeys(step.named)
        names = [name for name in named if name in STOPS and not self._is_flat(name)]
        if names:
            for values in product(*(STOPS[name] for name in names)):
                yield dict(zip(names, values, strict=True))

    def _is_flat(self, name: str) -> bool:
        """Return whether the browser draws all values of a choice: those of the flat scene."""
        return name == "winding_threshold" and bool(self.recorder.session.state.flat)

    def _view(self) -> dict[str, Any]:
        """Return the view as it is, in light and dark, with what the card shows."""
        state = self.recorder.session.state
        self.recorder.rest()
        state.dark = True
        dark = self.recorder.message()
        state.dark = False
        return {
            "messages": [self.recorder.message(), dark],
            "pressed": pressed_offers(state),
            "values": self._sliders(),
            "plot": self._plot(),
            "flat": self._flat(),
        }

    def _sliders(self) -> dict[str, Any]:
        """Return the numbers in the text, with those stops that are recorded."""
        values = named_values(self.recorder.session.state)
        for name, slider in values.items():
            if not self._is_flat(name):
                stops = [one for one in slider["stops"] if one[0] in STOPS[name]]
                values[name] = {**slider, "stops": stops}
        return values

    def _plot(self) -> dict[str, Any] | None:
        state = self.recorder.session.state
        is_shown = state.lesson_step.plot and state.step in state.answers
        return plot_of(state, state.lesson_step.plot) if is_shown else None

    def _flat(self) -> dict[str, Any] | None:
        """Return the mode and the section of the flat scene, by its number among all sections."""
        state = self.recorder.session.state
        if not state.flat or state.flat_data is None:
            return None
        text = state.flat_data
        if text not in self._section_of:
            self._section_of[text] = len(self.sections)
            self.sections.append(json.loads(text))
        return {
            "mode": state.flat,
            "section": self._section_of[text],
            "tau": state.winding_threshold,
        }

    def flat_colors(self) -> list[dict[str, Any]]:
        """Return the colours of the flat scene in light and dark."""
        state, colors = self.recorder.session.state, []
        for state.dark in (False, True):
            colors.append(flat_colors(state))
        return colors

    def _answers(self, step: Step) -> dict[str, Any]:
        """Return the data for answers in the picture: each vertex's joint, and the solution."""
        state = self.recorder.session.state
        part: dict[str, Any] = {"names": clickable(state)}
        if state.weights is not None:
            part["follows"] = followed(state)
        if step.answer.kind == "paint":
            part["right"] = self._moved(step)
            methods = state.methods if state.panel == "compare" else ()
            tables = {shown_title(state, name): weights_of(state, name) for name in methods}
            part["methods"] = {
                title: self._moved(step, table)
                for title, table in tables.items()
                if table is not None
            }
        return part

    def _moved(self, step: Step, weights: Any = None) -> NDArray[np.uint8]:
        """Return the vertices to paint, by some weights, shape (n,)."""
        moves = branch_weights(self.recorder.session.state, step.answer.joint, weights) > 0.5
        return moves.astype(np.uint8)

    def _draw(self) -> str:
        session, view = self.recorder.session, self.recorder.description
        clip = session.view.last_sent("clip")
        if clip is not None:
            matrices = np.asarray(clip["matrices"]).reshape(len(clip["times"]), -1, 4, 4)
            view = replace(view, pose=matrices[len(matrices) // 3])
        picture = cutcell_viewers.show(view, size=THUMBNAIL, camera=session.view.camera)
        content = io.BytesIO()
        picture.convert("RGB").save(content, "JPEG", quality=QUALITY)
        return base64.b64encode(content.getvalue()).decode()
