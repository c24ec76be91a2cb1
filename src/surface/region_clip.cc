#include "surface/region_clip.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

namespace patina {

using Imath::V2f;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

std::uint64_t edgeKey(int a, int b) {
    return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

/// Adds points on the edges of a surface, each once, whichever triangle asks first.
class EdgePoints {
  public:
    explicit EdgePoints(SurfaceMesh& surface) : surface_(surface) {}

    /// The vertex at `t` of the way from the smaller index to the larger.
    int vertex(int a, int b, double t) {
        const auto [found, isNew] = vertices_.emplace(edgeKey(a, b), static_cast<int>(surface_.positions.size()));
        if (isNew) {
            const int p = std::min(a, b), q = std::max(a, b);
            surface_.positions.push_back(between(surface_.positions[p], surface_.positions[q], t));
            V3f normal = between(surface_.normals[p], surface_.normals[q], t);
            surface_.normals.push_back(normal.length2() > 1e-6f ? normal.normalized() : surface_.normals[p]);
            for (auto& [name, values] : surface_.vertexAttributes)
                values.push_back(static_cast<float>(values[p] + t * (double(values[q]) - values[p])));
        }
        return found->second;
    }
    /// The same for UVs; t runs as for the vertices a, b.
    int uv(int uvA, int uvB, int a, int b, double t) {
        if (a > b)
            std::swap(uvA, uvB);
        const auto [found, isNew] = uvs_.emplace(std::uint64_t(std::uint32_t(uvA)) << 32 | std::uint32_t(uvB),
                                                 static_cast<int>(surface_.uvs.size()));
        if (isNew) {
            const V2f p = surface_.uvs[uvA], q = surface_.uvs[uvB];
            surface_.uvs.push_back(p + (q - p) * static_cast<float>(t));
        }
        return found->second;
    }
    void clear() {
        vertices_.clear();
        uvs_.clear();
    }

  private:
    static V3f between(const V3f& p, const V3f& q, double t) { return V3f(V3d(p) + (V3d(q) - V3d(p)) * t); }

    SurfaceMesh& surface_;
    std::unordered_map<std::uint64_t, int> vertices_;
    std::unordered_map<std::uint64_t, int> uvs_;
};

struct Corner {
    int vertex, uv;
};

/// Drops vertices and UVs that no triangle uses.
void dropUnused(SurfaceMesh& surface) {
    std::vector<int> vertex(surface.positions.size(), -1), uv(surface.uvs.size(), -1);
    SurfaceMesh used;
    std::vector<int> kept;
    for (V3i& triangle : surface.triangles)
        for (int c = 0; c < 3; ++c) {
            int& v = vertex[triangle[c]];
            if (v < 0) {
                v = static_cast<int>(kept.size());
                kept.push_back(triangle[c]);
            }
            triangle[c] = v;
        }
    for (V3i& triangle : surface.triangleUvs)
        for (int c = 0; c < 3; ++c) {
            int& u = uv[triangle[c]];
            if (u < 0) {
                u = static_cast<int>(used.uvs.size());
                used.uvs.push_back(surface.uvs[triangle[c]]);
            }
            triangle[c] = u;
        }
    for (const int v : kept) {
        used.positions.push_back(surface.positions[v]);
        used.normals.push_back(surface.normals[v]);
    }
    for (auto& [name, values] : surface.vertexAttributes) {
        std::vector<float> some;
        for (const int v : kept)
            some.push_back(values[v]);
        values.swap(some);
    }
    surface.positions.swap(used.positions);
    surface.normals.swap(used.normals);
    surface.uvs.swap(used.uvs);
}

/// Keeps what lies on one side of a plane across an axis.
void clipAt(SurfaceMesh& surface, int axis, double place, bool keepAbove) {
    const bool hasUvs = surface.hasUvs();
    // Above 0: kept. The same number for all triangles at a vertex.
    std::vector<double> side(surface.positions.size());
    for (std::size_t v = 0; v < side.size(); ++v)
        side[v] = keepAbove ? surface.positions[v][axis] - place : place - surface.positions[v][axis];
    EdgePoints points(surface);
    std::vector<V3i> triangles, triangleUvs;
    std::vector<int> faces;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const V3i corners = surface.triangles[t], uvs = hasUvs ? surface.triangleUvs[t] : V3i(0);
        Corner polygon[4];
        int count = 0;
        for (int c = 0; c < 3; ++c) {
            const int a = corners[c], b = corners[(c + 1) % 3];
            if (side[a] >= 0.0)
                polygon[count++] = {a, uvs[c]};
            // An edge that ends in the plane is not cut.
            if ((side[a] > 0.0 && side[b] < 0.0) || (side[a] < 0.0 && side[b] > 0.0)) {
                const int p = std::min(a, b), q = std::max(a, b);
                const double at = side[p] / (side[p] - side[q]);
                const int v = points.vertex(a, b, at);
                surface.positions[v][axis] = static_cast<float>(place);
                polygon[count++] = {v, hasUvs ? points.uv(uvs[c], uvs[(c + 1) % 3], a, b, at) : 0};
            }
        }
        for (int i = 2; i < count; ++i) {
            triangles.emplace_back(polygon[0].vertex, polygon[i - 1].vertex, polygon[i].vertex);
            if (hasUvs)
                triangleUvs.emplace_back(polygon[0].uv, polygon[i - 1].uv, polygon[i].uv);
            faces.push_back(surface.triangleFaces[t]);
        }
    }
    surface.triangles.swap(triangles);
    surface.triangleUvs.swap(triangleUvs);
    surface.triangleFaces.swap(faces);
}

} // namespace

