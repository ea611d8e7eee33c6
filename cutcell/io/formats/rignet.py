"""RigNet's pair of text files: ``NAME.obj`` and ``NAME.txt`` or ``NAME_rig.txt``.

Lines of the second: ``joints NAME x y z``, ``root NAME``, ``hier PARENT CHILD``, and
``skin VERTEX JOINT weight JOINT weight ...`` (Xu et al. 2020).
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

import numpy as np

from ...errors import CutcellError, FileError, SkeletonError, WeightsError
from ...rig import Rig, Skeleton, TriangleMesh
from ..files import naming, read_text, whole_characters
from ..materials.obj_materials import ObjSource
from ..obj import numbered_words, numbers, one_number, parse_obj, write_obj
from ..skeletons import SkeletonFile
from ..weights import NO_WEIGHTS, ReadWeights, loaded_rig, summed

SUFFIXES = {".txt": rb"(joints|root|hier|skin)\s"}
NOTE = "RigNet, with an .obj"
MAX_DIGITS = 20
"""Most digits of a vertex's number."""


def rig_file(path: Path) -> Path | None:
    """Return the rig file next to an OBJ, if there is one."""
    choices = (path.with_suffix(".txt"), path.with_name(f"{path.stem}_rig.txt"))
    return next((c for c in choices if c.is_file()), None)


def mesh_file(path: Path) -> Path:
    """Return the OBJ next to a rig file."""
    choices = [path.with_suffix(".obj")]
    if path.stem.endswith("_rig"):
        choices.insert(0, path.with_name(path.stem.removesuffix("_rig") + ".obj"))
    for choice in choices:
        if choice.is_file():
            return choice
    names = " or ".join(c.name for c in choices)
    raise FileError(f"is a RigNet rig whose mesh is missing: put {names} beside it")


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a RigNet rig, given its rig file (``.txt``)."""
    text = read_text(path)  # before its mesh is looked for: it may not be there at all
    obj = mesh_file(path)
    with naming(obj):
        contents = parse_obj(read_text(obj))
    with naming(path):
        skeleton, skin = _parse(text)
        mesh, source = contents.mesh, ObjSource(obj, contents)
        weights = _weights(skin, skeleton.names, len(mesh.vertices), f'mesh "{obj.stem}"')
        return loaded_rig(mesh, skeleton, weights, obj.stem, source=source)


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the skeleton of a rig file (``.txt``), whose mesh need not exist."""
    return SkeletonFile(_parse(read_text(path))[0])


def _parse(text: str) -> tuple[Skeleton, list[tuple[int, list[str]]]]:
    """Return the skeleton, and the number and the words of each line about a vertex."""
    positions: dict[str, list[float]] = {}
    parents: dict[str, str] = {}
    roots: list[str] = []
    skin: list[tuple[int, list[str]]] = []
    for number, tokens in numbered_words(text):
        kind, rest = tokens[0], tokens[1:]
        if kind == "joints":
            if not rest:
                raise FileError(f"line {number}: a joint needs a name")
            if rest[0] in positions:
                raise SkeletonError(f'line {number}: the joint "{rest[0][:40]}" is there twice')
            positions[rest[0]] = numbers(rest[1:], 3, number)
        elif kind == "root":
            roots.append(_joint(rest, 0, number))
        elif kind == "hier":
            parent, child = _joint(rest, 0, number), _joint(rest, 1, number)
            if parents.setdefault(child, parent) != parent:
                raise SkeletonError(f'line {number}: the joint "{child[:40]}" has two parents')
        elif kind == "skin":
            skin.append((number, rest))
        else:
            raise FileError(
                f'line {number}: starts with "{kind[:40]}", expected joints, root, hier or skin'
            )
    if not positions:
        raise SkeletonError("has no joints (no lines that start with the word joints)")
    for name in [*parents, *parents.values(), *roots]:
        if name not in positions:
            raise SkeletonError(f'the joint "{name[:40]}" has no line that gives its position')
    for name in roots:
        if name in parents:
            raise SkeletonError(
                f'the joint "{name[:40]}" is a root but hangs on "{parents[name][:40]}"'
            )
    place = {name: j for j, name in enumerate(positions)}
    above = [place[parents[name]] if name in parents else -1 for name in place]
    return Skeleton(list(positions.values()), above, tuple(place)), skin


