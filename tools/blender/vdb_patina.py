"""Blender add-on for vdb-patina: imports result folders, runs the program.

Install: Edit > Preferences > Add-ons > Install..., this file (Blender 3.4 or later). Then File > Import > vdb-patina result,
or the panel "Patina" in the 3D view's sidebar. From a script:

    import vdb_patina; vdb_patina.import_result("/path/of/result")
"""

bl_info = {
    "name": "vdb-patina",
    "author": "vdb-patina",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import, and the sidebar of the 3D view",
    "description": "Imports weathered surfaces with their displacement, materials and volumes",
    "category": "Import-Export",
}

import json
import math
import os
import pathlib
import re
import struct
import subprocess

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty


class ResultError(Exception):
    """What is wrong with a folder, in words for its owner."""


def exr_attributes(path):
    """The string and float attributes in the header of an OpenEXR file of one part."""
    found = {}
    with open(path, "rb") as file:
        if struct.unpack("<I", file.read(4))[0] != 20000630:
            raise ResultError(f"{path} is not an OpenEXR file")
        file.read(4)

        def word():
            text = b""
            while (byte := file.read(1)) not in (b"\0", b""):
                text += byte
            return text.decode("latin-1")

        while name := word():
            kind = word()
            data = file.read(struct.unpack("<I", file.read(4))[0])
            if kind == "float":
                found[name] = struct.unpack("<f", data)[0]
            elif kind == "string":
                found[name] = data.decode("utf-8", "replace")
    return found


