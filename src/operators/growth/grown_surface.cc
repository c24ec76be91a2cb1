#include "operators/growth/grown_surface.h"

#include "volume/distance_seeds.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

// Voxels. Points are about one apart, so that planes this large leave no gap that counts and reach little beyond edges.
constexpr float planeReach = 0.6f;

} // namespace

GrownSurface::GrownSurface(const openvdb::FloatGrid& grid, const openvdb::FloatGrid& before, double voxelSize,
                           const std::vector<VoxelMask>* wanted)
    : grown_(grid), before_(leavesOf(before.tree())), points_(makeSurfacePoints(grown_, voxelSize, wanted)) {}

float GrownSurface::distance(const openvdb::Coord& block, int pos, std::int32_t point, bool& bare) const {
    const openvdb::Coord home = points_.blockOfPoint(point).block;
    const Imath::V3f local(points_.x[point], points_.y[point], points_.z[point]);
    const int cell[3] = {int(local.x), int(local.y), int(local.z)};
    float c[8];
    bare = true;
    for (int n = 0; n < 8; ++n) {
        const int x = cell[0] + (n >> 2), y = cell[1] + ((n >> 1) & 1), z = cell[2] + (n & 1);
        // A crossed cell has all its corners in the band.
        const auto leaf =
            std::size_t(grown_.lattice().at(home.x() + (x >> 3), home.y() + (y >> 3), home.z() + (z >> 3)));
        const int at = (x & 7) << 6 | (y & 7) << 3 | (z & 7);
        c[n] = grown_.leaves()[leaf]->buffer().data()[at];
        bare &= c[n] == before_[leaf]->buffer().data()[at];
    }
    const Imath::V3f p(local.x - float(cell[0]), local.y - float(cell[1]), local.z - float(cell[2]));
    const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
    const Imath::V3f gradient(mix(mix(c[4] - c[0], c[5] - c[1], p.z), mix(c[6] - c[2], c[7] - c[3], p.z), p.y),
                              mix(mix(c[2] - c[0], c[3] - c[1], p.z), mix(c[6] - c[4], c[7] - c[5], p.z), p.x),
                              mix(mix(c[1] - c[0], c[3] - c[2], p.y), mix(c[5] - c[4], c[7] - c[6], p.y), p.x));
    const openvdb::Coord apart = home - block;
    const Imath::V3f from(float(pos >> 6) - local.x - 8.f * float(apart.x()),
                          float((pos >> 3) & 7) - local.y - 8.f * float(apart.y()),
                          float(pos & 7) - local.z - 8.f * float(apart.z()));
    const float squared = from.length2(), slope = gradient.length();
    if (!(slope > 0.f))
        return std::sqrt(squared);
    const float height = from.dot(gradient) / slope;
    const float across = std::max(0.f, std::sqrt(std::max(0.f, squared - height * height)) - planeReach);
    return std::sqrt(height * height + across * across);
}

} // namespace patina
