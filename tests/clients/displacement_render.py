"""Runs inside Blender: Cycles subdivides and displaces an imported result; where its surface lies is written out.

    blender -b --factory-startup --python-exit-code 1 --python displacement_render.py -- ADDON_FOLDER RESULT TANGENT OUTPUT PIXELS

OUTPUT/NAME.position, NAME.uv (float32, three and two numbers per pixel, rows upwards; all 0 where nothing is hit) for NAME
`as_imported` (heights), `vectors` and `tangent` (vectors as baked in the folder TANGENT, in Blender's tangent space), and
for the mistakes that the distance must show: `flipped_v`, `scaled` by 1.02, `undisplaced`;
OUTPUT/fold_mask (float32, rows upwards).
"""

import pathlib
import sys

import bpy

ADDON, RESULT, TANGENT, OUTPUT, PIXELS = sys.argv[sys.argv.index("--") + 1 :]
sys.path[:0] = [ADDON, str(pathlib.Path(__file__).resolve().parent)]
import cycles_passes  # noqa: E402
import vdb_patina  # noqa: E402


def render(name):
    for kind, values in cycles_passes.render(OUTPUT).items():
        with open(pathlib.Path(OUTPUT) / f"{name}.{kind}", "wb") as file:
            values.tofile(file)


bpy.ops.wm.read_factory_settings(use_empty=True)
mesh = vdb_patina.import_result(RESULT, volume=False, vectors=False)
cycles_passes.set_up(mesh, OUTPUT, PIXELS)
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

# Vectors say the same of a surface without overhangs.
mesh.data.materials[0] = vdb_patina.make_material(vdb_patina.Result(RESULT), vectors=True)
assert any(node.type == "VECTOR_DISPLACEMENT" for node in mesh.data.materials[0].node_tree.nodes)
render("vectors")

# The same in Blender's tangent space, on the diced limit surface.
mesh.hide_render = True
vdb_patina.import_result(TANGENT, volume=False)
assert any(getattr(node, "space", "") == "TANGENT" for node in bpy.context.object.data.materials[0].node_tree.nodes)
render("tangent")

with open(pathlib.Path(OUTPUT) / "fold_mask", "wb") as file:
    cycles_passes.pixels_of(pathlib.Path(RESULT) / "fold_mask.exr", 1).tofile(file)
