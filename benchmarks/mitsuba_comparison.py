#!/usr/bin/env python3
"""The same mesh, maps, camera and light in vdb-patina and in Mitsuba 3: mean light, time, variance.

    pip install mitsuba numpy openexr          (llvm_ad_rgb needs LLVM's shared library, on Debian libllvm19)
    benchmarks/mitsuba_comparison.py --program build/vdb-patina --mesh MODEL.obj

Cases: `matt`, an opaque layer of refractive index 1, against `diffuse` with diffuse.exr; `copper`, bare metal of a small
roughness, against `principled` with base_color.exr and roughness.exr; `satin`, copper as shipped, against `principled`
and against a GGX lobe with Smith's height-correlated term, which ours is and which Mitsuba does not have; `marine`, a
stack of four layers, against `principled`: another model, compared in time alone.

Times are of tracing alone: ours as `render -v` tells it, Mitsuba's of a render after the first, which compiles. They are
the processors' seconds, all threads together, which the machine's other work touches least; the two take turns and the
fastest of each counts. Both trace the same triangles, those of NAME_limit.ply: ours are not cut finer (--dice 0), and
the voxels are coarse enough for the stack to be read at the vertices. Our bound on indirect light, a bias, is off. The
last column compares what both pay for a picture of the same variance: above 1, ours is the cheaper.
"""

import argparse
import os
import re
import shutil
import subprocess
import tempfile
import time

import numpy as np

AZIMUTH, ELEVATION, FIELD_OF_VIEW = 20.0, 12.0, 22.0
MATT = """title = "Matt"
source = "For comparison: scatters as brochantite does and has no surface of its own."
refractive_index = 1.0
[absorption_over_scattering]
wavelengths_nm = [400, 460, 500, 540, 580, 620, 660, 700]
values = [0.4823, 0.182, 0.08077, 0.0719, 0.2216, 0.7847, 1.645, 2.117]
[scattering]
value = 50
unit = "1/um"
"""
SCRIPTS = {
    "matt": "new copper\ncoat matt 2\n",
    "copper": "new bright_copper\n",
    "satin": "new copper\n",
    "marine": None,  # the shipped script
}


def readExr(path, channels="RGB"):
    import OpenEXR
    with OpenEXR.File(path, separate_channels=True) as f:
        return np.stack([np.asarray(f.channels()[c].pixels, dtype=np.float64) for c in channels], -1)


def writePanorama(path):
    """A grey gradient with a bright disc of 6 degrees: soft light and a hard shadow."""
    import OpenEXR
    height, width = 256, 512
    v, u = np.mgrid[0:height, 0:width]
    theta, phi = (v + 0.5) / height * np.pi, ((u + 0.5) / width - 0.5) * 2 * np.pi
    y, x, z = np.cos(theta), np.sin(theta) * np.sin(phi), -np.sin(theta) * np.cos(phi)
    sky = np.repeat((0.3 + 0.25 * y)[..., None], 3, axis=2)
    sun = np.array([-0.45, 0.6, 0.66])
    sun /= np.linalg.norm(sun)
    near = x * sun[0] + y * sun[1] + z * sun[2] > np.cos(np.radians(6.0))
    sky[near] = (40.0, 38.0, 35.0)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": sky.astype(np.float32)}).write(path)


def prepare(arguments, folder, names):
    """Runs the scripts once each; returns the folder of each result."""
    data = os.path.join(folder, "data")
    shutil.copytree(arguments.data, data)
    with open(f"{data}/materials/matt.toml", "w") as f:
        f.write(MATT)
    with open(f"{data}/materials/copper.toml") as f:
        copper = f.read()
    with open(f"{data}/materials/bright_copper.toml", "w") as f:
        f.write(re.sub(r"roughness = .*", "roughness = 0.0005", copper))
    environment = dict(os.environ, VDB_PATINA_DATA=data)
    for name in names:
        script = f"{folder}/{name}.patina"
        if SCRIPTS[name] is None:
            shutil.copy(f"{data}/scripts/{name}.patina", script)
        else:
            with open(script, "w") as f:
                f.write(SCRIPTS[name])
        subprocess.run([arguments.program, "run", script, arguments.mesh, "--voxels", str(arguments.voxels), "--picture",
                        "0", "-o", f"{folder}/{name}", "--progress", "none", "-q"], check=True, env=environment)
    return environment


