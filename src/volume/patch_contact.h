#pragma once
// Whether patches of a surface stand in a ball. Includes OpenVDB: for sources only.

#include "volume/surface_contacts.h"

#include <Imath/ImathBox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace patina {

/// Where the contact points of many patches lie at most, as plain arrays: each patch's are within a disc of radius
/// `far` across its normal, `thick` to either side. Tells quickly that they stand clear of a ball.
class ContactBounds {
  public:
    static constexpr int lanes = 8;

    ContactBounds() = default;
    void reserve(std::size_t count);
    /// A patch; its point may be given from anywhere.
    void add(const Imath::V3f& point, const SurfaceContacts& contacts, std::size_t seed);
    /// How far from a patch's own point the nearest contact of a ball may be, squared.
    static float squaredReach(float distance) {
        return (distance + 1.01f * SurfaceContacts::furthest) * (distance + 1.01f * SurfaceContacts::furthest);
    }
    /// Fills up to whole lanes with what stands clear of any ball.
    void pad();
    std::size_t size() const { return x_.size(); }

    /// Of the patches `first` … `first + lanes - 1`, a bit for each with contact points that may be nearer than
    /// `distance` to c.
    unsigned near(std::size_t first, const Imath::V3f& c, float distance) const;

  private:
    std::vector<float> x_, y_, z_, normalX_, normalY_, normalZ_, far_, thick_;
};

/// Asks all patches of a surface that may meet a ball. Immutable; queries are safe from any thread.
class PatchContact {
  public:
    /// \param contacts  must outlive this
    explicit PatchContact(const SurfaceContacts& contacts);

    /// Whether no contact point is nearer than `distance` to a point, both in voxels, the point from a block's origin.
    /// \param guess  a seed whose patch may be nearer (the last answer), or -1: asked first, to save time. Set to the
    ///               seed that was found
    bool isClear(const openvdb::Coord& block, const Imath::V3f& point, float distance, std::int32_t& guess) const;

  private:
    bool standsIn(std::uint32_t seed, const Imath::V3f& fromSeed, float distance) const;

    const SurfaceContacts& contacts_;
    std::vector<Imath::Box3f> boxes_;  ///< of each block's seeds, in voxels from the block's origin
    std::vector<std::uint32_t> bound_; ///< of each block's first seed, index into bounds_
    ContactBounds bounds_;
};

inline unsigned ContactBounds::near(std::size_t first, const Imath::V3f& c, float distance) const {
    float apart[lanes], along[lanes], out[lanes], least = std::numeric_limits<float>::max();
    for (int l = 0; l < lanes; ++l) {
        const std::size_t i = first + l;
        const float dx = c.x - x_[i], dy = c.y - y_[i], dz = c.z - z_[i];
        apart[l] = dx * dx + dy * dy + dz * dz;
        along[l] = dx * normalX_[i] + dy * normalY_[i] + dz * normalZ_[i];
    }
    for (int l = 0; l < lanes; ++l)
        least = apart[l] < least ? apart[l] : least;
    if (!(least < squaredReach(distance)))
        return 0;
    for (int l = 0; l < lanes; ++l) {
        const std::size_t i = first + l;
        const float across2 = apart[l] - along[l] * along[l];
        const float across = std::sqrt(across2 > 0.f ? across2 : 0.f) - far_[i];
        const float side = across > 0.f ? across : 0.f;
        const float height = std::abs(along[l]) - thick_[i];
        const float above = height > 0.f ? height : 0.f;
        out[l] = side * side + above * above;
    }
    unsigned bits = 0;
    for (int l = 0; l < lanes; ++l)
        bits |= unsigned(out[l] < distance * distance) << l;
    return bits;
}

} // namespace patina
