// The digital surface of a mesh, by casting lattice lines along the three axes.

#include "base/errors.h"
#include "operators/growth/growth_lattice.h"
#include "operators/growth/lattice_links.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

struct Crossing {
    CellPlace place;
    Imath::V3d position;
    Imath::V3f normal;
    float area;
    int triangle;

    bool operator<(const Crossing& o) const {
        if (!(place == o.place))
            return place < o.place;
        for (int i = 0; i < 3; ++i) // two sheets within one voxel: in an order of their own
            if (position[i] != o.position[i])
                return position[i] < o.position[i];
        return triangle < o.triangle;
    }
};

struct Corner {
    double a, b;
};

/// Twice the signed area of (p, q, x), computed the same way from both sides of an edge, so that a line through a
/// shared edge belongs to exactly one of its triangles. Exactly on the edge counts as left of the edge's own direction.
struct EdgeSide {
    double value;
    bool left;
    EdgeSide(Corner p, Corner q, Corner x) {
        const bool turned = p.a != q.a ? p.a > q.a : p.b > q.b;
        if (turned)
            std::swap(p, q);
        const double side = (q.a - p.a) * (x.b - p.b) - (q.b - p.b) * (x.a - p.a);
        value = turned ? -side : side;
        left = turned ? side < 0.0 : side >= 0.0;
    }
};

int dominantAxis(const Imath::V3d& n) {
    int axis = 0;
    for (int i = 1; i < 3; ++i)
        if (std::abs(n[i]) > std::abs(n[axis]))
            axis = i;
    return axis;
}

/// A lattice line steeper to the surface than this does not carry its cells, whatever the shading normal says: the area
/// of a cell stays below 1/0.35.
constexpr double steepest = 0.35;
constexpr double farthestIndex = 1 << 27; // keys hold eight times that

void castLines(const SurfaceMesh& surface, int triangle, double cell, std::vector<Crossing>& crossings) {
    const Imath::V3i& corners = surface.triangles[triangle];
    const Imath::V3d p[3] = {Imath::V3d(surface.positions[corners[0]]), Imath::V3d(surface.positions[corners[1]]),
                             Imath::V3d(surface.positions[corners[2]])};
    const Imath::V3d twiceArea = (p[1] - p[0]) % (p[2] - p[0]);
    const double length = twiceArea.length();
    if (!(length > 0.0))
        return;
    const Imath::V3d flat = twiceArea / length;
    const int flatAxis = dominantAxis(flat);
    const bool shaded = surface.normals.size() == surface.positions.size();
    for (int axis = 0; axis < 3; ++axis) {
        if (axis != flatAxis && std::abs(flat[axis]) < steepest)
            continue;
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        int order[3] = {0, 1, 2};
        if (flat[axis] < 0.0)
            std::swap(order[1], order[2]);
        Corner c[3];
        for (int i = 0; i < 3; ++i)
            c[i] = {p[order[i]][a], p[order[i]][b]};
        const auto first = [cell](double x) { return static_cast<long long>(std::ceil(x / cell - 0.5)); };
        const auto last = [cell](double x) { return static_cast<long long>(std::floor(x / cell - 0.5)); };
        const long long a0 = first(std::min({c[0].a, c[1].a, c[2].a})), a1 = last(std::max({c[0].a, c[1].a, c[2].a}));
        const long long b0 = first(std::min({c[0].b, c[1].b, c[2].b})), b1 = last(std::max({c[0].b, c[1].b, c[2].b}));
        for (long long ia = a0; ia <= a1; ++ia) {
            for (long long ib = b0; ib <= b1; ++ib) {
                const Corner x{(double(ia) + 0.5) * cell, (double(ib) + 0.5) * cell};
                const EdgeSide e0(c[1], c[2], x), e1(c[2], c[0], x), e2(c[0], c[1], x);
                if (!e0.left || !e1.left || !e2.left)
                    continue;
                const double sum = e0.value + e1.value + e2.value;
                if (!(sum > 0.0))
                    continue;
                const double w[3] = {e0.value / sum, e1.value / sum, e2.value / sum};
                Imath::V3d normal = flat;
                if (shaded) {
                    Imath::V3d smooth(0.0);
                    for (int i = 0; i < 3; ++i)
                        smooth += w[i] * Imath::V3d(surface.normals[corners[order[i]]]);
                    if ((smooth ^ flat) > 0.0)
                        normal = smooth.normalized();
                }
                int owner = dominantAxis(normal);
                if (std::abs(flat[owner]) < steepest)
                    owner = flatAxis;
                if (owner != axis)
                    continue;
                const double depth = w[0] * p[order[0]][axis] + w[1] * p[order[1]][axis] + w[2] * p[order[2]][axis];
                Crossing crossing;
                crossing.position[axis] = depth;
                crossing.position[a] = x.a;
                crossing.position[b] = x.b;
                crossing.place.voxel[axis] = static_cast<int>(std::lround(depth / cell));
                crossing.place.voxel[a] = static_cast<int>(ia);
                crossing.place.voxel[b] = static_cast<int>(ib);
                crossing.place.facet = static_cast<std::uint8_t>(axis * 2 + (flat[axis] < 0.0));
                crossing.normal = Imath::V3f(normal);
                crossing.area = static_cast<float>(1.0 / std::abs(flat[axis]));
                crossing.triangle = triangle;
                crossings.push_back(crossing);
            }
        }
    }
}

} // namespace

