"""A skeleton in a small JSON file next to a bare mesh."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import FileError, SkeletonError
from ...rig import Skeleton
from ..files import has_halves, naming, one_line, read_text

FIELDS = ("name", "position", "parent", "deform")


def skeleton_file(path: Path) -> Path | None:
    """Return the skeleton file next to a mesh, if there is one."""
    choices = (path.with_name(f"{path.stem}.skeleton.json"), path.with_suffix(".json"))
    return next((c for c in choices if c.is_file()), None)


def read_skeleton_json(path: Path) -> tuple[Skeleton, bool]:
    """Read a skeleton, and whether the file says which joints may carry weight."""
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
        place = {name: k for k, name in enumerate(names)}
        for name, joint in zip(names, joints, strict=True):
            _check_fields(joint, name)
        says_deform = any("deform" in joint for joint in joints)
        skeleton = Skeleton(
            np.array([_position(j, n) for n, j in zip(names, joints, strict=True)]),
            np.array([_parent(j, n, place) for n, j in zip(names, joints, strict=True)], int),  # type: ignore[arg-type]
            tuple(names),
            np.array([_deform(j, n) for n, j in zip(names, joints, strict=True)], bool),
        )
        return skeleton, says_deform


def _name(joint: Any, k: int) -> str:
    if not isinstance(joint, dict):
        raise FileError(f"joint {k} must be an object with a name and a position")
    name = joint.get("name")
    if not isinstance(name, str) or not name:
        raise SkeletonError(f'joint {k} needs a "name"')
    if has_halves(name):
        raise SkeletonError(f"the name of joint {k} holds half of a character (a lone surrogate)")
    return name


def _check_fields(joint: dict[str, Any], name: str) -> None:
    unknown = next((k for k in joint if k not in FIELDS), None)
    if unknown is not None:
        raise FileError(f'joint "{name}": "{unknown}" is none of {", ".join(FIELDS)}')


def _position(joint: dict[str, Any], name: str) -> list[float]:
    value = joint.get("position")
    try:
        right = isinstance(value, list) and [type(x) in (int, float) for x in value] == [True] * 3
        if right and np.isfinite(np.array(value, np.float64)).all():
            return value  # type: ignore[return-value]
    except OverflowError:  # a whole number with hundreds of digits
        pass
    raise SkeletonError(f'joint "{name}": "position" must be three finite numbers')


def _parent(joint: dict[str, Any], name: str, place: dict[str, int]) -> int:
    parent = joint.get("parent")
    if parent is None:
        return -1
    if not isinstance(parent, str) or parent not in place:
        wrong = repr(parent)[:40]
        raise SkeletonError(f'joint "{name}": its parent {wrong} is not a joint of the file')
    return place[parent]


def _deform(joint: dict[str, Any], name: str) -> bool:
    value = joint.get("deform", True)
    if not isinstance(value, bool):
        raise SkeletonError(f'joint "{name}": "deform" must be true or false')
    return value
