#!/usr/bin/env python3
"""How fast `vdb-patina bake` is, and how long Blender's Cycles takes to bake one map of the same mesh.

    python3 benchmarks/bake_against_cycles.py VOLUME.vdb [MODEL] [--resolution 4096] [--program build/vdb-patina]
                                              [--blender blender] [--bake-option=--tx …]

Prints seconds, CPU seconds, M texel/s (texels in charts, each with all maps) and peak memory of the bake, all maps
written; then the seconds of Cycles' bake of the diffuse colour (pass `color`, one sample, margin 16, no displacement)
from a texture into an image of the same size, on the CPU, without start-up and saving; and the ratio. Both programs may
use all cores. Blender 3.4 or later; without it the ratio is left out.
"""

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time

CYCLES = r"""
import sys, time
import bpy
model, texture, size = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
if hasattr(bpy.ops.wm, "obj_import"):
    bpy.ops.wm.obj_import(filepath=model)
else:
    bpy.ops.import_scene.obj(filepath=model)
mesh = [o for o in bpy.context.scene.objects if o.type == "MESH"][0]
bpy.context.view_layer.objects.active = mesh
mesh.select_set(True)
material = bpy.data.materials.new("patina")
material.use_nodes = True
nodes, links = material.node_tree.nodes, material.node_tree.links
nodes.clear()
out, diffuse = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfDiffuse")
image = nodes.new("ShaderNodeTexImage")
image.image = bpy.data.images.load(texture)
links.new(image.outputs["Color"], diffuse.inputs["Color"])
links.new(diffuse.outputs["BSDF"], out.inputs["Surface"])
target = nodes.new("ShaderNodeTexImage")
target.image = bpy.data.images.new("target", int(size), int(size), float_buffer=True)
nodes.active = target
mesh.data.materials.clear()
mesh.data.materials.append(material)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = 1
scene.cycles.use_denoising = False
start = time.time()
bpy.ops.object.bake(type="DIFFUSE", pass_filter={"COLOR"}, margin=16)
print("CYCLES_SECONDS", time.time() - start)
print("CYCLES_MAX", max(target.image.pixels[:4 * int(size) * 64]), flush=True)
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("volume")
    parser.add_argument("model", nargs="?")
    parser.add_argument("--resolution", type=int, default=4096)
    parser.add_argument("--program", default="build/vdb-patina")
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--bake-option", action="append", default=[])
    options = parser.parse_args()
    model = options.model or os.path.splitext(options.volume)[0] + ".obj"

    with tempfile.TemporaryDirectory() as folder:
        command = [options.program, "bake", options.volume, model, "-o", folder, "--resolution",
                   str(options.resolution), "--progress", "none", "-q", *options.bake_option]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        start = time.time()
        subprocess.run(command, check=True)
        seconds = time.time() - start
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        with open(os.path.join(folder, "report.json")) as file:
            report = json.load(file)
        stages = {stage["name"]: stage["seconds"] for stage in report["stages"]}
        bake = stages["bake maps"] + stages["write maps"]
        texels = report["maps"]["texels"]
        maps = sum(name.endswith(".exr") for name in report["outputs"])
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        print(f"vdb-patina bake: {maps} maps of {options.resolution}², {texels * 1e-6:.2f} M texels in charts: "
              f"{bake:.1f} s, {texels * 1e-6 / bake:.2f} M texel/s; the program {seconds:.1f} s, {cpu:.1f} s of CPU, "
              f"peak memory {report['peak_memory_bytes'] / 2**30:.2f} GiB")
        if not shutil.which(options.blender):
            print("no Blender: no ratio")
            return
        script = os.path.join(folder, "cycles.py")
        with open(script, "w") as file:
            file.write(CYCLES)
        # Blender's Python loses its modules where another one comes first in the PATH.
        environment = {"PATH": "/usr/bin:/bin", "HOME": os.environ.get("HOME", "/tmp")}
        said = subprocess.run([shutil.which(options.blender), "-b", "--factory-startup", "--python-exit-code", "1",
                               "--python", script, "--", model, os.path.join(folder, "diffuse.exr"),
                               str(options.resolution)], env=environment, stdout=subprocess.PIPE, text=True)
        found = [line.split()[1] for line in said.stdout.splitlines() if line.startswith("CYCLES_SECONDS")]
        if said.returncode or not found:
            sys.exit("Blender failed:\n" + said.stdout[-2000:])
        cycles = float(found[0])
        print(f"Cycles, the diffuse colour alone: {cycles:.1f} s; all {maps} maps in {bake / cycles:.2f} of that time")


if __name__ == "__main__":
    main()
