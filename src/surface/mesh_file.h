#pragma once
// Meshes in and out: OBJ, PLY, STL, OFF through OpenMesh's readers.

#include "surface/mesh.h"

#include <filesystem>

namespace patina {

/// Reads a mesh as a plain face list; UVs and per-vertex attributes where the format has them.
/// Unreferenced vertices are dropped. Duplicate vertices of STL are merged.
/// \throws ModelError (exit 4) naming the file and the offending vertex or face: an empty, truncated or foreign file, NaN or
///         infinite coordinates, an index out of range, no faces, a zero-area model, a degenerate bounding box.
Mesh readMesh(const std::filesystem::path& path);

/// Writes control mesh and UVs as OBJ, atomically.
void writeObj(const Mesh& mesh, const std::filesystem::path& path);

/// Writes triangles, normals, UVs (per vertex, split at seams) and vertex attributes as binary PLY, atomically.
void writePly(const SurfaceMesh& surface, const std::filesystem::path& path);

} // namespace patina
