"""PyVista's meshes and plotters become descriptions, and descriptions plotters."""

import numpy as np
import pytest
import pyvista as pv

import cutcell_viewers
from cutcell_viewers.camera import framing
from cutcell_viewers.description import Actor, Description, Legend
from cutcell_viewers.scene import render_png


def test_a_surface_keeps_its_points_triangles_and_values():
    sphere = pv.Sphere()
    sphere["height"] = sphere.points[:, 2]
    actor = Actor.from_polydata(sphere, "height", colormap="distance", opacity=0.5)
    assert actor.kind == "surface"
    np.testing.assert_array_equal(actor.points, sphere.points)
    np.testing.assert_array_equal(actor.cells, sphere.regular_faces)
    np.testing.assert_allclose(actor.scalars, sphere.points[:, 2])
    assert actor.limits == (sphere.points[:, 2].min(), sphere.points[:, 2].max())
    assert (actor.colormap, actor.opacity) == ("distance", 0.5)


def test_values_of_cells_become_values_of_points():
    cube = pv.Cube().triangulate()
    cube.cell_data["part"] = np.arange(cube.n_cells, dtype=float)
    assert len(Actor.from_polydata(cube, "part").scalars) == cube.n_points


@pytest.mark.parametrize(
    ("mesh", "kind", "columns"),
    [
        (pv.MultipleLines([[0, 0, 0], [1, 0, 0], [1, 1, 0]]), "lines", 2),
        (pv.PolyData([[0.0, 0, 0], [1, 0, 0]]), "points", 1),
        (pv.ImageData(dimensions=(3, 3, 3)), "surface", 3),
    ],
)
def test_other_meshes_become_lines_points_and_surfaces(mesh, kind, columns):
    actor = Actor.from_polydata(mesh)
    assert actor.kind == kind
    assert actor.cells.shape[1] == columns
    assert actor.cells.max() == len(actor.points) - 1


def test_a_plotter_becomes_a_scene_that_looks_the_same():
    plotter = pv.Plotter(off_screen=True)
    sphere = pv.Sphere()
    sphere["height"] = sphere.points[:, 2]
    plotter.add_mesh(sphere, scalars="height", cmap="viridis", name="ball")
    moved = plotter.add_mesh(pv.Cube(), color="red", name="box")
    moved.position = (3, 0, 0)
    scene = cutcell_viewers.describe(plotter)
    assert set(scene.actors) == {"ball", "box"}
    table = plotter.actors["ball"].mapper.lookup_table
    shades = [table.map_value(value)[:3] for value in sphere["height"]]
    np.testing.assert_allclose(scene.actors["ball"].colors / 255, shades, atol=0.01)
    assert scene.actors["box"].color == (1.0, 0.0, 0.0)
    np.testing.assert_allclose(scene.actors["box"].points.mean(axis=0), (3, 0, 0), atol=1e-6)
    plotter.close()
    pixels = render_png(scene, size=(200, 100))
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 50


def test_a_plotter_of_a_scene_has_its_overlays_and_its_legend():
    ball = Actor.from_polydata(pv.Sphere(radius=1.0), color=(0.8, 0.8, 0.8))
    bone = Actor.from_polydata(pv.Cube().triangulate(), color=(1.0, 0.0, 0.0), overlay=True)
    bone = Actor("surface", 0.2 * bone.points, bone.cells, color=bone.color, overlay=True)
    legend = Legend("Weight", colormap="weight", low="0", high="1", swatches=(((0, 1, 0), "arm"),))
    scene = Description({"ball": ball, "bone": bone}, legend=legend)
    plotter = cutcell_viewers.plotter(scene, size=(300, 300))
    plotter.camera.position = framing(scene.bounds).position
    pixels = plotter.screenshot(return_img=True).astype(int)
    red = (pixels[..., 0] > 2 * pixels[..., 1] + 20) & (pixels[..., 0] > 2 * pixels[..., 2] + 20)
    assert red[140:160, 140:160].mean() > 0.5, "the bone is drawn over the ball"
    assert plotter.scalar_bars.keys() == {"Weight"}
    assert plotter.renderer.legend is not None
    plotter.close()
