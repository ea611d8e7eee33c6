"""Loading and saving rigs: ``load(path) -> Rig``, ``save(path, rig)``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import lazy_loader

if TYPE_CHECKING:
    from .formats.gltf import binary_ending as binary_ending
    from .formats.gltf import is_avatar as is_avatar
    from .formats.gltf import keeps_document as keeps_document
    from .loading import check_output as check_output
    from .loading import load as load
    from .loading import save as save
    from .loading import saving_notes as saving_notes

# `--help` lists the formats of `formats`, and must not wait for what reads them.
__getattr__, __dir__, _ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "formats.gltf": ["binary_ending", "is_avatar", "keeps_document"],
        "loading": ["check_output", "load", "save", "saving_notes"],
    },
)
__all__ = ["load", "save"]
