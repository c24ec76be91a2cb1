"""Makes a small result with vdb-patina and has Blender read it.

    blender_test.py PROGRAM WORK_FOLDER

Ends with 77 (skipped) where no Blender is installed.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77
RESOLUTION = 64
HERE = pathlib.Path(__file__).resolve().parent
# Another python3 on PATH would change the modules that Blender finds.
CLEAN_PATH = "/usr/bin:/bin"


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run([str(word) for word in command], check=True, **options)


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    blender = shutil.which("blender", path=CLEAN_PATH)
    if blender is None:
        print("skipped: no Blender here; `tools/setup.sh --clients` installs it")
        return SKIPPED

    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    # Exaggerated so that each layer is about a voxel thick and Blender's meshes of them can be told apart.
    run(program, "run", HERE / "three_layers.patina", "sphere", "--voxels", 48, "--resolution", RESOLUTION, "--picture", 0,
        "--exaggeration", 2000, "--progress", "none", "-o", folder)
    volume = folder / "three_layers.vdb"
    info = json.loads(run(program, "info", "--json", volume, stdout=subprocess.PIPE).stdout)
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))

    grids = {grid["name"]: grid["type"] for grid in info["grids"]}
    # The file also holds the last interface under the name that programs downstream look for.
    grids.setdefault("surface", "float")
    interfaces = [f"interface_{k:02}_{material}" for k, material in enumerate(info["layers"], 1)]
    for name in ["base", *interfaces]:
        assert grids.get(name) == "float", f"`info --json` does not announce {name} as float"
    assert grids.get("material") == "int32", "`info --json` does not announce material as int32"
    expected = {
        "volume": str(volume),
        "voxel_size": info["voxel_size_units"],
        "longest_side": 0.1,  # the sphere of `make` measures 10 cm
        "grids": grids,
        "nest": ["base", *interfaces],
        "maps": {name: str(folder / f"{name}.exr") for name in ("displacement", "diffuse")},
        "resolution": RESOLUTION,
        "max_displacement": report["maps"]["max_displacement_units"],
    }
    (folder / "expected.json").write_text(json.dumps(expected, indent=2) + "\n", encoding="utf-8")

    # Without the exit code option an exception in the script would end Blender with 0.
    blender_run = subprocess.run(
        [blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python", str(HERE / "blender_grids.py"), "--",
         str(folder / "expected.json")],
        env={"PATH": CLEAN_PATH, "HOME": os.environ.get("HOME", str(folder))}, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(blender_run.stdout)
    # A Blender that never reached the script would also end with 0.
    return 0 if blender_run.returncode == 0 and "all as announced" in blender_run.stdout else 1


sys.exit(main())
