"""Transfer of the open character's weights to a dropped mesh, which is opened with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from cutcell.editing import Edits, Layer, Mask
from cutcell.editing.stored import save_bound, settings_with_layers, stored_edits
from cutcell.editing.transfer import REFUSED, STATES, Transfer, transfer
from cutcell.errors import MeshError
from cutcell.io import binary_ending
from cutcell.io.files import naming
from cutcell.method import Method
from cutcell.rig import Rig
from cutcell.runtime.display import shown_name
from cutcell.runtime.progress import Progress

from ...derive.processes import in_process
from ...derive.tasks import Task
from ...document.loading import open_character
from ...document.method import effective, method_of
from ...document.opening import Request
from ...document.session import Session
from ...files.reading import main_file, read
from ...files.upload_cache import Group
from ..compute.stack import put_layer
from ..layers.commands import painted

NAMES = [name.capitalize() for name in STATES]
"""Names of the saved selections of vertices by state."""
WORDS = {"resolved": "ambiguous matches resolved"}
ENDED = "writing it came to a sudden end; there may be too little memory"


@dataclass(frozen=True)
class Written:
    """The file of a mesh with transferred weights.

    Parameters
    ----------
    name : str
    content : bytes
    layer : int
        Place of the layer of these weights.
    report : str
        A sentence.
    """

    name: str
    content: bytes
    layer: int
    report: str


class Transferring(Task):
    """Transfers the weights that the page shows to a mesh in dropped files, and opens it.

    The mesh is written as a file with a layer of these weights, so that it is opened again, undone,
    edited and exported as any other file with layers.
    """

    name, title = "transfer", "a transfer"

    def __init__(self, session: Session, group: Group) -> None:
        self._session, self._group = session, group

    def begin(self) -> Callable[[Progress], Any]:
        """Return what reads the mesh and transfers the weights of the open character."""
        state, folder = self._session.state, self._session.folder
        path, source = main_file(self._group.paths), state.rig.with_weights(state.weights)
        method = Method(**effective(method_of(state)))
        percent, angle, flipped = (
            state.transfer_distance, state.transfer_angle, state.transfer_flipped
        )  # fmt: skip

        def compute(progress: Progress) -> Written:
            reading = partial(progress, f"loading {path.name}", 0.0)
            reading()
            target = read(path, reading)
            with naming(path):
                result = transfer(
                    source, target, distance=percent / 100, angle=angle, flipped=flipped,
                    progress=progress,
                )  # fmt: skip
                if (result.state == REFUSED).all():
                    raise MeshError(
                        f"no vertex is close enough to {shown_name(source.name)} (within "
                        f"{percent:g}% of its diagonal). Place the mesh on the character, in the "
                        "same units, or raise the distance"
                    )
                edits, layer = with_layer(target, result, Path(source.name).stem)
            settings = settings_with_layers(target, method, result.weights, edits)
            # A separate folder: a stopped task may still write to its file.
            with TemporaryDirectory(dir=folder, ignore_cleanup_errors=True) as place:
                writing = partial(progress, "writing the file", 0.0)
                out = Path(place, path.stem + binary_ending(result.rig))
                in_process(save_bound, out, result.rig, settings, check=writing, ended=ENDED)
                return Written(out.name, out.read_bytes(), layer, report(path.name, result))

        return compute

    def finish(self, result: Written) -> None:
        """Open the mesh with its weights, coloured by how they came about."""
        session = self._session
        self.drop()
        group = session.uploads.cache.begin(len(result.content), session.uploads)
        session.uploads.hold(group.key)
        group.is_made = True
        group.paths = [group.folder / result.name]
        group.written = group.paths[0].write_bytes(result.content)

        def choose() -> None:
            session.state.layer = result.layer

        request = Request(
            f"~{group.key}",
            again=True,
            choices={"weights_shown": "selections"},
            then=choose,
            message=result.report,
        )
        open_character(session, request)

    def drop(self) -> None:
        """Remove the dropped files: the character is opened from another one."""
        self._session.uploads.cache.drop(self._group)


def with_layer(target: Rig, result: Transfer, source: str) -> tuple[Edits, int]:
    """Return the edits in a target's file with a layer of transferred weights, and its place.

    Selections are saved of the vertices by state.
    """
    own = Edits() if target.weights is None else Edits(base="file")
    edits = stored_edits(target) or own
    every = np.arange(len(result.weights))
    content = painted(result.rig.skeleton, every, result.weights)
    edits, place = put_layer(edits, Layer(content, name=f"Transferred from {source}"))
    selections = {name: mask for name, mask in edits.selections.items() if name not in NAMES}
    for state, name in enumerate(NAMES):
        if (result.state == state).any():
            selections[name] = Mask(vertices=np.flatnonzero(result.state == state))
    return replace(edits, selections=selections), place


def report(name: str, result: Transfer) -> str:
    """Return how many vertices were matched, in-painted and refused, and what to do about these."""
    counts = [
        f"{number:,} {WORDS.get(what, what)}" for what, number in result.report.items() if number
    ]
    text = f"{name}: {', '.join(counts)}."
    if not result.report[STATES[REFUSED]]:
        return text
    return (
        f"{text} Refused vertices have the weights of the closest point, although it is too far "
        "away or faces another way. Select them under Saved selection."
    )
