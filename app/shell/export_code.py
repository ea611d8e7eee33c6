"""Copy code that computes the weights of the page again."""

import cutcell
from cutcell.io import binary_ending

from ..document.edits import edits_in
from ..document.method import effective, method_of
from ..document.session import Session
from ..editing.correct.commands import file_name, stored
from ..files.reading import main_file
from .recipe import Recipe, command_of, script_of
from .session.export import stem_of


def copy_script(session: Session) -> None:
    """Copy a script that computes the weights of the page again."""
    recipe = recipe_of(session)
    if recipe is not None:
        needs_file = bool(recipe.edits) and not recipe.has_only_base
        _copy(session, recipe, "Script", script_of(recipe), needs_file)


def copy_command(session: Session) -> None:
    """Copy a command line that computes the weights of the page again."""
    recipe = recipe_of(session)
    if recipe is not None:
        _copy(session, recipe, "Command", command_of(recipe), bool(recipe.edits))


def _copy(session: Session, recipe: Recipe, what: str, text: str, needs_file: bool) -> None:
    """Copy a text, and hand over the files that it reads and that a person does not have."""
    session.view.answer(copy={"text": text, "what": what})
    files = session.uploads.cache.made(session.source[1:])
    if needs_file:
        files[recipe.layers] = stored(session)
    for name, content in files.items():
        session.view.offer(name, content)
    if files:
        were = "was" if len(files) == 1 else "were"
        text = f"The {what.lower()} reads {' and '.join(files)}, which {were} downloaded."
        session.state.message = ("info", f"{text} Run it in that folder.")


def recipe_of(session: Session) -> Recipe | None:
    """Return all inputs of the page's weights; None, with a message, where there are none."""
    state = session.state
    if state.rig is None or state.bare:
        state.message = ("info", "There are no weights to compute yet.")
        return None
    if state.repair is not None and state.repair.codes:
        text = "The mesh was repaired. Export the GLB, open it, and copy then."
        state.message = ("info", text)
        return None
    paths = session.paths or []
    file = main_file(paths).name if paths else f"{stem_of(session)}.glb"
    return Recipe(
        state.rig,
        session.uploads.listed.get(session.source[1:], file),
        state.demo,
        cutcell.Method(**effective(method_of(state))),
        state.edits,
        file_name(session),
        bool(edits_in(state.own)[0]),
        f"{stem_of(session)}-bound{binary_ending(state.rig)}",
    )
