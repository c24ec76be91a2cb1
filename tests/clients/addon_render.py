"""Runs inside Blender: imports a result by the add-on and renders it as the program's own picture was taken.

    blender -b --factory-startup --python-exit-code 1 --python addon_render.py -- ADDON_FOLDER RESULT PICTURE PANORAMA
"""

import math
import sys

import bpy
from mathutils import Vector

ADDON, RESULT, PICTURE, PANORAMA = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, ADDON)
import vdb_patina  # noqa: E402

bpy.ops.wm.read_factory_settings(use_empty=True)
vdb_patina.register()
try:
    vdb_patina.import_result(ADDON)
    raise SystemExit("a folder without a result was imported")
except vdb_patina.ResultError as error:
    assert "no result" in str(error), error

mesh = vdb_patina.import_result(RESULT, interfaces=True)
names = {item.name.split(" ", 1)[1] for item in bpy.data.objects if " " in item.name}
assert {"volume", "base", "interface_01_cuprite_2"} <= names, names
assert mesh.modifiers and len(mesh.data.materials) == 1
glossy = [node for node in mesh.data.materials[0].node_tree.nodes if node.type == "BSDF_GLOSSY"]
assert len(glossy) == 2, "copper's lobe and cuprite's"
depsgraph = bpy.context.evaluated_depsgraph_get()
film = bpy.data.objects[f"{mesh.name} interface_01_cuprite_2"].evaluated_get(depsgraph)
assert len(film.data.polygons) > 100, "the interface was not meshed"

scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 64
scene.cycles.use_denoising = False
scene.cycles.max_bounces = 4
scene.render.resolution_x = scene.render.resolution_y = 256
scene.view_settings.view_transform = "Standard"
world = bpy.data.worlds.new("panorama")
scene.world = world
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
around = nodes.new("ShaderNodeTexEnvironment")
around.image = bpy.data.images.load(PANORAMA)
# The panorama's middle lies ahead of a viewer at azimuth 0 (+y), Blender has it at +x.
turned, direction = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
turned.inputs["Rotation"].default_value = (0, 0, -math.pi / 2)
links.new(direction.outputs["Generated"], turned.inputs["Vector"])
links.new(turned.outputs["Vector"], around.inputs["Vector"])
links.new(around.outputs["Color"], nodes["Background"].inputs["Color"])

corners = [mesh.matrix_world @ Vector(corner) for corner in mesh.bound_box]
middle = sum(corners, Vector()) / 8
azimuth, elevation, distance = math.radians(20), math.radians(15), 0.4
towards = Vector(
    (math.sin(azimuth) * math.cos(elevation), -math.cos(azimuth) * math.cos(elevation), math.sin(elevation))
)
data = bpy.data.cameras.new("camera")
data.angle = math.radians(22)
camera = bpy.data.objects.new("camera", data)
scene.collection.objects.link(camera)
scene.camera = camera
camera.location = middle + towards * distance
camera.rotation_euler = (-towards).to_track_quat("-Z", "Y").to_euler()
scene.render.filepath = PICTURE
bpy.ops.render.render(write_still=True)
