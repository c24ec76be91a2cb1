#pragma once
// The stack along a normal: where each interface of the nest crosses it.

#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <memory>

namespace patina {

/// Reads thicknesses along the normal of the base surface (DESIGN: differences of crossings along the *same* line, so
/// that voxelisation errors larger than the patina cancel). Within a voxel of the base a thickness is the difference of
/// phi_0, a true distance, at two crossings: a film keeps it beside sharp edges, where the trilinear field is flatter,
/// and where the line leans over the base. From two voxels on it is the length of the line; between, a blend of both.
/// Heights are along the line everywhere. Valid while the volume is unchanged; safe from any thread.
class StackProbe {
  public:
    explicit StackProbe(const LayerVolume& volume);
    ~StackProbe();
    StackProbe(StackProbe&&) noexcept;

    struct Reading {
        bool found = false;       ///< whether there is a base near the point
        bool projected = false;   ///< it does not cross the normal, or grazes it (a crease, a thin edge): read at the
                                  ///< nearest crossing, along the base's own normal there
        double baseOffset = 0.0;  ///< signed distance from the point to the base crossing, scene units
        double height = 0.0;      ///< surface minus base along the normal, scene units as drawn (exaggerated); below 0
                                  ///< where the metal itself was eroded and not filled again
        double metalHeight = 0.0; ///< what is left of the metal minus base, <= 0
        /// Both again as thicknesses are measured, by phi_0 near the base: without pores the thicknesses lie between
        /// them.
        double distance = 0.0, metalDistance = 0.0;
    };

    /// \param point   on the base surface, scene units; the base must come within 3 voxels of it
    /// \param normal  outward, unit
    /// \param thicknessUm  receives each layer's thickness in real µm, bottom to top (layerCount() values, all >= 0)
    Reading read(const Imath::V3d& point, const Imath::V3d& normal, double* thicknessUm) const;

    /// The gradient of the height along the surface at a point that read() was asked for: how much steeper the
    /// outermost interface is there than the base; a vector in the plane of the normal, as drawn. 0 where read() found
    /// nothing or had to project.
    Imath::V3d reliefSlope(const Imath::V3d& point, const Imath::V3d& normal, const Reading& reading) const;

    int layerCount() const;

  private:
    struct Nest;
    std::unique_ptr<Nest> nest_;
};

} // namespace patina
