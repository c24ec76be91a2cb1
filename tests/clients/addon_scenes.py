"""Runs inside Blender: what the add-on makes of close-ups, Loop meshes, creases, open sheets, frames and the panel.

    blender -b --factory-startup --python-exit-code 1 --python addon_scenes.py -- ADDON_FOLDER WORK_FOLDER PROGRAM

WORK_FOLDER holds the results that addon_scenes_test.py made. Where surfaces lie is measured on what Cycles dices.
"""

import os
import pathlib
import sys

import bpy
from mathutils import Vector

ADDON, FOLDER, PROGRAM = sys.argv[sys.argv.index("--") + 1 :]
FOLDER = pathlib.Path(FOLDER).resolve()
sys.path[:0] = [ADDON, str(pathlib.Path(__file__).resolve().parent)]
import cycles_passes  # noqa: E402
import vdb_patina  # noqa: E402

failures = []


def check(holds, message):
    if not holds:
        failures.append(message)
        print("FAILED:", message)


def clean():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if not hasattr(bpy.types.Scene, "vdb_patina"):
        vdb_patina.register()


def box(points):
    return [(min(p[axis] for p in points), max(p[axis] for p in points)) for axis in range(3)]


def seen(mesh, elevation):
    """The points that Cycles shows, in the model's coordinates (y up)."""
    cycles_passes.set_up(mesh, FOLDER, 256, azimuth=30.0, elevation=elevation, dicing_pixels=1.0)
    values = cycles_passes.render(FOLDER)["position"]
    inverse = mesh.matrix_world.inverted()
    return [inverse @ Vector(p) for p in zip(*[iter(values)] * 3) if any(p)]


def check_close_up():
    """A volume of voxels of 3 µm is magnified 1024 times, and the mesh with it: both and the interfaces stand at one place."""
    clean()
    mesh = vdb_patina.import_result(FOLDER / "closeup", interfaces=True)
    result = vdb_patina.Result(FOLDER / "closeup")
    check(result.volume_scale == 1.0 / 1024.0, f"the volume's scale is {result.volume_scale}")
    (base,) = [item for item in bpy.data.objects if item.name.endswith(" base")]
    graph = bpy.context.evaluated_depsgraph_get()
    faces = base.evaluated_get(graph).data
    check(len(faces.polygons) > 100, "the metal was not meshed")
    there = box([base.matrix_world @ v.co for v in faces.vertices])
    here = box([mesh.matrix_world @ v.co for v in mesh.data.vertices])
    side = max(high - low for low, high in here)
    print("close-up: mesh", here, "metal of the volume", there)
    check(abs(side / (1024 * 2e-4) - 1.0) < 0.05, f"the close-up of 200 µm is {side} wide")
    for axis in range(3):
        # The voxels reach some margin beyond the box, all around.
        check(there[axis][0] < here[axis][0] + 0.05 * side and there[axis][1] > here[axis][1] - 0.05 * side,
              f"axis {axis}: the mesh at {here[axis]}, the volume at {there[axis]}")
        check(abs(sum(there[axis]) - sum(here[axis])) < 0.2 * side, f"axis {axis}: the middles differ")
    # Displacement is in the mesh's own units, and grows with it.
    points = [mesh.matrix_world @ p for p in seen(mesh, 60)]
    check(abs(max(p.z for p in points) - here[2][1]) < 0.01 * side, "what Cycles shows lies elsewhere")


def check_loop():
    """Blender has no Loop subdivision: the limit surface is imported, and not the octahedron around it."""
    clean()
    mesh = vdb_patina.import_result(FOLDER / "loop", volume=False)
    points = [v.co for v in mesh.data.vertices]
    # A vertex of valence 4 goes to v + (neighbours' mean - v) · 4 χ, χ = 1 / (3 / (8 β) + 4), β = (5/8 - (3/8 + 1/4 cos 90°)²) / 4:
    # of the octahedron around the origin the neighbours' mean is 0.
    beta = (5 / 8 - (3 / 8) ** 2) / 4
    expected = 1 - 4 / (3 / (8 * beta) + 4)
    reach = max(p.x for p in points)
    print(f"Loop: {len(points)} vertices reach {reach:.6f}, the limit is {expected:.6f}")
    check(abs(reach - expected) < 1e-4, "the vertices do not lie on the limit surface")
    check(len(mesh.data.polygons) > 100 and mesh.data.uv_layers.active is not None, "no dice, or no UVs")
    check(len(points) < len(mesh.data.loops) / 4, "the vertices of seams were not joined")
    check(mesh.modifiers[0].subdivision_type == "SIMPLE", "it would be subdivided once more")
    shown = max(p.x for p in seen(mesh, 20))
    check(abs(shown - expected) < 2e-3, f"Cycles shows it at {shown}")


