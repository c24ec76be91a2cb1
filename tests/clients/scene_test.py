"""Makes a small result with vdb-patina and has USD's and MaterialX's own checkers read its scene.

    scene_test.py PROGRAM WORK_FOLDER

Ends with 77 (skipped) where Python has neither `pxr` nor `MaterialX` (tests/clients/requirements.txt).
"""

import json
import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77
HERE = pathlib.Path(__file__).resolve().parent

try:
    import MaterialX as mx
    import MaterialX.PyMaterialXGenGlsl as mx_glsl
    import MaterialX.PyMaterialXGenOsl as mx_osl
    import MaterialX.PyMaterialXGenShader as mx_gen
    from pxr import Gf, Usd, UsdGeom, UsdShade, UsdUtils, UsdValidation, UsdVol
except ImportError as missing:
    print(f"skipped: {missing}; `tools/setup.sh --clients` installs it")
    sys.exit(SKIPPED)

failures = []


def check(holds, message):
    if not holds:
        failures.append(message)
        print("FAILED:", message)


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run([str(word) for word in command], check=True, **options)


def libraries():
    library = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    return library


# --- USD ---

# What USD calls the types of MaterialX.
USD_TYPES = {"float": "float", "color3": "color3f", "vector2": "float2", "vector3": "float3", "string": "string",
             "filename": "asset", "surfaceshader": "token", "displacementshader": "token"}


def validate(stage, library):
    """USD's validators; the registry of PyPI's USD knows no MaterialX, so those nodes are held against MaterialX's own."""
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    context = UsdValidation.ValidationContext(validators)
    for error in context.Validate(stage):
        materialx = error.GetName() == "MissingShaderIdInRegistry" and "'ND_" in error.GetMessage()
        check(materialx, f"{error.GetName()}: {error.GetMessage()}")
    nodes = 0
    for prim in stage.Traverse():
        shader = UsdShade.Shader(prim)
        name = shader.GetIdAttr().Get() if shader else None
        if not name or not name.startswith("ND_"):
            continue
        nodes += 1
        definition = library.getNodeDef(name)
        check(definition is not None, f"{prim.GetPath()}: MaterialX has no node {name}")
        if definition is None:
            continue
        for port in [*shader.GetInputs(), *shader.GetOutputs()]:
            declared = definition.getActiveInput(port.GetBaseName()) or definition.getActiveOutput(port.GetBaseName())
            kind = str(port.GetTypeName())
            check(declared is not None, f"{prim.GetPath()}: {name} has no {port.GetBaseName()}")
            check(declared is None or USD_TYPES.get(declared.getType()) == kind,
                  f"{prim.GetPath()}.{port.GetBaseName()}: {kind}, MaterialX says {declared and declared.getType()}")
    check(nodes >= 7, f"only {nodes} MaterialX nodes")
    print(f"{len(validators)} USD validators, {nodes} MaterialX nodes")


def read_obj(path):
    vertices, uvs, faces = [], [], []
    for line in path.read_text(encoding="utf-8").splitlines():
        word, *rest = line.split()
        if word == "v":
            vertices.append(tuple(float(x) for x in rest[:3]))
        elif word == "vt":
            uvs.append(tuple(float(x) for x in rest))
        elif word == "f":
            faces.append([tuple(int(i) - 1 for i in corner.split("/")) for corner in rest])
    return vertices, uvs, faces


def close(a, b):
    return len(a) == len(b) and all(abs(x - y) <= 1e-6 * max(1.0, abs(x)) for p, q in zip(a, b) for x, y in zip(p, q))


