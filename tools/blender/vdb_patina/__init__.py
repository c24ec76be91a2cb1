"""Blender add-on for vdb-patina: imports result folders, runs the program.

Install: pack this folder (python3 -m zipfile -c vdb_patina.zip vdb_patina), then Edit > Preferences > Add-ons > Install...
(Blender 3.4 or later). Then File > Import > vdb-patina result, or the panel "Patina" in the 3D view's sidebar. From a script:

    import vdb_patina; vdb_patina.import_result("/path/of/result")
"""

bl_info = {
    "name": "vdb-patina",
    "author": "vdb-patina",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "File > Import, and the sidebar of the 3D view",
    "description": "Imports weathered surfaces with their displacement, materials and volumes",
    "category": "Import-Export",
}

import atexit
import os
import pathlib
import shlex
import subprocess

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty

from .result import Result, ResultError, polygons_of_ply
from .scene import import_frames, import_result, make_material

__all__ = ["Result", "ResultError", "import_frames", "import_result", "make_material", "polygons_of_ply"]


class ImportPatina(bpy.types.Operator):
    """Import a folder that vdb-patina wrote: mesh, displacement, material, volume"""

    bl_idname = "import_scene.vdb_patina"
    bl_label = "vdb-patina result"
    bl_options = {"REGISTER", "UNDO"}

    directory: StringProperty(subtype="DIR_PATH")
    adaptive: BoolProperty(name="Adaptive subdivision", description="Dice to the pixel and displace (Cycles)", default=True)
    flattened: BoolProperty(name="One Principled shader", description="Instead of diffuse and all lobes", default=False)
    interfaces: BoolProperty(name="Interfaces as meshes", default=False)
    vectors: BoolProperty(name="Vector displacement", description="Where it was baked: follows overhangs", default=True)

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        options = {"adaptive": self.adaptive, "flattened": self.flattened, "interfaces": self.interfaces,
                   "vectors": self.vectors}
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

    def start(self, context):
        settings = context.scene.vdb_patina
        self.folder = bpy.path.abspath(settings.folder)
        # A model may be the name of a shape instead of a file.
        model = settings.model if os.sep not in settings.model else bpy.path.abspath(settings.model)
        command = [settings.program, "run", bpy.path.abspath(settings.script), model, "-o", self.folder, "--voxels",
                   str(settings.voxels), "--resolution", str(settings.resolution), "--exaggeration",
                   str(settings.exaggeration), "--progress", "none", "--picture", "0", "--force",
                   *shlex.split(settings.options)]
        os.makedirs(self.folder, exist_ok=True)
        self.log = open(os.path.join(self.folder, "vdb-patina.log"), "w+", encoding="utf-8")
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=self.log)

    def finish(self):
        self.log.seek(0)
        words = self.log.read().strip()
        self.log.close()
        if self.process.returncode != 0:
            self.report({"ERROR"}, words or f"it ended with {self.process.returncode}")
            return {"CANCELLED"}
        try:
            import_result(self.folder)
        except ResultError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def tell(self, context, error):
        self.report({"ERROR"}, f"{context.scene.vdb_patina.program}: {error}")
        return {"CANCELLED"}

    def execute(self, context):
        """From scripts: waits until the result is there."""
        try:
            self.start(context)
        except OSError as error:
            return self.tell(context, error)
        self.process.wait()
        return self.finish()

    def invoke(self, context, event):
        """From the panel: Blender stays usable, Escape ends the run."""
        try:
            self.start(context)
        except OSError as error:
            return self.tell(context, error)
        self.timer = context.window_manager.event_timer_add(0.5, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.process.terminate()
        if event.type != "TIMER" or self.process.poll() is None:
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        return self.finish()


class PatinaSettings(bpy.types.PropertyGroup):
    program: StringProperty(name="Program", default="vdb-patina", subtype="FILE_PATH")
    script: StringProperty(name="Script", subtype="FILE_PATH")
    model: StringProperty(name="Model", default="statuette", subtype="FILE_PATH")
    folder: StringProperty(name="Folder", default="//patina", subtype="DIR_PATH")
    voxels: IntProperty(name="Voxels", default=256, min=8)
    resolution: IntProperty(name="Map size", default=2048, min=16)
    exaggeration: FloatProperty(name="Exaggeration", default=1.0, min=0.001)
    options: StringProperty(name="Options", description="More of the command line: --unit cm --vector-displacement")


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
    # As a Python module Blender 4 crashes or hangs at the end where classes are still registered.
    if getattr(bpy.app, "module", not bpy.app.binary_path):
        atexit.register(unregister)


def unregister():
    atexit.unregister(unregister)
    bpy.types.TOPBAR_MT_file_import.remove(menu)
    del bpy.types.Scene.vdb_patina
    for item in reversed(CLASSES):
        bpy.utils.unregister_class(item)


if __name__ == "__main__":
    register()
