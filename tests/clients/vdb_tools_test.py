"""OpenVDB's own tools, its Python module and Blender read the volumes: grids, types, classes, half precision, fog.

    vdb_tools_test.py PROGRAM WORK_FOLDER

Ends with 77 (skipped) where OpenVDB's tools, python3-openvdb or Blender is not installed.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

SKIPPED = 77
CLEAN_PATH = "/usr/bin:/bin"
SCRIPT = """new copper
coat tarnish_1 0.5um
coat cuprite_2 1um exposure
render maps
"""
# Run by Debian's python3: an independent reader of the fog.
READ_FOG = """
import sys, pyopenvdb
for name in ("density", "density_01_tarnish_1", "density_02_cuprite_2"):
    grid = pyopenvdb.read(sys.argv[1], name)
    values = [item.value for item in grid.citerOnValues()]
    print(name, grid.gridClass, grid.background, min(values), max(values), grid.saveFloatAsHalf)
"""
BLENDER = """
import sys, bpy
volume = bpy.data.volumes.new("fog")
volume.filepath = sys.argv[sys.argv.index("--") + 1]
assert volume.grids.load(), volume.grids.error_message
for grid in volume.grids:
    assert grid.load(), volume.grids.error_message
print("BLENDER", sorted((grid.name, grid.data_type) for grid in volume.grids))
"""


def run(*command, **options):
    print("$", *(str(word)[:200] for word in command), flush=True)
    return subprocess.run([str(word) for word in command], check=True, **options)


def read(*command):
    return run(*command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, stdin=subprocess.DEVNULL,
               env={"PATH": CLEAN_PATH, "HOME": os.environ.get("HOME", "/")}).stdout


def printed(file):
    """What vdb_print says of each grid."""
    grids = {}
    # It ends with 0 on every error: only what it prints counts.
    for part in read("vdb_print", "-l", file).split("\nName: ")[1:]:
        def line(pattern):
            match = re.search(pattern, part, re.MULTILINE)
            return match.group(1).strip() if match else None

        grids[part.split("\n", 1)[0].strip()] = {
            "type": line(r"^  Type:\s+Tree_(\w+?)_5_4_3"), "class": line(r"^  class: (.*)$"),
            "half": line(r"^  is_saved_as_half_float: (.*)$"), "background": line(r"^  Background value: (.*)$"),
            "up": line(r"^  patina_up: (.*)$")}
    return grids


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    tools = [shutil.which(name, path=CLEAN_PATH) for name in ("vdb_print", "vdb_tool", "blender", "python3")]
    reader = tools[3] and subprocess.run([tools[3], "-c", "import pyopenvdb"], stderr=subprocess.DEVNULL,
                                         env={"PATH": CLEAN_PATH}, check=False)
    if not all(tools) or reader.returncode != 0:
        print("skipped: no vdb_print, vdb_tool, python3-openvdb or Blender here; `tools/setup.sh --clients` installs them")
        return SKIPPED
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    script = folder / "film.patina"
    script.write_text(SCRIPT, encoding="utf-8")
    run(program, "run", script, "sphere", "--voxels", 48, "--resolution", 64, "--picture", 0, "--exaggeration", 2000, "--fog",
        "--half-fields", "--progress", "none", "-q", "-o", folder)

    grids = printed(folder / "film.vdb")
    level_sets = ["base", "surface", "interface_01_tarnish_1", "interface_02_cuprite_2"]
    for name in level_sets:
        found = grids[name]
        assert (found["type"], found["class"], found["half"]) == ("float", "level set", "false"), (name, found)
        assert float(found["background"]) > 0.0 and found["up"] == "y", (name, found)
    assert grids["material"]["type"] == "int32", grids["material"]
    assert (grids["exposure"]["type"], grids["exposure"]["half"]) == ("float", "true"), grids["exposure"]
    fog = printed(folder / "film_fog.vdb")
    assert sorted(fog) == ["density", "density_01_tarnish_1", "density_02_cuprite_2"], fog
    for name, found in fog.items():
        assert (found["type"], found["class"], found["half"]) == ("float", "fog volume", "true"), (name, found)
        assert float(found["background"]) == 0.0, (name, found)

    listed = read("vdb_tool", "-read", folder / "film.vdb", "-print")
    for name in [*level_sets, "material", "exposure"]:
        assert f'"{name}"' in listed, f"vdb_tool did not read {name}"
    # A level set that vdb_tool can mesh.
    read("vdb_tool", "-read", folder / "film.vdb", "-ls2mesh", "vdb=0", "-write", folder / "meshed.ply")
    assert (folder / "meshed.ply").stat().st_size > 10000, "vdb_tool made no mesh"

    for line in read("python3", "-c", READ_FOG, folder / "film_fog.vdb").splitlines():
        print(line)
        name, *rest = line.rsplit(" ", 4)
        background, low, high = (float(word) for word in rest[:3])
        assert background == 0.0 and 0.0 < low and high <= 1.0, line
    (folder / "fog.py").write_text(BLENDER, encoding="utf-8")
    seen = read("blender", "-b", "--factory-startup", "--python-exit-code", 1, "--python", folder / "fog.py", "--",
                folder / "film_fog.vdb")
    expected = [(name, "FLOAT") for name in sorted(fog)]
    assert f"BLENDER {expected}" in seen, seen
    return 0


if __name__ == "__main__":
    sys.exit(main())
