"""Table of the weights of selected vertices, by vertex and joint, with those of the file."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell_lab.metrics import weight_l1
from cutcell_viewers.short_names import short_names

from ...document.selection import selected
from ...document.session import Session
from ...document.state import State
from ...server.protocol.received import EditWeight, Message, Page, PickVertex, Sort
from ..compute.selected import rows_at
from .operations import edit

ROWS = 20
"""Rows of a page."""
JOINTS = 6
"""Joints with a column, the chosen one first, then those with most weight."""
VERTEX, FILE = -1, -2
"""What the columns that are no joints show."""


@dataclass(frozen=True, eq=False)
class Table:
    """Weights of the selection, sorted.

    Parameters
    ----------
    columns : list of int
        Joints, or `VERTEX` or `FILE`.
    sorted_by : int
        One of the columns.
    values : array, shape (v, c)
        In the order of the rows.
    """

    columns: list[int]
    sorted_by: int
    values: NDArray[np.float64]


def table_of(state: State) -> Table | None:
    """Return the whole table; None without a selection."""
    chosen = selected(state)
    if not state.table or chosen is None or state.rows is None:
        return None
    vertices = np.flatnonzero(chosen)
    weights, joint = rows_at(state.rows, vertices), state.joint
    total = weights.sum(axis=0)
    most = [j for j in np.argsort(-total, kind="stable").tolist() if j != joint and total[j] > 0]
    most = most[: JOINTS - 1]
    columns, values = [VERTEX, joint], [vertices.astype(float), weights[:, joint]]
    if state.rig.weights is not None:
        columns.append(FILE)
        values.append(state.rig.weights[vertices, joint])
    columns += most
    table = np.stack([*values, *(weights[:, j] for j in most)], axis=1)
    column, largest_first = state.table_order
    sorted_by = column if column in columns else joint
    key = table[:, columns.index(sorted_by)]
    return Table(
        columns, sorted_by, table[np.argsort(-key if largest_first else key, kind="stable")]
    )


def _table(state: State) -> Table | None:
    choices = state.brush_selection, state.joint, state.table, *state.table_order
    inputs = state.rig, state.rows, *choices
    table: Table | None = state.memo("weights table", inputs, lambda: table_of(state))
    return table


def table_parts(state: State) -> dict[str, Any]:
    """Return the current page of the table as the widget's parameters."""
    table = _table(state)
    if table is None:
        return {"content": {}}
    names = short_names(state.rig.skeleton.names)
    titles = {VERTEX: "Vertex", FILE: "File"}
    pages = -(-len(table.values) // ROWS)
    page = min(state.table_page, pages - 1)
    rows = table.values[ROWS * page : ROWS * (page + 1)]
    weights = table.values[:, 1:]
    content = {
        "columns": [[titles.get(j, "") or names[j], j] for j in table.columns],
        "rows": [[int(row[0]), *(round(w, 4) for w in row[1:].tolist())] for row in rows],
        "totals": [
            ["Total", *(round(x, 4) for x in weights.sum(axis=0).tolist())],
            ["Mean", *(round(x, 4) for x in weights.mean(axis=0).tolist())],
        ],
        "order": [table.sorted_by, state.table_order[1]],
        "pages": [page, pages],
    }
    return {"content": content}


def table_text(state: State) -> str:
    """Return how much the selection differs from the file; what to do without a selection."""
    chosen = selected(state)
    if not state.table or state.rows is None:
        return ""
    if chosen is None:
        return "Select vertices to see their weights."
    if state.rig.weights is None or not state.rig.weights[chosen].any():
        return ""
    return (
        f"L1 to the file {weight_l1(rows_at(state.rows, chosen), state.rig.weights[chosen]):.3f}."
    )


def act(session: Session, message: Message) -> None:
    """Sort by a column, go to a page, choose the vertex of a row, or change a weight."""
    state, table = session.state, table_of(session.state)
    if table is None:
        return
    match message:
        case Sort(column):
            largest_first = (
                not state.table_order[1] if column == table.sorted_by else column != VERTEX
            )
            state.param.update(
                table_order=(None if column == state.joint else column, largest_first),
                table_page=0,
            )
        case Page(page):
            state.table_page = max(page, 0)
        case EditWeight(vertex, joint, value) if 0 <= joint < state.rows.shape[1]:
            edit(session, vertex, joint, value)
        case PickVertex(vertex):
            state.param.update(vertex=vertex, node=None)
