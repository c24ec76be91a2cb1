#pragma once
// From the maps of a checked script to functions over the surface.

#include "base/progress.h"
#include "operators/fields/field_store.h"
#include "operators/growth/grow.h"
#include "operators/growth/growth_lattice.h"
#include "operators/growth/growth_statistics.h"
#include "operators/growth/voxel_growth.h"
#include "operators/maps/thickness_map.h"
#include "script/program.h"
#include "surface/ray_scene.h"
#include "volume/region_context.h"
#include "volume/region_model.h"
#include "volume/surface_binding.h"

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace patina {

/// What maps need to know about the run.
struct MapContext {
    LayerVolume* volume = nullptr; ///< where fields are computed and kept
    const SurfaceBinding* binding = nullptr;
    double unitsPerRealUm = 1e-6; ///< scene units per micrometre of the model (not exaggerated)
    double voxelSize = 0.0;       ///< scene units of the model; growth patterns are filtered to it
    double longestSide = 0.0;     ///< of the whole model, scene units
    Imath::V3d up{0.0, 1.0, 0.0};
    std::uint64_t seed = 0;
    const RegionModel* region = nullptr;    ///< of a close-up: patterns, shadows and heights are then the whole model's
    const ContextFields* context = nullptr; ///< of a close-up: the whole model's fields
};

/// Model, rate and step of a growth: what its history depends on apart from sizes and maps.
GrowthOptions historyOf(const GrowthCall& call);

/// Builds maps and keeps the growth lattices (one per pitch) that they share.
class MapBuilder {
  public:
    explicit MapBuilder(const MapContext& context) : context_(context) {}

    /// Of a region, too, the result is to be asked in the model's coordinates, with triangles of RegionModel::work().
    /// \throws ModelError, RunError where a texture or an attribute cannot be had; Interrupted
    ThicknessMapPtr build(const Expression& expression, Progress& progress);

    /// What a coat of this map is where it grows in the voxel lattice: the first growth among the map's factors, which
    /// the others multiply. Nothing where the map is no such product, or the coat too thin for voxels
    /// (growsInVoxels()). Where the script gives no size, cells are voxels, but of a whole model no finer than 1/512 of
    /// its longest side.
    struct CoatGrowth {
        const GrowthLattice& lattice;
        VoxelGrowth growth;
    };
    std::optional<CoatGrowth> buildVoxelGrowth(const Expression& expression, double thicknessUm,
                                               const VolumeScale& scale, Progress& progress);
    /// Of a growth that coatByVoxelGrowth() has made.
    void noteStatistics(const GrowthStatistics& statistics) { statistics_.push_back(statistics); }

    /// Statistics of the growths built since the last call, in order.
    std::vector<GrowthStatistics> takeStatistics();

  private:
    struct GrowthSetup {
        const GrowthLattice& cells;
        GrowthOptions options;
        std::vector<float> flux; ///< BD on cells with `from`: what heights are multiplied by; empty: 1
    };
    /// \param asHeights  for a map of thickness, not for voxels
    GrowthSetup setUpGrowth(const GrowthCall& call, double cell, bool asHeights, Progress& progress);
    double cellOf(const GrowthCall& call, double byDefault) const;
    ThicknessMapPtr buildGrowth(const GrowthCall& call, Progress& progress);
    /// grow(), or what it made for a map shortly before: frames of a series ask for the last one's step again, and for
    /// later ones, which go on from it.
    std::shared_ptr<const GrowthPattern> pattern(const GrowthLattice& cells, const GrowthOptions& options,
                                                 const std::string& label, Progress& progress,
                                                 bool keepsStepBefore = true);
    ThicknessMapPtr buildCall(const Expression& expression, Progress& progress);
    ThicknessMapPtr buildField(const Expression& expression, Progress& progress);
    FieldStore& fieldStore();
    ThicknessMapPtr ofField(const std::string& name, const std::function<ThicknessMapPtr(FieldStore&)>& compute);
    const GrowthLattice& lattice(double cell, double marginCells);
    const SurfaceMesh& mapSurface() const; ///< what texture() and vertices() are asked on
    std::vector<float> perCell(const GrowthLattice& lattice, const ThicknessMap& map) const;
    std::vector<float> arrivalFrom(const GrowthLattice& lattice, const Imath::V3d& direction) const;

    MapContext context_;
    /// The part of the whole model from which the patterns of a region grow, with rays to it.
    struct GrowthPiece {
        SurfaceMesh surface;
        RayScene scene;
    };

    /// By pitch, and of a region by margin.
    std::map<std::pair<double, double>, std::unique_ptr<GrowthLattice>> lattices_;
    std::map<const GrowthLattice*, std::unique_ptr<GrowthPiece>> pieces_; ///< of a region
    const SurfaceMesh* cellSurface_ = nullptr;                            ///< while maps are built for cells of a piece
    std::vector<GrowthStatistics> statistics_;
    std::unique_ptr<FieldStore> fields_;
    /// A step of a history: what all its options but the step make it.
    struct Grown {
        std::string history;
        double step;
        std::shared_ptr<const GrowthPattern> pattern;
    };
    std::deque<Grown> recent_;   ///< newest last
    std::uint64_t followed_ = 0; ///< arrivals, for the growth that is being built
};

} // namespace patina
