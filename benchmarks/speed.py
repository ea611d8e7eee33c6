"""How fast every stage is beside its peers, timed in turn in the same run.

python -m benchmarks.speed [RIG...] [--resolutions 64 128] [--repeats 5] [--markdown OUT]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import igl
import numpy as np

import cutcell
from cutcell.geodesics import bone_distances, bone_segments
from cutcell.geodesics.shortest_paths import shortest_paths
from cutcell.graph import build_graph
from cutcell.weights.warm_up import warm_up
from cutcell_lab.benchmarks.rigs import Character, load_characters
from cutcell_lab.benchmarks.tables import Table, publish, ratio, seconds

from . import meshers, recipe, start_up
from .stages import cast, decide, midpoints, prepare
from .timing import Times, in_turn

ALL = "**median**"


class Sheet:
    """A table of times with a row for each rig and resolution, and medians at its end."""

    def __init__(
        self, title: str, first: str, peers: Sequence[str], ratios: Sequence[str], note: str
    ) -> None:
        against = [f"{first} vs {peer}" for peer in ratios]
        self.table = Table(title, ["rig", "R", first, *peers, *against], note)
        self.first, self.ratios, self.peers = first, ratios, peers
        self.rows: dict[int, list[tuple[list[float], list[float]]]] = {}

    def add(self, rig: str, resolution: int, times: dict[str, Times | None]) -> None:
        """Append the times of one rig; a peer that is not there is shown as a dash."""
        first_times = times[self.first]
        assert first_times is not None
        row_times = [times.get(name) for name in (self.first, *self.peers)]
        against = [times.get(name) for name in self.ratios]
        medians = [t.median if t else np.nan for t in row_times]
        faster = [t.median / first_times.median if t else np.nan for t in against]
        self.rows.setdefault(resolution, []).append((medians, faster))
        self.table.add(
            rig, resolution, *(str(t) if t else "-" for t in row_times), *map(_ratio_cell, faster)
        )
        print(f"{self.table.title}: {rig}, R={resolution}", file=sys.stderr, flush=True)

    def finish(self) -> Table:
        """Add the medians over all rigs, and the least ratio in brackets."""
        for resolution, rows in self.rows.items():
            medians, faster = (np.array([row[k] for row in rows]) for k in range(2))
            cells = [seconds(x) if np.isfinite(x) else "-" for x in _medians(medians)]
            least = np.where(np.isfinite(faster), faster, np.inf).min(axis=0)
            over = [
                f"{ratio(m)} (least {ratio(low)})" if np.isfinite(m) else "-"
                for m, low in zip(_medians(faster), least, strict=True)
            ]
            self.table.add(ALL, resolution, *cells, *over)
        return self.table


def _medians(values: np.ndarray) -> np.ndarray:
    finite = [column[np.isfinite(column)] for column in values.T]
    return np.array([np.median(column) if len(column) else np.nan for column in finite])


def _ratio_cell(value: float) -> str:
    return ratio(value) if np.isfinite(value) else "-"


def graph_table(characters: list[Character], options: argparse.Namespace) -> Table:
    """Time graph construction against the recipe."""
    sheet = Sheet(
        "Graph construction",
        "cutcell",
        ["recipe", "copy of the result"],
        ["recipe"],
        f"Mesh to graph, connectivity 6. The recipe casts its rays by {_cast_name()} and asks "
        "libigl's fast winding number about each midpoint between the first and last hit of a "
        "ray. Copying the arrays that make up the graph is the floor. The last rigs are the first "
        "one torn: every triangle shrunk, so that no two of them touch; a quarter of them gone; "
        "half of them turned round, by chance.",
    )
    for character, resolution in _each([*characters, *_torn(characters[0])], options):
        mesh = character.rig.mesh
        graph = build_graph(mesh, resolution, connectivity=6)
        arrays = [graph.nodes, graph.edges, graph.lengths, graph.node_kind, graph.edge_kind]
        ways: dict[str, Callable[[], object]] = {
            "cutcell": lambda m=mesh, r=resolution: build_graph(m, r, connectivity=6),
            "recipe": lambda m=mesh, r=resolution: recipe.build_graph(m, r, _caster()),
            "copy of the result": lambda a=arrays: [x.copy() for x in a],
        }
        sheet.add(character.name, resolution, _timed(ways, options))
    return sheet.finish()


def rays_table(characters: list[Character], options: argparse.Namespace) -> Table:
    """Time ray casting against Open3D and Embree."""
    sheet = Sheet(
        "Ray casting, all hits",
        "cutcell",
        ["Open3D list_intersections", "Embree"],
        ["Open3D list_intersections", "Embree"],
        "3 R^2 rays through a welded mesh in the unit cube. Peers compute in float32 and "
        "include building their scenes; Embree's rays start again behind each hit.",
    )
    for character, resolution in _each(characters, options):
        mesh = prepare(character.rig.mesh, resolution)
        shape = (mesh.mesh.points, mesh.mesh.faces, resolution)
        ways: dict[str, Callable[[], object]] = {"cutcell": lambda p=mesh: cast(p)}
        if has_open3d():
            ways["Open3D list_intersections"] = lambda s=shape: [
                recipe.hits_open3d(*s, axis) for axis in range(3)
            ]
        ways["Embree"] = lambda s=shape: [recipe.hits_embree(*s, axis) for axis in range(3)]
        sheet.add(character.name, resolution, _timed(ways, options))
    return sheet.finish()


def winding_table(characters: list[Character], options: argparse.Namespace) -> Table:
    """Time the decision inside or outside against libigl's fast winding number."""
    sheet = Sheet(
        "Inside or outside, all segments",
        "cutcell",
        ["libigl fast winding number"],
        ["libigl fast winding number"],
        "From crossings to kept segments, exactly; against libigl's approximation at the "
        "midpoints between the first and last crossing of each ray.",
    )
    for character, resolution in _each(characters, options):
        mesh = prepare(character.rig.mesh, resolution)
        crossings = cast(mesh)
        points, faces = midpoints(mesh, crossings), mesh.mesh.faces.astype(np.int64)
        ways: dict[str, Callable[[], object]] = {
            "cutcell": lambda p=mesh, c=crossings: decide(p, c),
            "libigl fast winding number": lambda v=mesh.mesh.points, f=faces, q=points: (
                igl.fast_winding_number(v, f, q)
            ),
        }
        sheet.add(character.name, resolution, _timed(ways, options))
    return sheet.finish()


