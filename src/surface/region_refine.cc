#include "surface/region_refine.h"

#include "base/errors.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <memory>

namespace patina {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

namespace {

template <class Value>
struct Weighted {
    Value value;
    void Clear(void* = nullptr) { value = Value(0.f); }
    void AddWithWeight(const Weighted& other, float weight) { value += weight * other.value; }
};

template <class Value, class Refine>
std::vector<Value> refined(const std::vector<Value>& coarse, int count, Refine&& refine) {
    std::vector<Weighted<Value>> from(coarse.size()), to(count);
    for (std::size_t i = 0; i < coarse.size(); ++i)
        from[i].value = coarse[i];
    refine(from, to);
    std::vector<Value> fine(to.size());
    for (std::size_t i = 0; i < to.size(); ++i)
        fine[i] = to[i].value;
    return fine;
}

std::unique_ptr<Far::TopologyRefiner> refinerOf(const Mesh& mesh, SubdivisionScheme scheme) {
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
    Sdc::Options rules;
    rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    rules.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_BOUNDARIES);
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    const auto type = scheme == SubdivisionScheme::loop ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
    return std::unique_ptr<Far::TopologyRefiner>(Factory::Create(descriptor, Factory::Options(type, rules)));
}

} // namespace

CagePart keepFaces(const CagePart& part, const std::vector<char>& keep) {
    const Mesh& mesh = part.mesh;
    CagePart kept;
    kept.mesh.name = mesh.name;
    std::vector<int> vertex(mesh.positions.size(), -1), uv(mesh.uvs.size(), -1), vertices;
    std::size_t start = 0;
    for (std::size_t f = 0; f < mesh.faceCount(); start += mesh.faceSizes[f], ++f) {
        if (!keep[f])
            continue;
        kept.mesh.faceSizes.push_back(mesh.faceSizes[f]);
        kept.faces.push_back(part.faces[f]);
        for (int i = 0; i < mesh.faceSizes[f]; ++i) {
            int& v = vertex[mesh.faceVertices[start + i]];
            if (v < 0) {
                v = static_cast<int>(vertices.size());
                vertices.push_back(mesh.faceVertices[start + i]);
            }
            kept.mesh.faceVertices.push_back(v);
            if (!mesh.hasUvs())
                continue;
            int& u = uv[mesh.faceUvs[start + i]];
            if (u < 0) {
                u = static_cast<int>(kept.mesh.uvs.size());
                kept.mesh.uvs.push_back(mesh.uvs[mesh.faceUvs[start + i]]);
            }
            kept.mesh.faceUvs.push_back(u);
        }
    }
    for (const int v : vertices)
        kept.mesh.positions.push_back(mesh.positions[v]);
    for (const auto& [name, values] : mesh.vertexAttributes)
        for (const int v : vertices)
            kept.mesh.vertexAttributes[name].push_back(values[v]);
    return kept;
}

void growByRings(const Mesh& mesh, std::vector<char>& marked, int rings) {
    std::vector<char> touched(mesh.positions.size());
    for (int ring = 0; ring < rings; ++ring) {
        std::size_t start = 0;
        for (std::size_t f = 0; f < mesh.faceCount(); start += mesh.faceSizes[f], ++f)
            for (int i = 0; marked[f] && i < mesh.faceSizes[f]; ++i)
                touched[mesh.faceVertices[start + i]] = 1;
        start = 0;
        for (std::size_t f = 0; f < mesh.faceCount(); start += mesh.faceSizes[f], ++f)
            for (int i = 0; !marked[f] && i < mesh.faceSizes[f]; ++i)
                marked[f] = touched[mesh.faceVertices[start + i]];
    }
}

CagePart refineOnce(const CagePart& part, SubdivisionScheme scheme) {
    const Mesh& mesh = part.mesh;
    const auto refiner = refinerOf(mesh, scheme);
    if (!refiner)
        throw ModelError(mesh.name, "the part of it near the region cannot be subdivided",
                         "use --scheme none, or repair the model");
    Far::TopologyRefiner::UniformOptions options(1);
    options.fullTopologyInLastLevel = true;
    refiner->RefineUniform(options);
    const Far::PrimvarRefiner primvars(*refiner);
    const Far::TopologyLevel& level = refiner->GetLevel(1);

    CagePart fine;
    fine.mesh.name = mesh.name;
    fine.mesh.positions = refined(mesh.positions, level.GetNumVertices(),
                                  [&](const auto& from, auto& to) { primvars.Interpolate(1, from, to); });
    if (mesh.hasUvs())
        fine.mesh.uvs = refined(mesh.uvs, level.GetNumFVarValues(0),
                                [&](const auto& from, auto& to) { primvars.InterpolateFaceVarying(1, from, to, 0); });
    for (const auto& [name, values] : mesh.vertexAttributes)
        fine.mesh.vertexAttributes[name] = refined(values, level.GetNumVertices(), [&](const auto& from, auto& to) {
            primvars.InterpolateVarying(1, from, to);
        });
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        const Far::ConstIndexArray corners = level.GetFaceVertices(f);
        fine.mesh.faceSizes.push_back(corners.size());
        fine.mesh.faceVertices.insert(fine.mesh.faceVertices.end(), &corners[0], &corners[0] + corners.size());
        if (mesh.hasUvs()) {
            const Far::ConstIndexArray uvs = level.GetFaceFVarValues(f, 0);
            fine.mesh.faceUvs.insert(fine.mesh.faceUvs.end(), &uvs[0], &uvs[0] + uvs.size());
        }
        fine.faces.push_back(part.faces[level.GetFaceParentFace(f)]);
    }
    return fine;
}

} // namespace patina
