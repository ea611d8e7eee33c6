"""Fit a template into a mesh: `fit_skeleton`."""

from __future__ import annotations

from typing import Literal, cast, get_args

import numpy as np

from ..checks import check_choice
from ..errors import MeshError
from ..graph import CutCellGraph, build_graph
from ..graph.fingerprint import data_fingerprint, require_same
from ..rig import Skeleton
from ..rig.inputs import MeshLike, as_mesh
from ..runtime.progress import Progress, silent
from . import biped, hand, quadruped
from .frame import Joints, lying, standing
from .interior import Interior, along

Template = Literal["biped", "quadruped", "hand", "snake", "chain"]
TEMPLATES: tuple[Template, ...] = get_args(Template)
FIT_RESOLUTION = 64
"""With half of it arms are narrower than a lattice cell, and no path runs through them."""
FEWEST_NODES = 8
ENDS = 0.12
"""Share of the length at each end in which its thickness is measured."""
STANDING = {
    "biped": (biped.place, biped.BIPED_PARENTS),
    "quadruped": (quadruped.place, quadruped.QUADRUPED_PARENTS),
}
CHAINS = {
    "snake": tuple(f"spine.{n}" for n in range(1, 13)),
    "chain": tuple(f"bone.{n}" for n in range(1, 6)),
}


def check_template(name: str) -> Template:
    """Return the template of a name."""
    return cast(Template, check_choice("template", name, TEMPLATES))


def fit_skeleton(
    mesh: MeshLike,
    template: Template,
    *,
    graph: CutCellGraph | None = None,
    progress: Progress = silent,
) -> Skeleton:
    """Fit a template skeleton into a mesh that has none.

    The ends of the body, such as hands and feet, are found as the farthest points of paths
    through its inside. Where such paths part, limbs begin. Joints lie on paths through the middle
    of the body, at the proportions of the template. Left and right are alike where the body
    stands alike on both sides. It is a beginning: joints are there to be moved.

    Parameters
    ----------
    mesh : TriangleMesh, (vertices, faces), trimesh.Trimesh or pyvista.PolyData
    template : {"biped", "quadruped", "hand", "snake", "chain"}
        Bipeds and quadrupeds stand upright, y or z up.
    graph : CutCellGraph, optional
        The mesh's, if it is there. It is built when left out, and where this one is too coarse to
        tell limbs apart, or finer than is needed.
    progress : callable
        See `cutcell.runtime.progress`.

    Returns
    -------
    Skeleton
        In the mesh's space and units; all joints inside where the mesh has an inside there.

    Raises
    ------
    ParameterError
        There is no such template, or the graph is of another mesh.
    MeshError
        The mesh has no inside that joints could be in.
    SkeletonError
        The mesh does not have what the template needs, such as fingers.

    Examples
    --------
    >>> rig = cutcell.load("statue.obj")  # doctest: +SKIP
    >>> skeleton = cutcell.fit_skeleton(rig.mesh, "biped")  # doctest: +SKIP
    >>> binding = cutcell.bind((rig.mesh, skeleton))  # doctest: +SKIP
    """
    template = check_template(template)
    mesh = as_mesh(mesh)
    if graph is not None:
        require_same("graph", graph.fingerprint, data_fingerprint(mesh))
    if graph is None or not FIT_RESOLUTION <= graph.lattice.resolution <= 2 * FIT_RESOLUTION:
        graph = build_graph(mesh, FIT_RESOLUTION, progress=progress)
    nodes = graph.nodes[graph.connected]
    if len(graph.interior) < FEWEST_NODES:
        raise MeshError(
            "the mesh has no inside that joints could lie in: it is too thin, or open everywhere"
        )
    axes = np.eye(3)
    if template in STANDING:
        axes = standing(nodes, tall=template == "biped")
    elif template == "hand":
        axes = lying(nodes)
    body = Interior(graph, axes, (nodes.min(axis=0) + nodes.max(axis=0)) / 2)
    joints, parents = _placed(body, template)
    names = list(parents)
    inside = body.inward(np.array([joints[name] for name in names]))
    above = [names.index(parents[name]) if parents[name] else -1 for name in names]
    return Skeleton(body.to_file(inside), above, names)


def _placed(body: Interior, template: Template) -> tuple[Joints, dict[str, str]]:
    if template in STANDING:
        place, parents = STANDING[template]
        return place(body), parents
    if template == "hand":
        joints = hand.place(body)
        return joints, hand.parents_of(joints)
    names = CHAINS[template]
    return _chain(body, names), dict(zip(names, ("", *names), strict=False))


def _chain(body: Interior, names: tuple[str, ...]) -> Joints:
    """Return where joints are along the middle of a body, from its thick end to its thin one."""
    start = int(body.distances(0).argmax())
    end = int(body.distances(start).argmax())
    path = body.middle_path(start, end)
    inset = 0.5 / len(names)
    shares = np.linspace(0.3 * inset, 1 - inset, len(names))
    if _thickness(body, end) > _thickness(body, start):
        path = path[::-1]
    return dict(zip(names, along(path, shares), strict=True))


def _thickness(body: Interior, end: int) -> float:
    far = body.distances(end)
    return float(body.depth[far < ENDS * far.max()].max())


def names_of(template: Template) -> list[tuple[str, ...]]:
    """Return the names that a template may give its joints: a hand may have fewer fingers."""
    if template in STANDING:
        return [tuple(STANDING[template][1])]
    return hand.names() if template == "hand" else [CHAINS[template]]