def distances_table(
    characters: list[Character], options: argparse.Namespace, connectivity: int = 6
) -> Table:
    """Time shortest paths against scipy's Dijkstra on the same graph, from the same sources."""
    whole = "with sources and fallback"
    sheet = Sheet(
        f"Distances of all bones to all vertices, connectivity {connectivity}",
        "cutcell",
        [whole, "scipy Dijkstra"],
        ["scipy Dijkstra"],
        "On the same graph, from the same sources. scipy's input is a finished matrix with a "
        "node for each bone; cutcell starts from the graph. The next column is the time of "
        "`bone_distances` as a whole, which also finds the sources first and finally handles "
        "vertices that no path reaches. The distances differ by less than 1e-6 (relative), "
        "unless stated otherwise.",
    )
    worst = 0.0
    for character, resolution in _each(characters, options):
        skeleton = character.rig.skeleton
        graph = build_graph(character.rig.mesh, resolution, connectivity=connectivity)
        sources = bone_distances(graph, skeleton, method="paper").sources
        count = len(bone_segments(skeleton).joint)
        augmented = recipe.with_bones(
            graph.csr(), sources.bone, sources.node, sources.distance, count
        )
        targets = graph.vertex_node
        problem = graph, sources, count, targets
        ways: dict[str, Callable[[], object]] = {
            "cutcell": lambda p=problem: shortest_paths(*p),
            whole: lambda g=graph, s=skeleton: bone_distances(g, s, method="paper"),
            "scipy Dijkstra": lambda a=augmented, b=count, t=targets: recipe.scipy_distances(
                a, b, t
            ),
        }
        sheet.add(character.name, resolution, _timed(ways, options))
        exact = recipe.scipy_distances(augmented, count, targets)
        worst = max(worst, _difference(shortest_paths(*problem), exact))
    table = sheet.finish()
    table.note += f" Largest relative difference seen: {worst:.1e}."
    if worst > 1e-6:
        table.note += " **That is too much.**"
    return table


def _difference(distances: np.ndarray, exact: np.ndarray) -> float:
    finite = np.isfinite(exact)
    if (np.isfinite(distances) != finite).any():
        return np.inf
    scale = np.maximum(exact[finite], 1e-9)
    return float((np.abs(distances[finite] - exact[finite]) / scale).max(initial=0))


def bind_table(characters: list[Character], options: argparse.Namespace) -> Table:
    """Time the whole way from rig to weights."""
    blender = "Blender bone heat, elsewhere"
    sheet = Sheet(
        "Rig to weights",
        "cutcell",
        ["paper's falloff", "connectivity 6", "recipe", blender],
        ["recipe", blender],
        "`bind`, warm, at R=64: with the defaults; with any-angle distances and the paper's "
        'falloff (`falloff="paper"`); and with the paper\'s graph as well (`connectivity=6`), as '
        "in the recipe. Blender's times are from the reference weights and were measured on "
        "another machine.",
    )
    for character in characters:
        rig = character.rig
        ways: dict[str, Callable[[], object]] = {
            "cutcell": lambda r=rig: cutcell.bind(r, 64),
            "paper's falloff": lambda r=rig: cutcell.bind(r, 64, falloff="paper"),
            "connectivity 6": lambda r=rig: cutcell.bind(r, 64, connectivity=6, falloff="paper"),
            "recipe": lambda r=rig: recipe.bind(r, 64, _caster()),
        }
        times: dict[str, Times | None] = dict(_timed(ways, options))
        if character.blender_seconds is not None:
            times[blender] = Times((character.blender_seconds,))
        sheet.add(f"{character.name} ({character.size})", 64, times)
    return sheet.finish()


