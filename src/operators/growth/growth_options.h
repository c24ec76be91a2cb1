#pragma once
// Which growth model, how far, and what steers it.

#include "operators/growth/growth_rate.h"

#include <Imath/ImathVec.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patina {

/// The models of the paper's section 3.3, by the names scripts use.
enum class GrowthModel {
    steadyThickening,    ///< ST
    randomDeposition,    ///< RD
    relaxation,          ///< RDR: random deposition with surface relaxation
    ballisticDeposition, ///< BD
    directedPercolation, ///< DPD, as the paper describes it
    barabasiStanley,     ///< DPD_BS: directed percolation depinning as Barabási and Stanley define it
};

/// "ST", "RD", "RDR", "BD", "DPD", "DPD_BS".
std::optional<GrowthModel> growthModelNamed(std::string_view name);
std::vector<std::string> growthModelNames();
std::string growthModelName(GrowthModel model);

/// One step of one history. Lengths are in cells, times in monolayers of age, rates per monolayer.
struct GrowthOptions {
    GrowthModel model = GrowthModel::randomDeposition;
    GrowthRate rate = GrowthRate::linear;
    double step = 1;
    double total = 1;
    bool ofFull = false; ///< factors relative to the last step instead of this one

    int reach = 1; ///< RDR: steps along the surface within which a particle seeks the lowest place

    int patch = 10;               ///< DPD: side of a seed patch, cells
    double firstSeeds = 3e-4;     ///< DPD: seed patches per cell that are there from the start
    double seeding = 1e-4;        ///< DPD: seed patches per cell and monolayer that come with time
    double blockedFraction = 0.5; ///< DPD, DPD_BS: of the cells (DPD_BS: of the voxels above them); 0…1
    double spread = 2.0;          ///< DPD: rate at which a cell takes an unblocked neighbour
    double blockedSpread = 0.08;  ///< DPD: rate at which it takes a blocked one; 0: blocks cannot be passed
    double thickening = 0.5;      ///< DPD: rate at which a fully supported cell rises by a level

    double pointSpacing = 48; ///< ST: least distance of the sample points, cells

    /// BD: towards the source, unit: particles come on straight tracks from there and touch first what stands in their way.
    /// 0: along the normal. How many come (the cosine, shadows of the object) is for `arrival` to say.
    Imath::V3d from{0.0, 0.0, 0.0};
    double levelHeight = 1.0; ///< BD with `from`: of a level, in cells; 0 < levelHeight <= 64

    std::vector<float> arrival; ///< per cell, 0…1: fraction of the particles that arrive; empty: all
    std::vector<float> blocked; ///< per cell, 0…1: in place of blockedFraction; empty: that
    std::vector<float> relief;  ///< per cell, levels: how high what is there already stands; RDR and BD see it; empty: flat
    std::vector<int> seedCells; ///< DPD: cells seeded at the start besides the random ones

    double age() const { return growthAge(rate, step, total); }
};

/// The spacing at which about `points` sample points cover `area` (scene units²) of the whole model; in cells.
double pointSpacingFor(int points, double area, double cell);

} // namespace patina