def ours(arguments, folder, name, environment, light, samples, distance):
    words = [arguments.program, "render", f"{folder}/{name}/{name}.vdb", "--light", light, "--no-floor", "--exr", "-v",
             "--picture", str(arguments.size), "--aspect", "1", "--samples", str(samples), "--progress", "none",
             "--clamp", "0", "--dice", "0", "--camera", f"{AZIMUTH},{ELEVATION},{distance},{FIELD_OF_VIEW}",
             "-o", f"{folder}/{name}_picture"]
    run = subprocess.run(words, check=True, env=environment, capture_output=True, text=True)
    told = re.search(r"(\d+) rays traced in [\d.]+ s \(([\d.]+) s of", run.stdout + run.stderr)
    exr = f"{folder}/{name}_picture/{name}.exr"
    return readExr(exr), readExr(exr, "A")[..., 0], float(told.group(2)), int(told.group(1))


def correlatedGgx(mi, dr):
    """One GGX lobe with Schlick's Fresnel and Smith's height-correlated masking and shadowing."""

    class CorrelatedGgx(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.colour = mi.Color3f(props["colour"])
            self.alpha = props["alpha"]
            self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0]

        def distribution(self):
            return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True)

        def value(self, wi, wo):
            d = self.distribution()
            h = dr.normalize(wi + wo)
            slope = lambda w: dr.sqrt(1 + self.alpha**2 * (1 - w.z * w.z) / (w.z * w.z))
            g2 = 2 / (slope(wi) + slope(wo))
            f = self.colour + (1 - self.colour) * (1 - dr.dot(wi, h)) ** 5
            return f * (d.eval(h) * g2 / (4 * wi.z))  # times the cosine

        def sample(self, ctx, si, sample1, sample2, active=True):
            h, _ = self.distribution().sample(si.wi, sample2)
            bs = mi.BSDFSample3f()
            bs.wo = mi.reflect(si.wi, h)
            bs.eta = 1.0
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            bs.sampled_component = mi.UInt32(0)
            bs.pdf = self.pdf(ctx, si, bs.wo, active)
            fine = active & (bs.pdf > 0) & (si.wi.z > 0) & (bs.wo.z > 0)
            return bs, dr.select(fine, self.value(si.wi, bs.wo) / bs.pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return dr.select(active & (si.wi.z > 0) & (wo.z > 0), self.value(si.wi, wo), 0)

        def pdf(self, ctx, si, wo, active=True):
            h = dr.normalize(si.wi + wo)
            density = self.distribution().pdf(si.wi, h) / (4 * dr.dot(wo, h))
            return dr.select(active & (si.wi.z > 0) & (wo.z > 0), density, 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    mi.register_bsdf("correlatedggx", CorrelatedGgx)


def mitsubaScene(mi, arguments, folder, name, model, light, panorama, distance):
    to = f"{folder}/{name}/"
    bitmap = lambda file: {"type": "bitmap", "filename": to + file, "raw": True}
    if model == "diffuse":
        bsdf = {"type": "diffuse", "reflectance": bitmap("diffuse.exr")}
    elif model == "correlatedggx":
        # Bare metal is the same everywhere.
        colour = np.median(readExr(to + "base_color.exr"), axis=(0, 1))
        roughness = float(np.median(readExr(to + "roughness.exr", "Y")))
        bsdf = {"type": "correlatedggx", "colour": mi.Color3f(*[float(c) for c in colour]), "alpha": roughness**2}
    else:
        bsdf = {"type": "principled", "base_color": bitmap("base_color.exr"), "roughness": bitmap("roughness.exr"),
                "metallic": bitmap("metallic.exr"), "specular": 0.5}
    low, high = bounds(folder, name)
    middle = (low + high) / 2
    a, e = np.radians(AZIMUTH), np.radians(ELEVATION)
    stand = middle + distance * np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])
    emitter = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}
    if light != "uniform":
        emitter = {"type": "envmap", "filename": panorama,
                   "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 180)}
    return mi.load_dict({
        "type": "scene",
        # A path of ours visits at most 4 surfaces.
        "integrator": {"type": "path", "max_depth": 5, "rr_depth": 3},
        "sensor": {"type": "perspective", "fov": FIELD_OF_VIEW, "fov_axis": "x",
                   "to_world": mi.ScalarTransform4f().look_at(stand.tolist(), middle.tolist(), [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": arguments.size, "height": arguments.size,
                            "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"},
                   "sampler": {"type": "independent"}},
        "emitter": emitter,
        "shape": {"type": "ply", "filename": f"{to}{name}_limit.ply", "flip_tex_coords": True, "bsdf": bsdf},
    })


def bounds(folder, name):
    points = []
    with open(f"{folder}/{name}/{name}.obj") as f:
        for line in f:
            if line.startswith("v "):
                points.append([float(x) for x in line.split()[1:4]])
    points = np.array(points)
    return points.min(0), points.max(0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/vdb-patina")
    parser.add_argument("--data", default="data")
    parser.add_argument("--mesh", required=True)
    parser.add_argument("--voxels", type=int, default=128)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--reference", type=int, default=1024, help="samples of the pictures that variance is told from")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--cases", default="matt,copper,satin,marine")
    parser.add_argument("--lights", default="uniform,sun")
    parser.add_argument("--work", help="a folder to keep")
    arguments = parser.parse_args()
    arguments.program = os.path.abspath(arguments.program)
    arguments.mesh = os.path.abspath(arguments.mesh) if os.path.exists(arguments.mesh) else arguments.mesh

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import drjit as dr
    correlatedGgx(mi, dr)
    folder = arguments.work or tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    names = arguments.cases.split(",")
    if not os.path.exists(f"{folder}/data"):
        environment = prepare(arguments, folder, names)
    environment = dict(os.environ, VDB_PATINA_DATA=f"{folder}/data")
    panorama = f"{folder}/sun.exr"
    writePanorama(panorama)
    models = {"matt": ["diffuse"], "copper": ["principled"], "satin": ["correlatedggx", "principled"],
              "marine": ["principled"]}
    print("case    light    Mitsuba's model  mean light  processor s   ours in     variance of a pixel   time x variance")
    print("                                  ours/its    ours   its    its speed   ours      its        its over ours")
    for name in names:
        low, high = bounds(folder, name)
        distance = float(np.linalg.norm(high - low) * 0.5 / np.tan(np.radians(FIELD_OF_VIEW / 2)))
        for light in arguments.lights.split(","):
            for model in models[name]:
                scene = mitsubaScene(mi, arguments, folder, name, model, light, panorama, distance)
                shown = "uniform" if light == "uniform" else panorama
                render = lambda samples, seed: np.array(mi.render(scene, spp=samples, seed=seed), dtype=np.float64)
                render(arguments.samples, 0)  # compiles
                best = [1e9, 1e9]
                for repeat in range(arguments.repeats):
                    picture, alpha, seconds, _ = ours(arguments, folder, name, environment, shown, arguments.samples,
                                                      distance)
                    best[0] = min(best[0], seconds)
                    begin = time.process_time()
                    its = render(arguments.samples, repeat + 1)
                    best[1] = min(best[1], time.process_time() - begin)
                inside = alpha >= 1.0
                trueOurs, trueIts = picture, its
                if arguments.reference > arguments.samples:
                    trueOurs = ours(arguments, folder, name, environment, shown, arguments.reference, distance)[0]
                    trueIts = render(arguments.reference, 99)
                    if arguments.work:
                        np.save(f"{folder}/{name}_{light}_{model}.npy", np.stack([trueOurs, trueIts]))
                ratio = trueOurs[inside].mean() / trueIts[inside].mean()
                variance = [np.mean((a - b)[inside] ** 2) for a, b in ((picture, trueOurs), (its, trueIts))]
                print(f"{name:7} {light:8} {model:16} {ratio:7.4f}   {best[0]:6.2f} {best[1]:6.2f}  "
                      f"{best[1] / best[0]:7.2f}     {variance[0]:.2e}  {variance[1]:.2e}  "
                      f"{best[1] * variance[1] / max(best[0] * variance[0], 1e-30):8.2f}", flush=True)


if __name__ == "__main__":
    main()