SurfaceMesh clippedTo(const SurfaceMesh& surface, const Imath::Box3d& box) {
    SurfaceMesh piece = surface;
    for (int axis = 0; axis < 3; ++axis) {
        clipAt(piece, axis, box.min[axis], true);
        clipAt(piece, axis, box.max[axis], false);
    }
    // Triangles that only touch a side have no area left.
    std::vector<V3i> triangles, triangleUvs;
    std::vector<int> faces;
    for (std::size_t t = 0; t < piece.triangles.size(); ++t) {
        const V3i& c = piece.triangles[t];
        const V3d a(piece.positions[c[0]]), p(piece.positions[c[1]]), q(piece.positions[c[2]]);
        if (!((p - a).cross(q - a).length() > 0.0))
            continue;
        triangles.push_back(c);
        if (piece.hasUvs())
            triangleUvs.push_back(piece.triangleUvs[t]);
        faces.push_back(piece.triangleFaces[t]);
    }
    piece.triangles.swap(triangles);
    piece.triangleUvs.swap(triangleUvs);
    piece.triangleFaces.swap(faces);
    dropUnused(piece);
    return piece;
}

SurfaceMesh diced(const SurfaceMesh& surface, double longestEdge) {
    SurfaceMesh fine = surface;
    const bool hasUvs = fine.hasUvs();
    EdgePoints points(fine);
    const double limit = longestEdge * longestEdge;
    for (bool again = true; again;) {
        again = false;
        points.clear();
        std::vector<V3i> triangles, triangleUvs;
        std::vector<int> faces;
        for (std::size_t t = 0; t < fine.triangles.size(); ++t) {
            const V3i corners = fine.triangles[t], uvs = hasUvs ? fine.triangleUvs[t] : V3i(0);
            double squared[3];
            int longEdges = 0, first = 0;
            for (int e = 0; e < 3; ++e) {
                squared[e] =
                    (V3d(fine.positions[corners[(e + 1) % 3]]) - V3d(fine.positions[corners[e]])).length2();
                longEdges += squared[e] > limit;
            }
            const auto add = [&](const Corner& a, const Corner& b, const Corner& c) {
                triangles.emplace_back(a.vertex, b.vertex, c.vertex);
                if (hasUvs)
                    triangleUvs.emplace_back(a.uv, b.uv, c.uv);
                faces.push_back(fine.triangleFaces[t]);
            };
            if (longEdges == 0) {
                add({corners[0], uvs[0]}, {corners[1], uvs[1]}, {corners[2], uvs[2]});
                continue;
            }
            again = true;
            // Turned so that edge 0 is split where one is, and edge 2 is the short one where two are.
            if (longEdges == 1)
                while (!(squared[first] > limit))
                    ++first;
            if (longEdges == 2)
                while (squared[(first + 2) % 3] > limit)
                    ++first;
            Corner c[3], middle[3];
            for (int i = 0; i < 3; ++i)
                c[i] = {corners[(first + i) % 3], uvs[(first + i) % 3]};
            for (int i = 0; i < longEdges; ++i) {
                const Corner &a = c[i], &b = c[(i + 1) % 3];
                middle[i].vertex = points.vertex(a.vertex, b.vertex, 0.5);
                middle[i].uv = hasUvs ? points.uv(a.uv, b.uv, a.vertex, b.vertex, 0.5) : 0;
            }
            if (longEdges == 1) {
                add(c[0], middle[0], c[2]);
                add(middle[0], c[1], c[2]);
            } else if (longEdges == 2) {
                add(middle[0], c[1], middle[1]);
                add(c[0], middle[0], middle[1]);
                add(c[0], middle[1], c[2]);
            } else {
                add(c[0], middle[0], middle[2]);
                add(middle[0], c[1], middle[1]);
                add(middle[2], middle[1], c[2]);
                add(middle[0], middle[1], middle[2]);
            }
        }
        fine.triangles.swap(triangles);
        fine.triangleUvs.swap(triangleUvs);
        fine.triangleFaces.swap(faces);
    }
    return fine;
}

} // namespace patina
