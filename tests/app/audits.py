"""A small audit to step through: an arm, the same again, one turned aside."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import cutcell
from cutcell.rig import Rig, Skeleton
from cutcell_lab.dataset import audit, save_audit
from tests.viewers.arm import arm_rig


def saved_audit(folder: Path, scheduler: str | None = None) -> Path:
    """Audit three characters in FOLDER/rigs; return FOLDER/audit."""
    rigs, out = folder / "rigs", folder / "audit"
    rigs.mkdir()
    arm = arm_rig()
    bent = np.add(arm.skeleton.joints, [[0, 0, 0], [0, 0, 0], [-0.1, 0.2, 0]])
    turned = Rig(arm.mesh, Skeleton(bent, [-1, 0, 1], arm.skeleton.names), arm.weights)
    for name, rig in (("arm", arm), ("same", arm), ("turned", turned)):
        cutcell.save(rigs / f"{name}.npz", Rig(rig.mesh, rig.skeleton, rig.weights))
    save_audit(audit([rigs], points=256, workers=1, scheduler=scheduler), out, [rigs])
    return out
