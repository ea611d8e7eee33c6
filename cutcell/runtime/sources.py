"""Hashes of sources: what was computed by other code is stale."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


@cache
def source_digest(*paths: Path) -> str:
    """Hash Python sources: files, and all below folders. Returns 32 hexadecimal digits."""
    digest = hashlib.blake2b(digest_size=16)
    for path in paths:
        for file in sorted(path.rglob("*.py")) if path.is_dir() else (path,):
            name = file.relative_to(path.parent).as_posix()
            digest.update(f"{name}\n".encode() + hashlib.blake2b(file.read_bytes()).digest())
    return digest.hexdigest()
