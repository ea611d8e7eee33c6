"""Change the weights of some vertices by layers, in one step of undo."""

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from cutcell.editing import Edits, FromFile, Layer, Mask, Painted
from cutcell.editing.layers.contents import Content
from cutcell.editing.layers.layer import EVERYWHERE
from cutcell.errors import CutcellError
from cutcell.rig import Skeleton

from ...document.session import Session
from ..binding.results import newest_rows, weights_below
from ..compute import stack
from ..compute.operations import ROWS
from ..compute.selected import rows_at
from ..correct.commands import check_alone, correct

STEPS = 10_000
"""Painted weights have as many steps from 0 to 1: files of layers stay short."""
Vertices = NDArray[np.intp]


def put_rows(
    session: Session, vertices: Vertices, rows: NDArray[np.float64] | csr_array, name: str = ""
) -> None:
    """Give vertices, shape (k,), weights that sum to one, shape (k, j); report what is refused.

    Rows may be sparse. They go into the chosen layer if it is painted, whose mask and opacity limit
    what is seen of the change, else into a new one on top, which is chosen then. Rows that do not
    change are left out.
    """
    state = session.state
    layer, names = stack.painted_layer(state.edits, state.layer), state.rig.skeleton.names
    is_masked = layer is not None and not (layer.is_opaque and layer.mask.is_all)
    present, changed, parts = newest_rows(state), [], []
    for start in range(0, len(vertices), ROWS):  # dense rows of all may not fit into memory
        which, dense = vertices[start : start + ROWS], rows[start : start + ROWS]
        seen = rows_at(present, which)
        dense = as_stored(dense.toarray() if isinstance(dense, csr_array) else dense, seen)
        differs = (dense != seen).any(axis=1)
        which, dense, seen = which[differs], dense[differs], seen[differs]
        if is_masked and layer is not None:
            dense = stack.rows_within(layer, names, which, seen, dense, state.max_influences)
            dense = in_steps(dense) / STEPS
        changed.append(which)
        parts.append(csr_array(dense))
    if not any(map(len, changed)):
        return

    def change() -> tuple[Edits, int | None]:
        painting = painted(state.rig.skeleton, np.concatenate(changed), vstack(parts, format="csr"))
        return stack.painted(state.edits, painting, state.layer, name)

    _change(session, change)


def take_from_file(
    session: Session, vertices: Vertices, opacity: float = 1.0, name: str | None = None
) -> None:
    """Give vertices, shape (k,), the file's weights; those without any stay as they are."""
    put_content(session, vertices, FromFile, opacity, name)


def recompute(
    session: Session,
    vertices: Vertices,
    opacity: float = 1.0,
    name: str | None = None,
    **options: Any,
) -> None:
    """Give vertices, shape (k,), weights computed with other options; see `Computed`."""
    reach = session.state.edits.reach
    put_content(session, vertices, lambda: replace(reach, options=options), opacity, name)


def painted(skeleton: Skeleton, vertices: Vertices, rows: Any) -> Painted:
    """Return rows (k, j) of vertices (k,), in any order, as the content of a layer."""
    rows = csr_array(rows)
    used = np.unique(rows.indices[rows.data > 0])
    for joint in used:
        check_alone(skeleton, int(joint))
    order = np.argsort(vertices)
    names = [skeleton.names[joint] for joint in used]
    return Painted(vertices[order], names, rows[order][:, used])


def as_stored(rows: NDArray[np.float64], before: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return painted rows (k, j) as layers store them: in steps, those before where all is less."""
    differs = np.abs(rows - before).max(axis=1, initial=0) > 0.5 / STEPS
    stored = before.copy()
    stored[differs] = in_steps(rows[differs]) / STEPS
    return stored


def in_steps(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """Round rows that sum to one to whole steps that sum to `STEPS` (the largest remainders)."""
    used = np.flatnonzero(rows.any(axis=0))
    if len(used) < rows.shape[1]:  # sorting all columns takes long
        result = np.zeros(rows.shape, np.int64)
        result[:, used] = in_steps(rows[:, used])
        return result
    scaled = rows * STEPS
    steps = np.floor(scaled).astype(np.int64)
    order = np.argsort(-(scaled - steps), axis=1, kind="stable")
    rank = np.argsort(order, axis=1, kind="stable")
    missing = STEPS - steps.sum(axis=1, keepdims=True)
    return steps + ((rank < missing) & (rows > 0))


def put_content(
    session: Session,
    vertices: Vertices | None,
    content: Callable[[], Content],
    opacity: float = 1.0,
    name: str | None = None,
    deform: Collection[str] = (),
) -> None:
    """Put a layer over some vertices, shape (k,), or over all for None, and choose it.

    Joints that are to `deform` may carry weight from then on.
    """

    def added() -> tuple[Edits, int | None]:
        mask = EVERYWHERE if vertices is None else Mask(vertices=np.unique(vertices))
        layer = Layer(content(), mask, name or "", opacity)
        state = session.state
        return stack.put_layer(stack.with_deform(state.edits, state.rig.skeleton, deform), layer)

    if vertices is None or len(vertices):
        _change(session, added)


def set_layer(session: Session, place: int, **changed: Any) -> None:
    """Change the name, opacity, content or mask of a layer, or switch it on or off."""
    edits = session.state.edits
    if not 0 <= place < len(edits.layers):
        return  # undo has removed it
    layer = replace(edits.layers[place], **changed)
    if layer != edits.layers[place]:
        _change(session, lambda: (stack.replaced(edits, place, layer), place), together=True)


def change(session: Session, act: Callable[[Edits, int], tuple[Edits, int | None]]) -> None:
    """Change the stack at the chosen layer, and choose the layer that comes of it."""
    edits, place = session.state.edits, session.state.layer
    if place is not None and place < len(edits.layers):
        _change(session, lambda: act(edits, place))


def merge_down(session: Session) -> None:
    """Merge the chosen layer into the one below it; the weights stay as they are."""

    def merge(edits: Edits, place: int) -> tuple[Edits, int | None]:
        rows = weights_below(session.state, place + 1)
        graph = session.state.binding.graph
        vertices = stack.vertices_of(edits.layers[place - 1 : place + 1], graph, len(rows))
        merged = Layer(
            painted(session.state.rig.skeleton, vertices, rows[vertices]),
            name=edits.layers[place - 1].name,
        )
        below = stack.replaced(edits, place, None)
        return stack.replaced(below, place - 1, merged if len(vertices) else None), place - 1

    if session.state.layer:
        change(session, merge)


def _change(
    session: Session, act: Callable[[], tuple[Edits, int | None]], together: bool = False
) -> None:
    """Take changed edits, and the layer that is chosen then, in a step of undo.

    Steps that are taken together follow each other fast and change the same: a slider's.
    """
    state = session.state
    try:
        edits, place = act()
    except CutcellError as error:
        session.fail(error)
        return
    if not together:
        session.history.part()
    correct(session, edits)
    if state.edits is edits:
        state.layer = place
