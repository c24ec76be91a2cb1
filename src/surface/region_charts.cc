#include "surface/region_charts.h"

#include "surface/chart_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace patina {

using Imath::V2d;
using Imath::V2f;
using Imath::V3d;
using Imath::V3i;

namespace {

struct Projection {
    V3d along, u, v; // u × v = along: seen from outside, nothing is mirrored
};

Projection projectionAlong(const V3d& along, const V3d& up) {
    V3d v = up - along * up.dot(along);
    if (v.length() < 0.05 * up.length()) {
        const V3d other = std::abs(along.x) < 0.9 ? V3d(1, 0, 0) : V3d(0, 0, 1);
        v = other - along * other.dot(along);
    }
    v.normalize();
    return {along, v.cross(along), v};
}

/// Patches of the surface by number, and which patches meet along which edges.
struct Patches {
    std::vector<int> of; ///< per triangle
    int count = 0;
};

class Adjacency {
  public:
    explicit Adjacency(const SurfaceMesh& surface) : next_(surface.triangles.size(), {-1, -1, -1}) {
        std::unordered_map<std::uint64_t, std::pair<int, int>> open;
        open.reserve(2 * surface.triangles.size());
        for (std::size_t t = 0; t < surface.triangles.size(); ++t)
            for (int e = 0; e < 3; ++e) {
                const auto a = std::uint32_t(surface.triangles[t][e]), b = std::uint32_t(surface.triangles[t][(e + 1) % 3]);
                // Only the same edge run through the other way: sheets back to back stay apart.
                const auto other = open.find(std::uint64_t(b) << 32 | a);
                if (other != open.end()) {
                    next_[t][e] = other->second.first;
                    next_[other->second.first][other->second.second] = static_cast<int>(t);
                    open.erase(other);
                } else {
                    open.emplace(std::uint64_t(a) << 32 | b, std::make_pair(static_cast<int>(t), e));
                }
            }
    }
    const std::array<int, 3>& of(int triangle) const { return next_[triangle]; }