def check_mesh(stage, obj, scheme):
    root = stage.GetDefaultPrim()
    mesh = UsdGeom.Mesh(root.GetChild("Surface"))
    vertices, uvs, faces = read_obj(obj)
    check(close(mesh.GetPointsAttr().Get(), vertices), "the points are not those of the control mesh")
    check(list(mesh.GetFaceVertexIndicesAttr().Get()) == [c[0] for f in faces for c in f], "faces differ")
    check(list(mesh.GetFaceVertexCountsAttr().Get()) == [len(f) for f in faces], "face sizes differ")
    valid, why = UsdGeom.Mesh.ValidateTopology(mesh.GetFaceVertexIndicesAttr().Get(), mesh.GetFaceVertexCountsAttr().Get(),
                                               len(vertices))
    check(valid, f"topology: {why}")
    check(mesh.GetSubdivisionSchemeAttr().Get() == scheme, f"scheme {mesh.GetSubdivisionSchemeAttr().Get()}")
    st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
    check(st.GetInterpolation() == "faceVarying", f"st is {st.GetInterpolation()}")
    check(close(st.ComputeFlattened(), [uvs[c[1]] for f in faces for c in f]), "UVs per corner differ")
    if scheme == "none":
        check(mesh.GetNormalsInterpolation() == "vertex" and len(mesh.GetNormalsAttr().Get()) == len(vertices),
              "a mesh that is not subdivided needs the normals that the maps were baked along")
    return mesh


def check_material(stage, mesh, folder):
    material, _ = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()
    check(bool(material), "no material is bound")
    for context, identifier in (("", "UsdPreviewSurface"), ("mtlx", "ND_standard_surface_surfaceshader")):
        for output in ("Surface", "Displacement"):
            shader = getattr(material, f"Compute{output}Source")(context)[0]
            check(bool(shader), f"{context or 'universal'} {output} is not connected")
            if shader and output == "Surface":
                check(shader.GetIdAttr().Get() == identifier, f"{context}: {shader.GetIdAttr().Get()}")
    preview = UsdShade.Shader(stage.GetPrimAtPath(material.GetPath().AppendChild("Preview")))
    reads = {"diffuseColor": "base_color", "metallic": "metallic", "roughness": "roughness",
             "displacement": "displacement"}
    for name, image in reads.items():
        source = preview.GetInput(name).GetConnectedSources()[0]
        check(len(source) == 1, f"Preview.{name} is not connected")
        if source:
            file = UsdShade.Shader(source[0].source.GetPrim()).GetInput("file").Get()
            check(pathlib.Path(file.resolvedPath) == (folder / f"{image}.exr"), f"Preview.{name} reads {file}")
    variants = material.GetPrim().GetVariantSet("relief")
    variants.SetVariantSelection("normal")
    check(not preview.GetInput("displacement") and preview.GetInput("normal").GetConnectedSources()[0],
          "the variant `normal` should bend normals and not displace")
    variants.SetVariantSelection("displacement")


def check_volume(stage, volume, grids):
    prim = UsdVol.Volume(stage.GetDefaultPrim().GetChild("Volume"))
    found = {}
    for name, path in prim.GetFieldPaths().items():
        asset = UsdVol.OpenVDBAsset(stage.GetPrimAtPath(path))
        check(pathlib.Path(asset.GetFilePathAttr().Get().resolvedPath) == volume, f"field {name} is in another file")
        found[asset.GetFieldNameAttr().Get()] = asset.GetFieldDataTypeAttr().Get()
    check(found == {name: {"int32": "int"}.get(kind, kind) for name, kind in grids.items()},
          f"fields {found}, the file holds {grids}")


def check_stage(file, volume, scheme, unit, up, library, program):
    stage = Usd.Stage.Open(str(file))
    validate(stage, library)
    check(UsdGeom.GetStageMetersPerUnit(stage) == unit, f"metersPerUnit {UsdGeom.GetStageMetersPerUnit(stage)}")
    check(UsdGeom.GetStageUpAxis(stage) == up, f"upAxis {UsdGeom.GetStageUpAxis(stage)}")
    unresolved = UsdUtils.ComputeAllDependencies(str(file))[2]
    check(not unresolved, f"not found: {unresolved}")
    check(str(file.parent) not in file.read_text(encoding="utf-8"), "an absolute path")
    mesh = check_mesh(stage, file.with_suffix(".obj"), scheme)
    check_material(stage, mesh, file.parent)
    info = json.loads(run(program, "info", "--json", volume, stdout=subprocess.PIPE).stdout)
    check_volume(stage, volume, {"surface": "float"} | {grid["name"]: grid["type"] for grid in info["grids"]})


