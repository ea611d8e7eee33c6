"""Materials and corners of formats that list them by face, and corners as a new GLB has them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...errors import CutcellError, FileError
from ...geometry.triangles import normals as face_normals
from ..files import read_beside
from .face_colors import BLENDED, OPAQUE, Collected, FaceColors, Layer, StoredImage

WHITE = (1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Surface:
    """The materials of a mesh's faces, and what their corners have."""

    faces: NDArray[np.int32]  # (m, 3): as they were read
    material: NDArray[np.int32]  # (m,): of each face, -1 for none
    places: NDArray[np.float32] | None = None
    """(m, 3, 2): position of each corner in the image, from its upper left corner."""
    colors: NDArray[np.uint8] | None = None  # (m, 3, 3): of each corner, sRGB
    normals: NDArray[np.float32] | None = None
    """(m, 3, 3): of each corner, of any length; zero or not finite where there is none."""

    @property
    def is_painted(self) -> bool:
        """True if faces have materials, or corners colours."""
        return self.colors is not None or bool((self.material >= 0).any())


@dataclass(frozen=True)
class Material:
    """The base colour of a material."""

    name: str
    color: tuple[float, ...] = WHITE  # red, green and blue from 0 to 1, sRGB
    image: int = -1  # -1 for none
    opacity: float = 1.0  # from 0 to 1
    blended: bool = False  # whether the image's alpha counts
    replaced: bool = False
    """The image replaces the colour, instead of being multiplied by it."""

    @property
    def tint(self) -> tuple[int, ...]:
        """The colour as bytes."""
        return tuple(np.round(255 * np.clip(np.nan_to_num(self.color), 0, 1)).astype(int).tolist())


@dataclass(frozen=True)
class ImageFile:
    """An image that a file brings, or only names."""

    names: tuple[str, ...]
    """Possible names of a separate file; the first that exists is used."""
    content: bytes = b""  # empty for a separate file


@dataclass(frozen=True, eq=False)
class Surfaces:
    """The materials of a file, and which faces have them."""

    path: Path  # the file; images are in its folder
    meshes: Mapping[int, Surface]
    """By the numbers of the meshes in the document that was made of the file; else 0 alone."""
    materials: tuple[Material, ...] = ()
    images: tuple[ImageFile, ...] = ()
    notes: tuple[str, ...] = ()  # what could not be read, in sentences

    @cached_property
    def coloured(self) -> bool:
        """True if there is more to see than one grey."""
        painted = [one for one in self.meshes.values() if one.is_painted]
        used = {int(k) for one in painted for k in np.unique(one.material)}
        materials = [self.materials[k] for k in used if k >= 0]
        if any(one.image >= 0 for one in materials):
            return True
        shades = {one.color for one in materials} | ({WHITE} if -1 in used else set())
        grey = len(shades) == 1 and all(len(set(shade)) == 1 for shade in shades)
        varied = (one.colors for one in painted if one.colors is not None)
        return (bool(shades) and not grey) or any((c != c[0, 0, 0]).any() for c in varied)

    def stored_image(self, number: int) -> StoredImage:
        """Return an image as it is stored, in the file or beside it."""
        image = self.images[number]
        name = next(filter(None, image.names), "").replace("\\", "/").rsplit("/", 1)[-1]
        label = f'image "{name[:80]}"' if name else "an image"
        return StoredImage(label, image.content or read_beside(self.path, image.names, label))


