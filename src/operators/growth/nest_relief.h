#pragma once
// What arriving particles find: how high the nest stands, and whose way it is in.

#include "operators/growth/growth_lattice.h"
#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <memory>
#include <vector>

namespace patina {

/// Height of the nest's surface above the bare metal at every cell, scene units as drawn; the outermost where a normal
/// crosses it more than once, 0 where the metal itself was eroded.
/// \param origin, magnification  where the volume lies in the lattice's coordinates (a region's), as in VoxelGrowth
std::vector<float> nestHeights(const LayerVolume& volume, const GrowthLattice& lattice, const Imath::V3d& origin,
                               double magnification);

/// Shadows that the nest as it stands throws on itself: layers and all, which rays against the bare model miss.
/// Valid while the volume is unchanged; safe from any thread.
class NestShadow {
  public:
    explicit NestShadow(const LayerVolume& volume);
    ~NestShadow();

    /// Whether a particle that comes from `towards` (unit) to the place above a point of the model is stopped on its
    /// way through the volume's band. What lies beyond the band is for rays against the model to say.
    /// \param point, normal  of the bare model, the volume's coordinates
    /// \param clearance  how far above the surface the ray begins, scene units
    bool falls(const Imath::V3d& point, const Imath::V3d& normal, const Imath::V3d& towards, double clearance) const;

  private:
    struct Nest;
    std::unique_ptr<const Nest> nest_;
};

} // namespace patina
