"""Whether what is bound and saved is the same when it is loaded again, in every format.

python -m benchmarks.round_trip [FILE...] [--resolution 32] [--markdown OUT]

Mesh, skeleton, clips and attachments must be equal, weights to the precision of the format, and
the glTF validator by Khronos must find nothing new. Ends with exit code 1 if anything differs.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

import cutcell
from cutcell.io import is_avatar, keeps_document
from cutcell.io.formats import GLTF, suffixes
from cutcell.io.formats.rignet import word_names
from cutcell.io.gltf.container import Document
from cutcell.io.gltf.read.accessors import read_accessor
from cutcell.io.gltf.read.read import GltfSource
from cutcell.io.materials.transfer import has_materials
from cutcell_lab.benchmarks.rigs import ROOT, SHARED
from cutcell_lab.benchmarks.tables import Table, publish
from tests.gltf_validator.validator import reports

SEVERITIES = ("error", "warning", "information", "hint")
SAVED = suffixes("write")
SINGLE = 2e-7
"""Largest difference of weights that are stored as float32."""
READ = ("*.glb", "*.gltf", "*.vrm", "*.fbx", "*.usd*", "*.npz", "*.txt")


def differences(rig: cutcell.Rig, again: cutcell.Rig, kind: str) -> Iterator[str]:
    """Yield what is not the same in a rig that was saved and loaded again.

    Parameters
    ----------
    rig, again : Rig
        Before and after.
    kind : str
        The ending of the file between them.
    """
    new = kind in GLTF and not isinstance(rig.source, GltfSource)
    colored = kind in GLTF and not keeps_document(rig) and has_materials(rig)
    exact = {"rtol": 0, "atol": 1e-6 * float(np.abs(rig.mesh.bounds).max()) if new else 0}
    names = tuple(word_names(rig.skeleton.names)) if kind == ".txt" else rig.skeleton.names
    # New files with materials store copies at seams last, and group faces by material.
    count = len(rig.mesh.vertices) if colored else None
    if not _same(rig.mesh.vertices, again.mesh.vertices[:count], **exact):
        yield "vertices"
    meshes = rig.mesh, again.mesh
    if not _same(*(_sorted(m) for m in meshes) if colored else (m.faces for m in meshes), **exact):
        yield "faces"
    if not _same(rig.skeleton.joints, again.skeleton.joints, **exact):
        yield "joints"
    if names != again.skeleton.names or not _same(rig.skeleton.parents, again.skeleton.parents):
        yield "names and parents"
    weights = None if again.weights is None else again.weights[:count]
    if not _same(rig.weights, weights, rtol=0, atol=SINGLE if kind in GLTF else 1e-15):
        yield "weights"
    if kind != ".txt" and not _same(rig.skeleton.deform, again.skeleton.deform):
        yield "joints that deform"
    if kind in GLTF:
        turned = rig.skeleton.orientations
        if turned is not None and not _same(turned, again.skeleton.orientations, atol=1e-6):
            yield "orientations"
        yield from _differences_of_gltf(rig, again, exact, colored)


def _sorted(mesh: cutcell.TriangleMesh) -> np.ndarray:
    corners = mesh.vertices.astype(np.float32)[mesh.faces].reshape(-1, 9)
    return corners[np.lexsort(corners.T)]


def _differences_of_gltf(
    rig: cutcell.Rig, again: cutcell.Rig, exact: dict, colored: bool
) -> Iterator[str]:
    if not _same(rig.world, again.world, atol=max(exact["atol"], 1e-12)):
        yield "place in the scene"
    clips = [(c.name, c.times, c.transforms) for c in rig.clips]
    if len(clips) != len(again.clips) or any(
        name != other.name
        or not _same(times, other.times, rtol=1e-6)
        or not _same(transforms, other.transforms, **exact)
        for (name, times, transforms), other in zip(clips, again.clips, strict=True)
    ):
        yield "clips"
    if len(rig.attachments) != len(again.attachments) or any(
        one.name != other.name
        or one.joint != other.joint
        or not _same(one.mesh.vertices, _vertices(one, other, colored), **exact)
        for one, other in zip(rig.attachments, again.attachments, strict=True)
    ):
        yield "attachments"
    if isinstance(rig.source, GltfSource) and not colored:
        yield from _differences_of_documents(rig.source.document, again.source.document)


def _vertices(one: cutcell.Attachment, other: cutcell.Attachment, colored: bool) -> np.ndarray:
    """Return vertices; without copies at seams, which stand last where there are colours."""
    return other.mesh.vertices[: len(one.mesh.vertices) if colored else None]


def _differences_of_documents(before: Document, after: Document) -> Iterator[str]:
    """Compare all accessors but those of the weights, and all images."""
    table_ = [p["attributes"] for m in before.items("meshes") for p in m["primitives"]]
    old = {v for a in table_ for k, v in a.items() if k.startswith(("JOINTS_", "WEIGHTS_"))}
    for i, accessor in enumerate(before.items("accessors")):
        if i in old:
            continue
        values = [read_accessor(d, i, accessor["type"], "it") for d in (before, after)]
        if not np.array_equal(*values, equal_nan=values[0].dtype.kind == "f"):
            yield f"accessor {i}"
    for image, other in zip(before.items("images"), after.items("images"), strict=True):
        stored = [_bytes(before, image), _bytes(after, other)]
        if None not in stored and stored[0] != stored[1]:
            yield "images"


def _bytes(document: Document, image: dict) -> bytes | None:
    if "bufferView" not in image:
        return None
    view = document.json["bufferViews"][image["bufferView"]]
    start = view.get("byteOffset", 0)
    return document.buffers[view["buffer"]][start : start + view["byteLength"]]


def _same(a: np.ndarray | None, b: np.ndarray | None, rtol: float = 0, atol: float = 0) -> bool:
    if a is None or b is None or a.shape != b.shape:
        return a is b
    return bool(np.allclose(a, b, rtol=rtol, atol=atol))


def findings(*paths: Path) -> list[Counter]:
    """Count what the validator finds in glTF files, by severity and kind."""
    return [
        Counter(f"{SEVERITIES[m['severity']]} {m['code']}" for m in report["issues"]["messages"])
        for report in reports(*paths)
    ]


def round_trip(path: Path, resolution: int, folder: Path) -> dict[str, str]:
    """Bind a file, save it in each format and load it again.

    Returns
    -------
    dict of str to str
        For each ending "equal", or what is not.
    """
    rig = cutcell.load(path)
    rig = rig.with_weights(cutcell.bind(rig, resolution).weights)
    outcome: dict[str, str] = {}
    saved: list[Path] = []
    for kind in SAVED:
        if kind == ".vrm" and not is_avatar(rig):
            continue
        out = folder / kind[1:] / f"{path.stem}{kind}"
        out.parent.mkdir()
        try:
            cutcell.save(out, rig)
            again = cutcell.load(out)
            outcome[kind] = ", ".join(differences(rig, again, kind)) or "equal"
            twice = out.with_stem("twice")
            cutcell.save(twice, again)
        except cutcell.CutcellError as error:
            outcome[kind] = str(error)
            continue
        binary = rig.source is not None and kind in (".glb", ".vrm")
        if binary and twice.read_bytes() != out.read_bytes():
            outcome[kind] += "; other bytes when it is saved again"
        if kind in GLTF:
            saved.append(out)
    comparable = path.suffix.lower() in GLTF
    before = findings(path)[0] if comparable else Counter()
    faults = ("error", "warning") if comparable else ("error",)
    for out, table_ in zip(saved, findings(*saved), strict=True):
        worse = table_ - before
        severe = [f"{n} {what}" for what, n in worse.items() if what.startswith(faults)]
        if severe:
            outcome[out.suffix] += "; new: " + ", ".join(severe)
        elif worse:
            outcome[out.suffix] += f" ({', '.join(f'{n} {what}' for what, n in worse.items())})"
    return outcome


def files(paths: Sequence[Path] = ()) -> list[Path]:
    """Return the files to try: those named, or all that are at hand."""
    folders = ROOT / "assets", SHARED / "rigs", SHARED / "wild"
    return [Path(path) for path in paths] or [
        path for folder in folders for kind in READ for path in sorted(folder.rglob(kind))
    ]


def table(options: argparse.Namespace) -> tuple[Table, bool]:
    """Try all files; return the table, and whether all of it is equal."""
    paths = files(options.files)
    stems = Counter(path.stem for path in paths)
    table_ = Table(
        "Round trips",
        ["file", *(kind[1:] for kind in SAVED)],
        f"Bound at R={options.resolution}, saved, and loaded again. In brackets: what "
        "the validator newly tells of and is no fault, or may be of the file as it came.",
    )
    good = True
    for path in paths:
        name = path.stem if stems[path.stem] == 1 else f"{path.parent.name}/{path.stem}"
        with tempfile.TemporaryDirectory(prefix="cutcell-round-trip-") as folder:
            try:
                outcome = round_trip(path, options.resolution, Path(folder))
            except cutcell.CutcellError as error:
                table_.add(name, f"not loaded: {error}", *["-"] * (len(SAVED) - 1))
                print(table_.rows[-1], file=sys.stderr)
                continue
        good &= all(text == "equal" or text.startswith("equal (") for text in outcome.values())
        table_.add(name, *(outcome.get(kind, "-") for kind in SAVED))
        print(table_.rows[-1], file=sys.stderr)
    return table_, good


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.round_trip", description=__doc__)
    parser.add_argument("files", nargs="*", metavar="FILE", help="all at hand when left out")
    parser.add_argument("--resolution", type=int, default=32, metavar="R")
    parser.add_argument("--markdown", type=Path, metavar="OUT")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> int:
    """Print the table, and write it too if a file is named."""
    options = arguments(argv)
    table_, good = table(options)
    publish([table_], options.markdown)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