def check_creases():
    """A cube whose lid is a ring of creases: the lid stays in its plane, the bottom is as round as without."""
    clean()
    mesh = vdb_patina.import_result(FOLDER / "lid", volume=False)
    points = seen(mesh, 35)
    top, width = max(p.y for p in points), max(p.x for p in points if p.y > 0.999)
    # Of a cage of side 2: the ring's B-spline reaches 11/12 in the middle of a side.
    print(f"lid: top at {top:.5f}, half as wide as {width:.5f}; 1 and {11 / 12:.5f}")
    check(abs(top - 1.0) < 1e-3, f"the lid lies at {top}")
    check(abs(width - 11 / 12) < 0.01, f"the lid reaches {width}")
    # A sharpness of 1 lasts one step: how far the surface reaches into the corner tells it from any other (2.333 for
    # ever sharp, 1.5 smooth); what was voxelised says where.
    clean()
    mesh = vdb_patina.import_result(FOLDER / "soft_lid", volume=False)
    expected = max(sum(p) for p in vdb_patina.polygons_of_ply(FOLDER / "soft_lid" / "film_limit.ply").points)
    shown = max(sum(p) for p in seen(mesh, 35))
    print(f"soft lid: seen {shown:.5f}, voxelised {expected:.5f}")
    check(1.9 < expected < 2.1, "the crease was not voxelised")
    check(abs(shown - expected) < 5e-3, "the half-sharp lid lies elsewhere than in the volume")


def check_sheet():
    """An open sheet of four quads keeps its corners, as the limit surface in the volume does."""
    clean()
    mesh = vdb_patina.import_result(FOLDER / "sheet", volume=False)
    check(mesh.modifiers[0].boundary_smooth == "PRESERVE_CORNERS", "the modifier rounds the corners")
    shown = box(seen(mesh, 60))
    print("sheet:", shown)
    for axis in (0, 2):
        for end, place in zip(shown[axis], (-1.0, 1.0)):
            check(abs(end - place) < 0.02, f"axis {axis}: a border at {end}")
    corner = max(p.x + p.z for p in seen(mesh, 60))
    check(abs(corner - 2.0) < 0.04, f"the corner was rounded: {corner}")


def check_frames():
    clean()
    count = vdb_patina.import_frames(FOLDER / "frames", volume=False)
    scene = bpy.context.scene
    check(count == 2 and (scene.frame_start, scene.frame_end) == (1, 2), f"{count} frames")
    meshes = sorted((item for item in bpy.data.objects if item.type == "MESH"), key=lambda item: item.name)
    check([item.name for item in meshes] == ["year_000", "year_005"] or len(meshes) == 2, str(meshes))
    for frame in (1, 2):
        scene.frame_set(frame)
        visible = [not item.hide_render for item in meshes]
        check(visible == [frame == 1, frame == 2], f"in frame {frame} {visible} are seen")
    try:
        vdb_patina.import_frames(FOLDER / "lid")
        check(False, "a folder without frames was imported")
    except vdb_patina.ResultError as error:
        check("no frames" in str(error), str(error))


def check_operators():
    """What the panel's buttons do, called from a script."""
    clean()
    settings = bpy.context.scene.vdb_patina
    settings.program, settings.script, settings.model = PROGRAM, str(FOLDER / "film.patina"), "sphere"
    settings.folder, settings.voxels, settings.resolution = str(FOLDER / "by_panel"), 32, 64
    settings.options = "--unit cm --fold-mask"
    check(bpy.ops.object.vdb_patina_run() == {"FINISHED"}, "the run did not finish")
    check((FOLDER / "by_panel" / "fold_mask.exr").exists(), "the options were not passed on")
    kinds = sorted(item.type for item in bpy.data.objects)
    check(kinds == ["MESH", "VOLUME"], f"the run left {kinds}")
    settings.script = str(FOLDER / "missing.patina")
    try:
        bpy.ops.object.vdb_patina_run()
        check(False, "a run without a script finished")
    except RuntimeError as error:
        check("missing.patina" in str(error), str(error))
    settings.program = str(FOLDER / "no_program")
    try:
        bpy.ops.object.vdb_patina_run()
        check(False, "a run without a program finished")
    except RuntimeError as error:
        check("no_program" in str(error), str(error))
    clean()
    check(bpy.ops.import_scene.vdb_patina(directory=str(FOLDER / "by_panel"), flattened=True) == {"FINISHED"}, "no import")
    nodes = [item for item in bpy.data.objects if item.type == "MESH"][0].data.materials[0].node_tree.nodes
    check(any(node.type == "BSDF_PRINCIPLED" for node in nodes), "no Principled shader")
    try:
        bpy.ops.import_scene.vdb_patina(directory=os.fspath(FOLDER / "nothing"))
        check(False, "a folder of nothing was imported")
    except RuntimeError as error:
        check("no result" in str(error), str(error))


for test in (check_close_up, check_loop, check_creases, check_sheet, check_frames, check_operators):
    print("---", test.__name__)
    test()
if failures:
    sys.exit(f"{len(failures)} checks failed in Blender {bpy.app.version_string}")
print(f"all scenes as they should be, in Blender {bpy.app.version_string}")