TABLES = {
    "graph": graph_table,
    "rays": rays_table,
    "winding": winding_table,
    "distances": distances_table,
    "distances26": partial(distances_table, connectivity=26),
    "bind": bind_table,
    "meshers": meshers.meshers_table,
    "start": start_up.start_up_table,
}


def has_open3d() -> bool:
    """Return whether Open3D can be loaded."""
    try:
        import open3d  # noqa: F401
    except (ImportError, OSError):
        return False
    return True


_chosen: list[Callable] = []


def _caster() -> Callable:
    """Choose the faster ray caster for the recipe: tried once, on a torus at R = 64."""
    if not _chosen:
        ways = {recipe.hits_embree.__name__: recipe.hits_embree}
        if has_open3d():
            ways[recipe.hits_open3d.__name__] = recipe.hits_open3d
        shape = _torus()
        times = in_turn({name: lambda c=call: c(*shape, 64, 0) for name, call in ways.items()}, 3)
        _chosen.append(ways[min(times, key=lambda name: times[name].median)])
    return _chosen[0]


def _cast_name() -> str:
    return {"hits_embree": "Embree", "hits_open3d": "Open3D"}[_caster().__name__]


def _torus() -> tuple[np.ndarray, np.ndarray]:
    import trimesh

    mesh = trimesh.creation.torus(0.33, 0.13, major_sections=96, minor_sections=32)
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, np.int32)


def _torn(character: Character) -> list[Character]:
    """Spoil a mesh in several ways."""
    mesh = character.rig.mesh
    chance = np.random.default_rng(0).random(len(mesh.faces))
    turned = np.where((chance < 0.5)[:, None], mesh.faces[:, ::-1], mesh.faces)
    meshes = {
        "shrunk by 1 %": _pulled_apart(mesh, 0.99),
        "shrunk by 20 %": _pulled_apart(mesh, 0.8),
        "a quarter gone": cutcell.TriangleMesh(mesh.vertices, mesh.faces[chance > 0.25]),
        "half turned": cutcell.TriangleMesh(mesh.vertices, turned),
    }
    skeleton = character.rig.skeleton
    return [
        Character(f"{character.name}, {name}", cutcell.Rig(mesh, skeleton), None)
        for name, mesh in meshes.items()
    ]


def _pulled_apart(mesh: cutcell.TriangleMesh, share: float) -> cutcell.TriangleMesh:
    """Shrink each triangle towards its middle."""
    corners = mesh.vertices[mesh.faces]
    middle = corners.mean(axis=1, keepdims=True)
    points = (middle + share * (corners - middle)).reshape(-1, 3)
    return cutcell.TriangleMesh(points, np.arange(len(points)).reshape(-1, 3))


def _each(characters, options):
    return [(c, r) for r in options.resolutions for c in characters]


def _timed(ways, options) -> dict[str, Times]:
    return in_turn(ways, options.repeats, options.patience)


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.speed", description=__doc__)
    parser.add_argument("rigs", nargs="*", metavar="RIG", help="all at hand when left out")
    parser.add_argument("--resolutions", type=int, nargs="+", default=[64, 128], metavar="R")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--patience", type=float, default=30, help="seconds for one peer and rig")
    parser.add_argument("--tables", nargs="+", choices=TABLES, default=list(TABLES))
    parser.add_argument("--mesher-python", default=sys.executable, help="has pytetwild, tetgen")
    parser.add_argument("--mesher-limit", type=float, default=120, help="seconds for one mesh")
    parser.add_argument("--cold", action="store_true", help="also time the very first compile")
    parser.add_argument("--markdown", type=Path, metavar="OUT")
    return parser.parse_args(argv)


def tables(options: argparse.Namespace) -> list[Table]:
    """Measure what was asked for."""
    characters = load_characters(options.rigs)
    warm_up()  # a first run that compiles would be too long to be repeated
    return [TABLES[name](characters, options) for name in options.tables]


def main(argv: Sequence[str] | None = None) -> None:
    """Print the tables, and write them too if a file is named."""
    options = arguments(argv)
    publish(tables(options), options.markdown)


if __name__ == "__main__":
    main()
