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

import hou


def import_result(folder):
    scenes = sorted(glob.glob(os.path.join(folder, "*.usda")))
    if len(scenes) != 1:
        raise hou.Error("expected one NAME.usda in " + folder)
    name = os.path.splitext(os.path.basename(scenes[0]))[0]
    with open(scenes[0], encoding="utf-8") as file:
        catmull_clark = 'subdivisionScheme = "catmullClark"' in file.read()

    scene = hou.node("/obj")
    mesh = scene.createNode("geo", name, run_init_scripts=False)
    source = mesh.createNode("file", "mesh")
    source.parm("file").set(os.path.join(folder, name + ".obj"))
    last = source
    if catmull_clark:
        last = mesh.createNode("subdivide", "limit_surface")
        last.setInput(0, source)
        last.parm("iterations").set(2)
    last.setDisplayFlag(True)
    last.setRenderFlag(True)

    volume = scene.createNode("geo", name + "_volume", run_init_scripts=False)
    grids = volume.createNode("file", "grids")
    grids.parm("file").set(os.path.join(folder, name + ".vdb"))
    surface = volume.createNode("convertvdb", "surface_as_polygons")
    surface.setInput(0, grids)
    surface.parm("group").set("@name=surface")
    surface.parm("conversion").set("poly")
    surface.setDisplayFlag(True)
    volume.setDisplayFlag(False)

    stage = hou.node("/stage")
    if stage is not None:
        layer = stage.createNode("sublayer", name)
        layer.parm("filepath1").set(scenes[0])
    return mesh


if __name__ == "__main__":
    chosen = hou.ui.selectFile(title="Result folder of vdb-patina", file_type=hou.fileType.Directory)
    if chosen:
        import_result(hou.text.expandString(chosen))
