"""The layout of the page: a sidebar, one big canvas, a slim line of facts."""

import functools
import weakref
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any
from urllib.parse import urlencode

import panel as pn
import panel_material_ui as pmui
from panel.io.resources import LOCAL_DIST
from tornado.ioloop import IOLoop

from cutcell_assets import DEMOS

from ..derive.jobs import Gate, on_its_thread
from ..document import loading
from ..document.opening import Request
from ..document.session import Session
from ..features import FEATURES
from ..features.learn.overlay import LessonNotes, steps_of
from ..features.learn.welcome import Welcome
from ..server.memory import collect_later, detach_from_panel
from ..widgets import controls as ui
from ..widgets.modules import style
from .favicon import FAVICON
from .session.begin import begin
from .session.reload import PAGES, arrive
from .sidebar import sidebar
from .status import STATUS_LINE, messages
from .theme import PAGE_STYLE, THEME

NARROW = 600
"""Windows that are less wide than this, in pixels, show the sidebar on demand only."""


ROOMY = 1000
"""Windows that are less wide than this show a lesson without the sidebar at first."""


def page(path: Path | None = None, choices: Mapping[str, Any] = MappingProxyType({})) -> pmui.Page:
    """Return a new page, on which a character is about to stand.

    The first demo comes without a path. `choices` are parameters of the state that the server was
    started with, such as a lesson, an audit, or actors that are shown with every character.
    """
    document: Any = pn.state.curdoc
    # Panel sets this as it writes a session's HTML; here that is written once for all of them.
    document.template_variables["dist_url"] = LOCAL_DIST
    gate = Gate(on_its_thread(document, IOLoop.current()))
    pn.state.onload(gate.open)
    session = begin(gate)
    session.state.param.update(**choices)
    opened = session.state.opened
    # Panel keeps its settings per document for as long as the document lives: what they hold
    # must not in turn hold the document.
    fail = weakref.WeakMethod(session.fail)
    pn.config.exception_handler = lambda error: _report(fail(), error)
    query = request_query()
    if query == "notes=":
        return notes(session)
    first = "" if path is not None else next(demo.id for demo in DEMOS if demo.path.exists())
    loading.choose(session, query, first)
    if opened is not None and not query:
        session.state.panel = "pairs"
    view: Any = session.view
    result = layout(session, greeting=path is None and opened is None and not query)
    key = PAGES.enter(session)
    document.on_session_destroyed(functools.partial(_close, session, key))

    request = Request("~", paths=[path]) if path is not None else Request(f"demo {first}")
    if path is None and not query and opened is None:
        request = replace(request, arrival={"playing": True})  # in the colours of its weights
    # Nothing is computed until the browser has opened its websocket.
    later = session.work.later
    view.when_seen(lambda: later(lambda: arrive(session, query, request)))
    return result


def notes(session: Session) -> pmui.Page:
    """Return the page of the speaker's notes."""
    text = LessonNotes(steps=steps_of(session.state.lesson), sizing_mode="stretch_width")
    result = pmui.Page(title="Notes", main=[text], busy_indicator=None, theme_config=THEME)
    detach_from_panel(result)
    return result


def request_query() -> str:
    """Return the query of the requested address."""
    arguments = pn.state.session_args or {}
    pairs = [(name, value) for name, values in arguments.items() for value in values[:1]]
    return urlencode(pairs)


def _close(session: Session, key: str, context: Any) -> None:
    try:
        PAGES.leave(key)
    finally:
        session.close()
        collect_later()


def _report(fail: Callable[[Exception], None] | None, error: Exception) -> None:
    if fail is not None:
        fail(error)


def layout(session: Session, greeting: bool = False) -> pmui.Page:
    """Return the page of a session, with a welcome on a first visit if it is to greet."""
    view: Any = session.view
    tagline = ui.text_line(
        "Skinning weights that follow the body, not the air",
        sx={"color": "text.secondary", "fontSize": 13, "display": {"xs": "none", "sm": "block"}},
        margin=(2, 0, 0, 16),
    )
    canvas = pmui.Column(
        view,
        messages(session),
        *(one.overlay(session) for one in FEATURES.values() if one.overlay is not None),
        sizing_mode="stretch_both",
        margin=0,
        styles={"position": "relative"},
        stylesheets=[style("page/stage_place")],
    )
    main = pmui.Column(
        *([Welcome(session, sizing_mode="stretch_width")] if greeting else []),
        canvas,
        ui.draw(session, STATUS_LINE),
        sizing_mode="stretch_both",
        margin=0,
    )
    result = pmui.Page(
        title="cutcell",
        header=[ui.draw(session, tagline)],
        sidebar=sidebar(session),
        sidebar_width=320,
        sidebar_variant="auto",
        sidebar_open="Mobi" not in (pn.state.headers or {}).get("User-Agent", ""),
        main=[main],
        busy_indicator=None,
        raw_css=[style("page/loader")],
        theme_config=THEME,
        sx=PAGE_STYLE,
        favicon=FAVICON,
    )

    def themed(event: Any) -> None:
        session.state.dark = event.new
        view.send(dark=event.new)

    def remembered(event: Any) -> None:
        if event.new is not None:
            session.work.later(lambda: result.param.update(dark_theme=event.new))

    def sized(event: Any) -> None:
        # The canvas comes first where both do not fit side by side.
        wide = event.new >= (NARROW if session.state.step < 0 else ROOMY)
        session.work.later(lambda: result.param.update(sidebar_open=wide))

    def taught(event: Any) -> None:
        # The sidebar would leave too little for the picture and the card.
        if event.new >= 0 and 0 < view.window_width < ROOMY:
            session.work.later(lambda: result.param.update(sidebar_open=False))

    def staged(event: Any) -> None:
        canvas.css_classes = ["staged"] if event.new else []

    def close_sidebar(event: Any) -> None:
        # On narrow windows the sidebar would cover the message.
        if event.new and event.new[0] == "error" and 0 < view.window_width < NARROW:
            session.work.later(lambda: result.param.update(sidebar_open=False))

    detach_from_panel(result)
    result.param.watch(themed, "dark_theme")
    view.param.watch(sized, "window_width")
    session.state.param.watch(close_sidebar, "message")
    session.state.param.watch(taught, "step")
    session.state.param.watch(staged, "staged")
    session.state.param.watch(lambda event: collect_later(), "binding")
    view.param.watch(remembered, "dark")
    session.state.dark = result.dark_theme
    return result
