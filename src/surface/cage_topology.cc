#include "surface/cage_topology.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <mutex>

namespace patina {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

namespace {

/// OpenSubdiv prints what it dislikes; here it is silenced while a topology is made, since the result says enough.
/// Its callbacks are global, so this happens one mesh at a time.
void ignoreError(Far::ErrorType, const char*) {}
void ignoreWarning(const char*) {}

} // namespace

std::unique_ptr<Far::TopologyRefiner> makeRefiner(const Mesh& mesh, SubdivisionScheme scheme) {
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(mesh.positions.size());
    descriptor.numFaces = static_cast<int>(mesh.faceSizes.size());
    descriptor.numVertsPerFace = mesh.faceSizes.data();
    descriptor.vertIndicesPerFace = mesh.faceVertices.data();
    Far::TopologyDescriptor::FVarChannel channel;
    if (mesh.hasUvs()) {
        channel.numValues = static_cast<int>(mesh.uvs.size());
        channel.valueIndices = mesh.faceUvs.data();
        descriptor.numFVarChannels = 1;
        descriptor.fvarChannels = &channel;
    }

    std::vector<int> creaseVertices, cornerVertices;
    std::vector<float> creaseWeights, cornerWeights;
    for (const Crease& crease : mesh.creases) {
        creaseVertices.insert(creaseVertices.end(), {crease.a, crease.b});
        creaseWeights.push_back(crease.sharpness);
    }
    for (const SharpCorner& corner : mesh.corners) {
        cornerVertices.push_back(corner.vertex);
        cornerWeights.push_back(corner.sharpness);
    }
    descriptor.numCreases = static_cast<int>(creaseWeights.size());
    descriptor.creaseVertexIndexPairs = creaseVertices.data();
    descriptor.creaseWeights = creaseWeights.data();
    descriptor.numCorners = static_cast<int>(cornerWeights.size());
    descriptor.cornerVertexIndices = cornerVertices.data();
    descriptor.cornerWeights = cornerWeights.data();

    Sdc::Options rules;
    rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    // UVs: charts keep their outline exactly (no bleeding over a seam, mirrored halves still meet) and are smoothed
    // inside, where they follow the surface. Blender's "keep boundaries", its default, is the same rule, so is USD's
    // "boundaries".
    rules.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_BOUNDARIES);
    const Sdc::SchemeType type = scheme == SubdivisionScheme::loop ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Factory::Options options(type, rules);
    options.validateFullTopology = true;

    static std::mutex callbacks;
    const std::lock_guard<std::mutex> lock(callbacks);
    Far::SetErrorCallback(ignoreError);
    Far::SetWarningCallback(ignoreWarning);
    std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(descriptor, options));
    Far::SetErrorCallback(nullptr);
    Far::SetWarningCallback(nullptr);
    return refiner;
}

std::vector<double> edgeLengths(const Mesh& mesh) {
    std::vector<double> edges;
    edges.reserve(mesh.faceVertices.size());
    std::size_t start = 0;
    for (const int size : mesh.faceSizes) {
        for (int i = 0; i < size; ++i)
            edges.push_back((Imath::V3d(mesh.positions[mesh.faceVertices[start + i]]) -
                             Imath::V3d(mesh.positions[mesh.faceVertices[start + (i + 1) % size]]))
                                .length());
        start += size;
    }
    return edges;
}

} // namespace patina