# --- MaterialX ---


def generate(generator, document, node, search):
    context = mx_gen.GenContext(generator)
    context.registerSourceCodeSearchPath(search)
    shader = generator.generate(node.getName(), node, context)
    check(shader is not None, f"{node.getName()}: no shader")
    return shader


def glsl_compiles(source, stage, name):
    compiler = shutil.which("glslangValidator")
    result = subprocess.run([compiler, "--stdin", "-S", stage], input=source, text=True, stdout=subprocess.PIPE)
    check(result.returncode == 0, f"{name}, {stage}: {result.stdout[:2000]}")


def check_materialx(file, library):
    document = mx.createDocument()
    mx.readFromXmlFile(document, str(file))
    document.importLibrary(library)
    valid, why = document.validate()
    check(valid, f"{file.name}: {why}")
    materials = [m for m in document.getMaterialNodes()]
    check(len(materials) == 2, f"{len(materials)} materials instead of 2")
    search = mx.getDefaultDataSearchPath()
    for make, language in ((mx_glsl.GlslShaderGenerator.create, "glsl"), (mx_osl.OslShaderGenerator.create, "osl")):
        generator = make()
        colours = mx_gen.DefaultColorManagementSystem.create(generator.getTarget())
        colours.loadLibrary(document)
        generator.setColorManagementSystem(colours)
        for material in materials:
            shader = generate(generator, document, material, search)
            if shader is None:
                continue
            source = shader.getSourceCode("pixel")
            check("base_color" in source, f"{language} of {material.getName()} does not read the maps")
            if language == "glsl":
                for stage, name in (("vertex", "vert"), ("pixel", "frag")):
                    glsl_compiles(shader.getSourceCode(stage), name, material.getName())
    displaced = [material for material in materials if material.getInput("displacementshader")]
    check(len(displaced) == 1, "one of the materials is displaced")


OCTAHEDRON = ("v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\nf 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\n"
              "f 4 2 6\nf 1 4 6\n")


def check_loop_and_region(script, folder, small, library, program):
    """Loop with a crease; a close-up of 200 µm whose voxels are below what OpenVDB takes: the volume is magnified."""
    model = folder / "octahedron.obj"
    model.write_text(OCTAHEDRON + "t crease 2/1/0 0 2 3\nt corner 1/1/0 4 10\n", encoding="utf-8")
    run(program, "run", script, model, *small, "--picture", 0, "--scheme", "loop", "-o", folder / "loop")
    scene = folder / "loop" / "three_layers.usda"
    check_stage(scene, folder / "loop" / "three_layers.vdb", "loop", 1.0, "Y", library, program)
    stage = Usd.Stage.Open(str(scene))
    mesh = UsdGeom.Mesh(stage.GetDefaultPrim().GetChild("Surface"))
    check(list(mesh.GetCreaseIndicesAttr().Get()) == [0, 2], f"creases {mesh.GetCreaseIndicesAttr().Get()}")
    check(list(mesh.GetCreaseLengthsAttr().Get()) == [2], "a crease of one edge has two vertices")
    check(list(mesh.GetCreaseSharpnessesAttr().Get()) == [3.0], "the crease's sharpness")
    check(list(mesh.GetCornerIndicesAttr().Get()) == [4], "the sharp corner")
    check(list(mesh.GetCornerSharpnessesAttr().Get()) == [10.0], "the corner's sharpness")
    check_materialx(folder / "loop" / "three_layers.mtlx", library)

    run(program, "run", script, "sphere", "--region-at", "0,0.1,0,0.0002", "--voxels", 48, "--resolution", 64,
        "--progress", "none", "--picture", 0, "-o", folder / "piece")
    scene = folder / "piece" / "three_layers.usda"
    stage = Usd.Stage.Open(str(scene))
    validate(stage, library)
    check(not UsdUtils.ComputeAllDependencies(str(scene))[2], "a file of the close-up is not found")
    root = stage.GetDefaultPrim()
    mesh = UsdGeom.Mesh(root.GetChild("Surface"))
    check(mesh.GetSubdivisionSchemeAttr().Get() == "none", "the dice of a close-up are not subdivided")
    check(len(mesh.GetNormalsAttr().Get()) == len(mesh.GetPointsAttr().Get()), "a close-up needs its normals")
    low, high = mesh.GetExtentAttr().Get()
    check(1e-4 < high[0] - low[0] < 4e-4, f"the close-up reaches from {low} to {high}")
    volume = UsdGeom.Xformable(root.GetChild("Volume"))
    scale = volume.GetLocalTransformation().GetRow(0)[0]
    check(abs(scale - 1.0 / 1024.0) < 1e-9, f"the magnified volume is scaled by {scale}")
    check_material(stage, mesh, folder / "piece")
    check_materialx(folder / "piece" / "three_layers.mtlx", library)


