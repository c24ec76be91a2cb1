#pragma once
// Where the balls of a closing may stand. Includes OpenVDB: for sources only.

#include "base/progress.h"
#include "volume/distance.h"
#include "volume/patch_contact.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

/// The balls of one radius that touch a surface from outside without cutting it. Their centres are {D = r}, D being the
/// distance outside: only voxels within two of it are looked at. A ball's place is solved from the surface patches that
/// it touches, so that the centres over a crease, where two or three patches hold the ball, are as exact as elsewhere.
class ClosingBalls {
  public:
    /// \param radius  voxels
    /// \param fromOutside  only balls that can come from outside, rolling within {D >= r}
    ClosingBalls(const DistanceTransform& surface, const SurfaceContacts& contacts, double radius, bool fromOutside,
                 Progress& progress);

    /// Points near {D = r}, about one in each lattice cell that it crosses.
    const PointBlocks& centres() const { return centres_; }

    /// The distance to the closest centre of a ball from x; both in voxels from a block's origin.
    /// \param start  the nearest of centres()
    float distance(const openvdb::Coord& block, const Imath::V3f& x, std::int32_t start) const;

    /// Whether a ball touches the surface at a point of it (in voxels from a block's origin): D(p + r n) >= r -
    /// contactTolerance for one of its normals n. Then the closing changes nothing there. False in doubt.
    /// \param guess  a seed that may be in the way, as PatchContact::isClear() takes it
    bool touches(const openvdb::Coord& block, const TouchPoint& point, std::int32_t& guess) const;
    bool touches(std::int32_t seed, std::int32_t& guess) const;

    /// Takes from `voxels` those of a block that are further from the surface than a ball's centre: open air.
    void dropOpen(const openvdb::Coord& block, std::uint64_t* voxels) const;

  private:
    struct ShellBlock {
        openvdb::Coord block;
        std::array<std::int32_t, 512> seed; ///< nearest to the voxel, or NearestInBlock::further, closer
    };
    /// Patches that may hold a ball: those nearest to the corners of the cells that its centre has been in.
    struct Patches {
        std::array<std::int32_t, 24> seed;
        std::array<Imath::V3f, 24> point; ///< the seed's own, in voxels from the block's origin
        int count = 0;
        openvdb::Coord cell = openvdb::Coord::max(); ///< the last that was looked at
        bool holds(std::int32_t s) const;
    };

    static constexpr std::int32_t blocked = -1, freeBlock = -2;

    bool fits(const openvdb::Coord& block, const Imath::V3f& centre, std::int32_t& guess) const;
    void findShell(Progress& progress);
    void keepReachable();
    void placeCentres(Progress& progress);
    void centresOfBlock(std::size_t n, std::vector<Imath::V3f>& found) const;
    std::int32_t seedAt(const openvdb::Coord& voxel) const;
    /// Whether the patch was not there yet.
    bool addPatch(const openvdb::Coord& block, std::int32_t seed, Patches& patches) const;
    /// Adds the patches nearest to the corners of the cell that a point is in; whether there were new ones.
    bool addPatches(const openvdb::Coord& block, const Imath::V3f& point, Patches& patches) const;
    /// The point closest to x at which the ball cuts none of the patches. \return whether one was found near `centre`
    bool place(const openvdb::Coord& block, const Imath::V3f& x, Patches& patches, Imath::V3f& centre,
               bool mayAdd) const;
    /// From the foot on the patch to a point.
    Imath::V3f fromFoot(const Patches& patches, int i, const Imath::V3f& point) const {
        const Imath::V3f w = point - patches.point[i];
        return w - surface_.seeds().patches[patches.seed[i]].foot(w);
    }
    float clearance(const Imath::V3f& point, const Patches& patches) const;

    const DistanceTransform& surface_;
    PatchContact contact_;
    float radius_;
    BlockBox lattice_; ///< block to shell block; or blocked, free
    std::vector<ShellBlock> shell_;
    std::vector<std::array<std::uint64_t, 8>> reachable_; ///< for each shell block, where asked for
    bool fromOutside_ = false;
    PointBlocks centres_;
};

} // namespace patina
