#include "surface/surface_walk.h"

#include "surface/weld.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace patina {

using Imath::V3d;
using Imath::V3i;

SurfaceWalk::SurfaceWalk(const SurfaceMesh& surface) : surface_(surface) {
    const std::vector<int> place = weldedIndices(surface.positions);
    struct Edge {
        std::uint64_t ends; // the smaller place first
        int code;           // 3 triangle + edge
        bool reversed;
        bool operator<(const Edge& other) const { return ends != other.ends ? ends < other.ends : code < other.code; }
    };
    std::vector<Edge> edges(3 * surface.triangles.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (int e = 0; e < 3; ++e) {
            const auto a = static_cast<std::uint32_t>(place[surface.triangles[t][e]]);
            const auto b = static_cast<std::uint32_t>(place[surface.triangles[t][(e + 1) % 3]]);
            edges[3 * t + e] = {std::uint64_t(std::min(a, b)) << 32 | std::max(a, b), static_cast<int>(3 * t + e), a > b};
        }
    tbb::parallel_sort(edges.begin(), edges.end());
    behind_.assign(edges.size(), -1);
    for (std::size_t first = 0; first < edges.size();) {
        std::size_t last = first;
        while (last < edges.size() && edges[last].ends == edges[first].ends)
            ++last;
        // Of more than two triangles at an edge, those that run through it the other way, in order.
        for (std::size_t i = first; i < last; ++i)
            for (std::size_t j = i + 1; j < last && behind_[edges[i].code] < 0; ++j)
                if (edges[j].reversed != edges[i].reversed && behind_[edges[j].code] < 0) {
                    behind_[edges[i].code] = edges[j].code;
                    behind_[edges[j].code] = edges[i].code;
                }
        first = last;
    }
}

SurfacePoint SurfaceWalk::from(SurfacePoint start, V3d displacement) const {
    const auto corner = [&](int t, int c) { return V3d(surface_.positions[surface_.triangles[t][c]]); };
    int t = start.triangle;
    double weight[3] = {1.0 - double(start.u) - double(start.v), start.u, start.v};
    for (int step = 0; step < 64; ++step) {
        const V3d p[3] = {corner(t, 0), corner(t, 1), corner(t, 2)};
        const V3d e1 = p[1] - p[0], e2 = p[2] - p[0];
        const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2), determinant = a * c - b * b;
        if (!(determinant > 1e-14 * a * c))
            break;
        const double d1 = displacement.dot(e1), d2 = displacement.dot(e2);
        const double du = (c * d1 - b * d2) / determinant, dv = (a * d2 - b * d1) / determinant;
        const double change[3] = {-du - dv, du, dv};
        int out = -1;
        double way = 1.0;
        for (int i = 0; i < 3; ++i) {
            const double end = weight[i] + change[i];
            if (end >= -1e-9 || change[i] >= 0.0)
                continue;
            const double reach = std::clamp(weight[i] / -change[i], 0.0, 1.0);
            if (out < 0 || reach < way) {
                way = reach;
                out = i;
            }
        }
        for (int i = 0; i < 3; ++i)
            weight[i] = std::max(0.0, weight[i] + way * change[i]);
        if (out < 0)
            break;
        weight[out] = 0.0;
        const int edge = (out + 1) % 3, next = behind(t, edge);
        if (next < 0)
            break;
        const int triangle = next / 3, entry = next % 3;
        const V3d along = (p[(out + 2) % 3] - p[(out + 1) % 3]).normalized();
        const V3d normal = e1.cross(e2).normalized();
        const V3d nextNormal = (corner(triangle, 1) - corner(triangle, 0))
                                   .cross(corner(triangle, 2) - corner(triangle, 0))
                                   .normalized();
        displacement *= 1.0 - way;
        displacement =
            along * displacement.dot(along) + along.cross(nextNormal) * displacement.dot(along.cross(normal));
        double entering[3] = {0.0, 0.0, 0.0};
        entering[entry] = weight[(out + 2) % 3];
        entering[(entry + 1) % 3] = weight[(out + 1) % 3];
        std::copy(entering, entering + 3, weight);
        t = triangle;
    }
    const double sum = weight[0] + weight[1] + weight[2];
    return {t, static_cast<float>(weight[1] / sum), static_cast<float>(weight[2] / sum)};
}

} // namespace patina
