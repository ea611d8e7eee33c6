"""Joints that have each other's weights: of one limb and another, or of left and right."""

from __future__ import annotations

from collections.abc import Generator, Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ..editing.symmetry import partners_by_name
from ..rig.names import plain
from .finding import Finding, finding_of
from .leaks import pose_of
from .subject import Subject, bones_distance
from .weights import VISIBLE_WEIGHT

NEARER = 0.5
"""The skin of a joint must be this much nearer to one that it is exchanged with: some bones lie
together."""
LEADING = 0.5
"""Weight from which a vertex is a joint's own."""
SAMPLES = 200
"""Vertices of each joint whose distances are measured."""
MOST = 2000
"""Vertices of a finding whose distances are measured."""
NO_PAIR = 1e6


def check_exchanged(subject: Subject) -> Iterator[Finding]:
    """Look for joints whose skin lies at the bones of others, which have theirs in return."""
    sided = yield from _other_side(subject, subject.weights)
    yield from _permuted(subject, subject.weights, sided)


def _other_side(
    subject: Subject, weights: NDArray[np.float64]
) -> Generator[Finding, None, NDArray[np.bool_]]:
    """Look for skin that follows the joints of the other side; return which joints it follows."""
    points, bones = subject.mesh.points[subject.welded], subject.distances.bones
    names = partners_by_name(subject.rig.skeleton.names)
    partner = names if subject.mirror is None else subject.mirror.joint
    has_bone = np.isin(np.arange(len(partner)), bones.joint)
    crossed, sound = np.zeros((2, len(weights)))
    rows, across, sound_sum = [], np.zeros(len(partner)), np.zeros(len(partner))
    for j in np.flatnonzero((partner >= 0) & has_bone & has_bone[partner]).tolist():
        if partner[j] == j:
            continue
        at = np.flatnonzero((weights[:, j] > VISIBLE_WEIGHT) & subject.is_used)
        to_joint, to_partner = (bones_distance(bones, int(k), points[at]) for k in (j, partner[j]))
        far = to_partner < to_joint
        rows.append((j, at, far))
        across[j], sound_sum[j] = weights[at[far], j].sum(), weights[at[~far], j].sum()
    is_wrong = np.zeros(len(partner), np.bool_)
    for j, at, far in rows:
        # Most of the skin at the partner follows this joint.
        is_wrong[j] = across[j] > sound_sum[partner[j]]
        crossed[at[far]] += weights[at[far], j] * is_wrong[j]
        sound[at[~far]] += weights[at[~far], j]
    if not is_wrong.any():
        return is_wrong
    vertices, joints = np.flatnonzero(crossed > sound), np.flatnonzero(is_wrong)
    pairs = {int(one): int(partner[one]) for j in joints for one in (j, partner[j])}
    yield from _finding(subject, "other-side", vertices, joints, pairs)
    return is_wrong | is_wrong[partner]


