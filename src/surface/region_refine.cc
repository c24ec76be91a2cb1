#include "surface/region_refine.h"

#include "base/errors.h"
#include "surface/cage_topology.h"

#include <opensubdiv/far/primvarRefiner.h>

namespace patina {

namespace Far = OpenSubdiv::Far;

namespace {

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
    for (const Crease& crease : mesh.creases)
        if (vertex[crease.a] >= 0 && vertex[crease.b] >= 0)
            kept.mesh.creases.push_back({vertex[crease.a], vertex[crease.b], crease.sharpness});
    for (const SharpCorner& corner : mesh.corners)
        if (vertex[corner.vertex] >= 0)
            kept.mesh.corners.push_back({vertex[corner.vertex], corner.sharpness});
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
    const auto refiner = makeRefiner(mesh, scheme);
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
    // What is left of their sharpness. Boundaries are sharp by the rules.
    for (int e = 0; e < level.GetNumEdges(); ++e)
        if (level.GetEdgeSharpness(e) > 0.f && !level.IsEdgeBoundary(e)) {
            const Far::ConstIndexArray ends = level.GetEdgeVertices(e);
            fine.mesh.creases.push_back({ends[0], ends[1], level.GetEdgeSharpness(e)});
        }
    for (int v = 0; v < level.GetNumVertices(); ++v)
        if (level.GetVertexSharpness(v) > 0.f)
            fine.mesh.corners.push_back({v, level.GetVertexSharpness(v)});
    return fine;
}

} // namespace patina
