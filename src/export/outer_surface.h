#pragma once
// Where the nest ends, for what a height along the normal cannot say.

#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <memory>
#include <optional>

namespace patina {

/// Reads the outermost interface around points of the base. Valid while the volume is unchanged; safe from any thread.
class OuterSurface {
  public:
    explicit OuterSurface(const LayerVolume& volume);
    ~OuterSurface();

    /// Whether the line leaves the outermost interface more than once before it comes nearer to another part of the
    /// model: an overhang, which a height map draws as a wall. \param floor  on the metal, scene units \param normal
    /// outward, unit
    bool foldsOver(const Imath::V3d& floor, const Imath::V3d& normal) const;

    /// Whether a height ends beside the outermost interface: the normal comes into metal opposite before it is out of the
    /// layers (a crease filled to the brim), or leaves them where no base is read. By more than a tenth of a voxel, beyond
    /// what lies between `foot` and the base. \param foot  where the height starts, on the base or near it, scene units
    /// \param end  where it ends
    bool misses(const Imath::V3d& foot, const Imath::V3d& end) const;

    /// The point of the outermost interface that belongs to a point of the metal: the end of the line along which
    /// phi_0 / (phi_0 - phi_n) grows fastest. These lines do not cross, start at right angles to the metal, arrive so
    /// at the interface, and spread into overhangs; closed pores are passed through. nullopt where the line cannot be
    /// followed.
    std::optional<Imath::V3d> above(const Imath::V3d& floor) const;

  private:
    struct Nest;
    std::unique_ptr<Nest> nest_;
};

} // namespace patina