def _joint(tokens: list[str], at: int, line: int) -> str:
    if len(tokens) <= at:
        raise FileError(f"line {line}: the name of a joint is missing")
    return tokens[at]


def _weights(
    skin: list[tuple[int, list[str]]], names: tuple[str, ...], vertices: int, owner: str
) -> ReadWeights:
    if not skin:
        return NO_WEIGHTS
    place = {name: j for j, name in enumerate(names)}
    rows, columns, values = [], [], []
    for line, tokens in skin:
        is_index = tokens and tokens[0].isdecimal() and len(tokens[0]) <= MAX_DIGITS
        vertex = int(tokens[0]) if is_index else -1
        if not 0 <= vertex < vertices:
            raise WeightsError(
                f"line {line}: there is no vertex {tokens[0][:40] if tokens else '(missing)'}; the "
                f"mesh has {vertices} (numbered from 0)"
            )
        if len(tokens) % 2 == 0:
            raise WeightsError(f"line {line}: joints and weights must come in pairs")
        for name, word in zip(tokens[1::2], tokens[2::2], strict=True):
            if name not in place:
                raise WeightsError(f'line {line}: there is no joint "{name[:40]}"')
            rows.append(vertex)
            columns.append(place[name])
            values.append(one_number(word, line))
    shape = vertices, len(place)
    return summed(np.array(rows, int), np.array(columns, int), np.array(values), shape, owner)


def write(path: Path, rig: Rig) -> dict[Path, bytes]:
    """Return the two files of a rig, given the path of the rig file (``.txt``)."""
    skeleton, names = rig.skeleton, word_names(rig.skeleton.names)
    lines = [
        f"joints {n} {x!r} {y!r} {z!r}"
        for n, (x, y, z) in zip(names, skeleton.joints.tolist(), strict=True)
    ]
    parents = skeleton.parents.tolist()
    lines += [f"root {n}" for n, p in zip(names, parents, strict=True) if p < 0]
    lines += [f"hier {names[p]} {n}" for n, p in zip(names, parents, strict=True) if p >= 0]
    if rig.weights is not None:
        for i, row in enumerate(rig.weights):
            pairs = " ".join(f"{names[j]} {float(row[j])!r}" for j in np.flatnonzero(row))
            if pairs:
                lines.append(f"skin {i} {pairs}")
    text = "\n".join(lines) + "\n"
    if _has_mesh_file(path, rig.mesh):
        return {path: text.encode()}
    return {_mesh_goal(path): write_obj(rig.mesh).encode(), path: text.encode()}


def check(path: Path, rig: Rig) -> None:
    """Refuse to replace another mesh."""
    _has_mesh_file(path, rig.mesh)


def _has_mesh_file(path: Path, mesh: TriangleMesh) -> bool:
    """Return whether the mesh exists next to a rig file, which then keeps all that it holds."""
    obj = _mesh_goal(path)
    if not os.path.lexists(obj):
        return False
    with suppress(CutcellError):
        existing = parse_obj(read_text(obj)).mesh
        same = np.array_equal(existing.vertices, mesh.vertices)
        if same and np.array_equal(existing.faces, mesh.faces):
            return True
    raise FileError(
        f"its mesh belongs in {obj.name}, but a file of that name is there and holds another "
        "mesh; choose another name, or remove that file"
    )


def _mesh_goal(path: Path) -> Path:
    """Return where the mesh of a rig file is written."""
    stem = path.stem.removesuffix("_rig") if path.stem != "_rig" else path.stem
    return path.with_name(f"{stem}.obj")


def word_names(names: tuple[str, ...]) -> list[str]:
    """Return names without spaces, still unique: words are what these lines are made of."""
    words: dict[str, None] = {}
    numbers: dict[str, int] = {}
    for name in names:
        word = base = "_".join(whole_characters(name).split()) or "joint"
        while word in words:
            numbers[base] = numbers.get(base, 1) + 1
            word = f"{base}_{numbers[base]}"
        words[word] = None
    return list(words)
