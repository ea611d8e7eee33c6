"""Interactive pages in one file each, with their lists: the lesson, the failures and the demos.

`make docs` makes them, into `docs/auto_pages`, when a source has changed since.
"""

from __future__ import annotations

import html
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "docs")]

from failures import FAILURES, Failure  # noqa: E402

import cutcell  # noqa: E402
import cutcell_viewers  # noqa: E402
from cutcell.rig import Rig  # noqa: E402
from cutcell_app.headless import Choices, describe  # noqa: E402
from cutcell_app.headless.interactive import interactive_page  # noqa: E402
from cutcell_app.headless.lesson_page import lesson_page  # noqa: E402
from cutcell_assets import DEMOS  # noqa: E402

PAGES = ROOT / "docs" / "auto_pages"
"""What the site has at its root."""
LISTS = ROOT / "docs" / "auto_lists"
"""Parts of `failures.md`."""
SOURCES = [ROOT / name for name in ("app", "assets", "cutcell", "docs", "lab", "viewers")]
SUFFIXES = (".css", ".glb", ".html", ".js", ".md", ".py")
PICTURE_SIZE = (480, 360)
LIST = """<div class="one-file-pages" style="display: grid; gap: 1.5rem;
 grid-template-columns: repeat(auto-fill, minmax(14rem, 1fr))">{}</div>"""
CARD = """<div><a href="pages/{id}.html"><img src="pages/{id}.png" alt="" width="480" height="360"
 style="height: auto"><br>{title}</a><br>{text}</div>"""


def main() -> None:
    """Make all pages that are out of date."""
    stamp = LISTS / "made"
    if stamp.is_file() and stamp.stat().st_mtime > _newest():
        return
    (PAGES / "pages").mkdir(parents=True, exist_ok=True)
    LISTS.mkdir(exist_ok=True)
    (PAGES / "lesson.html").write_text(lesson_page(), encoding="utf-8")
    _write("failures", [_failure(one) for one in FAILURES])
    # The others are among the failures.
    _write("demos", [_demo(one) for one in DEMOS if not one.id.startswith("biped_")])
    stamp.touch()


def _newest() -> float:
    """Return when a source of the pages was changed last."""
    paths = (path for folder in SOURCES for path in folder.rglob("*"))
    made = ("auto_", "__pycache__")
    return max(
        path.stat().st_mtime
        for path in paths
        if path.suffix in SUFFIXES and not any(part.startswith(made) for part in path.parts)
    )


def _write(name: str, cards: list[str]) -> None:
    (LISTS / f"{name}.html").write_text(LIST.format("".join(cards)), encoding="utf-8")


def _failure(one: Failure) -> str:
    rig = one.make()
    text = f"{one.cause} {one.remedy}"
    method = cutcell.Method(**one.method)
    return _page(rig, one.id, one.title, text, one.view, one.bone, method)


def _demo(demo: Any) -> str:
    rig = cutcell.load(demo.path)
    return _page(rig, f"demo-{demo.id}", demo.title, demo.lesson, "weights", "", cutcell.ANIMATION)


def _page(
    rig: Rig, id: str, title: str, text: str, view: str, bone: str, method: cutcell.Method
) -> str:
    """Write a page and its picture; return its card for the list."""
    binding = cutcell.bind(rig, method=method)
    names = rig.skeleton.names
    joint = names.index(bone) if bone else len(names)
    page = interactive_page(
        rig, binding, joint=joint, view=view, title=title, caption=f"{title}. {text}"
    )
    path = PAGES / "pages" / id
    path.with_suffix(".html").write_text(page, encoding="utf-8")
    choices = Choices(view, bone or None, shown=None if bone else "mix", method=method)
    scene = describe(rig, choices, binding=binding)
    cutcell_viewers.show(scene, size=PICTURE_SIZE).save(path.with_suffix(".png"))
    return CARD.format(id=id, title=html.escape(title), text=html.escape(text))


if __name__ == "__main__":
    main()