class Result:
    """A folder that `vdb-patina run` or `bake` wrote."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        scenes = sorted(self.folder.glob("*.usda"))
        if not scenes:
            raise ResultError(f"{folder} holds no result with maps: there is no NAME.usda in it")
        if len(scenes) > 1:
            raise ResultError(f"{folder} holds more than one result: " + ", ".join(s.stem for s in scenes))
        self.name = scenes[0].stem
        text = scenes[0].read_text(encoding="utf-8")

        def token(pattern, default):
            match = re.search(pattern, text)
            return match.group(1) if match else default

        self.scheme = token(r'subdivisionScheme = "(\w+)"', "none")
        self.up = token(r'upAxis = "(\w)"', "Y")
        self.metres_per_unit = float(token(r"metersPerUnit = (\S+)", "1"))
        self.mesh = self.folder / f"{self.name}.obj"
        if not self.mesh.exists():
            raise ResultError(f"{self.mesh} is missing")
        volume = token(r"asset filePath = @([^@]+)@", f"./{self.name}.vdb")
        self.volume = (self.folder / volume).resolve()
        self.lobes = sorted(self.folder.glob("lobe_*.exr"))

    def map(self, name):
        path = self.folder / f"{name}.exr"
        if not path.exists():
            raise ResultError(f"{path} is missing: bake the maps first (vdb-patina bake)")
        return path

    def turn(self):
        """The rotation about x that brings the result's up axis to Blender's."""
        return math.pi / 2 if self.up == "Y" else 0.0


def load_image(path, colour):
    image = bpy.data.images.load(str(path), check_existing=True)
    names = ("Linear", "Linear Rec.709") if colour else ("Non-Color",)
    for name in names:
        try:
            image.colorspace_settings.name = name
            break
        except TypeError:
            continue
    return image


def make_material(result, flattened=False):
    """Diffuse part and one glossy lobe for each interface, added; or one Principled BSDF from the flattened maps."""
    material = bpy.data.materials.new(result.name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    output.location = (900, 0)

    def texture(path, colour, row):
        node = nodes.new("ShaderNodeTexImage")
        node.image = load_image(path, colour)
        node.extension = "EXTEND"
        node.label = node.name = path.stem
        node.location = (0, -300 * row)
        return node

    if flattened:
        shader = nodes.new("ShaderNodeBsdfPrincipled")
        shader.location = (400, 0)
        links.new(texture(result.map("base_color"), True, 0).outputs["Color"], shader.inputs["Base Color"])
        links.new(texture(result.map("metallic"), False, 1).outputs["Color"], shader.inputs["Metallic"])
        links.new(texture(result.map("roughness"), False, 2).outputs["Color"], shader.inputs["Roughness"])
        surface, row = shader.outputs["BSDF"], 3
    else:
        diffuse = nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.location = (400, 0)
        links.new(texture(result.map("diffuse"), True, 0).outputs["Color"], diffuse.inputs["Color"])
        surface, row = diffuse.outputs["BSDF"], 1
        for path in result.lobes:
            lobe = nodes.new("ShaderNodeBsdfGlossy" if "ShaderNodeBsdfGlossy" in dir(bpy.types) else "ShaderNodeBsdfAnisotropic")
            lobe.distribution = "GGX"
            # Blender squares its roughness to get GGX's alpha.
            lobe.inputs["Roughness"].default_value = math.sqrt(exr_attributes(path).get("patina_ggx_alpha", 0.2))
            lobe.location = (400, -300 * row)
            links.new(texture(path, True, row).outputs["Color"], lobe.inputs["Color"])
            both = nodes.new("ShaderNodeAddShader")
            both.location = (620, -150 * row)
            links.new(surface, both.inputs[0])
            links.new(lobe.outputs["BSDF"], both.inputs[1])
            surface, row = both.outputs["Shader"], row + 1
    links.new(surface, output.inputs["Surface"])

    height = nodes.new("ShaderNodeDisplacement")
    height.location = (620, -300 * row)
    height.inputs["Midlevel"].default_value = 0.0
    height.inputs["Scale"].default_value = 1.0
    links.new(texture(result.map("displacement"), False, row).outputs["Color"], height.inputs["Height"])
    links.new(height.outputs["Displacement"], output.inputs["Displacement"])
    if hasattr(material, "displacement_method"):  # 4.1 and later
        material.displacement_method = "DISPLACEMENT"
    else:
        material.cycles.displacement_method = "DISPLACEMENT"
    return material


def import_mesh(result, adaptive):
    before = set(bpy.data.objects)
    bpy.ops.wm.obj_import(filepath=str(result.mesh), forward_axis="Y" if result.up == "Z" else "NEGATIVE_Z", up_axis=result.up)
    (mesh,) = set(bpy.data.objects) - before
    mesh.name = result.name
    for polygon in mesh.data.polygons:
        polygon.use_smooth = True
    if adaptive:
        modifier = mesh.modifiers.new("Subdivision", "SUBSURF")
        modifier.subdivision_type = "CATMULL_CLARK" if result.scheme == "catmullClark" else "SIMPLE"
        modifier.levels = modifier.render_levels = 0
        modifier.uv_smooth = "PRESERVE_BOUNDARIES"
        scene = bpy.context.scene
        if bpy.app.version < (5, 0, 0):
            scene.cycles.feature_set = "EXPERIMENTAL"
            mesh.cycles.use_adaptive_subdivision = True
        else:
            modifier.use_adaptive_subdivision = True
    return mesh


def import_volume(result):
    data = bpy.data.volumes.new(result.name + ".vdb")
    data.filepath = str(result.volume)
    volume = bpy.data.objects.new(result.name + " volume", data)
    bpy.context.collection.objects.link(volume)
    volume.rotation_euler.x = result.turn()
    # Level sets drawn as a density are a shell around the mesh.
    volume.hide_render = True
    volume.hide_set(True)
    return volume


def import_interfaces(result, volume):
    """Each level set of the nest as a mesh (Volume to Mesh)."""
    volume.data.grids.load()
    names = [grid.name for grid in volume.data.grids if grid.name == "base" or grid.name.startswith("interface_")]
    made = []
    for name in names:
        mesh = bpy.data.meshes.new(f"{result.name} {name}")
        item = bpy.data.objects.new(f"{result.name} {name}", mesh)
        bpy.context.collection.objects.link(item)
        modifier = item.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
        modifier.object = volume
        modifier.grid_name = name
        modifier.threshold = 0.0
        modifier.resolution_mode = "GRID"
        item.rotation_euler.x = result.turn()
        item.hide_render = True
        made.append(item)
    return made


def import_result(folder, adaptive=True, flattened=False, volume=True, interfaces=False):
    """Mesh with true displacement and material, the volume and, if asked for, its interfaces as meshes.

    Returns the mesh object. Raises ResultError with what is missing.
    """
    result = Result(folder)
    mesh = import_mesh(result, adaptive)
    mesh.data.materials.clear()
    mesh.data.materials.append(make_material(result, flattened))
    if volume and result.volume.exists():
        grids = import_volume(result)
        if interfaces:
            import_interfaces(result, grids)
    bpy.context.view_layer.objects.active = mesh
    return mesh


def import_frames(folder, **options):
    """The frames of `vdb-patina weather --maps all`, year_000, year_006, ...: each is seen for one frame."""
    frames = [path for path in sorted(pathlib.Path(folder).glob("year_*")) if list(path.glob("*.usda"))]
    if not frames:
        raise ResultError(f"{folder} holds no frames with maps: run `vdb-patina weather` with --maps all")
    for number, path in enumerate(frames, 1):
        mesh = import_result(path, **options)
        mesh.name = path.name
        for frame, hidden in ((number - 1, True), (number, False), (number + 1, True)):
            mesh.hide_render = mesh.hide_viewport = hidden
            mesh.keyframe_insert("hide_render", frame=frame)
            mesh.keyframe_insert("hide_viewport", frame=frame)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, len(frames)
    return len(frames)


class ImportPatina(bpy.types.Operator):
    """Import a folder that vdb-patina wrote: mesh, displacement, material, volume"""

    bl_idname = "import_scene.vdb_patina"
    bl_label = "vdb-patina result"
    bl_options = {"REGISTER", "UNDO"}

    directory: StringProperty(subtype="DIR_PATH")
    adaptive: BoolProperty(name="Adaptive subdivision", description="Dice to the pixel and displace (Cycles)", default=True)
    flattened: BoolProperty(name="One Principled shader", description="Instead of diffuse and all lobes", default=False)
    interfaces: BoolProperty(name="Interfaces as meshes", default=False)

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        options = {"adaptive": self.adaptive, "flattened": self.flattened, "interfaces": self.interfaces}
        try:
            if any(pathlib.Path(self.directory).glob("year_*")):
                import_frames(self.directory, **options)
            else:
                import_result(self.directory, **options)
        except ResultError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class RunPatina(bpy.types.Operator):
    """Run the script on the model and import the result"""

    bl_idname = "object.vdb_patina_run"
    bl_label = "Run and import"

    process = None

    def execute(self, context):
        settings = context.scene.vdb_patina
        folder = bpy.path.abspath(settings.folder)
        command = [settings.program, "run", bpy.path.abspath(settings.script), bpy.path.abspath(settings.model), "-o", folder,
                   "--voxels", str(settings.voxels), "--resolution", str(settings.resolution), "--exaggeration",
                   str(settings.exaggeration), "--progress", "none", "--picture", "0", "--force"]
        try:
            os.makedirs(folder, exist_ok=True)
            self.log = open(os.path.join(folder, "vdb-patina.log"), "w+", encoding="utf-8")
            self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=self.log)
        except OSError as error:
            self.report({"ERROR"}, f"{settings.program}: {error}")
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(0.5, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.process.terminate()
        if event.type != "TIMER" or self.process.poll() is None:
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        self.log.seek(0)
        words = self.log.read().strip()
        self.log.close()
        if self.process.returncode != 0:
            self.report({"ERROR"}, words or f"it ended with {self.process.returncode}")
            return {"CANCELLED"}
        try:
            import_result(bpy.path.abspath(context.scene.vdb_patina.folder))
        except ResultError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class PatinaSettings(bpy.types.PropertyGroup):
    program: StringProperty(name="Program", default="vdb-patina", subtype="FILE_PATH")
    script: StringProperty(name="Script", subtype="FILE_PATH")
    model: StringProperty(name="Model", default="statuette", subtype="FILE_PATH")
    folder: StringProperty(name="Folder", default="//patina", subtype="DIR_PATH")
    voxels: IntProperty(name="Voxels", default=256, min=8)
    resolution: IntProperty(name="Map size", default=2048, min=16)
    exaggeration: FloatProperty(name="Exaggeration", default=1.0, min=0.001)


class PatinaPanel(bpy.types.Panel):
    bl_label = "vdb-patina"
    bl_idname = "VIEW3D_PT_vdb_patina"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Patina"

    def draw(self, context):
        for name in PatinaSettings.__annotations__:
            self.layout.prop(context.scene.vdb_patina, name)
        self.layout.operator(RunPatina.bl_idname)
        self.layout.operator(ImportPatina.bl_idname, text="Import a result")


CLASSES = (ImportPatina, RunPatina, PatinaSettings, PatinaPanel)


def menu(self, context):
    self.layout.operator(ImportPatina.bl_idname)


def register():
    for item in CLASSES:
        bpy.utils.register_class(item)
    bpy.types.Scene.vdb_patina = bpy.props.PointerProperty(type=PatinaSettings)
    bpy.types.TOPBAR_MT_file_import.append(menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(menu)
    del bpy.types.Scene.vdb_patina
    for item in reversed(CLASSES):
        bpy.utils.unregister_class(item)


if __name__ == "__main__":
    register()
