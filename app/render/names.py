"""Bones and clips by their names, as people write them."""

from difflib import get_close_matches

from cutcell.errors import ParameterError
from cutcell.rig import Clip, Rig
from cutcell.rig.names import folded


def find_bone(rig: Rig, name: str) -> int:
    """Return the number of the joint of a name; the case of its letters does not matter.

    Raises
    ------
    ParameterError
        There is none; the sentence tells the names that are nearest.
    """
    return _find("bone", name, list(rig.skeleton.names), rig)


def find_clip(rig: Rig, name: str) -> Clip:
    """Return the clip of a name or number.

    Raises
    ------
    ParameterError
        There is none; the sentence tells those that there are.
    """
    if not rig.clips:
        raise ParameterError(f"{rig.name} has no clips to play")
    names = [clip.name for clip in rig.clips]
    if name not in names and name.isdecimal() and 1 <= int(name) <= len(names):
        return rig.clips[int(name) - 1]
    return rig.clips[_find("clip", name, names, rig)]


def _find(what: str, name: str, names: list[str], rig: Rig) -> int:
    if name in names:
        return names.index(name)
    wanted, comparable = folded(name), [folded(one) for one in names]
    if comparable.count(wanted) == 1:
        return comparable.index(wanted)
    near = get_close_matches(wanted, comparable, 3, 0.5)
    near += [one for one in comparable if wanted in one][: 3 - len(near)]
    matches = [names[comparable.index(one)] for one in dict.fromkeys(near)]
    few = matches or names[:8]
    intro = "the nearest names are" if matches else "there are" if len(names) <= 8 else "some are"
    quoted = ", ".join(f'"{one}"' for one in few)
    raise ParameterError(f'{rig.name} has no {what} "{name}"; {intro} {quoted}')
