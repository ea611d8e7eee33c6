"""Tables of joints that get the weight of others: of whole branches, or as a person writes them."""

import re
from difflib import SequenceMatcher

import numpy as np
from scipy.optimize import linear_sum_assignment

from cutcell.checks import shown
from cutcell.editing.locks import joint_index
from cutcell.errors import ParameterError
from cutcell.rig import Skeleton
from cutcell_viewers.short_names import short_names

RULE = re.compile(r"(.+?)\s*(<->|->)\s*(.+)")
SEPARATOR = re.compile(r"[;,\n]")
EXAMPLE = "index_* <-> middle_*, eye_L -> head"


def branch_pairs(skeleton: Skeleton, one: int, other: int) -> dict[int, int]:
    """Pair the joints of two branches from their roots down, children by their names.

    Raises
    ------
    ParameterError
        One of the branches contains the other.
    """
    if skeleton.subtree[one, other] or skeleton.subtree[other, one]:
        names = skeleton.names[one], skeleton.names[other]
        raise ParameterError(
            '"{}" and "{}" are of one branch; leave out their children'.format(*names)
        )
    pairs, below = {}, [(one, other)]
    while below:
        pair = below.pop()
        pairs[pair[0]] = pair[1]
        children = [np.flatnonzero(skeleton.parents == joint).tolist() for joint in pair]
        # Of names that are equally alike, the order in the file decides.
        unlike = np.array([
            [_unlike(skeleton, a, b) + 1e-3 * abs(i - k) for k, b in enumerate(children[1])]
            for i, a in enumerate(children[0])
        ]).reshape(len(children[0]), len(children[1]))  # fmt: skip
        rows, columns = linear_sum_assignment(unlike)
        below += (
            (children[0][row], children[1][column])
            for row, column in zip(rows, columns, strict=True)
        )
    return pairs


def _unlike(skeleton: Skeleton, one: int, other: int) -> float:
    return 1 - SequenceMatcher(None, skeleton.names[one], skeleton.names[other]).ratio()


def swapped(pairs: dict[int, int]) -> dict[int, int]:
    """Return pairs of joints in both directions."""
    return {**pairs, **{other: one for one, other in pairs.items()}}


def read_table(text: str, skeleton: Skeleton) -> dict[int, int]:
    """Read which joint gets the weight of which, such as `index_* <-> middle_*, eye_L -> head`.

    `A -> B` replaces A by B, `A <-> B` swaps them. A star stands for the same text on both sides.
    Names may be those that the page shows, without a prefix that all share.

    Raises
    ------
    ParameterError
        It cannot be read, names no joint of the skeleton, or gives one joint two others.
    """
    table: dict[int, int] = {}
    for rule in filter(None, map(str.strip, SEPARATOR.split(text))):
        match = RULE.fullmatch(rule)
        if match is None:
            raise ParameterError(f"{shown(rule)} is no rule; write for example {EXAMPLE}")
        one, how, other = match.groups()
        pairs = _pairs(one.strip(), other.strip(), skeleton)
        for source, target in (swapped(pairs) if how == "<->" else pairs).items():
            if table.setdefault(source, target) != target:
                names = [skeleton.names[joint] for joint in (source, table[source], target)]
                raise ParameterError('"{}" is replaced by both "{}" and "{}"'.format(*names))
    if not table:
        raise ParameterError(f"the table has no rule; write for example {EXAMPLE}")
    return table


def _pairs(one: str, other: str, skeleton: Skeleton) -> dict[int, int]:
    """Return the joints that one side of a rule names, and their partners on the other side."""
    number = dict(zip(short_names(skeleton.names), range(len(skeleton.names)), strict=True))
    number |= {name: skeleton.names.index(name) for name in skeleton.names}
    if "*" not in one:
        return {_joint(number, one, skeleton): _joint(number, other, skeleton)}
    if one.count("*") > 1 or other.count("*") > 1:
        raise ParameterError(f"{shown(one)} and {shown(other)} may have one star each")
    pattern = re.compile(re.escape(one).replace(r"\*", "(.*)"))
    matches = [(joint, pattern.fullmatch(name)) for name, joint in number.items()]
    pairs = {
        joint: number[target]
        for joint, match in matches
        if match and (target := other.replace("*", match.group(1))) in number
    }
    if not pairs:
        raise ParameterError(f"no joint {shown(one)} has a joint {shown(other)}")
    return pairs


def _joint(number: dict[str, int], name: str, skeleton: Skeleton) -> int:
    return number[name] if name in number else joint_index(skeleton, name)
