"""Runs inside Blender: loads a volume and maps of vdb-patina and checks what arrives.

    blender -b --factory-startup --python-exit-code 1 --python blender_grids.py -- EXPECTED.json

EXPECTED.json (written by blender_test.py): `volume`, `voxel_size`, `longest_side` (scene units), `grids` (name to type),
`nest` (names of the level sets, innermost first), `maps` (name to path), `resolution`, `max_displacement`.
Only Python's own modules: Debian's Blender comes without numpy.
"""

import array
import json
import math
import sys

import bpy

# What vdb-patina calls a type, and what Blender does.
BLENDER_TYPES = {"float": "FLOAT", "int32": "INT", "bool": "BOOLEAN", "vec3f": "VECTOR_FLOAT"}

failures = []


def check(holds, message):
    if not holds:
        failures.append(message)
        print("FAILED:", message)


def load_volume(path):
    volume = bpy.data.volumes.new("patina")
    volume.filepath = path
    check(volume.grids.load(), f"{path}: {volume.grids.error_message}")
    return volume


def check_grids(volume, expected):
    found = {}
    for grid in volume.grids:
        check(grid.load(), f"grid {grid.name}: its values cannot be read: {volume.grids.error_message}")
        found[grid.name] = grid.data_type
        print(f"grid {grid.name:32} {grid.data_type:8} voxel {grid.matrix_object[0][0]:.6g}")
        for axis in range(3):
            step = grid.matrix_object[axis][axis]
            check(abs(step / expected["voxel_size"] - 1) < 1e-5, f"grid {grid.name}: voxel size {step} along axis {axis}")
    for name, kind in expected["grids"].items():
        check(name in found, f"grid {name} is missing")
        check(found.get(name) in (None, BLENDER_TYPES[kind]), f"grid {name} should be {kind}, Blender read {found.get(name)}")
    for name in found:
        check(name in expected["grids"], f"grid {name} was not announced by `vdb-patina info --json`")


def longest_side(volume, grid_name):
    """Of the zero crossing, as Volume to Mesh finds it: only a level set with its values in place has one."""
    scene = bpy.context.scene.collection.objects
    source = bpy.data.objects.get("source") or bpy.data.objects.new("source", volume)
    if source.name not in scene:
        scene.link(source)
    result = bpy.data.objects.new(grid_name, bpy.data.meshes.new(grid_name))
    scene.link(result)
    modifier = result.modifiers.new("crossing", "VOLUME_TO_MESH")
    modifier.object = source
    modifier.grid_name = grid_name
    modifier.threshold = 0.0
    vertices = result.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
    if len(vertices) == 0:
        return 0.0
    return max(max(v.co[axis] for v in vertices) - min(v.co[axis] for v in vertices) for axis in range(3))


def check_nest(volume, expected):
    sides = [longest_side(volume, name) for name in expected["nest"]]
    for name, side in zip(expected["nest"], sides):
        print(f"mesh of {name:29} {side:.6g} scene units")
    voxel = expected["voxel_size"]
    # Blender's mesh is faceted at the scale of a voxel: its extent falls short by a fraction of one.
    check(abs(sides[0] - expected["longest_side"]) < 0.5 * voxel, f"the base measures {sides[0]}, not {expected['longest_side']}")
    for inner, outer, name in zip(sides, sides[1:], expected["nest"][1:]):
        check(outer > inner + 0.1 * voxel, f"{name} does not lie outside the interface below it: {outer} after {inner}")
    check(abs(longest_side(volume, "surface") - sides[-1]) < 1e-6 * sides[-1], "the surface is not the last interface")


def check_map(name, path, expected):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    values = array.array("f", bytes(4 * len(image.pixels)))
    image.pixels.foreach_get(values)
    channels = image.channels
    largest = [max(values[c::channels]) for c in range(min(channels, 3))] if values else [0.0]
    print(f"map {name:15} {image.size[0]} x {image.size[1]}, {channels} channels, largest {largest}")
    check(tuple(image.size) == (expected["resolution"],) * 2, f"map {name}: size {tuple(image.size)}")
    check(image.is_float, f"map {name}: not read as float")
    check(all(map(math.isfinite, values)), f"map {name}: holds NaN or infinity")
    check(min(largest) > 0.0, f"map {name}: a channel is zero everywhere")
    return largest


def main():
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        expected = json.load(file)
    volume = load_volume(expected["volume"])
    check_grids(volume, expected)
    check_nest(volume, expected)
    for name, path in expected["maps"].items():
        largest = check_map(name, path, expected)
        if name == "displacement":
            error = abs(largest[0] / expected["max_displacement"] - 1)
            check(error < 1e-6, f"displacement reaches {largest[0]}, the report says {expected['max_displacement']}")
    if failures:
        sys.exit(f"{len(failures)} checks failed in Blender {bpy.app.version_string}")
    print(f"all as announced, in Blender {bpy.app.version_string}")


main()
