"""Results of every kind, imported by the Blender add-on: close-up, Loop, creases, open sheet, frames, the panel's run.

    addon_scenes_test.py PROGRAM ADDON_FOLDER WORK_FOLDER

Ends with 77 (skipped) where no Blender is installed.
"""

import os
import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77
HERE = pathlib.Path(__file__).resolve().parent
CLEAN_PATH = "/usr/bin:/bin"

OCTAHEDRON = """v 1 0 0
v -1 0 0
v 0 1 0
v 0 -1 0
v 0 0 1
v 0 0 -1
f 1 3 5
f 3 2 5
f 2 4 5
f 4 1 5
f 3 1 6
f 2 3 6
f 4 2 6
f 1 4 6
"""
# A cube of side 2 with sharp edges around its face y = 1.
CUBE = """v -1 -1 -1
v 1 -1 -1
v -1 1 -1
v 1 1 -1
v -1 -1 1
v 1 -1 1
v -1 1 1
v 1 1 1
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
"""
LID = "".join(f"t crease 2/1/0 {a} {b} {{sharpness}}\n" for a, b in ((2, 3), (3, 7), (7, 6), (6, 2)))


def sheet():
    """Four quads in the plane y = 0, from -1 to 1."""
    lines = [f"v {x} 0 {z}" for z in (1, 0, -1) for x in (-1, 0, 1)]
    lines += [f"f {a} {a + 1} {a + 4} {a + 3}" for a in (1, 2, 4, 5)]
    return "\n".join(lines) + "\n"


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run([str(word) for word in command], check=True, **options)


def main():
    program, addon, folder = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], pathlib.Path(sys.argv[3]).resolve()
    blender = shutil.which("blender", path=CLEAN_PATH)
    if blender is None:
        print("skipped: no Blender here; `tools/setup.sh --clients` installs it")
        return SKIPPED
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, text in (("film.patina", "new copper\ncoat cuprite_2 1um\nrender maps\n"), ("octahedron.obj", OCTAHEDRON),
                       ("lid.obj", CUBE + LID.format(sharpness=10)), ("soft_lid.obj", CUBE + LID.format(sharpness=1)),
                       ("sheet.obj", sheet())):
        (folder / name).write_text(text, encoding="utf-8")
    script, small = folder / "film.patina", ["--resolution", 64, "--picture", 0, "--progress", "none", "-q"]
    for name, model, options in (
            ("closeup", "sphere", ["--region-at", "0,0.1,0,0.0002", "--voxels", 64]),
            ("loop", folder / "octahedron.obj", ["--scheme", "loop", "--voxels", 48]),
            ("lid", folder / "lid.obj", ["--voxels", 48]),
            ("soft_lid", folder / "soft_lid.obj", ["--voxels", 48]),
            ("sheet", folder / "sheet.obj", ["--repair", "sheet", "--voxels", 48])):
        run(program, "run", script, model, *options, *small, "-o", folder / name)
    run(program, "weather", "sphere", "--environment", "marine", "--years", "5:10:5", "--maps", "all", "--voxels", 32, *small,
        "-o", folder / "frames")
    # Another python3 on PATH would change the modules that Blender finds.
    clean = {"PATH": CLEAN_PATH, "HOME": os.environ.get("HOME", str(folder))}
    if "VDB_PATINA_DATA" in os.environ:
        clean["VDB_PATINA_DATA"] = os.environ["VDB_PATINA_DATA"]
    ran = run(blender, "-b", "--factory-startup", "--python-exit-code", 1, "--python", HERE / "addon_scenes.py", "--", addon,
              folder, program, env=clean, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
    print("\n".join(line for line in ran.stdout.splitlines() if not line.startswith(("Fra:", "Saved:"))))
    assert "all scenes as they should be" in ran.stdout, "Blender never reached the end of the script"
    return 0


if __name__ == "__main__":
    sys.exit(main())
