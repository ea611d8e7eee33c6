"""Draw the pictures of docs/blender.md, and print its table, with Blender as a module.

`python scripts/blender.py pictures` runs it where the extension is installed into a temporary home.
"""

import colorsys
import os
from pathlib import Path

import bpy
import mathutils

ROOT = Path(__file__).resolve().parent.parent
PICTURE = ROOT / "docs" / "pictures" / "blender-bound.png"
GOLDEN = 0.618034
"""Hues of bones that follow each other differ by this part of the circle."""


def install():
    """Install the extension."""
    bpy.ops.extensions.package_install_files(
        repo="user_default", filepath=os.environ["CUTCELL_ARCHIVE"], enable_on_install=True
    )


def bound_character():
    """Import a demo, and bind it from the menu's operator."""
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(ROOT / "assets" / "biped.glb"))
    mesh = next(o for o in bpy.data.objects if o.type == "MESH" and o.vertex_groups)
    armature = mesh.modifiers[0].object
    bpy.ops.object.select_all(action="DESELECT")
    mesh.select_set(True)
    armature.select_set(True)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.cutcell_parent()
    return mesh


def colour(mesh):
    """Colour each vertex by the bones that move it."""
    hues = [i * GOLDEN % 1 for i in range(len(mesh.vertex_groups))]
    palette = [colorsys.hsv_to_rgb(hue, 0.55, 0.85) for hue in hues]
    layer = mesh.data.color_attributes.new("bones", "FLOAT_COLOR", "POINT")
    for vertex in mesh.data.vertices:
        rgb = [sum(g.weight * palette[g.group][k] for g in vertex.groups) for k in range(3)]
        layer.data[vertex.index].color = (*rgb, 1)
    material = bpy.data.materials.new("bones")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    attribute = nodes.new("ShaderNodeVertexColor")
    attribute.layer_name = "bones"
    links.new(attribute.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    mesh.data.materials.clear()
    mesh.data.materials.append(material)


def render(mesh):
    """Render the character in the pose of the file's first frame."""
    scene = bpy.context.scene
    for obj in bpy.data.objects:
        obj.hide_render = obj.type == "MESH" and obj != mesh
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3, (0.7, 0.2, 0.6)
    for obj in (camera, sun):
        scene.collection.objects.link(obj)
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (1, 1, 1)
    bpy.context.view_layer.update()
    corners = [mesh.matrix_world @ mathutils.Vector(c) for c in mesh.bound_box]
    centre = sum(corners, mathutils.Vector()) / 8
    size = max(corner[2] for corner in corners) - min(corner[2] for corner in corners)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1.15 * size
    direction = mathutils.Vector((0.5, -1, 0.2)).normalized()
    camera.location = centre + 4 * size * direction
    camera.rotation_euler = direction.to_track_quat("Z", "Y").to_euler()
    scene.camera, scene.render.engine = camera, "CYCLES"
    scene.cycles.samples, scene.cycles.device = 24, "CPU"
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 480, 640
    scene.render.film_transparent = False
    scene.render.filepath = str(PICTURE)
    bpy.ops.render.render(write_still=True)


def print_table():
    """Print the options of the operator's panel as Blender has them."""
    print("\n| option | default | values | tooltip |\n|---|---|---|---|")
    for option in bpy.ops.object.cutcell_parent.get_rna_type().properties:
        if option.identifier == "rna_type":
            continue
        if option.type == "ENUM":
            values = ", ".join(item.name for item in option.enum_items)
            default = option.enum_items[option.default].name
        else:
            values, default = f"{option.hard_min} to {option.hard_max}", option.default
        print(f"| {option.name} | {default} | {values} | {option.description} |")


if __name__ == "__main__":
    install()
    print_table()
    character = bound_character()
    colour(character)
    render(character)