def _permuted(
    subject: Subject, weights: NDArray[np.float64], without: NDArray[np.bool_]
) -> Iterator[Finding]:
    """Look for joints that have each other's weights everywhere."""
    points, bones = subject.mesh.points[subject.welded], subject.distances.bones
    leads = (weights > LEADING) & subject.is_used[:, None]
    leads[:, without] = False
    joints = np.intersect1d(np.flatnonzero(leads.any(axis=0)), bones.joint)
    if len(joints) < 2:
        return
    led = [np.flatnonzero(leads[:, j]) for j in joints]
    samples = [at[:: -(-len(at) // SAMPLES)] for at in led]
    begin, at = np.cumsum([0, *map(len, samples)]), np.concatenate(samples)
    gap = np.stack(
        [np.add.reduceat(bones_distance(bones, int(k), points[at]), begin[:-1]) for k in joints], 1
    )
    gap /= np.diff(begin)[:, None]
    stay = np.diag(gap)
    cost = np.where(gap < NEARER * stay[:, None], gap, NO_PAIR)
    np.fill_diagonal(cost, stay)
    target = joints[linear_sum_assignment(cost)[1]]
    moved = np.flatnonzero(target != joints)
    pairs = _with_names(subject, {int(joints[k]): int(target[k]) for k in moved}, without)
    exchanged = np.array(sorted(pairs), np.intp)
    vertices = np.flatnonzero((weights[:, exchanged] > 0).any(axis=1))
    yield from _finding(subject, "exchanged-joints", vertices, exchanged, pairs)


def _with_names(
    subject: Subject, pairs: dict[int, int], without: NDArray[np.bool_]
) -> dict[int, int]:
    """Add pairs of joints whose names differ in the same word, as those of two fingers do.

    The skin of both together must be nearer then, though not as much: where no joint has a parent,
    the bones of some are a guess.
    """
    names = [plain(name) for name in subject.rig.skeleton.names]
    texts = [base.split() for base, _ in names]
    rules = set()
    for one, other in pairs.items():
        if len(texts[one]) == len(texts[other]):
            pairs_of_words = zip(texts[one], texts[other], strict=True)
            differ = [both for both in pairs_of_words if both[0] != both[1]]
            rules |= set(differ) if len(differ) == 1 else set()
    result, number = dict(pairs), {name: joint for joint, name in enumerate(names)}
    has_bone = np.isin(np.arange(len(names)), subject.distances.bones.joint) & ~without
    for joint in np.flatnonzero(has_bone & (subject.weights > VISIBLE_WEIGHT).any(axis=0)).tolist():
        for word, instead in rules:
            base = " ".join(instead if text == word else text for text in texts[joint])
            other = number.get((base, names[joint][1]), joint)
            if {joint, other} & result.keys() or other == joint or not has_bone[other]:
                continue
            both = {joint: other, other: joint}
            which = (subject.weights[:, [joint, other]] > VISIBLE_WEIGHT).any(axis=1)
            now, then = _mean_distances(subject, np.flatnonzero(which), both)
            if then < now:
                result |= both
    return result


def _finding(
    subject: Subject,
    code: str,
    vertices: NDArray[np.intp],
    joints: NDArray[np.intp],
    pairs: dict[int, int],
) -> Iterator[Finding]:
    if not len(joints):
        return
    names, order = {joint: subject.name(joint) for joint in pairs}, _order(subject, pairs)
    rows = subject.weights[vertices]
    each = [(a, b) for a, b in pairs.items() if pairs.get(b) != a or a < b]
    yield from finding_of(
        code,
        vertices=vertices,
        joints=joints,
        details=[f"{names[a]} and {names[b]}" for a, b in each],
        pose=pose_of(subject, int(joints[0]), vertices),
        exchanged=tuple(pairs.items()),
        better=_better(subject, vertices, pairs),
        change=subject.weight_share(vertices, np.abs(rows - rows[:, order]).sum(axis=1) / 2),
    )


def _order(subject: Subject, pairs: dict[int, int]) -> NDArray[np.intp]:
    """Return for each joint the one whose weight it gets, shape (j,)."""
    order = np.arange(subject.weights.shape[1])
    order[[*pairs.values()]] = [*pairs]
    return order


def _better(subject: Subject, vertices: NDArray[np.intp], pairs: dict[int, int]) -> str:
    """Say by how much an exchange brings weights nearer to the other side's, or else to bones."""
    mirror, order = subject.mirror, _order(subject, pairs)
    text = " The L1 difference from the other side falls from {:.2f} to {:.2f}."
    if mirror is not None:
        other = mirror.vertex[vertices]
        at, other = (one[(other >= 0) & (other != vertices)] for one in (vertices, other))
        after = subject.weights.copy()
        after[vertices] = after[vertices][:, order]
        now, then = (
            float(np.abs(one[at] - one[other][:, mirror.swap]).sum() / max(len(at), 1))
            for one in (subject.weights, after)
        )
    if mirror is None or then >= now:
        text = " The mean distance from the bones falls from {:.1%} to {:.1%} of the size."
        now, then = _mean_distances(subject, vertices, pairs)
    return text.format(now, then)


def _mean_distances(
    subject: Subject, vertices: NDArray[np.intp], pairs: dict[int, int]
) -> tuple[float, float]:
    """Return the mean distances of the weight of joints from their bones, now and exchanged."""
    samples = vertices[:: -(-len(vertices) // MOST)]
    points, weights = subject.mesh.points[subject.welded[samples]], subject.weights[samples]
    sums = np.zeros(3)
    for joint, target in pairs.items():
        weight = weights[:, joint]
        at = np.flatnonzero(weight)
        to_joint, to_target = (
            bones_distance(subject.distances.bones, k, points[at]) for k in (joint, target)
        )
        sums += weight[at] @ to_joint, weight[at] @ to_target, weight[at].sum()
    now, then = (sums[:2] / max(sums[2], 1e-12)).tolist()
    return now, then
