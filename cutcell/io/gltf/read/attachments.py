"""Meshes without a skin that hang on joints, such as a sword."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....errors import MeshError
from ....rig import Attachment, TriangleMesh
from ..container import Document
from ..nodes import Nodes
from .added_skins import add_skins, has_volume
from .parts import draws_mesh, hidden_nodes, vanishes
from .primitives import read_triangles
from .skins import Bind


def moved(points: NDArray, matrix: NDArray) -> NDArray:
    """Return points (n, 3) moved by a matrix (4, 4)."""
    if np.array_equal(matrix, np.eye(4)):
        return points
    return points @ matrix[:3, :3].T + matrix[:3, 3]


class _Hanging(NamedTuple):
    """A mesh without a skin below a joint."""

    node: int
    joint: int
    to_rig: NDArray[np.float64]
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]


def _hanging(document: Document, nodes: Nodes, bind: Bind) -> Iterator[_Hanging]:
    place = {node: j for j, node in enumerate(bind.nodes)}
    nearest = nodes.nearest(place)
    # From the mesh up to the joint by the local transforms: a joint that is scaled to nothing at
    # rest (a hidden weapon) could not be inverted.
    local = nodes.relative_to(bind.nodes)
    for i, node in enumerate(nodes.raw):
        if "mesh" not in node or "skin" in node or nearest[i] < 0:
            continue
        joint = place[nearest[i]]
        vertices, faces, drawn = read_triangles(document, node["mesh"], document.label("nodes", i))
        if drawn and local[i, :3, :3].any():
            yield _Hanging(i, joint, np.linalg.inv(bind.inverse[joint]) @ local[i], vertices, faces)


def bind_accessories(document: Document, nodes: Nodes, bind: Bind) -> dict[int, int]:
    """Give skins to the meshes of the scene without one; return the joint of each that has one."""
    hanging = {one.node: one for one in _hanging(document, nodes, bind)}
    to_rig = {i: one.to_rig for i, one in hanging.items()}
    if has_volume(bind.world):
        from_scene = np.linalg.inv(bind.world)
        unskinned = (
            i for i in nodes.in_scene() if nodes.raw[i].keys() & {"mesh", "skin"} == {"mesh"}
        )
        to_rig |= {i: from_scene @ nodes.world[i] for i in unskinned if i not in hanging}
    to_rig = {
        i: matrix
        for i, matrix in sorted(to_rig.items())
        if draws_mesh(document, nodes, i) and not vanishes(nodes, i) and has_volume(matrix)
    }
    add_skins(document, nodes, bind, to_rig)
    return {nodes.raw[i]["mesh"]: hanging[i].joint for i in to_rig if i in hanging}


def read_attachments(document: Document, nodes: Nodes, bind: Bind) -> dict[int, Attachment]:
    """Return the attachment of each node that has one."""
    hidden = hidden_nodes(nodes)
    attachments: dict[int, Attachment] = {}
    for i, joint, to_rig, vertices, corners in _hanging(document, nodes, bind):
        document.allowance.take(vertices.nbytes + corners.nbytes, document.label("nodes", i))
        faces = corners[:, ::-1] if np.linalg.det(to_rig[:3, :3]) < 0 else corners
        name = nodes.raw[i].get("name") or f"attachment {len(attachments)}"
        try:
            mesh = TriangleMesh(moved(vertices, to_rig), faces)  # type: ignore[arg-type]
        except MeshError as e:
            raise MeshError(f"{document.label('nodes', i)}: {e}") from None
        attachments[i] = Attachment(str(name), mesh, joint, i in hidden or vanishes(nodes, i))
    return attachments
