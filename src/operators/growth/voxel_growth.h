#pragma once
// Layers that grow in voxels (paper section 3.3): RD, RDR, BD and DPD where the drawn layer is thick enough to show
// particles.

#include "operators/growth/grow.h"
#include "operators/growth/growth_lattice.h"
#include "operators/growth/growth_options.h"
#include "operators/surface_operation.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace patina {

/// Where a layer is drawn at least this many voxels thick its particles occupy voxels; below, a growth is a map of
/// thickness (GrowthMap) for coat().
constexpr double thinnestVoxelGrowth = 4.0;

/// Particles of BD that are flatter than this (height as drawn to width) are flakes: their layer is a map of thickness at
/// any size of voxels.
constexpr double flattestParticle = 0.5;

/// Whether a coat of a growth model belongs in the voxel lattice: all but ST, from thinnestVoxelGrowth on. BD is another
/// matter where the script gives its particles' size: a column's solid is a number of particles in voxels, the height
/// of an envelope in a map, and their grains differ (0.7 and 1.7 cells). So the script alone decides, by the shape of a
/// particle (height by a closed form within 6 per cent from an age of 4 on), not the voxels; but a particle is a voxel
/// wide at least.
/// \param cellVoxels  a particle's width, voxels; none: VoxelGrowth::cubes
bool growsInVoxels(const VolumeScale& scale, double thicknessUm, const GrowthOptions& options,
                   std::optional<double> cellVoxels);

/// One coat's growth.
struct VoxelGrowth {
    GrowthOptions options;
    double since = 0.0; ///< only what has grown since this step of the same history; needs options.ofFull
    std::uint64_t seed = 0;
    std::string label;
    /// The script gave no size of a particle: those of BD are then cubes of one cell, as many as make up the thickness.
    bool cubes = false;
    std::vector<float> factor;           ///< per cell, 0…1: what thickness is multiplied by; empty: 1
    Imath::V3d origin = Imath::V3d(0.0); ///< of the volume in the lattice's coordinates (a region's)
    double magnification = 1.0;          ///< the volume's units per unit of the lattice's (a region's)
};

struct VoxelGrowthReport {
    OperationReport operation;
    GrowthStatistics statistics; ///< in levels of levelUm
};

/// Levels (particles above each other) and how thick they are.
struct LevelScale {
    double age = 0.0;         ///< monolayers of the history at the step
    double since = 0.0;       ///< those that had arrived before; the layer is what lies between
    double levelVoxels = 0.0; ///< thickness of a level as drawn
};

/// How a coat of BD of a thickness (voxels as drawn; the largest, as coat() understands it) is made of particles of
/// `cellVoxels`. Solid per area is what it is on surface cells: thickness * mean / (mean + 3 sigma) of the model's
/// height, for cubes as that many monolayers of cells, otherwise as the monolayers of the step, each as thick as it
/// takes, whatever the voxels (but no thinner than 1/16 of one; then fewer arrive). Levels thinner than a voxel, by
/// themselves or by a factor, become levels of one voxel that hold as much (makeVoxelLevels()).
LevelScale ballisticLevels(const VoxelGrowth& growth, double thicknessVoxels, double cellVoxels);

/// About how high a coat's grown layer will stand at its highest, voxels: never lower than the thickness. BD's pores lift
/// it; from the model's known velocity and width, without growing anything. For the band and the budget.
/// \param thicknessVoxels  as drawn
/// \param cellVoxels  size of a particle, where the script gives one; cubes of a voxel otherwise
double highestVoxelGrowth(const GrowthOptions& options, double since, double thicknessVoxels,
                          std::optional<double> cellVoxels);

/// Adds a grown layer on top of the nest.
///
/// The lattice of particles is aligned with the surface: a column stands on each surface cell, levels are counted along
/// the normal from phi_n, so a plate along the axes with cells of a voxel is the cubic lattice, voxel for voxel. A
/// voxel takes the state of the column its closest point of the model lies in, at its own height above phi_n. Rules,
/// arrival, history and margin of a cut are those of grow(). RDR and BD see the relief that is there: how high the nest
/// stands above the model is part of the heights by which particles find the lowest place or stick. RD, RDR, DPD and DPD_BS are compact: columns of factor *
/// thickness; BD has its pores and overhangs.
/// \param lattice  of the model at the particles' pitch (surfaceLattice())
/// \param thicknessUm  largest solid thickness, real µm
VoxelGrowthReport coatByVoxelGrowth(Workpiece& work, const std::string& material, double thicknessUm,
                                    const GrowthLattice& lattice, const VoxelGrowth& growth, Progress& progress);

} // namespace patina
