#include "surface/region_cutter.h"

#include "surface/cage_topology.h"
#include "surface/region_refine.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::Box3d;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

constexpr int deepestLevel = 24; // of a part: a face of a metre is then a tenth of a micrometre

double longestOf(const Imath::Box3f& box) {
    const V3f size = box.size();
    return std::max({size.x, size.y, size.z});
}

V3f relative(const V3f& p, const V3d& origin) {
    return V3f(V3d(p) - origin);
}

// Faces whose own box, `slack` of its size larger, meets the box: a limit surface stays within its control points'
// hull, which for the faces marked here and their two rings is not far from the face.
std::vector<char> facesMeeting(const Mesh& mesh, const Box3d& box, double slack) {
    std::vector<char> meets(mesh.faceCount(), 0);
    std::size_t start = 0;
    for (std::size_t f = 0; f < mesh.faceCount(); start += mesh.faceSizes[f], ++f) {
        Box3d face;
        for (int i = 0; i < mesh.faceSizes[f]; ++i)
            face.extendBy(V3d(mesh.positions[mesh.faceVertices[start + i]]));
        const V3d size = face.size();
        const V3d more(slack * std::max({size.x, size.y, size.z}));
        meets[f] = Box3d(face.min - more, face.max + more).intersects(box);
    }
    return meets;
}

double medianEdge(const Mesh& mesh) {
    std::vector<double> edges = edgeLengths(mesh);
    if (edges.empty())
        return 0.0;
    std::nth_element(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2), edges.end());
    return edges[edges.size() / 2];
}

/// The triangles of a surface that meet a box, with what they use only.
SurfaceMesh trianglesMeeting(const SurfaceMesh& surface, const Box3d& box) {
    SurfaceMesh kept;
    kept.closed = surface.closed;
    std::vector<int> vertex(surface.positions.size(), -1), uv(surface.uvs.size(), -1), vertices;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        Box3d own;
        for (int c = 0; c < 3; ++c)
            own.extendBy(V3d(surface.positions[surface.triangles[t][c]]));
        if (!own.intersects(box))
            continue;
        V3i corners, uvs;
        for (int c = 0; c < 3; ++c) {
            int& v = vertex[surface.triangles[t][c]];
            if (v < 0) {
                v = static_cast<int>(vertices.size());
                vertices.push_back(surface.triangles[t][c]);
            }
            corners[c] = v;
            if (!surface.hasUvs())
                continue;
            int& u = uv[surface.triangleUvs[t][c]];
            if (u < 0) {
                u = static_cast<int>(kept.uvs.size());
                kept.uvs.push_back(surface.uvs[surface.triangleUvs[t][c]]);
            }
            uvs[c] = u;
        }
        kept.triangles.push_back(corners);
        if (surface.hasUvs())
            kept.triangleUvs.push_back(uvs);
        kept.triangleFaces.push_back(surface.triangleFaces[t]);
    }
    for (const int v : vertices) {
        kept.positions.push_back(surface.positions[v]);
        kept.normals.push_back(surface.normals[v]);
    }
    for (const auto& [name, values] : surface.vertexAttributes)
        for (const int v : vertices)
            kept.vertexAttributes[name].push_back(values[v]);
    return kept;
}

} // namespace

RegionCutter::RegionCutter(const Mesh& mesh, const LimitSurfaceOptions& options) : mesh_(mesh) {
    LimitSurfaceOptions coarse = options;
    coarse.level = 1;
    whole_ = makeLimitSurface(mesh, coarse);
    longestSide_ = longestOf(whole_.bounds());
    const bool trianglesOnly =
        std::all_of(mesh.faceSizes.begin(), mesh.faceSizes.end(), [](int size) { return size == 3; });
    scheme_ = options.scheme;
    if (scheme_ == SubdivisionScheme::automatic)
        scheme_ = trianglesOnly || !whole_.note.empty() ? SubdivisionScheme::none : SubdivisionScheme::catmullClark;
    level_ = options.level;
    if (scheme_ == SubdivisionScheme::none)
        return;
    coarse.level = level_;
    coarse.targetEdge = longestSide_ / wholeEdgesPerSide;
    if (level_ != 1)
        whole_ = makeLimitSurface(mesh, coarse);
}

SurfaceMesh RegionCutter::near(const Box3d& box, const V3d& origin, double targetEdge) const {
    const Box3d localBox(box.min - origin, box.max - origin);
    if (scheme_ == SubdivisionScheme::none) {
        SurfaceMesh piece = trianglesMeeting(whole_, box);
        for (V3f& p : piece.positions)
            p = relative(p, origin);
        return piece;
    }
    // First in the model's own coordinates, then relative to the origin: as the faces get smaller and nearer, so do
    // the rounding errors.
    CagePart part;
    part.mesh = mesh_;
    part.faces.resize(mesh_.faceCount());
    for (std::size_t f = 0; f < part.faces.size(); ++f)
        part.faces[f] = static_cast<int>(f);
    for (V3f& p : part.mesh.positions)
        p = relative(p, origin);
    const auto keepNear = [&] {
        std::vector<char> keep = facesMeeting(part.mesh, localBox, 0.5);
        growByRings(part.mesh, keep, 2);
        part = keepFaces(part, keep);
        return !part.faces.empty();
    };
    SurfaceMesh none;
    none.closed = whole_.closed;
    for (int level = 1; level < (level_ >= 0 ? level_ : deepestLevel); ++level) {
        if (!keepNear())
            return none;
        if (level_ < 0 && 0.5 * medianEdge(part.mesh) <= targetEdge)
            break;
        part = refineOnce(part, scheme_);
    }
    if (!keepNear())
        return none;
    LimitSurfaceOptions last;
    last.scheme = scheme_;
    last.level = level_ == 0 ? 0 : 1;
    SurfaceMesh piece = makeLimitSurface(part.mesh, last);
    for (int& face : piece.triangleFaces)
        face = part.faces[face];
    piece = trianglesMeeting(piece, localBox);
    piece.closed = whole_.closed;
    return piece;
}

} // namespace patina
