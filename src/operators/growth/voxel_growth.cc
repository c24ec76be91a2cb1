#include "operators/growth/voxel_growth.h"

#include "base/errors.h"
#include "base/random.h"
#include "operators/growth/cell_lookup.h"
#include "operators/growth/growth_map.h"
#include "operators/growth/nest_relief.h"
#include "operators/growth/voxel_interface.h"
#include "operators/growth/voxel_levels.h"
#include "volume/band.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/open_air.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace patina {

namespace {

constexpr float tie = 1e-3f;             // of a voxel
constexpr double thinnestLevel = 0.0625; // of a voxel: no one sees finer ones, and each takes memory

/// BD on an endless plane in closed form: mean and deviation of the height within 6 per cent from an age of 4 on.
struct PlaneOfParticles {
    double normal = 0.0; ///< age at which the pattern is normalised

    explicit PlaneOfParticles(const GrowthOptions& options)
        : normal(growthAge(options.rate, options.ofFull ? options.total : options.step, options.total)) {}
    static double mean(double age) { return 3.334 * age - 5.5 * (1.0 - std::exp(-age / 3.0)); }
    double top() const { return mean(normal) + 12.0 * (1.0 - std::exp(-normal / 2.3)); }
    /// How thick a level of a coat of a thickness is.
    double level(double thickness) const { return top() > 0.0 ? thickness * mean(normal) / (top() * normal) : 0.0; }
};

/// What stands on each cell: compact columns, or levels with pores.
struct Columns {
    std::vector<float> height;      ///< end of the (outermost) solid, voxels
    std::vector<float> levelVoxels; ///< porous: thickness of a level, per cell
    std::vector<float> foot;        ///< porous: the level of the history on which the column begins; empty: 0
    LevelOccupancy occupancy;
    bool porous = false;
    std::unique_ptr<const GrowthMap>
        smooth; ///< compact: the height between columns, where it runs from one to the next

    static float below(float c) { return c < tie ? std::min(c, 0.f) : c; }

    /// c of interfaceOfVoxels() for a voxel `phi` voxels above the surface.
    float offset(int cell, float phi) const {
        if (cell < 0)
            return phi; // what takes no particles ends at height 0
        const auto i = static_cast<std::size_t>(cell);
        // A voxel's centre may lie on the border of two levels: it belongs to the lower one, whatever rounding says.
        if (!porous)
            return below(phi - height[i]);
        const float thickness = levelVoxels[i];
        if (phi <= 0.f || !(thickness > 0.f))
            return phi; // metal and older layers are one solid level
        const float level = std::ceil((phi - tie) / thickness);
        const auto below = static_cast<std::int64_t>(foot.empty() ? 0.f : foot[i]);
        return occupancy.holds(i, below + static_cast<std::int64_t>(level))
                   ? std::min(0.f, phi - level * thickness)
                   : std::max(tie, phi - (level - 1.f) * thickness);
    }
};

double factorAt(const VoxelGrowth& growth, std::size_t cell) {
    return growth.factor.empty() ? 1.0 : std::clamp(double(growth.factor[cell]), 0.0, 1.0);
}

/// The same growth, told how high the nest stands above the model (DESIGN: particles see the relief that is there).
VoxelGrowth withRelief(const Workpiece& work, const GrowthLattice& lattice, const VoxelGrowth& growth,
                       double levelVoxels) {
    VoxelGrowth onRelief = growth;
    if (work.volume.layerCount() == 0 || !(levelVoxels > 0.0))
        return onRelief;
    onRelief.options.relief = nestHeights(work.volume, lattice, growth.origin, growth.magnification);
    for (float& height : onRelief.options.relief)
        height = static_cast<float>(height / (levelVoxels * work.volume.scale().voxelSize));
    return onRelief;
}

Columns compactColumns(const GrowthLattice& lattice, const VoxelGrowth& growth, double thicknessVoxels,
                       double voxelSize, VoxelGrowthReport& report, Progress& progress) {
    const GrowthPattern now = grow(lattice, growth.options, growth.seed, growth.label, &progress);
    report.statistics = now.statistics;
    std::vector<float> before;
    if (growth.since > 0.0) {
        GrowthOptions earlier = growth.options;
        earlier.step = growth.since;
        before = grow(lattice, earlier, growth.seed, growth.label, &progress).factor;
    }
    Columns columns;
    columns.height.resize(lattice.size());
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        const double grown = before.empty() ? now.factor[i] : std::max(0.f, now.factor[i] - before[i]);
        columns.height[i] = static_cast<float>(grown * thicknessVoxels * factorAt(growth, i));
    }
    // RD stands in columns of its own. Particles of the others find each other: their surface runs from column to
    // column, as that of cells of one voxel cannot but do, so that finer voxels show the same.
    // (And columns finer than voxels show as their mean.)
    const double pitch = voxelSize / growth.magnification;
    if (growth.options.model != GrowthModel::randomDeposition || lattice.cell < 0.99 * pitch) {
        columns.smooth = std::make_unique<GrowthMap>(lattice, columns.height, readingWidth(lattice.cell, pitch),
                                                     readingShift(lattice.cell, lattice.cell, pitch));
    }
    return columns;
}

