"""Ray hits by Embree and Open3D, and winding numbers by libigl, for comparison.

Both ray tracers compute in float32, so rays within about 1e-6 of an edge may have other hits than
those of `rays.py`. libigl's fast winding number is a truncated series: segments whose number is
within about 1e-2 of tau may be decided otherwise.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from ..errors import MissingLibraryError
from ..geometry.triangles import normals
from .rays import AXES, RayHits, points_on_rays

Vertices = NDArray[np.float64]
Faces = NDArray[np.int32]
Hits = NDArray[np.int64]

LEAD = 0.25
"""Rays begin this far outside the unit cube."""

FLOAT32_STEP = 2.0**-20
"""Eight units in the last place of float32 near 1: past a triangle for sure, seldom past two."""

SHARED_CROSSING = 4 * FLOAT32_STEP
"""Neighbouring triangles hit within this distance of each other share one crossing."""

MAX_RAY_HITS = 100_000
"""Hits followed along a ray; a soup deeper than this is no body."""


def cast_rays_open3d(vertices: Vertices, faces: Faces, resolution: int, axis: int) -> RayHits:
    """Cast the rays of one axis by Open3D's RaycastingScene.list_intersections, in float32."""
    o3d = optional_library("open3d", 'rays="open3d"', "open3d")
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(faces.astype(np.uint32))
    )
    rays = np.concatenate(_rays(resolution, axis, 1), axis=1)
    hits = scene.list_intersections(o3d.core.Tensor(rays))
    ray, triangle = (hits[key].numpy().astype(np.int64) for key in ("ray_ids", "primitive_ids"))
    return _ray_hits(vertices, faces, resolution, axis, ray, triangle)


def cast_rays_embree(vertices: Vertices, faces: Faces, resolution: int, axis: int) -> RayHits:
    """Cast the rays of one axis by Embree, hit after hit, in float32.

    Embree reports the first triangle that a ray meets. Each ray is cast again from a float32 step
    behind it, and all are cast in both directions: a triangle hidden within that step behind
    another is the first hit from the other side.
    """
    scenes = optional_library("embreex.rtcore_scene", 'rays="embree"', "embreex")
    scene = scenes.EmbreeScene()
    import_module("embreex.mesh_construction").TriangleMesh(
        scene, vertices.astype(np.float32), faces.astype(np.int32)
    )
    hits = [np.empty((2, 0), np.int64)]
    for direction in (1, -1):
        origins, directions = _rays(resolution, axis, direction)
        live, last = np.arange(resolution**2), np.full(resolution**2, -1, np.int64)
        step = np.full(resolution**2, FLOAT32_STEP)
        for _ in range(MAX_RAY_HITS):
            hit = scene.run(origins[live], directions[live]).astype(np.int64)
            live, hit = live[hit >= 0], hit[hit >= 0]
            if len(live) == 0:
                break
            # The same triangle again: the step was too short. Do not count it, and step further.
            again = last[live] == hit
            step[live] = np.where(again, 2 * step[live], FLOAT32_STEP)
            last[live] = hit
            hits.append(np.stack([live, hit])[:, ~again])
            position = _positions(vertices, faces, resolution, axis, live, hit) * direction
            origin = origins[live, AXES[axis][2]].astype(np.float64) * direction
            ahead = np.maximum(position, origin) + step[live]
            origins[live, AXES[axis][2]] = ahead * direction
    ray, triangle = np.unique(np.concatenate(hits, axis=1), axis=1)
    return _ray_hits(vertices, faces, resolution, axis, ray, triangle)


