"""Hashes of the package's sources: what was computed by other code is stale."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


@cache
def source_digest(*left_out: str) -> str:
    """Hash all Python sources of cutcell but those in some folders, 32 hexadecimal digits."""
    digest = hashlib.blake2b(digest_size=16)
    for path in sorted(PACKAGE.rglob("*.py")):
        name = path.relative_to(PACKAGE)
        if name.parts[0] not in left_out:
            content = hashlib.blake2b(path.read_bytes()).digest()
            digest.update(f"{name.as_posix()}\n".encode() + content)
    return digest.hexdigest()