Columns porousColumns(const GrowthLattice& lattice, const VoxelGrowth& growth, const LevelScale& levels,
                      double voxelSize, VoxelGrowthReport& report, Progress& progress) {
    Columns columns;
    columns.porous = true;
    GrowthOptions options = growth.options;
    options.rate = GrowthRate::linear;
    options.step = levels.age;
    options.total = std::max(levels.age, 1e-9);
    options.levelHeight = levels.levelVoxels * voxelSize / (lattice.cell * growth.magnification);
    GrownParticles grown = growParticles(lattice, options, growth.seed, growth.label, &progress, levels.since);
    report.statistics = grown.statistics;
    columns.foot = std::move(grown.foot);
    columns.occupancy = std::move(grown.occupancy);
    columns.height.resize(lattice.size());
    columns.levelVoxels.resize(lattice.size());
    const KeyedRandom phases(growth.seed, growth.label, "BD/voxels");
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        const double level = levels.levelVoxels * factorAt(growth, i);
        columns.levelVoxels[i] = static_cast<float>(level);
        columns.height[i] = grown.height[i] * columns.levelVoxels[i];
        if (!(level > 0.0 && level < 1.0 - tie))
            continue;
        const Imath::V3i& key = lattice.keys[i];
        const auto foot = columns.foot.empty() ? 0 : static_cast<std::int32_t>(columns.foot[i]);
        columns.height[i] =
            static_cast<float>(makeVoxelLevels(columns.occupancy, i, foot, static_cast<std::int32_t>(grown.height[i]),
                                               level, uniformFromWord(phases.words(0, key.x, key.y, key.z)[0])));
        columns.levelVoxels[i] = 1.f;
        if (!columns.foot.empty())
            columns.foot[i] = 0.f;
    }
    return columns;
}

/// c of every voxel of the band, in voxels, in a copy of phi_n.
openvdb::FloatGrid::Ptr offsetsOfVoxels(const Workpiece& work, const GrowthLattice& lattice, const VoxelGrowth& growth,
                                        const Columns& columns, float highest, const Progress& progress) {
    const openvdb::FloatGrid& surface = work.volume.grids().surface();
    const double voxelSize = work.volume.scale().voxelSize;
    const CellLookup lookup(lattice);
    auto offsets = surface.deepCopy();
    const auto from = leavesOf(surface.tree());
    const auto to = leavesOf(offsets->tree());
    const SurfaceMesh& mesh = work.binding.surface();
    // Voxel centres lie at whole multiples of the voxel size and so do the borders of columns: a quarter of a voxel
    // keeps rounding from having a say.
    const double perUnit = 1.0 / growth.magnification;
    const Imath::V3d nudge = growth.origin + Imath::V3d(0.25 * voxelSize * perUnit);
    tbb::parallel_for(std::size_t(0), from.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        std::size_t at = work.binding.leafStart(n);
        for (auto voxel = from[n]->cbeginValueOn(); voxel; ++voxel, ++at) {
            const auto phi = static_cast<float>(*voxel / voxelSize);
            float& offset = to[n]->buffer().data()[voxel.pos()];
            if (phi > highest + 3.f) {
                offset = phi - highest;
                continue;
            }
            // Below the surface, too: the end of the column that stands on a voxel belongs to its neighbourhood.
            const SurfacePoint& under = work.binding.at(at);
            if (phi <= -2.f || under.triangle < 0) {
                offset = columns.offset(GrowthLattice::noCell, phi);
                continue;
            }
            const Imath::V3d position = positionAt(mesh, under) * perUnit, normal = normalAt(mesh, under);
            if (columns.smooth) {
                MapPoint point;
                point.position = position + growth.origin;
                point.normal = normal;
                offset = Columns::below(phi - static_cast<float>(columns.smooth->value(point)));
            } else {
                offset = columns.offset(lookup.cellAt(position + nudge, normal), phi);
            }
        }
    });
    progress.checkpoint();
    return offsets;
}

/// No particle comes where the air is closed to the outside: there the surface keeps its bits.
void keepClosedAir(const LayerVolume& volume, openvdb::FloatGrid& grown) {
    const OpenAir air(volume);
    if (!air.anyClosed())
        return;
    const auto before = leavesOf(std::as_const(volume.grids().surface().tree()));
    const auto after = leavesOf(grown.tree());
    tbb::parallel_for(std::size_t(0), after.size(), [&](std::size_t n) {
        for (auto voxel = after[n]->beginValueOn(); voxel; ++voxel)
            if (air.isSealed(n, voxel.pos()))
                voxel.setValue(before[n]->getValue(voxel.pos()));
    });
}

} // namespace