  private:
    std::vector<std::array<int, 3>> next_;
};

Patches connect(const Adjacency& adjacency, const std::vector<int>& label) {
    Patches patches;
    patches.of.assign(label.size(), -1);
    std::vector<int> stack;
    for (int seed = 0; seed < static_cast<int>(label.size()); ++seed) {
        if (patches.of[seed] >= 0)
            continue;
        patches.of[seed] = patches.count;
        stack.push_back(seed);
        while (!stack.empty()) {
            const int t = stack.back();
            stack.pop_back();
            for (const int n : adjacency.of(t))
                if (n >= 0 && patches.of[n] < 0 && label[n] == label[t]) {
                    patches.of[n] = patches.count;
                    stack.push_back(n);
                }
        }
        ++patches.count;
    }
    return patches;
}

/// Patches whose projections lie on themselves (a spiral, drapery over drapery) are taken apart: each part grows from its
/// first triangle as long as nothing is in the way.
Patches separateOverlaps(const SurfaceMesh& surface, const Adjacency& adjacency, const Patches& given,
                         const std::vector<Projection>& projections) {
    const std::size_t count = surface.triangles.size();
    double edges = 0.0;
    for (const V3i& t : surface.triangles)
        edges += (V3d(surface.positions[t[1]]) - V3d(surface.positions[t[0]])).length();
    // A mesh of few long triangles must not be sorted into millions of squares.
    double extent = 0.0;
    for (const Imath::V3f& p : surface.positions)
        extent = std::max(extent, (V3d(p) - V3d(surface.positions[0])).length());
    const double cell = std::max({edges / static_cast<double>(count), extent / 512.0, 1e-30});
    Patches parts;
    parts.of.assign(count, -1);
    std::deque<int> front;
    for (int seed = 0; seed < static_cast<int>(count); ++seed) {
        if (parts.of[seed] >= 0)
            continue;
        const int patch = given.of[seed];
        const Projection& projection = projections[patch];
        FlatTriangles taken(cell);
        front.assign(1, seed);
        while (!front.empty()) {
            const int t = front.front();
            front.pop_front();
            if (parts.of[t] >= 0)
                continue;
            FlatTriangle flat;
            for (int c = 0; c < 3; ++c) {
                const V3d p(surface.positions[surface.triangles[t][c]]);
                flat[c] = V2d(p.dot(projection.u), p.dot(projection.v));
            }
            if (!taken.add(flat))
                continue;
            parts.of[t] = parts.count;
            for (const int n : adjacency.of(t))
                if (n >= 0 && parts.of[n] < 0 && given.of[n] == patch)
                    front.push_back(n);
        }
        ++parts.count;
    }
    return parts;
}

int dominantLabel(const V3d& n) {
    int axis = 0;
    for (int i = 1; i < 3; ++i)
        if (std::abs(n[i]) > std::abs(n[axis]))
            axis = i;
    return 2 * axis + (n[axis] < 0.0);
}

V3d axisOf(int label) {
    V3d axis(0.0);
    axis[label / 2] = label % 2 ? -1.0 : 1.0;
    return axis;
}

/// Patches below a hundredth of the area take the label of the neighbour they share most edges with, where all of
/// their triangles face its axis at all.
void joinSmallPatches(const Adjacency& adjacency, const std::vector<V3d>& areas, std::vector<int>& label) {
    double total = 0.0;
    for (const V3d& area : areas)
        total += area.length();
    for (int pass = 0; pass < 4; ++pass) {
        const Patches patches = connect(adjacency, label);
        std::vector<double> size(patches.count, 0.0);
        std::vector<std::array<int, 6>> border(patches.count, {0, 0, 0, 0, 0, 0});
        std::vector<std::array<char, 6>> faces(patches.count, {1, 1, 1, 1, 1, 1});
        for (std::size_t t = 0; t < label.size(); ++t) {
            const int p = patches.of[t];
            size[p] += areas[t].length();
            for (const int n : adjacency.of(static_cast<int>(t)))
                if (n >= 0 && label[n] != label[t])
                    ++border[p][label[n]];
            for (int l = 0; l < 6; ++l)
                if (areas[t].dot(axisOf(l)) < 0.15 * areas[t].length())
                    faces[p][l] = 0;
        }
        std::vector<int> change(patches.count, -1);
        bool any = false;
        for (int p = 0; p < patches.count; ++p) {
            int best = -1;
            for (int l = 0; l < 6; ++l)
                if (faces[p][l] && border[p][l] > 0 && (best < 0 || border[p][l] > border[p][best]))
                    best = l;
            if (size[p] < 0.01 * total && best >= 0) {
                change[p] = best;
                any = true;
            }
        }
        if (!any)
            return;
        for (std::size_t t = 0; t < label.size(); ++t)
            if (change[patches.of[t]] >= 0)
                label[t] = change[patches.of[t]];
    }
}

struct Chart {
    V2d low{1e300, 1e300}, high{-1e300, -1e300}; ///< projected, scene units
    V2d place{0.0, 0.0};                          ///< of its low corner in the tile
    V2d size() const { return high - low; }
};

/// Rows of charts, tallest first, at `scale` tile widths per scene unit. \return whether they fit
bool pack(std::vector<Chart>& charts, const std::vector<int>& order, double scale, double gap) {
    double x = gap, y = gap, rowHeight = 0.0;
    for (const int c : order) {
        const V2d size = charts[c].size() * scale;
        if (x + size.x + gap > 1.0) {
            y += rowHeight + gap;
            x = gap;
            rowHeight = 0.0;
        }
        if (x + size.x + gap > 1.0 + 1e-12 || y + size.y + gap > 1.0 + 1e-12)
            return false;
        charts[c].place = {x, y};
        x += size.x + gap;
        rowHeight = std::max(rowHeight, size.y);
    }
    return true;
}

} // namespace

