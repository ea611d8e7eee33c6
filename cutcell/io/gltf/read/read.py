"""From a glTF document to a Rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError, MeshError
from ....rig import Part, Rig, Skeleton, TriangleMesh
from ....rig.transforms import moved
from ...weights import NO_WEIGHTS, ReadWeights, sum_warnings, with_deform
from ..constants import FLOAT, ROUNDED
from ..container import Document
from ..influences import read_deform
from ..nodes import Nodes
from .added_skins import bind_accessories, bind_to_bones, read_attachments
from .clips import read_clips
from .parts import hidden_nodes, left_out_meshes, left_out_warnings, mesh_name, vanishes
from .primitives import StoredFaces, drawn_primitives, read_triangles
from .seams import closed_seams
from .skins import Bind, check_unused, read_bind, read_skeleton

VERTEX_NAMES = ("POSITION", "JOINTS_", "WEIGHTS_")
"""Attributes of a vertex buffer; primitives that share them draw from the same."""


@dataclass(eq=False)
class StoredPart:
    """Vertices that are stored together: one vertex buffer bound to one skin."""

    label: str
    primitives: list[tuple[int, int]]  # (mesh, primitive) that draw from it
    skin: int
    rows: slice  # its vertices in the rig
    joints: Sequence[int]  # joint of the rig for each joint of the skin


@dataclass(frozen=True, eq=False)
class GltfSource:
    """The glTF file that a rig came from, for saving."""

    document: Document
    parts: list[StoredPart]
    skeleton: Skeleton
    nodes: list[int]  # the node of each joint
    inverse: NDArray[np.float64]  # (j, 4, 4): of each joint, for vertices in the rig's space
    faces: tuple[StoredFaces, ...] = ()
    attached: tuple[int, ...] = ()  # the node of each attachment
    mended: dict[int, dict[int, NDArray[np.float64]]] = field(default_factory=dict)
    """Inverse bind matrices that contradict their nodes, as they should be: by skin, and by the
    joint's number in it."""
    rescaled: NDArray[np.bool_] | None = None
    """Vertices whose weights are saved as they were loaded, not as the document has them."""


@dataclass(frozen=True, eq=False)
class BareSource:
    """The glTF file without a skin that a rig came from, for saving."""

    document: Document
    mesh: TriangleMesh  # as it was read
    placed: dict[int, NDArray[np.float64]]  # world matrices (4, 4) of the nodes that show it
    faces: tuple[StoredFaces, ...] = ()  # as they are now, if faces were repaired
    why_bare: str = ""  # why there are no joints, where the file lets expect some


def read_rig(
    document: Document,
    world: NDArray | None = None,
    accessories: bool = False,
    why_bare: str | None = None,
) -> Rig:
    """Return what a document with plain accessors holds.

    `world` is of `read_bind`. Meshes without a skin that hang on joints are bound with the others
    if `accessories`. In a document without a skin, plain nodes may be joints unless `why_bare`
    says why it has none.
    """
    nodes = Nodes(document)
    skinned = skinned_nodes(nodes)
    if skinned:
        for i in skinned:
            document.item("skins", nodes.raw[i]["skin"], document.label("nodes", i))
        skins = list(dict.fromkeys(nodes.raw[i]["skin"] for i in skinned))
        bind = read_bind(document, nodes, skins, world)
    else:
        bones, why = bind_to_bones(document, nodes) if why_bare is None else (None, why_bare)
        if bones is None:
            return read_bare(document, nodes, why)
        bind, skinned = bones, skinned_nodes(nodes)
    check_unused(document, bind)
    rigid = bind_accessories(document, nodes, bind) if accessories else {}
    skinned = skinned_nodes(nodes) if rigid else skinned
    stored = _read_parts(document, nodes, skinned, bind)
    parts = stored.parts
    if not sum(len(corners) for corners in stored.faces):
        raise MeshError("its skinned meshes have no triangles")
    mesh = stored.mesh()
    shape = len(mesh.vertices), len(bind.nodes)
    weights, sums = _dense(document, stored, shape, rigid)
    stored_deform = read_deform(document, bind.skins, len(bind.nodes))
    skeleton, weights, warnings = with_deform(
        mesh, read_skeleton(nodes, bind), weights, stored_deform
    )
    attached = read_attachments(document, nodes, bind)
    left_out = left_out_meshes(document, nodes, skinned, attached)
    warnings += sum_warnings(sums, mesh.faces, stored.named)
    warnings += left_out_warnings(left_out, attached.values())
    inverse = np.array(bind.inverse)
    clips = read_clips(document, nodes, bind.nodes, inverse, bind.world)
    document.forget()
    faces, shown = tuple(stored.drawn), tuple(attached)
    source = GltfSource(document, parts, skeleton, bind.nodes, inverse, faces, shown, bind.mended)
    return Rig(
        mesh,
        skeleton,
        weights,
        clips=clips,
        attachments=tuple(attached.values()),
        name=document.path.stem,
        world=bind.world,
        allowed=_allowed(parts, len(mesh.vertices), len(bind.nodes)),
        parts=tuple(stored.named),
        left_out=left_out,
        warnings=(*document.warnings, *warnings),
        weight_sums=sums,
        source=source,
    )


