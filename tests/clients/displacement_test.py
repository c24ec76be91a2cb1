"""Cycles subdivides and displaces an exported cage: what it makes is the surface in the volume, to 0.1 voxel.

    displacement_test.py PROGRAM ADDON_FOLDER CAGE WORK_FOLDER

The cage (Spot, data/meshes) under 5 to 13 voxels of relief, adaptive subdivision, an orthographic camera; Position pass
against the grid `surface`. Three mistakes must show: a map that is upside down, a scale of 1.02, no displacement.
Ends with 77 (skipped) where Blender, python3-openvdb or python3-numpy is not installed.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77
PIXELS = 384
HERE = pathlib.Path(__file__).resolve().parent
CLEAN_PATH = "/usr/bin:/bin"
SCRIPT = """new copper
coat cuprite_2 10um 0.6 + 0.4 * noise(300mm)
render maps
"""


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run([str(word) for word in command], check=True, **options)


def clean_environment(folder):
    # Another python3 on PATH would change the modules that Blender finds.
    return {"PATH": CLEAN_PATH, "HOME": os.environ.get("HOME", str(folder))}


def main():
    program, addon, cage, folder = sys.argv[1], sys.argv[2], sys.argv[3], pathlib.Path(sys.argv[4])
    blender, python = shutil.which("blender", path=CLEAN_PATH), shutil.which("python3", path=CLEAN_PATH)
    reader = python and subprocess.run([python, "-c", "import numpy, pyopenvdb"], stderr=subprocess.DEVNULL,
                                       env=clean_environment(folder), check=False)
    if blender is None or not reader or reader.returncode != 0:
        print("skipped: no Blender or no python3-openvdb here; `tools/setup.sh --clients` installs them")
        return SKIPPED
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "points").mkdir(parents=True)
    script = folder / "hills.patina"
    script.write_text(SCRIPT, encoding="utf-8")
    # The cage is 1.7 m: a micrometre, 13000 times life size, is a voxel of 1.3 cm.
    run(program, "run", script, cage, "--atlas", "--voxels", 128, "--resolution", 1024, "--picture", 0, "--exaggeration",
        13000, "--keep-exaggeration", "--fold-mask", "--vector-displacement", "--progress", "none", "-q", "-o", folder / "hills")
    run(program, "bake", folder / "hills" / "hills.vdb", cage, "--atlas", "--resolution", 1024, "--keep-exaggeration",
        "--vector-displacement", "--vector-space", "blender", "--progress", "none", "-q", "-o", folder / "tangent")
    run(blender, "-b", "--factory-startup", "--python-exit-code", 1, "--python", HERE / "displacement_render.py", "--", addon,
        folder / "hills", folder / "tangent", folder / "points", PIXELS, env=clean_environment(folder), stdin=subprocess.DEVNULL)
    measured = run(python, HERE / "displacement_distance.py", folder / "hills" / "hills.vdb", folder / "points", PIXELS,
                   env=clean_environment(folder), stdout=subprocess.PIPE, text=True)
    figures = json.loads(measured.stdout)
    for name, found in figures.items():
        print(f"{name:12} {found['pixels']} pixels, {found['folded']} under the fold mask: rms {found['rms']:.4f}, "
              f"99.9 % under {found['p999']:.3f}, at most {found['max']:.3f} voxel")
    for name in ("as_imported", "vectors", "tangent"):
        right = figures.pop(name)
        assert right["pixels"] > 0.2 * PIXELS * PIXELS, "the surface is not in the picture"
        # Heights show jumps and creases that vectors pass (measured: 1.8 % against 0.3 %).
        most = 0.025 if name == "as_imported" else 0.01
        assert right["folded"] < most * right["pixels"], "too much of the surface is masked"
        assert right["rms"] <= 0.1, f"the surface that Cycles displaced is not the volume's: {name}"
    assert sorted(figures) == ["flipped_v", "scaled", "undisplaced"], figures.keys()
    for name, wrong in figures.items():
        assert wrong["rms"] > 0.1, f"the distance does not show a mistake: {name}"
    return 0


if __name__ == "__main__":
    sys.exit(main())
