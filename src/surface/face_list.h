#pragma once
// What repair does to the faces of a mesh before it asks which of them are shells.

#include "surface/mesh.h"
#include "surface/mesh_topology.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace patina {

/// First corner of each face, and their total behind the last.
std::vector<int> faceStarts(const Mesh& mesh);

/// One number for the edge between two vertices, whichever comes first.
inline std::uint64_t edgeKey(int a, int b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
}

/// Joins vertices at exactly one place where that closes edges: faces that are to be subdivided must share their
/// vertices, or they come apart along their seams. Meshes of triangles alone, and those whose attributes differ at a
/// place, stay as they are.
/// \return whether any were joined
bool joinVertices(Mesh& mesh);

/// Sheets that are there twice, once for each side: the second copies of the faces of patches that touch no others.
std::vector<int> backsOfDoubleSheets(const Mesh& mesh, const std::vector<int>& starts, const MeshTopology& topology);

/// Takes faces out, with their UVs; vertices stay.
void removeFaces(Mesh& mesh, const std::vector<int>& faces);

} // namespace patina