GrowthLattice surfaceLattice(const SurfaceMesh& surface, double cellSize) {
    if (!(cellSize > 0.0) || !std::isfinite(cellSize))
        throw RunError("growth lattice", "the size of a cell must be positive");
    const Imath::Box3f box = surface.bounds();
    for (int i = 0; i < 3 && !surface.positions.empty(); ++i)
        if (std::max(std::abs(box.min[i]), std::abs(box.max[i])) / cellSize > farthestIndex)
            throw RunError("growth lattice", "cells are too small for a model this far from its origin",
                           "use a larger cell");

    constexpr std::size_t chunk = 1024;
    const std::size_t chunks = (surface.triangles.size() + chunk - 1) / chunk;
    std::vector<std::vector<Crossing>> parts(chunks);
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t c) {
        const std::size_t last = std::min(surface.triangles.size(), (c + 1) * chunk);
        for (std::size_t t = c * chunk; t < last; ++t)
            castLines(surface, static_cast<int>(t), cellSize, parts[c]);
    });
    std::vector<Crossing> crossings;
    std::size_t total = 0;
    for (const auto& part : parts)
        total += part.size();
    if (total > (std::size_t(1) << 31) - 1)
        throw RunError("growth lattice", "more than two billion cells", "use a larger cell or a region");
    crossings.reserve(total);
    for (auto& part : parts) {
        crossings.insert(crossings.end(), part.begin(), part.end());
        std::vector<Crossing>().swap(part);
    }
    tbb::parallel_sort(crossings.begin(), crossings.end());

    GrowthLattice lattice;
    lattice.cell = cellSize;
    lattice.keys.resize(total);
    lattice.areas.resize(total);
    lattice.centres.resize(total);
    lattice.normals.resize(total);
    lattice.axes.resize(total);
    std::vector<CellPlace> places(total);
    for (std::size_t i = 0; i < total; ++i) {
        const Crossing& crossing = crossings[i];
        places[i] = crossing.place;
        lattice.keys[i] = crossing.place.voxel;
        lattice.keys[i].z = crossing.place.voxel.z * 8 + crossing.place.facet;
        lattice.areas[i] = crossing.area;
        lattice.centres[i] = Imath::V3f(crossing.position);
        lattice.normals[i] = crossing.normal;
        lattice.axes[i] = static_cast<std::uint8_t>(crossing.place.facet / 2);
    }
    std::vector<Crossing>().swap(crossings);
    linkCells(lattice, places);
    return lattice;
}

} // namespace patina
