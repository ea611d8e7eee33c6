# SPDX-License-Identifier: GPL-3.0-or-later
"""Process that computes: reads requests from standard input, replies on standard output.

Each request and each reply is a line of JSON; arrays go through .npz files. The process ends with
its standard input. Needs no Blender.
"""

from __future__ import annotations

import json
import sys
import traceback

import numpy as np

MAX_SHARES = 12
"""Joints in the explanation of a vertex."""

graphs: list = []
"""The graph of the last mesh that was bound, for its next binding."""


def bind(arrays, options, progress):
    """Compute weights."""
    import cutcell
    from cutcell.graph.fingerprint import graph_fingerprint
    from cutcell.method import method_of

    rig, method = rig_of(arrays), method_of(options["method"], **options["options"])
    wanted = graph_fingerprint(rig.mesh, method)
    graph = next((graph for graph in graphs if graph.fingerprint == wanted), None)
    bound = cutcell.bind(rig, method.resolution, method=method, graph=graph, progress=progress)
    graphs[:] = [bound.graph]
    weights = beside_locked(bound.weights, arrays, method.max_influences)
    return sparse(weights), {"warnings": list(bound.warnings)}


def clean(arrays, options, progress):
    """Remove implausible weights."""
    import cutcell

    cleaned = cutcell.clean(rig_of(arrays), options["resolution"], progress=progress)
    reply = {"share": cleaned.share, "joints": [loss.name for loss in cleaned.losses]}
    return sparse(beside_locked(cleaned.weights, arrays)) | {"changed": cleaned.vertices}, reply


def transfer(arrays, options, progress):
    """Transfer weights from one mesh to others."""
    import cutcell

    prefix = "source_"
    source = {k.removeprefix(prefix): a for k, a in arrays.items() if k.startswith(prefix)}
    target = cutcell.TriangleMesh(arrays["vertices"], arrays["faces"])
    moved = cutcell.transfer(rig_of(source), target, **options, progress=progress)
    return sparse(beside_locked(moved.weights, arrays, options["max_influences"])), moved.report


def diagnose(arrays, options, progress):
    """Find faults, and explain the weights of a vertex, a line a joint."""
    import cutcell

    rig, resolution, vertex = rig_of(arrays), options["resolution"], options["vertex"]
    findings = [
        {"severity": finding.severity, "text": f"{finding.message} {finding.advice}"}
        for finding in cutcell.diagnose(rig, resolution, progress=progress).findings
    ]
    lines = []
    if vertex >= 0:
        explanation = cutcell.explain(rig, vertex, resolution, progress=progress)
        lines += [explanation.fallback] if explanation.fallback else []
        for share in explanation.joints[:MAX_SHARES]:
            stored = "" if share.file_weight is None else f"weight {share.file_weight:.3f}, "
            lengths = f"distance {share.distance:.3g} through the body, {share.straight:.3g} direct"
            line = f"{share.name}: {stored}computed {share.weight:.3f}, {lengths}"
            lines.append(f"{line}. {share.absence}" if share.absence else line)
    return {}, {"findings": findings, "vertex": lines}


def save(arrays, options, progress):
    """Save a character as a file."""
    import cutcell

    cutcell.save(options["path"], rig_of(arrays))
    return {}, {}


def load(arrays, options, progress):
    """Read the weights of a file for bones of some names."""
    import cutcell

    rig = cutcell.load(options["path"])
    if rig.weights is None:
        raise cutcell.WeightsError("the file has no weights; bind the character first")
    column = {name: j for j, name in enumerate(rig.skeleton.names)}
    padded = np.pad(rig.weights, ((0, 0), (0, 1)))  # for bones that the file lacks
    weights = padded[:, [column.pop(name, -1) for name in arrays["names"].tolist()]]
    return sparse(weights) | {"vertices": rig.mesh.vertices}, {"missing": list(column)}


TASKS = {task.__name__: task for task in (bind, clean, transfer, diagnose, save, load)}


def rig_of(arrays):
    """Return the rig of a request. Bones whose groups are locked get no new weight."""
    from cutcell import Rig, Skeleton, TriangleMesh

    mesh = TriangleMesh(arrays["vertices"], arrays["faces"])
    names = tuple(arrays["names"].tolist())
    skeleton = Skeleton(arrays["joints"], arrays["parents"], names, arrays["deform"])
    allowed = ~arrays["locked"] if "locked" in arrays else None
    return Rig(mesh, skeleton, arrays.get("weights"), allowed=allowed, name="character")


def beside_locked(weights, arrays, max_influences=None):
    """Scale weights (n, j) to what the locked groups of each vertex leave of one.

    With a limit, the smallest weights of a vertex are dropped so that locked ones count, too.
    """
    if "locked" not in arrays:
        return weights
    locked = arrays["locked"]
    stored = np.where(locked, arrays["stored"], 0.0)
    weights = np.where(locked, 0.0, weights)
    if max_influences is not None:
        rank = np.argsort(np.argsort(-weights, axis=1, kind="stable"), axis=1, kind="stable")
        weights[rank >= (max_influences - (stored > 0).sum(axis=1))[:, None]] = 0.0
    total = weights.sum(axis=1, keepdims=True)
    share = np.clip(1 - stored.sum(axis=1, keepdims=True), 0, 1)
    return weights * np.divide(share, total, out=np.zeros_like(total), where=total > 0)


def sparse(weights):
    """Return weights (n, j) as the arrays of a sparse matrix by columns."""
    from scipy.sparse import csc_array

    columns = csc_array(weights)
    return {"data": columns.data, "indices": columns.indices, "indptr": columns.indptr}


def run(request, write):
    """Run a request, and write its progress and its result, or its error."""
    from cutcell.errors import CutcellError
    from cutcell.weights.warm_up import is_compiled, warm_up

    def progress(stage, fraction):
        write({"stage": stage, "fraction": fraction})

    try:
        with np.load(request["input"]) as archive:
            arrays = dict(archive)
        if request["task"] not in ("save", "load") and not is_compiled():
            progress("compile", 0.0)
            warm_up()
        arrays, result = TASKS[request["task"]](arrays, request["options"], progress)
        np.savez(request["output"], **arrays)
        write({"result": result})
    except CutcellError as error:
        write({"error": str(error)})
    except Exception as error:
        traceback.print_exc()
        write({"error": f"{type(error).__name__}: {error}. See the system console"})


def main():
    """Run requests until standard input ends."""
    sys.path.extend(sys.argv[1:])
    replies, sys.stdout = sys.stdout, sys.stderr  # what libraries print is no reply

    def write(message):
        print(json.dumps(message), file=replies, flush=True)

    for line in sys.stdin:
        run(json.loads(line), write)


if __name__ == "__main__":
    main()
