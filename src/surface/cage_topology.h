#pragma once
// A control mesh as OpenSubdiv sees it: inside the room only.

#include "surface/limit_surface.h"
#include "surface/mesh.h"

#include <opensubdiv/far/topologyRefiner.h>

#include <memory>
#include <vector>

namespace patina {

/// Faces, UVs, creases and sharp corners under the rules that all limit surfaces here have (boundaries and their
/// corners are kept, UVs follow inside their charts). nullptr where OpenSubdiv cannot take the mesh: non-manifold
/// topology, or a face that Loop's scheme does not know. Safe from any thread.
std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> makeRefiner(const Mesh& mesh, SubdivisionScheme scheme);

/// A number as OpenSubdiv wants to add it.
template <class Value>
struct Weighted {
    Value value;
    void Clear(void* = nullptr) { value = Value(0.f); }
    void AddWithWeight(const Weighted& other, float weight) { value += weight * other.value; }
};

/// The length of every side of every face, face by face, scene units: inner edges come twice.
std::vector<double> edgeLengths(const Mesh& mesh);

} // namespace patina
