"""What a result folder holds, without Blender: NAME.usda says which mesh the maps belong to and where the volume lies."""

import array
import pathlib
import re
import struct


class ResultError(Exception):
    """What is wrong with a folder, in words for its owner."""


def exr_attributes(path):
    """The string and float attributes in the header of an OpenEXR file of one part."""
    found = {}
    with open(path, "rb") as file:
        if file.read(4) != struct.pack("<I", 20000630):
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


class Polygons:
    """A face list. UVs are one per corner; creases map vertices (an edge's, or one) to OpenSubdiv's sharpness."""

    def __init__(self, points, faces, corner_uvs, creases=None, corners=None):
        self.points, self.faces, self.corner_uvs = points, faces, corner_uvs
        self.creases, self.corners = creases or {}, corners or {}

    def sheet_corners(self):
        """Vertices of one face alone: corners of an open sheet, which the limit surface keeps."""
        count = [0] * len(self.points)
        for face in self.faces:
            for vertex in face:
                count[vertex] += 1
        return [vertex for vertex, faces in enumerate(count) if faces == 1]


def tuples(values, size):
    return list(zip(*[iter(values)] * size))


def polygons_of_usd(text):
    """The mesh in a NAME.usda, whose arrays have a line each."""

    def numbers(name, kind):
        match = re.search(rf"^\s*\S+ {name} = \[(.*)\]", text, re.MULTILINE)
        words = match.group(1).replace("(", " ").replace(")", " ").replace(",", " ").split() if match else []
        return [kind(word) for word in words]

    points = tuples(numbers("points", float), 3)
    corners, faces = iter(numbers("faceVertexIndices", int)), []
    for size in numbers("faceVertexCounts", int):
        faces.append([next(corners) for _ in range(size)])
    uvs, uv_indices = tuples(numbers("primvars:st", float), 2), numbers("primvars:st:indices", int)
    ends, creases = iter(numbers("creaseIndices", int)), {}
    sharpnesses = numbers("creaseSharpnesses", float)
    for length, sharpness in zip(numbers("creaseLengths", int), sharpnesses):
        chain = [next(ends) for _ in range(length)]
        creases.update({(min(pair), max(pair)): sharpness for pair in zip(chain, chain[1:])})
    corner_sharpness = dict(zip(numbers("cornerIndices", int), numbers("cornerSharpnesses", float)))
    return Polygons(points, faces, [uvs[i] for i in uv_indices], creases, corner_sharpness)


def polygons_of_ply(path):
    """The triangles of NAME_limit.ply; its vertices, which seams of the UVs split, are joined again."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii")
    vertices, triangles = (int(n) for n in re.findall(r"^element \w+ (\d+)$", header, re.MULTILINE))
    names = re.findall(r"^property (float|uchar) (\w+)$", header, re.MULTILINE)
    record = struct.Struct("<" + "".join("f" if kind == "float" else "B" for kind, _ in names))
    places = [name for _, name in names]
    s, t = (places.index("s"), places.index("t")) if "s" in places else (None, None)
    points, uvs, joined, number = [], [], array.array("i"), {}
    for values in record.iter_unpack(data[end : end + vertices * record.size]):
        vertex = number.setdefault(values[:6], len(points))
        if vertex == len(points):
            points.append(values[:3])
        joined.append(vertex)
        uvs.append((values[s], values[t]) if s is not None else (0.0, 0.0))
    faces, corner_uvs = [], []
    start = end + vertices * record.size
    for _, *corners in struct.iter_unpack("<B3i", data[start : start + 13 * triangles]):
        faces.append([joined[c] for c in corners])
        corner_uvs.extend(uvs[c] for c in corners)
    return Polygons(points, faces, corner_uvs)


class Result:
    """A folder that `vdb-patina run` or `bake` wrote.

    up: "Y" or "Z"; scheme: "none", "catmullClark" or "loop"; volume_scale: from the volume's units to the model's,
    which differ in close-ups of very small voxels. Raises ResultError.
    """

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        scenes = sorted(self.folder.glob("*.usda"))
        if not scenes:
            raise ResultError(f"{folder} holds no result with maps: there is no NAME.usda in it")
        if len(scenes) > 1:
            raise ResultError(f"{folder} holds more than one result: " + ", ".join(s.stem for s in scenes))
        self.name = scenes[0].stem
        self.text = scenes[0].read_text(encoding="utf-8")

        def token(pattern, default):
            match = re.search(pattern, self.text)
            return match.group(1) if match else default

        self.scheme = token(r'subdivisionScheme = "(\w+)"', "none")
        self.up = token(r'upAxis = "(\w)"', "Y")
        self.metres_per_unit = float(token(r"metersPerUnit = (\S+)", "1"))
        volume = token(r"asset filePath = @+([^@]+)@", f"./{self.name}.vdb")
        self.volume = (self.folder / volume).resolve()
        self.volume_scale = float(token(r"float3 xformOp:scale = \((\S+),", "1"))
        self.lobes = sorted({path.stem.split(".")[0] for path in self.folder.glob("lobe_*.exr")})

    def polygons(self, diced):
        """What is to be displaced: the mesh that the maps belong to, or its limit surface, diced."""
        if not diced:
            return polygons_of_usd(self.text)
        path = self.folder / f"{self.name}_limit.ply"
        if not path.exists():
            raise ResultError(f"{path} is missing: Blender cannot subdivide the mesh as its maps were baked")
        return polygons_of_ply(path)

    def vector_space(self):
        """"object", "blender" or "materialx"; "" where no vectors were baked."""
        if not self.has_map("vector_displacement"):
            return ""
        return exr_attributes(self.map("vector_displacement")).get("patina_space", "object")

    def has_map(self, name):
        return any((self.folder / f"{name}{tile}.exr").exists() for tile in ("", ".1001"))

    def map(self, name):
        """Its file; of several UV tiles the first."""
        for path in (self.folder / f"{name}.exr", self.folder / f"{name}.1001.exr"):
            if path.exists():
                return path
        raise ResultError(f"{self.folder / name}.exr is missing: bake the maps first (vdb-patina bake)")

    def tiles(self, name):
        """The numbers of the UV tiles that a map has besides the first."""
        found = (re.fullmatch(rf"{re.escape(name)}\.(\d{{4}})", path.stem) for path in self.folder.glob(f"{name}.*.exr"))
        return sorted(int(match.group(1)) for match in found if match and match.group(1) != "1001")
