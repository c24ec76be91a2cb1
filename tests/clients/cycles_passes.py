"""For scripts inside Blender: what Cycles' passes hold, as numbers. Blender's own modules only, no numpy."""

import array
import math
import pathlib

import bpy
from mathutils import Vector


def pixels_of(path, channels):
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = array.array("f", bytes(4 * len(image.pixels)))
    image.pixels.foreach_get(values)
    planes = [values[c :: image.channels] for c in range(channels)]
    bpy.data.images.remove(image)
    out = array.array("f", bytes(4 * channels * len(planes[0])))
    for c, plane in enumerate(planes):
        out[c::channels] = plane
    return out


def set_up(mesh, output, pixels, azimuth=35.0, elevation=20.0, dicing_pixels=0.5):
    """An orthographic camera around the mesh, degrees, and files of the passes Position and UV for each render."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    # One sample: the passes then hold a point of the surface and no average of several.
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.dicing_rate = dicing_pixels
    scene.render.resolution_x = scene.render.resolution_y = int(pixels)
    layer = bpy.context.view_layer
    layer.use_pass_position = layer.use_pass_uv = True

    corners = [mesh.matrix_world @ Vector(corner) for corner in mesh.bound_box]
    middle = sum(corners, Vector()) / 8
    size = max((corner - middle).length for corner in corners)
    azimuth, elevation = math.radians(azimuth), math.radians(elevation)
    towards = Vector(
        (math.sin(azimuth) * math.cos(elevation), -math.cos(azimuth) * math.cos(elevation), math.sin(elevation))
    )
    data = bpy.data.cameras.new("camera")
    data.type = "ORTHO"
    data.ortho_scale = 2.0 * size
    data.clip_end = 10.0 * size
    camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.location = middle + towards * 4.0 * size
    camera.rotation_euler = (-towards).to_track_quat("-Z", "Y").to_euler()

    newer = bpy.app.version >= (5, 0, 0)
    if newer:
        tree = scene.compositing_node_group = bpy.data.node_groups.new("passes", "CompositorNodeTree")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
    tree.nodes.clear()
    layers = tree.nodes.new("CompositorNodeRLayers")
    for name in ("Position", "UV"):
        files = tree.nodes.new("CompositorNodeOutputFile")
        if newer:
            files.directory, files.file_name, files.format.media_type = str(output), "", "IMAGE"
            files.file_output_items.new("RGBA", name)
        else:
            files.base_path = str(output)
            files.file_slots.clear()
            files.file_slots.new(name)
        files.format.file_format = "OPEN_EXR"
        files.format.color_mode = "RGB"
        files.format.color_depth = "32"
        tree.links.new(layers.outputs[name], files.inputs[name])


def render(output):
    """The passes by name: numbers per pixel, rows upwards, 0 where nothing is hit."""
    bpy.ops.render.render()
    found = {}
    for kind, channels in (("Position", 3), ("UV", 2)):
        (path,) = pathlib.Path(output).glob(f"{kind}*.exr")
        found[kind.lower()] = pixels_of(path, channels)
        path.unlink()
    return found
