#pragma once
// One step of subdivision of a part of a cage: inside the room only.

#include "surface/limit_surface.h"
#include "surface/mesh.h"

#include <vector>

namespace patina {

/// A part of a control mesh and the face of the whole that each of its faces came from.
struct CagePart {
    Mesh mesh;
    std::vector<int> faces;
};

/// The faces of a part that `keep` marks (one entry per face), with what they use only.
CagePart keepFaces(const CagePart& part, const std::vector<char>& keep);

/// Marks, besides the faces marked, those that share a vertex with one; `rings` times.
void growByRings(const Mesh& mesh, std::vector<char>& marked, int rings);

/// The mesh after one step of its scheme (Catmull–Clark or Loop), with the rules of makeLimitSurface(): its limit
/// surface is the same, but for two rings of faces where a part was cut off. \throws ModelError where the part cannot
/// be subdivided
CagePart refineOnce(const CagePart& part, SubdivisionScheme scheme);

} // namespace patina
