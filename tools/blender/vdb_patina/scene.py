"""A result as objects of Blender's scene: mesh, material, volume, interfaces, frames."""

import math
import pathlib

import bmesh
import bpy

from .result import Result, ResultError, exr_attributes


def turn(result):
    """The rotation about x that brings the result's up axis to Blender's."""
    return math.pi / 2 if result.up == "Y" else 0.0


def load_image(result, name, colour):
    image = bpy.data.images.load(str(result.map(name)), check_existing=True)
    if image.filepath.endswith(".1001.exr"):
        image.source = "TILED"
        for number in result.tiles(name):
            image.tiles.new(number)
    spaces = ("Linear", "Linear Rec.709") if colour else ("Non-Color",)
    for space in spaces:
        try:
            image.colorspace_settings.name = space
            break
        except TypeError:
            continue
    return image


def add_displacement(result, nodes, links, texture, vectors, row):
    """Heights along the normal, or, where they were baked, vectors: these follow overhangs."""
    space = result.vector_space() if vectors else ""
    if space:
        displace = nodes.new("ShaderNodeVectorDisplacement")
        spaces = {"object": "OBJECT", "blender": "TANGENT"}
        if space not in spaces:
            raise ResultError(f"vector_displacement.exr is in the tangent space '{space}', which Blender does not read: "
                              "bake it in object space")
        displace.space = spaces[space]
        links.new(texture("vector_displacement", False, row).outputs["Color"], displace.inputs["Vector"])
    else:
        displace = nodes.new("ShaderNodeDisplacement")
        links.new(texture("displacement", False, row).outputs["Color"], displace.inputs["Height"])
    displace.location = (620, -300 * row)
    displace.inputs["Midlevel"].default_value = 0.0
    displace.inputs["Scale"].default_value = 1.0
    return displace.outputs["Displacement"]


