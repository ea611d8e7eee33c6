"""Look-up of bones and clips by approximate names."""

from difflib import get_close_matches

from cutcell.errors import ParameterError
from cutcell.rig import Clip, Rig
from cutcell.rig.names import folded


def bone_index(rig: Rig, name: str) -> int:
    """Return the number of the joint of a name, in any case; an error lists the nearest names."""
    return _find("bone", name, list(rig.skeleton.names), rig)


def clip_index(rig: Rig, name: str) -> int:
    """Return the index of the clip of a name or number; an error lists the nearest names."""
    if not rig.clips:
        raise ParameterError(f"{rig.name} has no clips to play")
    names = [clip.name for clip in rig.clips]
    if name not in names and name.isdecimal() and 1 <= int(name) <= len(names):
        return int(name) - 1
    return _find("clip", name, names, rig)


def clip_named(rig: Rig, name: str) -> Clip:
    """Return the clip of a name or number."""
    return rig.clips[clip_index(rig, name)]


def _find(what: str, name: str, names: list[str], rig: Rig) -> int:
    if name in names:
        return names.index(name)
    query, comparable = folded(name), [folded(one) for one in names]
    if comparable.count(query) == 1:
        return comparable.index(query)
    near = get_close_matches(query, comparable, 3, 0.5)
    near += [one for one in comparable if query in one][: 3 - len(near)]
    matches = [names[comparable.index(one)] for one in dict.fromkeys(near)]
    intro = "the nearest names are" if matches else "there are" if len(names) <= 8 else "some are"
    quoted = ", ".join(f'"{one}"' for one in matches or names[:8])
    raise ParameterError(f'{rig.name} has no {what} "{name}"; {intro} {quoted}')