def read_bare(document: Document, nodes: Nodes, why: str = "") -> Rig:
    """Return the scene's meshes as a rig without joints; `why` is said where that surprises."""
    shown = [i for i, node in enumerate(nodes.raw) if "mesh" in node]
    shown = sorted(set(shown) & set(nodes.in_scene())) or shown
    placed = {}
    for i in shown:
        if len(read_triangles(document, nodes.raw[i]["mesh"], document.label("nodes", i))[1]):
            placed[i] = nodes.world[i]
    if not placed:
        raise MeshError("its meshes have no triangles")
    bind = Bind(skins={i: [] for i in placed}, to_rig=placed)
    stored = _read_parts(document, nodes, list(placed), bind, is_bare=True)
    mesh = stored.mesh()
    left_out = left_out_meshes(document, nodes, placed, ())
    read_clips(document, nodes, [], np.zeros((0, 4, 4)), np.eye(4))  # as saving does
    document.forget()
    return Rig(
        mesh,
        Skeleton([], []),
        name=document.path.stem,
        parts=tuple(stored.named),
        left_out=left_out,
        warnings=(*document.warnings, *filter(None, [why]), *left_out_warnings(left_out, ())),
        source=BareSource(document, mesh, placed, tuple(stored.drawn), why),
    )


def skinned_nodes(nodes: Nodes) -> list[int]:
    """Return the nodes with a skinned mesh, those of the default scene if it has any."""
    skinned = [i for i, n in enumerate(nodes.raw) if "skin" in n and "mesh" in n]
    if not skinned and not any("mesh" in n for n in nodes.raw):
        raise FileError("has no mesh")
    return sorted(set(skinned) & set(nodes.in_scene())) or skinned


class _Stored(NamedTuple):
    """Arrays of the skinned meshes; vertices and weights are those of `parts`."""

    parts: list[StoredPart]
    vertices: list[NDArray]
    weights: list[ReadWeights]
    faces: list[NDArray]
    drawn: list[StoredFaces]
    named: list[Part]
    grids: dict[tuple[int, bytes], list[NDArray]]  # see `closed_seams`

    def mesh(self) -> TriangleMesh:
        vertices, faces = np.concatenate(self.vertices), np.concatenate(self.faces)
        return TriangleMesh(closed_seams(vertices, faces, self.grids), faces)  # type: ignore[arg-type]


def _read_parts(
    document: Document, nodes: Nodes, shown: list[int], bind: Bind, is_bare: bool = False
) -> _Stored:
    """Read every vertex buffer once; without skins, each node counts as one of no joints.

    A mesh with two skins is read for the first: both draw with the same stored weights.
    """
    parts: dict[Any, StoredPart] = {}
    stored = _Stored([], [], [], [], [], [], {})
    _, vertices, weights, faces, drawn, named, grids = stored
    hidden = hidden_nodes(nodes)
    read_meshes: set[int] = set()
    total = triangles = 0
    for i in shown:
        mesh, skin, first = nodes.raw[i]["mesh"], i if is_bare else nodes.raw[i]["skin"], total
        document.item("meshes", mesh, document.label("nodes", i))
        if mesh in read_meshes and not is_bare:
            continue
        read_meshes.add(mesh)
        for primitive in drawn_primitives(document, mesh, document.label("nodes", i)):
            positions, corners = primitive.positions, primitive.faces()
            named_accessors, to_rig = primitive.attributes, bind.to_rig[skin]
            shared = [one for one in named_accessors.items() if one[0].startswith(VERTEX_NAMES)]
            key = skin, *sorted(shared)
            if key not in parts:
                document.allowance.take(positions.nbytes, primitive.label)
                joints = bind.skins[skin]
                rows = slice(total, total := total + len(positions))
                parts[key] = StoredPart(primitive.label, [], skin, rows, joints)
                vertices.append(moved(positions, to_rig))
                weights.append(primitive.weights(len(joints)) if joints else NO_WEIGHTS)
                index = named_accessors["POSITION"]
                accessor, by_draco = document.items("accessors")[index], {ROUNDED: True}
                own = index if accessor.get("extras") == by_draco else -1
                grid = grids.setdefault((own, to_rig.tobytes()), [])
                if own >= 0 or accessor["componentType"] != FLOAT:
                    grid.append(positions * np.linalg.norm(to_rig[:3, :3]))
            parts[key].primitives.append((mesh, primitive.number))
            is_mirrored = bool(np.linalg.det(to_rig[:3, :3]) < 0)
            if is_mirrored:
                corners = corners[:, ::-1]  # what was outside stays outside
            start = parts[key].rows.start
            rows = slice(triangles, triangles := triangles + len(corners))
            faces.append(corners + start)
            drawn.append(StoredFaces(i, mesh, primitive.number, start, rows, is_mirrored))
        if total > first:
            rows = slice(first, total)
            hides = i in hidden or (is_bare and vanishes(nodes, i))
            named.append(Part(mesh_name(document, nodes, i), rows, hides))
    return stored._replace(parts=list(parts.values()))


def _dense(
    document: Document, stored: _Stored, shape: tuple[int, int], rigid: Mapping[int, int]
) -> tuple[NDArray | None, NDArray | None]:
    """Return all weights and the rows' sums in the file; `rigid` has the joints of rigid meshes."""
    if all(read.weights is None for read in stored.weights):
        return None, None
    document.allowance.take_weights(*shape)
    weights, sums = np.zeros(shape), np.zeros(shape[0])
    for part, read in zip(stored.parts, stored.weights, strict=True):
        if read.weights is not None and read.sums is not None:
            weights[part.rows, part.joints] = read.weights
            sums[part.rows] = read.sums
        elif part.primitives[0][0] in rigid:
            weights[part.rows, rigid[part.primitives[0][0]]] = sums[part.rows] = 1
    return weights, sums


def _allowed(parts: list[StoredPart], vertices: int, joints: int) -> NDArray | None:
    if all(len(part.joints) == joints for part in parts):
        return None
    allowed = np.zeros((vertices, joints), bool)
    for part in parts:
        allowed[part.rows, part.joints] = True
    return allowed