def fast_winding_numbers(
    vertices: Vertices, faces: Faces, points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Approximate the winding number at points (k, 3) by libigl (Barill et al. 2018)."""
    igl = optional_library("igl", 'winding="fast"', "libigl")
    if len(points) == 0:
        return np.empty(0)
    numbers: NDArray[np.float64] = igl.fast_winding_number(vertices, faces.astype(np.int64), points)
    return numbers


CASTERS = {"open3d": cast_rays_open3d, "embree": cast_rays_embree}


def optional_library(module: str, option: str, package: str) -> ModuleType:
    """Import the library that an option needs."""
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        raise MissingLibraryError(
            f"{option} needs the package {package}; install it by: pip install {package}"
        ) from error
    except (ImportError, OSError) as error:  # a shared library that it loads is missing
        advice = (
            "on Debian and Ubuntu: apt-get install libusb-1.0-0"
            if "libusb" in str(error)
            else "install the library that it names"
        )
        raise MissingLibraryError(
            f"{option} cannot load the package {package}: {error}; {advice}"
        ) from error


def _rays(
    resolution: int, axis: int, direction: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return origins and directions of the R x R rays, two arrays (R * R, 3) of float32."""
    ray, start = np.arange(resolution**2), np.float64(-LEAD if direction > 0 else 1 + LEAD)
    origins = points_on_rays(ray, start, resolution, axis).astype(np.float32)
    directions = np.zeros_like(origins)
    directions[:, AXES[axis][2]] = direction
    return origins, directions


def _positions(
    vertices: Vertices, faces: Faces, resolution: int, axis: int, ray: Hits, triangle: Hits
) -> NDArray[np.float64]:
    """Intersect rays with the planes of triangles, in double precision."""
    along = AXES[axis][2]
    corners = vertices[faces[triangle]]
    normal, ends = normals(corners), corners[:, :, along]
    start = points_on_rays(ray, np.float64(0), resolution, axis)
    steep = np.where(normal[:, along] == 0, 1, normal[:, along])
    position = np.einsum("ij,ij->i", corners[:, 0] - start, normal) / steep
    # A ray may graze a triangle that stands nearly along it: stay within its extent.
    return np.clip(position, ends.min(axis=1), ends.max(axis=1))


def _ray_hits(
    vertices: Vertices, faces: Faces, resolution: int, axis: int, ray: Hits, triangle: Hits
) -> RayHits:
    """Sort hits by ray and position, one for each point where a ray passes the surface."""
    ray, triangle = _with_twins(faces, ray, triangle)
    along = AXES[axis][2]
    normal = normals(vertices[faces[triangle]])
    sign = np.sign(normal[:, along]).astype(np.int8)
    facing = sign != 0  # a triangle seen edge-on is not passed
    ray, triangle, sign = ray[facing], triangle[facing], sign[facing]
    position = _positions(vertices, faces, resolution, axis, ray, triangle)
    order = np.lexsort([triangle, sign, position, ray])
    repeated = _repeated(faces, ray[order], triangle[order], sign[order], position[order])
    order = order[~repeated]
    ray, triangle, sign, position = ray[order], triangle[order], sign[order], position[order]
    start = np.searchsorted(ray, np.arange(resolution**2 + 1)).astype(np.int64)
    return RayHits(start, position, triangle.astype(np.int32), sign)


def _with_twins(faces: Faces, ray: Hits, triangle: Hits) -> tuple[Hits, Hits]:
    """Add the hits of triangles that have the same corners as a triangle hit."""
    _, group, size = np.unique(
        np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    group = group.ravel()
    if size.max() > 1:
        members, first = np.argsort(group, kind="stable"), np.cumsum(size) - size
        hit = np.unique(np.stack([ray, group[triangle]]), axis=1)
        copies = size[hit[1]]
        slot = np.arange(copies.sum()) - np.repeat(np.cumsum(copies) - copies, copies)
        ray, triangle = np.repeat(hit[0], copies), members[np.repeat(first[hit[1]], copies) + slot]
    return ray, triangle


def _repeated(
    faces: Faces, ray: Hits, triangle: Hits, sign: NDArray[np.int8], position: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Mark hits that repeat an earlier one: a ray through an edge or corner hits all around it.

    Triangles with all three corners in common are separate layers, not neighbours.
    """
    repeated = np.zeros(len(ray), bool)
    for back in range(1, 16):  # around a corner there may be many
        if back >= len(ray):
            break
        near = (
            (ray[back:] == ray[:-back])
            & (sign[back:] == sign[:-back])
            & (position[back:] - position[:-back] <= SHARED_CROSSING)
        )
        if not near.any():
            continue
        pair = np.flatnonzero(near)
        corners, other = faces[triangle[pair + back]], faces[triangle[pair]]
        shared = (corners[:, :, None] == other[:, None, :]).any(axis=2).sum(axis=1)
        repeated[pair[(shared > 0) & (shared < 3)] + back] = True
    return repeated
