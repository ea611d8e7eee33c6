"""Transfer of weights to clothes and levels of detail: options, and a place to drop the mesh."""

from ...document.loading import receiver
from ...document.session import Session
from ...files.upload_cache import Group
from ...widgets import controls as ui
from ...widgets.file_drop import FileDrop
from .task import Transferring

ABOUT = (
    "Drop clothes or a level of detail that lie on the character. They open with its weights, as a "
    "layer."
)
HINT = "With or without a skeleton"


def transfer_to(session: Session, group: Group) -> None:
    """Transfer the weights of the open character to the mesh in dropped files, and open it."""
    session.uploads.hold(group.key)
    session.tasks.add(Transferring(session, group))


def _drop(session: Session) -> FileDrop:
    label, files = "Drop a mesh here, or browse", receiver(session, transfer_to)
    return FileDrop(files, label=label, hint=HINT, margin=ui.GAP, **ui.WIDE)


TRANSFER = ui.folded(
    "Clothes, levels of detail",
    ui.caption(ABOUT),
    _drop,
    ui.slider("transfer_distance", format="0.0"),
    ui.slider("transfer_angle", format="0"),
    ui.switch("transfer_flipped"),
    visible=lambda state: state.binding is not None,
)
