#pragma once
// Which side of the model each voxel is on. Includes OpenVDB: for sources of volume/ only.

#include "surface/winding_number.h"
#include "volume/nest_grids.h"

#include <vector>

namespace patina {

/// The active voxels of a band, in groups that no surface divides.
///
/// Two neighbours whose distances to the surface add up to more than a voxel have nothing between them. Groups joined
/// so are on one side as a whole: one question to the winding number settles thousands of voxels, and cracks narrower
/// than a voxel let nothing leak. What is left are single voxels next to the surface.
class SideGroups {
  public:
    /// \param grid  distances (signs are ignored) in scene units, exact next to the surface
    SideGroups(const openvdb::FloatGrid& grid, double voxelSize);

    /// Whether all the groups of 32 voxels and more have the signs that the winding number gives them.
    bool agree(const WindingNumber& winding) const;
    /// Corrects the signs of the smaller groups, in the grid that this was made of.
    void correct(const WindingNumber& winding, openvdb::FloatGrid& grid) const;
    /// Gives every active voxel of the grid (of the same topology) its sign: inside where the winding number is at
    /// least a half. Groups that are not of one mind are asked voxel by voxel.
    void apply(const WindingNumber& winding, openvdb::FloatGrid& grid) const;

  private:
    struct Group {
        int size = 0;
        int samples[4] = {-1, -1, -1, -1}; ///< leaf * 512 + position of the deepest voxels, spread over the group
        float depths[4] = {0.f, 0.f, 0.f, 0.f};
    };
    enum Side : char { outside, inside, mixed, asItIs };
    void set(const std::vector<char>& side, const WindingNumber& winding, openvdb::FloatGrid& grid) const;
    Imath::V3d placeOf(int voxel) const;
    Side sideOf(const Group& group, const WindingNumber& winding) const;

    std::vector<const FloatLeaf*> leaves_;
    IndexSpace space_;
    double voxelSize_;
    std::vector<int> groupOf_; ///< per leaf and voxel; -1 where inactive
    std::vector<Group> groups_;
};

} // namespace patina
