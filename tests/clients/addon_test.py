"""A result folder, imported by the Blender add-on and rendered by Cycles, looks as our own picture of the same view does.

    addon_test.py PROGRAM ADDON_FOLDER WORK_FOLDER

Ends with 77 (skipped) where Blender or the picture comparison (flip-evaluator) is not installed.
"""

import math
import pathlib
import shutil
import struct
import subprocess
import sys

SKIPPED = 77
HERE = pathlib.Path(__file__).resolve().parent
CLEAN_PATH = "/usr/bin:/bin"
SCRIPT = """new copper
coat cuprite_2 0.6um texture(DPD(rate=linear, step=8, total=20, cell=2mm)) of full
render maps
"""


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run([str(word) for word in command], check=True, **options)


def write_panorama(path, width=256, height=128):
    """Radiance HDR, dim all around: a window to the upper left behind the viewer's back, a warm lamp to the right."""

    def texel(u, v):
        window = abs(u - 0.86) < 0.06 and abs(v - 0.3) < 0.12
        lamp = math.hypot((u - 0.25) * 2.0, v - 0.42) < 0.08
        return (9.0, 9.5, 10.0) if window else (8.0, 5.0, 2.5) if lamp else (0.25, 0.27, 0.3)

    def rgbe(colour):
        exponent = math.frexp(max(colour))[1]
        return struct.pack("4B", *(int(c * 256.0 / 2.0**exponent) for c in colour), exponent + 128)

    with open(path, "wb") as file:
        file.write(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode("ascii"))
        for row in range(height):
            for column in range(width):
                file.write(rgbe(texel((column + 0.5) / width, (row + 0.5) / height)))


def main():
    program, addon, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    blender = shutil.which("blender", path=CLEAN_PATH)
    try:
        import flip_evaluator
    except ImportError:
        flip_evaluator = None
    if blender is None or flip_evaluator is None:
        print("skipped: no Blender or no flip-evaluator here; `tools/setup.sh --clients` installs them")
        return SKIPPED
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    script = folder / "spots.patina"
    script.write_text(SCRIPT, encoding="utf-8")
    panorama = folder / "window.hdr"
    write_panorama(panorama)
    # Relief of two voxels: what bends light is to be seen, and not only colours.
    run(program, "run", script, "sphere", "--voxels", 96, "--resolution", 512, "--picture", 0, "--exaggeration", 3000,
        "--keep-exaggeration", "-q", "-o", folder / "spots")
    run(program, "render", folder / "spots" / "spots.vdb", "--light", panorama, "--no-floor", "--camera", "20,15,0.4,22",
        "--aspect", 1, "--picture", 256, "--samples", 128, "--view", "srgb", "-q", "-o", folder)
    # Another python3 on PATH would change the modules that Blender finds.
    run(blender, "-b", "--factory-startup", "--python-exit-code", 1, "--python", HERE / "addon_render.py", "--", addon,
        folder / "spots", folder / "cycles.png", panorama, env={"PATH": CLEAN_PATH, "HOME": str(pathlib.Path.home())})

    ours, theirs = str(folder / "spots.png"), str(folder / "cycles.png")
    difference = flip_evaluator.evaluate(ours, theirs, "LDR")[1]
    print(f"FLIP {difference:.4f}")
    assert difference <= 0.1, "the add-on's picture is not ours"
    return 0


if __name__ == "__main__":
    sys.exit(main())
