"""Joints of a face, which their names show: a head continues past them, up to the crown."""

from __future__ import annotations

import unicodedata
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...rig import Skeleton
from ...rig.names import words

_FACE = (
    "brow brows cheek cheeks chin ear ears eye eyes jaw lash lashes lid lids lip lips mouth "
    "muzzle nose nostril pupil teeth tongue tooth"
)
WORDS = frozenset(_FACE.split())
PARTS = ("eye", "brow", "jaw", "mouth", "tongue", "teeth", "cheek")
"""The same inside longer words, as in `lefteyelid`."""
LETTERS = "目眼瞳眉顎口唇歯舌耳鼻"
"""Japanese: eye, pupil, brow, jaw, mouth, lip, teeth, tongue, ear, nose."""

CACHED_NAMES = 4096
"""Names whose answers stay in memory: a skeleton's are the same while its joints are moved."""


def face_parts(skeleton: Skeleton) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Find the joints of faces, and of these the eyes, lids and brows, both of shape (j,).

    A joint with other children, such as a head named after a face, is none.
    """
    in_face = np.array([is_face_part(name) for name in skeleton.names])
    in_face &= ~(skeleton.subtree & ~in_face & skeleton.deform).any(axis=1)
    return in_face, in_face & np.array([is_eye_part(name) for name in skeleton.names])


@lru_cache(CACHED_NAMES)
def is_face_part(name: str) -> bool:
    """Return whether a name is that of a joint in a face."""
    parts = words(name)
    return (
        not WORDS.isdisjoint(parts)
        or any(part in word for word in parts for part in PARTS)
        or not set(LETTERS).isdisjoint(unicodedata.normalize("NFKC", name))
    )


@lru_cache(CACHED_NAMES)
def is_eye_part(name: str) -> bool:
    """Return whether a name is that of an eye, or of a lid or brow, which have no length."""
    parts = words(name)
    return any(p in w for w in parts for p in ("eye", "brow", "pupil")) or any(
        letter in unicodedata.normalize("NFKC", name) for letter in "目眼瞳眉"
    )
