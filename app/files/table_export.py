"""Weights, distances and graphs as plain numbers, for spreadsheets and scripts."""

import csv
import json
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.binding import Binding
from cutcell.editing.stored import ABOUT
from cutcell.errors import FileError, ParameterError
from cutcell.graph import CutCellGraph
from cutcell.rig import Rig
from cutcell.runtime.display import printable
from cutcell.runtime.writing import check_place, write_all
from cutcell_viewers.graph_scene import KINDS

FORMULA = tuple("=+-@\t\r＝＋－＠")
"""Prefixes that start a formula in a spreadsheet."""
DIGITS = 7
"""Significant digits of a CSV's numbers, as of 32 bits."""


def settings_of(result: Binding | CutCellGraph) -> dict[str, Any]:
    """Return the settings that a result was computed with, the program's version and the unit."""
    if isinstance(result, Binding):
        return {**ABOUT, **asdict(result.method)}
    options = {
        "resolution": result.lattice.resolution,
        "connectivity": result.connectivity,
        "winding_threshold": result.winding_threshold,
    }
    return {**ABOUT, **options}


def save_numbers(
    path: str | Path, rig: Rig, *, settings: Mapping[str, Any] | None = None, **tables: ArrayLike
) -> None:
    """Save numbers of every vertex and joint.

    Parameters
    ----------
    path : path
        Ends in ".csv", for one table, or in ".npz".
    rig : Rig
    settings : mapping, optional
        See `settings_of`: lines that begin with "#" before a CSV's header, or JSON as the array
        "settings" of an NPZ.
    **tables : array_like, shape (n, j)
        Lengths are in the file's units.
    """
    path = Path(path)
    shape = (len(rig.mesh.vertices), len(rig.skeleton.joints))
    arrays = {name: np.asarray(table) for name, table in tables.items()}
    for name, array in arrays.items():
        if array.dtype.kind not in "biuf":
            raise ParameterError(f"{name} must be real numbers, not {array.dtype}")
        if array.shape != shape:
            raise ParameterError(
                f"{name} has the shape {array.shape}, but the rig has {shape[0]} vertices and "
                f"{shape[1]} joints"
            )
    check_place(path)
    kind = path.suffix.lower()
    if kind == ".npz":
        if not arrays:
            raise ParameterError("there are no numbers to save")
        pack = _packed_npz
    elif kind == ".csv":
        if len(arrays) != 1:
            raise ParameterError(f"a CSV holds one table, not {len(arrays)}; save an NPZ for all")
        pack = _packed_csv
    else:
        raise FileError(f'{path.name}: numbers are saved as .csv or .npz, not as "{kind}"')
    write_all({path: pack(rig, arrays, settings or {})})


def _packed_npz(rig: Rig, arrays: dict[str, NDArray], settings: Mapping[str, Any]) -> bytes:
    packed = BytesIO()
    about = {"settings": np.array(json.dumps(settings))} if settings else {}
    np.savez_compressed(
        packed,
        joint_names=np.array(rig.skeleton.names),
        parents=rig.skeleton.parents,
        vertex_indices=np.arange(len(rig.mesh.vertices)),
        **about,  # type: ignore[arg-type]
        **{name: array.astype(np.float64) for name, array in arrays.items()},  # type: ignore[arg-type]
    )
    return packed.getvalue()


def _packed_csv(rig: Rig, arrays: dict[str, NDArray], settings: Mapping[str, Any]) -> bytes:
    ((what, table),) = arrays.items()
    lines = {"table": what, **settings} if settings else {}
    rows = (
        [vertex, *(f"{value:.{DIGITS}g}" for value in row)]
        for vertex, row in enumerate(table.astype(np.float64).tolist())
    )
    about = "".join(f"# {name}: {value}\r\n" for name, value in lines.items())
    text = _csv(["vertex", *map(spreadsheet_cell, rig.skeleton.names)], rows, "\r\n")
    return (about + text).encode()


def _csv(head: Iterable[object], rows: Iterable[Iterable[object]], end: str = "\n") -> str:
    text = StringIO(newline="")
    csv.writer(text, lineterminator=end).writerows([head, *rows])
    return text.getvalue()


def spreadsheet_cell(name: str) -> str:
    """Return a name as a cell; formulas get an apostrophe (OWASP, "CSV Injection")."""
    is_formula = name.lstrip().startswith(FORMULA) or name.startswith(FORMULA)
    return f"'{printable(name)}" if is_formula else printable(name)


def save_graph(path: Path, graph: CutCellGraph) -> None:
    """Write a graph's nodes and edges; positions and lengths are in the file's units.

    A ".zip" contains "nodes.csv", "edges.csv" and "settings.json"; else the path ends in ".npz".
    """
    kinds = np.array(KINDS)
    places = graph.lattice.to_file(graph.nodes)
    lengths = graph.lengths * graph.lattice.size
    settings = json.dumps(settings_of(graph))
    if path.suffix == ".npz":
        np.savez_compressed(
            path, nodes=places, node_kind=graph.node_kind, triangle=graph.triangle,
            edges=graph.edges, edge_kind=graph.edge_kind, lengths=lengths,
            vertex_node=graph.vertex_node, kinds=kinds,
            settings=np.array(settings),
        )  # fmt: skip
        return
    nodes = zip(
        range(len(places)), kinds[graph.node_kind], *places.T.tolist(), graph.triangle.tolist(),
        strict=True,
    )  # fmt: skip
    edges = zip(*graph.edges.T.tolist(), kinds[graph.edge_kind], lengths.tolist(), strict=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("nodes.csv", _csv(("node", "kind", "x", "y", "z", "triangle"), nodes))
        archive.writestr("edges.csv", _csv(("from", "to", "kind", "length"), edges))
        archive.writestr("settings.json", settings)
