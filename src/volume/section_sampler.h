#pragma once
// Cuts through a volume: what lies where, and the line along which a plane cuts the metal.

#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <memory>
#include <optional>
#include <vector>

namespace patina {

/// Reads regions of the nest at points. Valid while the volume is unchanged; safe from any thread.
class SectionSampler {
  public:
    explicit SectionSampler(const LayerVolume& volume);
    ~SectionSampler();
    SectionSampler(SectionSampler&&) noexcept;

    static constexpr int air = -1;

    /// What is at a point (scene units): 0 the metal, k layer k, or air. Beyond the band: metal or air.
    int regionAt(const Imath::V3d& point) const;

    /// A point of the metal's surface.
    struct Foot {
        Imath::V3d position; ///< scene units
        Imath::V3d normal;   ///< outward, unit
    };

    /// The foot of a point on the metal's surface, where Newton steps lead to it within `reach` voxels.
    std::optional<Foot> foot(const Imath::V3d& point, double reach = 6.0) const;

    /// Follows the metal's surface in a plane, both ways from the foot of `start`.
    /// \param along  the direction in which the line runs at first; its part in the tangent plane counts
    /// \param step, count  scene units between points, and their number; the start is the middle one
    /// \return `count` feet; those that the line does not reach (it ends, or leaves the band) are empty
    /// \throws RunError where there is no metal within a few voxels of the start
    std::vector<std::optional<Foot>> trace(const Imath::V3d& start, const Imath::V3d& along, double step,
                                           int count) const;

    /// A place whose stack is most like the mean one: where a core sample says most.
    Foot typicalPlace() const;

  private:
    struct Nest;
    std::unique_ptr<Nest> nest_;
};

} // namespace patina
