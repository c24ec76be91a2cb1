"""The same close-up over the displaced mesh and over the voxels' own surface: FLIP at most 0.02.

    closeup_test.py PROGRAM WORK_FOLDER

The statuette of `make` under the shipped marine script at 256 voxels, a patch of 3 cm. A picture of the bare metal must
be told apart by more than that. Ends with 77 (skipped) where flip-evaluator is not installed.
"""

import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77
SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "data" / "scripts"
MOST = 0.02  # measured: 0.0082; 0.05 is the aim. With voxels' triangles a voxel wide it was 0.0504.
CLOSEUP = "0,0.14,0.05,0.03"


def run(*command):
    print("$", *command, flush=True)
    subprocess.run([str(word) for word in command], check=True)


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    voxels = int(sys.argv[3]) if len(sys.argv) > 3 else 256
    try:
        import flip_evaluator
    except ImportError:
        print("skipped: no flip-evaluator here; `tools/setup.sh --clients` installs it")
        return SKIPPED
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "bare.patina").write_text("new copper\n", encoding="utf-8")
    for name, script in (("marine", SCRIPTS / "marine.patina"), ("bare", folder / "bare.patina")):
        run(program, "run", script, "statuette", "--voxels", voxels, "--picture", 0, "--resolution", 256, "-q",
            "-o", folder / name)

    def picture(name, surface):
        made = folder / f"{name}_{surface}"
        run(program, "render", folder / name / f"{name}.vdb", "--from", surface, "--closeup", CLOSEUP, "--picture", 256,
            "--samples", 32, "-q", "-o", made)
        return str(made / f"{name}.png")

    mesh = picture("marine", "mesh")
    same = flip_evaluator.evaluate(mesh, picture("marine", "volume"), "LDR")[1]
    other = flip_evaluator.evaluate(mesh, picture("bare", "mesh"), "LDR")[1]
    print(f"FLIP {same:.4f} between mesh and volume, {other:.4f} from bare metal")
    assert same <= MOST, "mesh and volume are not the same picture"
    assert other > 2 * MOST, "the measure tells nothing here"
    return 0


if __name__ == "__main__":
    sys.exit(main())
