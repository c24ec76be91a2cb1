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
    ClosingBalls(const DistanceTransform& surface, double radius, bool fromOutside, Progress& progress);

    /// Points near {D = r}, about one in each lattice cell that it crosses.
    const PointBlocks& centres() const { return centres_; }

    /// The distance to the closest centre of a ball from x; both in voxels from a block's origin.
    /// \param start  the nearest of centres()
    float distance(const openvdb::Coord& block, const Imath::V3f& x, std::int32_t start) const;

    /// Whether a ball touches the surface at a point of it (in voxels from a block's origin), D(p + r n) >= r -
    /// contactTolerance: then the closing changes nothing there. False in doubt.
    bool touches(const openvdb::Coord& block, const PatchPoint& point) const;
    bool touches(std::int32_t seed) const;

  private:
    struct ShellBlock {
        openvdb::Coord block;
        std::array<std::int32_t, 512> seed; ///< nearest to the voxel, or NearestInBlock::further, closer
    };
    struct Patches {
        std::array<std::int32_t, 24> seed;
        int count = 0;
        bool add(std::int32_t s);
    };

    void findShell(Progress& progress);
    void keepReachable();
    void placeCentres(Progress& progress);
    void centresOfBlock(std::size_t n, std::vector<Imath::V3f>& found) const;
    std::int32_t seedAt(const openvdb::Coord& voxel) const;
    /// Adds the patches nearest to the corners of the cell that a point is in; whether there were new ones.
    bool addPatches(const openvdb::Coord& block, const Imath::V3f& point, Patches& patches) const;
    /// The point closest to x at which the ball cuts none of the patches. \return whether one was found near `centre`
    bool place(const openvdb::Coord& block, const Imath::V3f& x, Patches& patches, Imath::V3f& centre,
               bool mayAdd) const;
    float clearance(const openvdb::Coord& block, const Imath::V3f& point, const Patches& patches) const;

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
