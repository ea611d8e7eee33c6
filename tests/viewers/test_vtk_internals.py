"""What the scenes use of VTK beyond PyVista is still there."""

import pytest
import pyvista as pv
from vtkmodules.util.misc import calldata_type
from vtkmodules.util.vtkConstants import VTK_OBJECT

import cutcell_viewers.scene  # noqa: F401 (chooses how VTK draws without a screen)
from cutcell_viewers import vtk_internals
from cutcell_viewers.vtk_internals import DECLARATIONS, MARKERS, polygon_actor, replace_in_shader

PAIRS = [(stage, marker) for stage, markers in MARKERS.items() for marker in markers]


@pytest.fixture(scope="module")
def sources():
    """Return VTK's shaders for polygons, with our code in the place of all markers."""
    actor, result = polygon_actor(pv.Sphere()), {}
    for stage, marker in PAIRS:
        code = f"{marker}\n// cutcell {marker[7:]}\n"
        early = stage == "Vertex" or marker == DECLARATIONS
        replace_in_shader(actor, stage, marker, code, early)

    @calldata_type(VTK_OBJECT)
    def remember(mapper, event, program):
        for stage in MARKERS:
            result[stage] = getattr(program, f"Get{stage}Shader")().GetSource()

    actor.mapper.AddObserver("UpdateShaderEvent", remember)
    plotter = pv.Plotter(off_screen=True, window_size=(16, 16))
    plotter.add_actor(actor)
    plotter.screenshot(return_img=True)
    plotter.close()
    return result


@pytest.mark.parametrize(("stage", "marker"), PAIRS)
def test_vtks_shaders_have_the_markers(sources, stage, marker):
    assert f"// cutcell {marker[7:]}" in sources[stage], (
        f'the {stage.lower()} shader of this VTK has no "{marker}": find its new name in '
        f"vtkOpenGLPolyDataMapper, and change it in {vtk_internals.__file__}"
    )


def test_the_vertex_shader_has_the_names_that_strokes_use(sources):
    names = ("vertexMC", "MCDCMatrix", "gl_Position")
    missing = [name for name in names if name not in sources["Vertex"]]
    assert not missing, f"viewers/strokes.py uses names that this VTK has changed: {missing}"
