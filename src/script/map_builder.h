#pragma once
// From the maps of a checked script to functions over the surface.

#include "base/progress.h"
#include "operators/growth/growth_lattice.h"
#include "operators/growth/growth_statistics.h"
#include "operators/maps/thickness_map.h"
#include "script/program.h"
#include "volume/surface_binding.h"

#include <map>
#include <memory>

namespace patina {

/// What maps need to know about the run.
struct MapContext {
    const SurfaceBinding* binding = nullptr;
    double unitsPerRealUm = 1e-6; ///< scene units per micrometre of the model (not exaggerated)
    double voxelSize = 0.0;       ///< scene units; growth patterns are filtered to it
    double longestSide = 0.0;     ///< of the whole model, scene units
    Imath::V3d up{0.0, 1.0, 0.0};
    std::uint64_t seed = 0;
};

/// Builds maps and keeps the growth lattices (one per pitch) that they share.
class MapBuilder {
  public:
    explicit MapBuilder(const MapContext& context) : context_(context) {}

    /// \throws ModelError, RunError where a texture or an attribute cannot be had; Interrupted
    ThicknessMapPtr build(const Expression& expression, Progress& progress);

    /// Statistics of the growths built since the last call, in order.
    std::vector<GrowthStatistics> takeStatistics();

  private:
    ThicknessMapPtr buildGrowth(const GrowthCall& call, Progress& progress);
    ThicknessMapPtr buildCall(const Expression& expression, Progress& progress);
    ThicknessMapPtr buildField(const Expression& expression) const;
    const GrowthLattice& lattice(double cell);
    std::vector<float> perCell(const GrowthLattice& lattice, const ThicknessMap& map) const;
    std::vector<float> arrivalFrom(const GrowthLattice& lattice, const Imath::V3d& direction) const;

    MapContext context_;
    std::map<double, std::unique_ptr<GrowthLattice>> lattices_;
    std::vector<GrowthStatistics> statistics_;
};

} // namespace patina
