"""A graph's nodes and edges as numbers: two tables in a ZIP, or arrays in an NPZ."""

import csv
import io
import json
import zipfile
from pathlib import Path

import numpy as np

from cutcell.graph import CutCellGraph
from cutcell_viewers.graph_scene import KINDS

from .table_export import settings_of


def save_graph(path: Path, graph: CutCellGraph) -> None:
    """Write a graph's nodes and edges; positions and lengths are in the file's units.

    A ".zip" contains "nodes.csv", "edges.csv" and "settings.json"; else the path ends in ".npz".
    """
    places = graph.lattice.to_file(graph.nodes)
    lengths = graph.lengths * graph.lattice.size
    settings = json.dumps(settings_of(graph))
    if path.suffix == ".npz":
        np.savez_compressed(
            path, nodes=places, node_kind=graph.node_kind, triangle=graph.triangle,
            edges=graph.edges, edge_kind=graph.edge_kind, lengths=lengths,
            vertex_node=graph.vertex_node, kinds=np.array(KINDS),
            settings=np.array(settings),
        )  # fmt: skip
        return
    kinds = np.array(KINDS)
    nodes = zip(
        range(len(places)), kinds[graph.node_kind], *places.T.tolist(), graph.triangle.tolist(),
        strict=True,
    )  # fmt: skip
    edges = zip(*graph.edges.T.tolist(), kinds[graph.edge_kind], lengths.tolist(), strict=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, head, rows in (
            ("nodes.csv", ("node", "kind", "x", "y", "z", "triangle"), nodes),
            ("edges.csv", ("from", "to", "kind", "length"), edges),
        ):
            text = io.StringIO()
            table = csv.writer(text, lineterminator="\n")
            table.writerow(head)
            table.writerows(rows)
            archive.writestr(name, text.getvalue())
        archive.writestr("settings.json", settings)
