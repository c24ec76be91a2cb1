#include "volume/patch_contact.h"

#include <algorithm>
#include <cmath>

namespace patina {

void ContactBounds::reserve(std::size_t count) {
    for (std::vector<float>* list : {&x_, &y_, &z_, &normalX_, &normalY_, &normalZ_, &far_, &thick_})
        list->reserve(count);
}

void ContactBounds::add(const Imath::V3f& point, const SurfaceContacts& contacts, std::size_t seed) {
    constexpr float rounding = 1e-3f;
    const SurfacePatch& patch = contacts.seeds().patches[seed];
    // Pieces of an edge have no side: a ball around them.
    const Imath::V3f normal = patch.crease ? Imath::V3f(0.f) : patch.normal;
    x_.push_back(point.x);
    y_.push_back(point.y);
    z_.push_back(point.z);
    normalX_.push_back(normal.x);
    normalY_.push_back(normal.y);
    normalZ_.push_back(normal.z);
    far_.push_back(contacts.reachOf(seed) + rounding);
    thick_.push_back(contacts.heightOf(seed) + rounding);
}

void ContactBounds::pad() {
    while (x_.size() % lanes != 0) {
        for (std::vector<float>* list : {&x_, &y_, &z_})
            list->push_back(1e9f);
        for (std::vector<float>* list : {&normalX_, &normalY_, &normalZ_, &far_, &thick_})
            list->push_back(0.f);
    }
}

PatchContact::PatchContact(const SurfaceContacts& contacts) : contacts_(contacts) {
    const PointBlocks& points = contacts.seeds().points;
    boxes_.resize(points.blocks.size());
    bound_.resize(points.blocks.size());
    bounds_.reserve(points.size() + 4 * points.blocks.size());
    for (std::size_t b = 0; b < boxes_.size(); ++b) {
        bound_[b] = static_cast<std::uint32_t>(bounds_.size());
        for (std::uint32_t s = points.blocks[b].begin; s < points.blocks[b].end; ++s) {
            const Imath::V3f point(points.x[s], points.y[s], points.z[s]);
            boxes_[b].extendBy(point);
            bounds_.add(point, contacts, s);
        }
        bounds_.pad();
    }
}

bool PatchContact::standsIn(std::uint32_t seed, const Imath::V3f& fromSeed, float distance) const {
    const SurfaceContacts::Points contacts = contacts_.of(seed);
    return std::any_of(contacts.begin(), contacts.end(), [&](const Imath::V3f& q) {
        const Imath::V3f away = fromSeed - q;
        return away.dot(away) < distance * distance;
    });
}

bool PatchContact::isClear(const openvdb::Coord& block, const Imath::V3f& point, float distance,
                           std::int32_t& guess) const {
    const PointBlocks& points = contacts_.seeds().points;
    if (guess >= 0 && standsIn(static_cast<std::uint32_t>(guess), point - points.from(block, guess), distance))
        return false;
    const float limit = ContactBounds::squaredReach(distance), reach = std::sqrt(limit);
    openvdb::Coord low, high;
    for (int axis = 0; axis < 3; ++axis) {
        // A seed that was moved onto a crease may have left its block by less than a voxel.
        low[axis] = std::max(block[axis] + int(std::floor((point[axis] - reach - 1.f) / 8.f)),
                             points.lattice.box().min()[axis]);
        high[axis] = std::min(block[axis] + int(std::floor((point[axis] + reach + 1.f) / 8.f)),
                              points.lattice.box().max()[axis]);
    }
    for (int i = low.x(); i <= high.x(); ++i)
        for (int j = low.y(); j <= high.y(); ++j)
            for (int k = low.z(); k <= high.z(); ++k) {
                const std::int32_t number = points.lattice.at({i, j, k});
                if (number < 0)
                    continue;
                const Imath::V3f c =
                    point - Imath::V3f(float(i - block.x()), float(j - block.y()), float(k - block.z())) * 8.f;
                float apart = 0.f;
                for (int axis = 0; axis < 3; ++axis) {
                    const float d =
                        std::max({boxes_[number].min[axis] - c[axis], c[axis] - boxes_[number].max[axis], 0.f});
                    apart += d * d;
                }
                if (apart >= limit)
                    continue;
                const PointBlocks::Block& seeds = points.blocks[number];
                for (std::uint32_t s = seeds.begin; s < seeds.end; s += ContactBounds::lanes) {
                    unsigned near = bounds_.near(bound_[number] + (s - seeds.begin), c, distance);
                    for (std::uint32_t l = 0; near; ++l, near >>= 1) {
                        if (!(near & 1u))
                            continue;
                        const std::uint32_t seed = s + l;
                        if (standsIn(seed, c - Imath::V3f(points.x[seed], points.y[seed], points.z[seed]), distance)) {
                            guess = static_cast<std::int32_t>(seed);
                            return false;
                        }
                    }
                }
            }
    return true;
}

} // namespace patina
