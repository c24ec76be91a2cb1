"""Runs inside Blender: Cycles subdivides and displaces an imported result; where its surface lies is written out.

    blender -b --factory-startup --python-exit-code 1 --python displacement_render.py -- ADDON_FOLDER RESULT OUTPUT PIXELS

OUTPUT/NAME.position, NAME.uv (float32, three and two numbers per pixel, rows upwards; all 0 where nothing is hit) for NAME
`as_imported`, and for the mistakes that the distance must show: `flipped_v`, `scaled` by 1.02, `undisplaced`;
OUTPUT/fold_mask (float32, rows upwards).
"""

import array
import math
import pathlib
import sys

import bpy
from mathutils import Vector

ADDON, RESULT, OUTPUT, PIXELS = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, ADDON)
import vdb_patina  # noqa: E402


def pixels_of(path, channels):
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = array.array("f", bytes(4 * len(image.pixels)))
    image.pixels.foreach_get(values)
    planes = [values[c :: image.channels] for c in range(channels)]
    bpy.data.images.remove(image)
    out = array.array("f", bytes(4 * channels * len(planes[0])))
    for c, plane in enumerate(planes):
        out[c::channels] = plane
    return out


def set_up(scene, mesh):
    scene.render.engine = "CYCLES"
    # One sample: the passes then hold a point of the surface and no average of several.
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.dicing_rate = 0.5
    scene.render.resolution_x = scene.render.resolution_y = int(PIXELS)
    layer = bpy.context.view_layer
    layer.use_pass_position = layer.use_pass_uv = True

    corners = [mesh.matrix_world @ Vector(corner) for corner in mesh.bound_box]
    middle = sum(corners, Vector()) / 8
    size = max((corner - middle).length for corner in corners)
    azimuth, elevation = math.radians(35), math.radians(20)
    towards = Vector(
        (math.sin(azimuth) * math.cos(elevation), -math.cos(azimuth) * math.cos(elevation), math.sin(elevation))
    )
    data = bpy.data.cameras.new("camera")
    data.type = "ORTHO"
    data.ortho_scale = 2.0 * size
    data.clip_end = 10.0 * size
    camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.location = middle + towards * 4.0 * size
    camera.rotation_euler = (-towards).to_track_quat("-Z", "Y").to_euler()

    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    layers = tree.nodes.new("CompositorNodeRLayers")
    files = tree.nodes.new("CompositorNodeOutputFile")
    files.base_path = str(OUTPUT)
    files.format.file_format = "OPEN_EXR"
    files.format.color_mode = "RGB"
    files.format.color_depth = "32"
    files.file_slots.clear()
    for name in ("Position", "UV"):
        files.file_slots.new(name)
        tree.links.new(layers.outputs[name], files.inputs[name])


def render(name):
    bpy.ops.render.render()
    for kind, channels in (("Position", 3), ("UV", 2)):
        (path,) = pathlib.Path(OUTPUT).glob(f"{kind}[0-9]*.exr")
        with open(pathlib.Path(OUTPUT) / f"{name}.{kind.lower()}", "wb") as file:
            pixels_of(path, channels).tofile(file)
        path.unlink()


bpy.ops.wm.read_factory_settings(use_empty=True)
mesh = vdb_patina.import_result(RESULT, volume=False)
scene = bpy.context.scene
set_up(scene, mesh)
nodes = mesh.data.materials[0].node_tree.nodes
links = mesh.data.materials[0].node_tree.links
(height,) = [node for node in nodes if node.type == "DISPLACEMENT"]
image = nodes["displacement"]

render("as_imported")
height.inputs["Scale"].default_value = 1.02
render("scaled")
height.inputs["Scale"].default_value = 0.0
render("undisplaced")
height.inputs["Scale"].default_value = 1.0
mapping, coordinates = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
mapping.inputs["Scale"].default_value = (1, -1, 1)
mapping.inputs["Location"].default_value = (0, 1, 0)
links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
links.new(mapping.outputs["Vector"], image.inputs["Vector"])
render("flipped_v")

with open(pathlib.Path(OUTPUT) / "fold_mask", "wb") as file:
    pixels_of(pathlib.Path(RESULT) / "fold_mask.exr", 1).tofile(file)
