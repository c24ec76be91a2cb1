"""Houdini: import a result folder of vdb-patina. UNTESTED: written against SideFX's documentation, never run in Houdini.

Shelf tool: paste this into the Script tab of a new tool, or run it in the Python shell:

    import_result("/path/of/result")

What it builds in /obj: a Geo node with the mesh (OBJ, as polygons or as a subdivision surface), a second one with the
grids, and in /stage (where there is one) a Sublayer LOP that reads NAME.usda: the whole scene with its material.

Grids: `surface` and `interface_...` are float level sets (class "level set", background half a band in scene units), `base` the
bare metal, `material` an int32 grid of IDs whose names are in the metadata of the file; all share one transform. A VDB
Activate or VDB Combine node takes them by name; VDB Convert with isovalue 0 makes polygons of a level set.
"""

import glob
import os
import re


def read_scene(path):
    """What NAME.usda says: whether its mesh is a subdivision cage, where the volume lies, and the volume's scale.

    The volume lies elsewhere where maps were baked in a folder of their own; in close-ups of very small voxels its units
    are magnified, and the scale brings it back to the mesh.
    """
    with open(path, encoding="utf-8") as file:
        text = file.read()
    volume = re.search(r"asset filePath = @+([^@]+)@", text)
    scale = re.search(r"float3 xformOp:scale = \((\S+),", text)
    folder = os.path.dirname(os.path.abspath(path))
    return {
        "catmull_clark": 'subdivisionScheme = "catmullClark"' in text,
        "volume": os.path.normpath(os.path.join(folder, volume.group(1))) if volume else None,
        "volume_scale": float(scale.group(1)) if scale else 1.0,
    }


def import_result(folder):
    import hou

    scenes = sorted(glob.glob(os.path.join(folder, "*.usda")))
    if len(scenes) != 1:
        raise hou.Error("expected one NAME.usda in " + folder)
    name = os.path.splitext(os.path.basename(scenes[0]))[0]
    found = read_scene(scenes[0])

    scene = hou.node("/obj")
    mesh = scene.createNode("geo", name, run_init_scripts=False)
    source = mesh.createNode("file", "mesh")
    source.parm("file").set(os.path.join(folder, name + ".obj"))
    last = source
    if found["catmull_clark"]:
        last = mesh.createNode("subdivide", "limit_surface")
        last.setInput(0, source)
        last.parm("iterations").set(2)
    last.setDisplayFlag(True)
    last.setRenderFlag(True)

    if found["volume"] and os.path.exists(found["volume"]):
        volume = scene.createNode("geo", name + "_volume", run_init_scripts=False)
        grids = volume.createNode("file", "grids")
        grids.parm("file").set(found["volume"])
        surface = volume.createNode("convertvdb", "surface_as_polygons")
        surface.setInput(0, grids)
        surface.parm("group").set("@name=surface")
        surface.parm("conversion").set("poly")
        surface.setDisplayFlag(True)
        volume.parm("scale").set(found["volume_scale"])
        volume.setDisplayFlag(False)

    stage = hou.node("/stage")
    if stage is not None:
        layer = stage.createNode("sublayer", name)
        layer.parm("filepath1").set(scenes[0])
    return mesh


if __name__ == "__main__":
    import hou

    chosen = hou.ui.selectFile(title="Result folder of vdb-patina", file_type=hou.fileType.Directory)
    if chosen:
        import_result(hou.text.expandString(chosen))