def check_houdini(folder):
    """What of the Houdini script needs no Houdini: where it looks for the volume, and how large it makes it."""
    sys.path.insert(0, str(HERE.parents[1] / "tools" / "houdini"))
    import import_result

    found = import_result.read_scene(str(folder / "maps" / "three_layers.usda"))
    check(found == {"catmull_clark": True, "volume": str(folder / "cage" / "three_layers.vdb"), "volume_scale": 1.0},
          f"baked elsewhere: {found}")
    found = import_result.read_scene(str(folder / "piece" / "three_layers.usda"))
    check(not found["catmull_clark"] and abs(found["volume_scale"] - 1.0 / 1024.0) < 1e-9, f"close-up: {found}")


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    if shutil.which("glslangValidator") is None:
        print("skipped: no glslangValidator here; `tools/setup.sh --clients` installs it")
        return SKIPPED
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    library = libraries()
    small = ["--voxels", 48, "--resolution", 64, "--progress", "none"]
    script = HERE / "three_layers.patina"
    # A cage at its own scale, z up; then the same volume baked elsewhere; then a mesh that is not subdivided.
    run(program, "run", script, "sphere", *small, "--picture", 0, "--unit", "cm", "--up", "z", "-o", folder / "cage")
    volume = folder / "cage" / "three_layers.vdb"
    check_stage(folder / "cage" / "three_layers.usda", volume, "catmullClark", 0.01, "Z", library, program)
    check_materialx(folder / "cage" / "three_layers.mtlx", library)
    run(program, "bake", volume, folder / "cage" / "three_layers.obj", "--resolution", 64, "--progress", "none",
        "--colour-space", "acescg", "--unit", "cm", "-o", folder / "maps")
    # The volume knows which way is up, and nobody has to say it again.
    check_stage(folder / "maps" / "three_layers.usda", volume, "catmullClark", 0.01, "Z", library, program)
    check_materialx(folder / "maps" / "three_layers.mtlx", library)
    run(program, "run", script, "sphere", *small, "--picture", 0, "--scheme", "none", "-o", folder / "plain")
    check_stage(folder / "plain" / "three_layers.usda", folder / "plain" / "three_layers.vdb", "none", 1.0, "Y", library,
                program)
    check_loop_and_region(script, folder, small, library, program)
    check_houdini(folder)
    if failures:
        print(f"{len(failures)} checks failed")
        return 1
    print("USD and MaterialX read the scenes as they were meant")
    return 0


sys.exit(main())
