"""The materials of a character's file, once somebody wants to see them."""

from cutcell.errors import FileError
from cutcell.io.materials.transfer import has_materials, read_materials
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_viewers.materials import Textures, as_textures, decoded, none_decoded

from ..jobs.processes import MAX_SECONDS, in_process
from .session import Session

ENDED = "decoding its images came to a sudden end"


def watch(session: Session) -> None:
    """Read a file's materials as soon as the body is to be seen in them."""
    session.state.param.watch(lambda *events: find(session), ["panel", "rig", "pose_colors"])


def find(session: Session) -> None:
    """Read the materials of the open character, if they are needed and not read yet."""
    state = session.state
    rig = state.rig
    is_current = state.materials is not None and rig is not None and state.materials[0] is rig.mesh
    if not is_current:
        state.materials = None  # of another character, or as it was before a repair
    is_needed = state.panel == "pose" and state.pose_colors == "materials"
    if is_current or not is_needed or rig is None or not has_materials(rig):
        session.tasks.jobs("materials").cancel()
        return

    def done(textures: Textures | None) -> None:
        if state.rig is not None and state.rig.mesh is rig.mesh:
            state.materials = (rig.mesh, textures)

    session.tasks.jobs("materials").start(
        lambda progress: read(rig, progress), done, session.fail, lambda stage, fraction: None
    )


def read(rig: Rig, progress: Progress) -> Textures | None:
    """Return what shows a rig in its materials; images are decoded in another process."""
    materials = read_materials(rig)
    if materials is None:
        return None
    inputs = materials.images, materials.layers

    def require_current() -> None:
        progress("materials", 0.0)

    try:
        pixels, problems = in_process(
            decoded, *inputs, check=require_current, ended=ENDED, limit=MAX_SECONDS
        )
    except FileError as error:
        pixels, problems = none_decoded(materials.layers, str(error))
    return as_textures(rig, materials, pixels, problems)
