"""The materials of a character's file, once somebody wants to see them."""

from cutcell.errors import FileError
from cutcell.io.materials.transfer import has_materials, read_materials
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_viewers.materials import Textures, as_textures, decoded, none_decoded

from ...derive.derived import Derived
from ...derive.processes import MAX_SECONDS, in_process

ENDED = "decoding its images came to a sudden end"


def read(rig: Rig, progress: Progress) -> Textures | None:
    """Return the textures of a rig's materials; images are decoded in another process."""
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


MATERIALS = Derived(
    "materials",
    lambda state: None if state.rig is None or not has_materials(state.rig) else (state.rig.mesh,),
    lambda mesh, rig, progress: read(rig, progress),
    wanted=lambda state: state.panel == "pose" and state.pose_colors == "materials",
    more=lambda state: (state.rig,),
)