def make_material(result, flattened=False, vectors=True):
    """Diffuse part and one glossy lobe for each interface, added; or one Principled BSDF from the flattened maps."""
    material = bpy.data.materials.new(result.name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    output.location = (900, 0)

    def texture(name, colour, row):
        node = nodes.new("ShaderNodeTexImage")
        node.image = load_image(result, name, colour)
        node.extension = "EXTEND"
        node.label = node.name = name
        node.location = (0, -300 * row)
        return node

    if flattened:
        shader = nodes.new("ShaderNodeBsdfPrincipled")
        shader.location = (400, 0)
        links.new(texture("base_color", True, 0).outputs["Color"], shader.inputs["Base Color"])
        links.new(texture("metallic", False, 1).outputs["Color"], shader.inputs["Metallic"])
        links.new(texture("roughness", False, 2).outputs["Color"], shader.inputs["Roughness"])
        surface, row = shader.outputs["BSDF"], 3
    else:
        diffuse = nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.location = (400, 0)
        links.new(texture("diffuse", True, 0).outputs["Color"], diffuse.inputs["Color"])
        surface, row = diffuse.outputs["BSDF"], 1
        for name in result.lobes:
            # 4.0 and later have one node for both; the name of the older still makes it.
            lobe = nodes.new("ShaderNodeBsdfGlossy" if hasattr(bpy.types, "ShaderNodeBsdfGlossy")
                             else "ShaderNodeBsdfAnisotropic")
            lobe.distribution = "GGX"
            # Blender squares its roughness to get GGX's alpha.
            alpha = exr_attributes(result.map(name)).get("patina_ggx_alpha", 0.2)
            lobe.inputs["Roughness"].default_value = math.sqrt(alpha)
            lobe.location = (400, -300 * row)
            links.new(texture(name, True, row).outputs["Color"], lobe.inputs["Color"])
            both = nodes.new("ShaderNodeAddShader")
            both.location = (620, -150 * row)
            links.new(surface, both.inputs[0])
            links.new(lobe.outputs["BSDF"], both.inputs[1])
            surface, row = both.outputs["Shader"], row + 1
    links.new(surface, output.inputs["Surface"])
    links.new(add_displacement(result, nodes, links, texture, vectors, row), output.inputs["Displacement"])
    if hasattr(material, "displacement_method"):  # 4.1 and later
        material.displacement_method = "DISPLACEMENT"
    else:
        material.cycles.displacement_method = "DISPLACEMENT"
    return material


def set_creases(mesh, creases, corners):
    """Weights (0…1) of edges, by their two vertices, and of vertices."""
    if not creases and not corners:
        return
    if bpy.app.version >= (4, 0, 0):
        edges = mesh.attributes.new("crease_edge", "FLOAT", "EDGE")
        edges.data.foreach_set("value", [creases.get(tuple(sorted(edge.vertices)), 0.0) for edge in mesh.edges])
        vertices = mesh.attributes.new("crease_vert", "FLOAT", "POINT")
        vertices.data.foreach_set("value", [corners.get(i, 0.0) for i in range(len(mesh.vertices))])
        return
    work = bmesh.new()
    work.from_mesh(mesh)
    of_edges, of_vertices = work.edges.layers.crease.verify(), work.verts.layers.crease.verify()
    for edge in work.edges:
        edge[of_edges] = creases.get(tuple(sorted(vertex.index for vertex in edge.verts)), 0.0)
    for vertex in work.verts:
        vertex[of_vertices] = corners.get(vertex.index, 0.0)
    work.to_mesh(mesh)
    work.free()


def import_mesh(result, adaptive, vectors=True):
    # Blender has no Loop subdivision, and Cycles no tangents on what it subdivides itself: there, the limit surface.
    tangents = vectors and result.vector_space() == "blender"
    diced = tangents or result.scheme == "loop"
    adaptive = adaptive and not tangents
    polygons = result.polygons(diced)
    data = bpy.data.meshes.new(result.name)
    data.from_pydata(polygons.points, [], polygons.faces)
    data.polygons.foreach_set("use_smooth", [True] * len(polygons.faces))
    if polygons.corner_uvs:
        layer = data.uv_layers.new(name="st")
        layer.data.foreach_set("uv", [number for uv in polygons.corner_uvs for number in uv])
    subdivided = result.scheme == "catmullClark" and not diced
    if subdivided:
        # OpenSubdiv's sharpness of 10 is infinite. Cycles' own subdivision takes a tenth of it as the weight, the
        # modifier its square root.
        weight = (lambda s: min(s / 10.0, 1.0)) if adaptive else (lambda s: math.sqrt(min(s / 10.0, 1.0)))
        corners = dict.fromkeys(polygons.sheet_corners(), 1.0)
        corners.update({vertex: weight(s) for vertex, s in polygons.corners.items()})
        set_creases(data, {edge: weight(s) for edge, s in polygons.creases.items()}, corners)
    data.update()
    mesh = bpy.data.objects.new(result.name, data)
    bpy.context.collection.objects.link(mesh)
    mesh.rotation_euler.x = turn(result)
    # Blender ends itself (OpenVDB: a nearly singular matrix) where voxels become smaller than OpenVDB takes: in such
    # close-ups the mesh is brought to the volume's size, and not the other way round.
    mesh.scale = [1.0 / result.volume_scale] * 3
    if adaptive:
        modifier = mesh.modifiers.new("Subdivision", "SUBSURF")
        modifier.subdivision_type = "CATMULL_CLARK" if subdivided else "SIMPLE"
        # Cycles dices the cage itself; levels of the modifier would come before.
        modifier.levels = modifier.render_levels = 0
        modifier.uv_smooth = "PRESERVE_BOUNDARIES"
        modifier.boundary_smooth = "PRESERVE_CORNERS"
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
    volume.rotation_euler.x = turn(result)
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
        item.rotation_euler.x = turn(result)
        item.hide_render = True
        made.append(item)
    return made


def import_result(folder, adaptive=True, flattened=False, volume=True, interfaces=False, vectors=True):
    """Mesh with true displacement and material, the volume and, if asked for, its interfaces as meshes.

    vectors: displace by vector_displacement.exr where it was baked. Returns the mesh object. Raises ResultError with
    what is missing.
    """
    result = Result(folder)
    material = make_material(result, flattened, vectors)
    mesh = import_mesh(result, adaptive, vectors)
    mesh.data.materials.append(material)
    if volume and result.volume.exists():
        grids = import_volume(result)
        if interfaces:
            import_interfaces(result, grids)
    bpy.context.view_layer.objects.active = mesh
    bpy.context.view_layer.update()  # scripts that ask where it is are told
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
