"""A skeleton in JSON, for a mesh in another file."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import FileError, SkeletonError
from ...rig import Skeleton
from ..files import has_halves, naming, one_line, read_text
from ..skeletons import SkeletonFile

SUFFIXES = {".json": rb'\s*\{\s*"joints"'}
NOTE = ""
FIELDS = ("name", "position", "parent", "deform")


def read_skeleton(path: Path) -> SkeletonFile:
    """Read a skeleton, and which joints may carry weight if the file says so."""
    with naming(path):
        text = read_text(path)
        try:
            data = json.loads(text)
        except (ValueError, RecursionError) as e:  # also numbers of thousands of digits
            raise FileError(f"its JSON cannot be read: {one_line(e)}") from None
        joints = data.get("joints") if isinstance(data, dict) else None
        if not isinstance(joints, list):
            raise FileError('is not a skeleton: it must be {"joints": [...]}')
        if not joints:
            raise SkeletonError("the skeleton has no joints; it needs at least one")
        names = [_name(joint, k) for k, joint in enumerate(joints)]
        twice = next((name for name, times in Counter(names).items() if times > 1), None)
        if twice is not None:
            raise SkeletonError(f'the joint "{twice}" is there twice; names must differ')
        place = {name: k for k, name in enumerate(names)} | {None: -1}
        for name, joint in zip(names, joints, strict=True):
            unknown = next((k for k in joint if k not in FIELDS), None)
            if unknown is not None:
                raise FileError(f'joint "{name}": "{unknown}" is none of {", ".join(FIELDS)}')
            parent = joint.setdefault("parent", None)
            if not isinstance(parent, str | None) or parent not in place:
                wrong = repr(parent)[:40]
                raise SkeletonError(
                    f'joint "{name}": its parent {wrong} is not a joint of the file'
                )
            if not isinstance(joint.get("deform", True), bool):
                raise SkeletonError(f'joint "{name}": "deform" must be true or false')
        skeleton = Skeleton(
            [_position(joint, name) for name, joint in zip(names, joints, strict=True)],
            [place[joint["parent"]] for joint in joints],
            names,
            [joint.get("deform", True) for joint in joints],
        )
        stored = skeleton.deform.astype(np.int8) if any("deform" in one for one in joints) else None
        return SkeletonFile(skeleton, stored=stored)


def _name(joint: Any, k: int) -> str:
    if not isinstance(joint, dict):
        raise FileError(f"joint {k} must be an object with a name and a position")
    name = joint.get("name")
    if not isinstance(name, str) or not name:
        raise SkeletonError(f'joint {k} needs a "name"')
    if has_halves(name):
        raise SkeletonError(f"the name of joint {k} holds half of a character (a lone surrogate)")
    return name


def _position(joint: dict[str, Any], name: str) -> list[float]:
    value = joint.get("position")
    try:
        right = isinstance(value, list) and [type(x) in (int, float) for x in value] == [True] * 3
        if right and np.isfinite(np.array(value, np.float64)).all():
            return value  # type: ignore[return-value]
    except OverflowError:  # a whole number with hundreds of digits
        pass
    raise SkeletonError(f'joint "{name}": "position" must be three finite numbers')