def paint_surface(
    surfaces: Surfaces,
    collected: Collected,
    surface: Surface | None,
    at: NDArray,
    colors: FaceColors,
) -> None:
    """Fill the rows of a mesh; `at` are its vertices by its own numbers; see `Paint`."""
    where = None if surface is None else stored_corners(surface.faces, at)
    if surface is None or where is None:
        return
    material = surface.material[where[:, 0] // 3]
    places = None if surface.places is None else surface.places.reshape(-1, 2)[where]
    for k in np.unique(material[material >= 0]).tolist():
        rows = np.flatnonzero(material == k)
        one = surfaces.materials[k]
        colors.materials[rows] = collected.material(k, one.name)
        colors.tints[rows] = one.tint
        through = one.blended or one.opacity < 1
        colors.opacity[rows] = round(OPAQUE * min(max(one.opacity, 0), 1))
        colors.corners[rows, :, 3] = BLENDED * through
        try:
            layer = _layer(surfaces, collected, one, places)
        except CutcellError as error:
            collected.note(f'material "{one.name}"' if one.name else "a material", error)
            continue
        if layer >= 0 and places is not None:
            if one.replaced:
                colors.tints[rows] = OPAQUE
            colors.corners[rows, :, 2] = layer
            colors.corners[rows, :, :2] = np.where(np.isfinite(places[rows]), places[rows], 0)
    if surface.colors is not None:
        colors.tints[:] = np.round(colors.tints * (surface.colors.reshape(-1, 3)[where] / 255))


def _layer(
    surfaces: Surfaces, collected: Collected, material: Material, places: NDArray | None
) -> int:
    """Return the number of a material's use of its image; -1 for none."""
    if material.image < 0:
        return -1
    if places is None:
        raise FileError("its mesh has no texture coordinates")
    instead = material.tint if material.replaced else None
    use = Layer(material.image, blended=material.blended, color=instead)
    return collected.layer(use, lambda: surfaces.stored_image(material.image))


def scene_surfaces(
    scene: Mapping[str, NDArray], path: Path, numbers: Mapping[int, int]
) -> Surfaces:
    """Return the materials of a scene of another format, and what corners have.

    Of materials: `material_names`, `material_values` (k, 4: red, green, blue, sRGB, and opacity)
    and `material_uses` (k, 2: image or -1, and whether its alpha is used); the image replaces the
    colour. Of images: `image_files` (i, names that a file beside may have), and the content of
    those that are embedded, `image_I_content`. Of each mesh K perhaps `mesh_K_materials` (m,),
    `mesh_K_places`, `mesh_K_colors` and `mesh_K_normals`; see `Surface`.
    """
    meshes = {}
    for k, number in numbers.items():
        faces = scene[f"mesh_{k}_faces"].astype(np.int32)
        material = scene.get(f"mesh_{k}_materials", np.full(len(faces), -1)).astype(np.int32)
        corners = {key: scene.get(f"mesh_{k}_{key}") for key in ("places", "colors", "normals")}
        meshes[number] = Surface(faces, material, **corners)
    stored = (scene[f"material_{key}"].tolist() for key in ("names", "values", "uses"))
    materials = [
        Material(str(name), tuple(values[:3]), int(image), values[3], bool(cut), True)
        for name, values, (image, cut) in zip(*stored, strict=True)
    ]
    images = [
        ImageFile(tuple(map(str, names)), scene[f"image_{i}_content"].tobytes())
        for i, names in enumerate(scene["image_files"])
    ]
    return Surfaces(path, meshes, tuple(materials), tuple(images))


def stored_corners(stored: NDArray, faces: NDArray) -> NDArray[np.intp] | None:
    """Find the corners of faces (k, 3) among those that a file stores (m, 3), perhaps turned."""
    order = np.arange(3 * len(stored)).reshape(-1, 3)
    for way in (order, order[:, ::-1]):
        if np.array_equal(stored.reshape(-1)[way], faces):
            return way
    both = np.sort(np.concatenate([stored, faces]), axis=1)
    which = np.unique(both, axis=0, return_inverse=True)[1].reshape(-1)
    stored_groups, groups = which[: len(stored)], which[len(stored) :]
    # Of faces with the same corners the first is the first, and so on.
    sorted_rows = np.argsort(stored_groups, kind="stable")
    at = np.searchsorted(stored_groups[sorted_rows], groups) + _repeats(groups)
    is_stored = at < len(stored)
    rows = sorted_rows[np.where(is_stored, at, 0)]
    if not is_stored.all() or (stored_groups[rows] != groups).any():
        return None
    corner = (stored[rows][:, None, :] == faces[:, :, None]).argmax(axis=2)
    return 3 * rows[:, None] + corner


def _repeats(values: NDArray) -> NDArray[np.intp]:
    """Return how many equal values come before each."""
    order = np.argsort(values, kind="stable")
    ordered = values[order]
    before = np.empty(len(values), np.intp)
    before[order] = np.arange(len(values)) - np.searchsorted(ordered, ordered)
    return before


DECIMALS = 6
"""Decimals of normals, so that rounding errors of a file split no vertices."""


class Corners(NamedTuple):
    """The corners of a mesh."""

    normals: NDArray[np.float32] | None = None  # (m, 3, 3): of length one
    places: NDArray[np.float32] | None = None
    """(m, 3, 2): texture coordinates from the upper left corner of an image."""


Piece: TypeAlias = tuple[Surface, NDArray[np.integer], slice, NDArray[np.float64]]
"""What a file stores of some faces of a mesh: these by the vertices of its surface (k, 3), their
rows in the mesh, and the matrix (4, 4) from the space of the surface."""


def join_corners(vertices: NDArray, faces: NDArray, pieces: Iterable[Piece]) -> Corners:
    """Return the corners of a mesh of pieces; the faces of some may not be their surface's.

    Where a file has no normal, or a normal without a direction, it is that of the smooth surface.
    """
    normals, places = np.zeros((len(faces), 3, 3)), np.zeros((len(faces), 3, 2), np.float32)
    has_normals = has_places = False
    for surface, triangles, rows, matrix in pieces:
        where = stored_corners(surface.faces, triangles)
        if where is None:
            continue
        if surface.places is not None:
            has_places = True
            stored = surface.places.reshape(-1, 2)[where]
            places[rows] = np.nan_to_num(stored, posinf=0, neginf=0)
        if surface.normals is not None:
            has_normals = True
            # Faces of a mirrored mesh are turned on loading, and still face the same side.
            turned = (where[:, 1] - where[:, 0]) % 3 == 2
            turned ^= np.linalg.det(matrix[:3, :3]) < 0
            moved = _moved(surface.normals.reshape(-1, 3)[where], matrix)
            against = np.einsum("ikc,ic->ik", moved, face_normals(vertices[faces[rows]])) < 0
            normals[rows] = np.where((against & turned[:, None])[..., None], -moved, moved)
    complete = _complete(normals, vertices, faces) if has_normals else None
    return Corners(complete, places if has_places else None)


def _moved(normals: NDArray, matrix: NDArray) -> NDArray:
    """Return unit normals in another space, zero for none; (k, 3, 3) and (4, 4) to (k, 3, 3)."""
    unit = _unit(normals.astype(float))
    rows = matrix[:3, :3] / max(np.abs(matrix[:3, :3]).max(), 1e-300)
    if np.array_equal(rows, np.eye(3)):
        return unit
    # The inverse transpose but for a factor: the cofactors, which a singular matrix has, too.
    cofactors = np.cross(rows[[1, 2, 0]], rows[[2, 0, 1]])
    return _unit(unit @ cofactors.T * (-1 if np.linalg.det(rows) < 0 else 1))


def _unit(vectors: NDArray) -> NDArray:
    """Return vectors of length one, zero for those without a direction; (..., 3)."""
    finite = np.where(np.isfinite(vectors).all(axis=-1, keepdims=True), vectors, 0)
    largest = np.abs(finite).max(axis=-1, keepdims=True)
    scaled = finite / np.where(largest > 0, largest, 1)
    length = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return scaled / np.where(length > 0, length, 1)


def _complete(normals: NDArray, vertices: NDArray, faces: NDArray) -> NDArray[np.float32]:
    """Return normals as they are stored; (m, 3, 3), zero for none."""
    missing = (normals == 0).all(axis=2)
    if missing.any():
        normals = np.where(missing[..., None], vertex_normals(vertices, faces)[faces], normals)
    return np.asarray(np.round(normals, DECIMALS) + 0.0, np.float32)  # -0 is 0


def vertex_normals(vertices: NDArray, faces: NDArray) -> NDArray[np.float32]:
    """Return unit normals, shape (n, 3): faces weighted by area, equal positions together."""
    area = face_normals(vertices[faces].astype(float))
    same = np.unique(vertices, axis=0, return_inverse=True)[1].reshape(-1)
    summed = np.zeros((same.max() + 1, 3))
    for k in range(3):
        np.add.at(summed, same[faces[:, k]], area)
    summed /= np.abs(summed).max() or 1.0
    length = np.linalg.norm(summed, axis=1, keepdims=True)
    # Any direction does for a vertex without a face; glTF only asks for unit length.
    unit = np.where(length > 1e-12, summed / np.maximum(length, 1e-12), [0.0, 1.0, 0.0])
    return unit[same].astype(np.float32)
