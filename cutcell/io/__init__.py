"""Loading and saving rigs: ``load(path) -> Rig``, ``save(path, rig)``."""

from __future__ import annotations

from pathlib import Path

from ..rig import Rig
from .files import naming, write_all
from .gltf_fresh import new_glb
from .gltf_read import read_gltf


def load(path, skeleton=None) -> Rig:
    path = Path(path)
    with naming(path):
        return read_gltf(path)


def save(path, rig) -> None:
    path = Path(path)
    with naming(path):
        write_all({path: new_glb(rig)})
