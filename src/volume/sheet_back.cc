#include "volume/sheet_back.h"

#include <algorithm>
#include <array>
#include <utility>

namespace patina {

ClosedSurface closeSurface(const SurfaceMesh& surface, double thickness) {
    ClosedSurface closed;
    closed.positions = surface.positions;
    closed.triangles = surface.triangles;
    closed.frontTriangles = surface.triangles.size();
    if (surface.closed)
        return closed;

    const int count = static_cast<int>(surface.positions.size());
    closed.positions.reserve(2 * surface.positions.size());
    for (int v = 0; v < count; ++v)
        closed.positions.push_back(surface.positions[v] - surface.normals[v] * static_cast<float>(thickness));

    // Every edge with its direction; one that no second triangle shares lies on the rim.
    struct Edge {
        int low, high, from, to;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * surface.triangles.size());
    for (const Imath::V3i& t : surface.triangles)
        for (int c = 0; c < 3; ++c) {
            const int a = t[c], b = t[(c + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), a, b});
        }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::array{a.low, a.high, a.from} < std::array{b.low, b.high, b.from};
    });

    for (const Imath::V3i& t : surface.triangles)
        closed.triangles.emplace_back(t[0] + count, t[2] + count, t[1] + count);
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t j = i + 1;
        while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high)
            ++j;
        if (j - i == 1) {
            const int a = edges[i].from, b = edges[i].to;
            closed.triangles.emplace_back(b, a, a + count);
            closed.triangles.emplace_back(b, a + count, b + count);
        }
        i = j;
    }
    return closed;
}

} // namespace patina
