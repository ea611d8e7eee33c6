"""Dense weights to JOINTS_n and WEIGHTS_n."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...weights import normalised


def pack_influences(weights: NDArray) -> tuple[NDArray, NDArray]:
    """Sort each row's influences into slots of four.

    Shapes: weights (n, j); returns joints (s, n, 4), shares (s, n, 4).
    """
    rounded = normalised(weights).astype(np.float32)
    # What rounding took or gave goes to the heaviest, where it matters least, before they are
    # sorted: so what was saved is sorted the same way when it is loaded and saved again.
    rows, heaviest = np.arange(len(weights)), rounded.argmax(axis=1)
    largest = rounded[rows, heaviest].astype(np.float64)
    rest = 1 - rounded.sum(axis=1, dtype=np.float64)
    rounded[rows, heaviest] = np.where(largest > 0, largest + rest, 0)
    most = int((rounded > 0).sum(axis=1).max(initial=1))
    sets = max(-(-most // 4), 1)
    slots = min(4 * sets, weights.shape[1])
    order = np.argsort(-rounded, axis=1, kind="stable")[:, :slots]
    shares = np.zeros((len(weights), 4 * sets), np.float32)
    shares[:, :slots] = np.take_along_axis(rounded, order, axis=1)
    joints = np.zeros((len(weights), 4 * sets), np.uint16)
    joints[:, :slots] = order
    joints[shares == 0] = 0
    return (
        joints.reshape(-1, sets, 4).transpose(1, 0, 2),
        shares.reshape(-1, sets, 4).transpose(1, 0, 2),
    )
