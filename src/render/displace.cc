#include "render/displace.h"

#include "base/errors.h"
#include "surface/weld.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

// Vertices at one place, sorted by place: `members[starts[i] … starts[i + 1])`.
struct Places {
    std::vector<int> members;
    std::vector<int> starts;
};

Places groupByPlace(const std::vector<V3f>& positions) {
    const std::vector<int> representative = weldedIndices(positions);
    Places places;
    places.members.resize(positions.size());
    std::iota(places.members.begin(), places.members.end(), 0);
    std::stable_sort(places.members.begin(), places.members.end(),
                     [&](int a, int b) { return representative[std::size_t(a)] < representative[std::size_t(b)]; });
    for (std::size_t i = 0; i < places.members.size(); ++i)
        if (i == 0 ||
            representative[std::size_t(places.members[i])] != representative[std::size_t(places.members[i - 1])])
            places.starts.push_back(int(i));
    places.starts.push_back(int(places.members.size()));
    return places;
}

// Calls f(vertex, other) for all pairs at one place whose original normals say that they are the same surface,
// each vertex with itself included, in a fixed order.
template <typename F>
void forEachTwin(const Places& places, const std::vector<V3f>& normals, F f) {
    for (std::size_t g = 0; g + 1 < places.starts.size(); ++g)
        for (int i = places.starts[g]; i < places.starts[g + 1]; ++i)
            for (int j = places.starts[g]; j < places.starts[g + 1]; ++j) {
                const int a = places.members[std::size_t(i)], b = places.members[std::size_t(j)];
                if (a == b || (normals[std::size_t(a)] ^ normals[std::size_t(b)]) > 0.5f)
                    f(std::size_t(a), std::size_t(b));
            }
}

// Sum of the triangles' unit normals, each by its angle at the vertex; in double, because heights of a film are a
// millionth of a statue.
std::vector<V3d> angleWeightedSums(const std::vector<V3d>& positions, const std::vector<V3i>& triangles) {
    std::vector<V3d> sums(positions.size(), V3d(0.0));
    // Angles in parallel, block by block; added up in the order of the triangles, whatever the threads.
    constexpr std::size_t block = 1 << 15;
    std::vector<V3d> parts(3 * std::min(block, triangles.size()));
    for (std::size_t begin = 0; begin < triangles.size(); begin += block) {
        const std::size_t end = std::min(triangles.size(), begin + block);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, 1024), [&](const auto& range) {
            for (std::size_t n = range.begin(); n != range.end(); ++n) {
                const V3i& t = triangles[n];
                const V3d corner[3] = {positions[std::size_t(t.x)], positions[std::size_t(t.y)],
                                       positions[std::size_t(t.z)]};
                const V3d cross = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
                const double area = cross.length();
                for (int i = 0; i < 3; ++i) {
                    const V3d a = corner[(i + 1) % 3] - corner[i], b = corner[(i + 2) % 3] - corner[i];
                    parts[3 * (n - begin) + std::size_t(i)] =
                        area > 0.0 ? cross / area * std::atan2(area, a ^ b) : V3d(0.0);
                }
            }
        });
        for (std::size_t n = begin; n < end; ++n)
            for (int i = 0; i < 3; ++i)
                sums[std::size_t(triangles[n][i])] += parts[3 * (n - begin) + std::size_t(i)];
    }
    return sums;
}

} // namespace

struct Displacer::Seams {
    const SurfaceMesh& surface;
    Places places;
    std::vector<V3d> normals; ///< geometric, angle-weighted, unit; of all vertices at a place together

    explicit Seams(const SurfaceMesh& of) : surface(of), places(groupByPlace(of.positions)) {
        std::vector<V3d> positions(surface.positions.size());
        std::transform(surface.positions.begin(), surface.positions.end(), positions.begin(),
                       [](const V3f& p) { return V3d(p); });
        normals = normalsOf(positions);
    }
    std::vector<V3d> normalsOf(const std::vector<V3d>& positions) const {
        const std::vector<V3d> sums = angleWeightedSums(positions, surface.triangles);
        std::vector<V3d> out(positions.size(), V3d(0.0));
        forEachTwin(places, surface.normals, [&](std::size_t a, std::size_t b) { out[a] += sums[b]; });
        for (V3d& normal : out)
            normal.normalize();
        return out;
    }
};

Displacer::Displacer(const SurfaceMesh& surface) : seams_(std::make_unique<const Seams>(surface)) {}
Displacer::~Displacer() = default;
Displacer::Displacer(Displacer&&) noexcept = default;

SurfaceMesh Displacer::displaced(const std::vector<float>& heights) const {
    const SurfaceMesh& surface = seams_->surface;
    const std::size_t count = surface.positions.size();
    if (heights.size() != count)
        throw RunError("displacement", fmt::format("{} heights for {} vertices", heights.size(), count));
    const auto bad = std::find_if(heights.begin(), heights.end(), [](float h) { return !std::isfinite(h); });
    if (bad != heights.end())
        throw RunError(fmt::format("displacement, vertex {}", bad - heights.begin()), "its height is not finite");

    SurfaceMesh out = surface;
    std::vector<V3d> after(count), shift(count, V3d(0.0));
    std::vector<double> twins(count, 0.0);
    forEachTwin(seams_->places, surface.normals, [&](std::size_t a, std::size_t b) {
        shift[a] += V3d(surface.normals[b]) * double(heights[b]);
        twins[a] += 1.0;
    });
    for (std::size_t i = 0; i < count; ++i) {
        after[i] = V3d(surface.positions[i]) + shift[i] / twins[i];
        out.positions[i] = V3f(after[i]);
    }
    const std::vector<V3d> normals = seams_->normalsOf(after);
    for (std::size_t i = 0; i < count; ++i) {
        const V3d tilt = normals[i] - seams_->normals[i];
        if (tilt == V3d(0.0))
            continue;
        const V3d normal = V3d(surface.normals[i]) + tilt;
        if (normal.length2() > 1e-12)
            out.normals[i] = V3f(normal.normalized());
    }
    return out;
}

SurfaceMesh displaced(const SurfaceMesh& surface, const std::vector<float>& heights) {
    return Displacer(surface).displaced(heights);
}

} // namespace patina