void makeProjectedCharts(SurfaceMesh& surface, const V3d& up, int resolution, int gapTexels) {
    const std::size_t count = surface.triangles.size();
    std::vector<V3d> areas(count);
    V3d sum(0.0);
    for (std::size_t t = 0; t < count; ++t) {
        const V3i& c = surface.triangles[t];
        const V3d a(surface.positions[c[0]]);
        areas[t] = (V3d(surface.positions[c[1]]) - a).cross(V3d(surface.positions[c[2]]) - a);
        sum += areas[t];
    }
    surface.uvs.clear();
    surface.triangleUvs.assign(count, V3i(0));
    if (count == 0)
        return;

    const V3d mean = sum.length() > 0.0 ? sum.normalized() : V3d(0, 0, 1);
    const bool facesOneWay = std::all_of(areas.begin(), areas.end(),
                                         [&](const V3d& area) { return area.dot(mean) >= 0.5 * area.length(); });
    const Adjacency adjacency(surface);
    std::vector<int> label(count, 0);
    if (!facesOneWay) {
        for (std::size_t t = 0; t < count; ++t)
            label[t] = dominantLabel(areas[t]);
        joinSmallPatches(adjacency, areas, label);
    }
    const auto projectionsOf = [&](const Patches& patches) {
        std::vector<Projection> projections(patches.count);
        for (std::size_t t = 0; t < count; ++t)
            projections[patches.of[t]] = projectionAlong(facesOneWay ? mean : axisOf(label[t]), up);
        return projections;
    };
    const Patches connected = connect(adjacency, label);
    const Patches patches = separateOverlaps(surface, adjacency, connected, projectionsOf(connected));
    const std::vector<Projection> projections = projectionsOf(patches);

    // One UV per vertex and patch.
    std::vector<Chart> charts(patches.count);
    std::vector<V2d> flat;
    std::vector<int> chartOf;
    std::unordered_map<std::uint64_t, int> indices;
    for (std::size_t t = 0; t < count; ++t)
        for (int c = 0; c < 3; ++c) {
            const int vertex = surface.triangles[t][c], patch = patches.of[t];
            const auto key = std::uint64_t(std::uint32_t(vertex)) << 32 | std::uint32_t(patch);
            const auto [found, isNew] = indices.emplace(key, static_cast<int>(flat.size()));
            if (isNew) {
                const V3d p(surface.positions[vertex]);
                const V2d uv(p.dot(projections[patch].u), p.dot(projections[patch].v));
                flat.push_back(uv);
                chartOf.push_back(patch);
                for (int i = 0; i < 2; ++i) {
                    charts[patch].low[i] = std::min(charts[patch].low[i], uv[i]);
                    charts[patch].high[i] = std::max(charts[patch].high[i], uv[i]);
                }
            }
            surface.triangleUvs[t][c] = found->second;
        }

    std::vector<int> order(charts.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        const double ha = charts[a].size().y, hb = charts[b].size().y;
        return ha != hb ? ha > hb : a < b;
    });
    // Where there are so many charts that their gaps alone fill the tile, the gaps shrink.
    double gap = double(gapTexels) / resolution;
    gap = std::min(gap, 0.25 / std::sqrt(double(charts.size())));
    double longest = 0.0;
    for (const Chart& chart : charts)
        longest = std::max({longest, chart.size().x, chart.size().y});
    double low = 0.0, high = longest > 0.0 ? 1.0 / longest : 1.0;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (pack(charts, order, middle, gap) ? low : high) = middle;
    }
    pack(charts, order, low, gap);
    surface.uvs.reserve(flat.size());
    for (std::size_t i = 0; i < flat.size(); ++i) {
        const Chart& chart = charts[chartOf[i]];
        surface.uvs.emplace_back(V2f(chart.place + (flat[i] - chart.low) * low));
    }
}

void makeProjectedCharts(Mesh& mesh, const V3d& up, int resolution, int gapTexels) {
    SurfaceMesh surface;
    surface.positions = mesh.positions;
    for (std::size_t i = 0; i + 2 < mesh.faceVertices.size(); i += 3)
        surface.triangles.emplace_back(mesh.faceVertices[i], mesh.faceVertices[i + 1], mesh.faceVertices[i + 2]);
    makeProjectedCharts(surface, up, resolution, gapTexels);
    mesh.uvs = std::move(surface.uvs);
    mesh.faceUvs.clear();
    for (const V3i& uv : surface.triangleUvs)
        mesh.faceUvs.insert(mesh.faceUvs.end(), {uv[0], uv[1], uv[2]});
}

} // namespace patina
