#pragma once
// The closest point of an interface to a voxel: where thicknesses, slopes and maps of that interface are read.
// Includes OpenVDB: for operators/ sources.

#include "operators/surface_operation.h"
#include "volume/nest_sampler.h"

namespace patina {

/// Whether the whole stack is so small a part of a voxel (less than a tenth) that the model's closest point serves all
/// interfaces, and their slope there is that of phi_0: 1, as of any true distance. (What they differ by is tangential,
/// s a voxel, and makes it the root of 1 + s².) The trilinear field's own is off by a percent on round surfaces, and by a
/// quarter beside sharp edges.
bool isThinStack(const LayerVolume& volume);

/// Finds feet on any interface of a nest. Valid while the nest is unchanged; safe from any thread.
class InterfaceFoot {
  public:
    explicit InterfaceFoot(const Workpiece& work);

    struct Foot {
        Imath::V3d position; ///< voxels
        SurfacePoint under;  ///< the model's point that a map is asked at; triangle -1 on the back of a sheet
    };

    /// The foot on phi_k of the active voxel `coord`, number `at` of the binding. Where the whole stack is a small part
    /// of a voxel the model's closest point serves all interfaces.
    Foot find(int k, const openvdb::Coord& coord, std::size_t at) const;

    /// |grad phi_k| at a foot, scene units per scene unit; 1 in a thin stack.
    double slope(int k, const Imath::V3d& position) const {
        return thinStack_ ? 1.0 : sampler_.slope(k, position) / voxelSize_;
    }

    const NestSampler& sampler() const { return sampler_; }

  private:
    const SurfaceBinding& binding_;
    NestSampler sampler_;
    double voxelSize_;
    bool thinStack_;
};

} // namespace patina