bool growsInVoxels(const VolumeScale& scale, double thicknessUm, const GrowthOptions& options,
                   std::optional<double> cellVoxels) {
    const double thickness = thicknessUm * scale.voxelsPerUm();
    if (options.model == GrowthModel::ballisticDeposition && cellVoxels)
        return *cellVoxels > 0.99 && PlaneOfParticles(options).level(thickness) >= flattestParticle * *cellVoxels;
    return options.model != GrowthModel::steadyThickening && thickness >= thinnestVoxelGrowth;
}

LevelScale ballisticLevels(const VoxelGrowth& growth, double thicknessVoxels, double cellVoxels) {
    const GrowthScale full = expectedScale(growth.options);
    if (!(full.top() > 0.0))
        return {};
    const auto meanAt = [&](double step) {
        GrowthOptions at = growth.options;
        at.ofFull = false;
        at.step = step;
        return step > 0.0 ? expectedScale(at).mean : 0.0;
    };
    const GrowthOptions& options = growth.options;
    const double perMean = thicknessVoxels / full.top();
    const double solid = perMean * (options.ofFull ? meanAt(options.step) : full.mean);
    const double before = perMean * meanAt(growth.since);
    if (!(solid > before))
        return {};
    double level = std::max(1.0, cellVoxels);
    if (!growth.cubes) {
        // One thickness for the whole history: that of the step at which the pattern is normalised.
        const double age = options.ofFull ? growthAge(options.rate, options.total, options.total) : options.age();
        level = std::max(thinnestLevel, perMean * full.mean / age);
    }
    return {solid / level, before / level, level};
}

double highestVoxelGrowth(const GrowthOptions& options, double since, double thicknessVoxels,
                          std::optional<double> cellVoxels) {
    if (options.model != GrowthModel::ballisticDeposition)
        return thicknessVoxels;
    const PlaneOfParticles plane(options);
    if (!(plane.top() > 0.0))
        return thicknessVoxels;
    const double level = cellVoxels ? plane.level(thicknessVoxels) : 1.0;
    const double perMean = thicknessVoxels / plane.top();
    const double grown = plane.mean(options.age()) - plane.mean(growthAge(options.rate, since, options.total));
    // The highest columns stand 6 to 15 levels above the line of the mean velocity.
    const double age = std::min(thicknessVoxels, perMean * grown) / level;
    return std::max(thicknessVoxels, level * (3.334 * age + 8.0 + 0.12 * age) + (level < 1.0 ? 1.0 : 0.0));
}

VoxelGrowthReport coatByVoxelGrowth(Workpiece& work, const std::string& material, double thicknessUm,
                                    const GrowthLattice& lattice, const VoxelGrowth& growth, Progress& progress) {
    LayerVolume& volume = work.volume;
    const VolumeScale& scale = volume.scale();
    if (!growth.factor.empty() && growth.factor.size() != lattice.size())
        throw RunError("growth", "a map that does not fit the lattice", "give one value per cell");
    const double thicknessVoxels = thicknessUm * scale.voxelsPerUm();
    const bool porous = growth.options.model == GrowthModel::ballisticDeposition;

    VoxelGrowthReport report;
    Columns columns;
    double levelVoxels = 0.0;
    if (porous) {
        const LevelScale levels =
            ballisticLevels(growth, thicknessVoxels, lattice.cell * growth.magnification / scale.voxelSize);
        levelVoxels = levels.levelVoxels;
        columns = porousColumns(lattice, withRelief(work, lattice, growth, levelVoxels), levels, scale.voxelSize,
                                report, progress);
    } else {
        const bool seesRelief = growth.options.model == GrowthModel::relaxation && volume.layerCount() > 0;
        const double top = seesRelief ? expectedScale(growth.options).top() : 0.0;
        columns = compactColumns(lattice, top > 0.0 ? withRelief(work, lattice, growth, thicknessVoxels / top) : growth,
                                 thicknessVoxels, scale.voxelSize, report, progress);
        levelVoxels = thicknessVoxels * report.statistics.levelFactor;
    }
    report.statistics.levelUm = levelVoxels / scale.voxelsPerUm();
    float highest = 0.f;
    for (const float height : columns.height)
        highest = std::max(highest, height);

    const bool extends = volume.layerCount() > 0 && volume.layers().back() == material;
    if (highest > 0.f) {
        if (ensureExteriorBand(volume, stackHeightVoxels(volume) + highest + 3.0)) {
            work.binding.rebind(volume);
            report.operation.grewBand = true;
        }
        const auto grown = offsetsOfVoxels(work, lattice, growth, columns, highest, progress);
        columns = Columns();
        interfaceOfVoxels(volume.grids().surface(), *grown, scale.voxelSize, porous, progress);
        keepClosedAir(volume, *grown);
        if (extends) {
            volume.grids().interfaces.back() = grown;
        } else {
            volume.grids().interfaces.push_back(grown);
            volume.nameTopLayer(material);
        }
    } else if (!extends) {
        volume.pushLayer(material);
    }
    report.operation.changedIds = updateMaterialIds(volume);
    return report;
}

} // namespace patina
