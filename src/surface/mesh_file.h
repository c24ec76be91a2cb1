#pragma once
// Meshes in and out: OBJ, PLY, STL, OFF through OpenMesh's readers.

#include "surface/mesh.h"

#include <filesystem>

namespace patina {

/// Reads a mesh as a plain face list; its name is the file's stem. What no halfedge structure can hold (edges of three
/// faces, faces twice) comes through unchanged. UVs are read from OBJ (per corner) and PLY (per vertex; the vertices
/// that seams split there are joined again), and only kept if every corner has one. Vertex colours of OBJ and PLY
/// become the attributes red, green, blue (0…1), every other number per vertex of PLY an attribute of its name; normals
/// are not read. Strips of triangles (PLY) become triangles. Equal vertices of STL are merged, unreferenced vertices
/// and repeated corners of a face dropped. Creases and sharp corners are read from OpenSubdiv's
/// tags in OBJ (`t crease 2/1/0 VERTEX VERTEX SHARPNESS`, `t corner 1/1/0 VERTEX SHARPNESS`, vertices counted from 0).
/// Material files are not opened. Any thread may call it; the OpenMesh part
/// runs one file at a time. \throws ModelError (exit 4) naming the file and the offending vertex or face: an empty,
/// truncated or foreign file, NaN or
///         infinite coordinates (or beyond 1e15), an index out of range, a crease on no edge, a face of more than 16384
///         corners, no faces, a zero-area model, a degenerate bounding box; a missing file, a folder, another format.
Mesh readMesh(const std::filesystem::path& path);

/// Writes control mesh, UVs, vertex colours, creases and sharp corners as OBJ, atomically; numbers read back to the
/// same bits. \param normals  per vertex, for meshes that are not subdivided; null: none are written \throws RunError
/// where the file cannot be written; an older one is then still there.
void writeObj(const Mesh& mesh, const std::filesystem::path& path, const std::vector<Imath::V3f>* normals = nullptr);

/// Writes triangles, normals, UVs (per vertex as s, t; split at seams) and vertex attributes as binary PLY, atomically.
/// Red, green and blue, where all three are there, are written as bytes (0…1 → 0…255), everything else as float.
/// \throws RunError where the file cannot be written.
void writePly(const SurfaceMesh& surface, const std::filesystem::path& path);

} // namespace patina
