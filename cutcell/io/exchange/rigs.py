"""Weights of a rig to and from files of other programs, mesh by mesh."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...errors import FileError, WeightsError
from ...rig import Part, Rig
from ...rig.names import plain, same_names
from ...runtime.writing import check_place, write_all
from ..files import naming
from .files import WEIGHT_FILES, MeshWeights, read_weights

MAX_DISTANCE = 0.1
"""Vertices of a file may be this part of the mesh's diagonal away from the rig's, in the mean."""


def save_weights(path: Path, rig: Rig) -> tuple[Path, ...]:
    """Save the weights of a rig, of each mesh in a file of its own.

    Parameters
    ----------
    path : Path
        Ends in ``.xml`` (Maya), ``.json`` (ngSkinTools) or ``.csv``. Of several meshes each file
        has the mesh's name before this ending.
    rig : Rig

    Returns
    -------
    tuple of Path
        The files that were written.

    Raises
    ------
    FileError
        Another ending, or a file cannot be written.
    WeightsError
        The rig has no weights.
    """
    kind = path.suffix.lower()
    if kind not in WEIGHT_FILES:
        raise FileError(
            f'{path.name}: weights are saved as {", ".join(WEIGHT_FILES)}, not as "{kind}"'
        )
    if rig.weights is None:
        raise WeightsError(f"{rig.name} has no weights to save; bind it first")
    check_place(path)
    files: dict[Path, bytes] = {}
    for part in rig.parts:
        place = path
        if len(rig.parts) > 1:
            name = re.sub(r"[^\w.-]", "_", part.name)
            place, number = path.with_name(f"{path.stem}.{name}{kind}"), 2
            while place in files:  # meshes of one name
                place, number = path.with_name(f"{path.stem}.{name}-{number}{kind}"), number + 1
        points, rows = rig.mesh.vertices[part.vertices], rig.weights[part.vertices]
        one = MeshWeights(part.name, rig.skeleton.names, rows, points)
        files[place] = WEIGHT_FILES[kind][0](one, place).encode()
    write_all(files)
    return tuple(files)


def with_saved_weights(rig: Rig, paths: Sequence[Path]) -> Rig:
    """Return a rig with the weights in some files, by names of meshes and joints.

    A file is for the mesh of its name; of several such meshes, or without any, for the one whose
    vertices are nearest. Vertices follow in order where their number is the same and they are in
    the same places; else each takes the weights of the nearest vertex. Other meshes keep theirs.

    Parameters
    ----------
    rig : Rig
    paths : sequence of Path
        Files as `save_weights` or the other program writes them.

    Returns
    -------
    Rig

    Raises
    ------
    FileError
        A file is not of these formats, or damaged.
    WeightsError
        It names a joint that the rig lacks, fits no mesh, or leaves one without weights.
    """
    shape = (len(rig.mesh.vertices), len(rig.skeleton.names))
    weights = np.zeros(shape) if rig.weights is None else rig.weights.copy()
    used: set[int] = set()
    for path in paths:
        with naming(path):
            for one in read_weights(path):
                number, order = _part_of(rig, one, used)
                used.add(number)
                rows = np.zeros((len(one.weights), shape[1]))
                np.add.at(rows.T, _joints_of(rig, one), one.weights.T)
                weights[rig.parts[number].vertices] = rows[order]
    if rig.weights is None and len(used) < len(rig.parts):
        rest = [part.name for k, part in enumerate(rig.parts) if k not in used]
        raise WeightsError(f"no weights for {', '.join(rest)}; give a file for each mesh")
    return rig.with_weights(weights)


def _part_of(rig: Rig, one: MeshWeights, used: set[int]) -> tuple[int, NDArray[np.intp]]:
    """Return the mesh of a rig that weights are for, and the row for each of its vertices."""
    left = [k for k in range(len(rig.parts)) if k not in used]
    named = [k for k in left if _same_mesh(rig.parts[k].name, one.mesh)] or left
    fits = [(*_order(rig, rig.parts[k], one), k) for k in named]
    if not fits or min(fits, key=lambda fit: fit[0])[0] > MAX_DISTANCE:
        raise WeightsError(
            f'"{one.mesh}" with {len(one.weights):,} vertices lies on no mesh of {rig.name}; save '
            "it in the units and the rest pose of the rig"
        )
    _, order, number = min(fits, key=lambda fit: (fit[0], fit[2]))
    return number, order


def _order(rig: Rig, part: Part, one: MeshWeights) -> tuple[float, NDArray[np.intp]]:
    """Return how far vertices are from those of a file, of the diagonal, and their rows there."""
    points = rig.mesh.vertices[part.vertices]
    in_order, same = np.arange(len(points)), len(points) == len(one.weights)
    if one.points is None:
        return (0.0 if same else np.inf), in_order
    diagonal = max(float(np.linalg.norm(np.ptp(points, axis=0))), 1e-300)
    if same:
        away = np.linalg.norm(points - one.points, axis=1) / diagonal
        if away.max() < 1e-4:
            return float(away.mean()), in_order
    away, nearest = cKDTree(one.points).query(points)
    return float(away.mean()) / diagonal, nearest


def _same_mesh(name: str, other: str) -> bool:
    """Return whether two names are those of a mesh, with or without name space and `Shape`."""
    one, two = (plain(re.sub(r"Shape(\d*)$", r"\1", text)) for text in (name, other))
    return name == other or one == two


def _joints_of(rig: Rig, one: MeshWeights) -> NDArray[np.intp]:
    """Return the rig's joint for each of a file, whose names may be paths in Maya."""
    names = [name.split("|")[-1] for name in one.joints]
    joints = same_names(names, rig.skeleton.names)
    if (lost := (joints < 0) & one.weights.any(axis=0)).any():
        name = names[int(lost.argmax())]
        raise WeightsError(f'"{one.mesh}" follows the joint "{name}", which the rig lacks')
    return np.maximum(joints, 0)
