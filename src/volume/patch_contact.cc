#include "volume/patch_contact.h"

#include <algorithm>
#include <cmath>

namespace patina {

PatchContact::PatchContact(const SurfaceSeeds& seeds) : seeds_(seeds) {
    const PointBlocks& points = seeds.points;
    boxes_.resize(points.blocks.size());
    for (std::size_t b = 0; b < boxes_.size(); ++b)
        for (std::uint32_t s = points.blocks[b].begin; s < points.blocks[b].end; ++s)
            boxes_[b].extendBy(Imath::V3f(points.x[s], points.y[s], points.z[s]));
}

bool PatchContact::isClear(const openvdb::Coord& block, const Imath::V3f& point, float distance) const {
    constexpr std::uint32_t lanes = 8;
    const PointBlocks& points = seeds_.points;
    const float limit = ContactPoints::squaredReach(distance), reach = std::sqrt(limit);
    openvdb::Coord low, high;
    for (int axis = 0; axis < 3; ++axis) {
        // A seed that was moved onto a crease may have left its block by less than a voxel.
        low[axis] = std::max(block[axis] + int(std::floor((point[axis] - reach - 1.f) / 8.f)),
                             points.lattice.box().min()[axis]);
        high[axis] = std::min(block[axis] + int(std::floor((point[axis] + reach + 1.f) / 8.f)),
                              points.lattice.box().max()[axis]);
    }
    const auto standsIn = [&](std::uint32_t s, const Imath::V3f& c) {
        const Imath::V3f w = c - Imath::V3f(points.x[s], points.y[s], points.z[s]);
        const ContactPoints contacts(seeds_.patches[s]);
        return std::any_of(contacts.at.begin(), contacts.at.end(), [&](const Imath::V3f& q) {
            const Imath::V3f away = w - q;
            return away.dot(away) < distance * distance;
        });
    };
    for (int i = low.x(); i <= high.x(); ++i)
        for (int j = low.y(); j <= high.y(); ++j)
            for (int k = low.z(); k <= high.z(); ++k) {
                const std::int32_t number = points.lattice.at({i, j, k});
                if (number < 0)
                    continue;
                const Imath::V3f c = point - Imath::V3f(float(i - block.x()), float(j - block.y()), float(k - block.z())) * 8.f;
                float apart = 0.f;
                for (int axis = 0; axis < 3; ++axis) {
                    const float d = std::max(
                        {boxes_[number].min[axis] - c[axis], c[axis] - boxes_[number].max[axis], 0.f});
                    apart += d * d;
                }
                if (apart >= limit)
                    continue;
                const std::uint32_t end = points.blocks[number].end;
                for (std::uint32_t s = points.blocks[number].begin; s < end; s += lanes) {
                    const std::uint32_t count = std::min(lanes, end - s);
                    float squared[lanes];
                    unsigned near = 0;
                    if (count == lanes) {
                        for (std::uint32_t l = 0; l < lanes; ++l) {
                            const float dx = points.x[s + l] - c.x, dy = points.y[s + l] - c.y,
                                        dz = points.z[s + l] - c.z;
                            squared[l] = dx * dx + dy * dy + dz * dz;
                        }
                        for (std::uint32_t l = 0; l < lanes; ++l)
                            near |= unsigned(squared[l] < limit) << l;
                    } else {
                        near = (1u << count) - 1u;
                    }
                    for (std::uint32_t l = 0; near; ++l, near >>= 1)
                        if ((near & 1u) && standsIn(s + l, c))
                            return false;
                }
            }
    return true;
}

} // namespace patina
