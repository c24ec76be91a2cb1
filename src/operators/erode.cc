#include "operators/erode.h"

#include "operators/interface_foot.h"
#include "operators/nest_layers.h"
#include "operators/sealed_erosion.h"
#include "operators/shift_field.h"
#include "volume/interior_band.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace patina {

namespace {

// phi of the new surface in one voxel: from the top down, each layer costs its thickness times its hardness, and what
// is left of the budget goes into the metal. nest[0] is the floor.
double newSurface(const std::vector<float*>& nest, openvdb::Index voxel, double budget, const LayerHardness& hardness,
                  double metalHardness) {
    double surface = nest.back()[voxel];
    for (std::size_t k = nest.size() - 1; k >= 1; --k) {
        const double depth = double(nest[k - 1][voxel]) - surface;
        const double cost = depth * hardness[k - 1];
        if (cost >= budget)
            return surface + budget / hardness[k - 1];
        budget -= cost;
        surface = nest[k - 1][voxel];
    }
    return surface + budget / metalHardness;
}

// The same for a whole leaf, layer by layer in plain loops over all its voxels: where the budget is 0, as it is in
// voxels that are not active, no bit changes.
void walkDown(const std::vector<float*>& nest, const LayerHardness& hardness, double metalHardness,
              float* __restrict budget, float* __restrict surface) {
    for (std::size_t k = nest.size() - 1; k >= 1; --k) {
        const float* below = nest[k - 1];
        const auto costs = static_cast<float>(hardness[k - 1]), gives = 1.f / costs;
        for (openvdb::Index pos = 0; pos < FloatLeaf::SIZE; ++pos) {
            const float from = surface[pos], to = below[pos], left = budget[pos], cost = (to - from) * costs;
            const float part = from + left * gives, rest = left - cost;
            const bool through = cost < left;
            surface[pos] = through ? to : part;
            budget[pos] = through ? rest : 0.f;
        }
    }
    const auto gives = static_cast<float>(1.0 / metalHardness);
    for (openvdb::Index pos = 0; pos < FloatLeaf::SIZE; ++pos)
        surface[pos] += budget[pos] * gives;
}

// The same budget in every active voxel of a leaf, but none on the back of a sheet.
void evenBudget(const FloatLeaf& leaf, const SurfaceBinding& binding, std::size_t n, float thickness, float* budget) {
    if (leaf.isDense() && !binding.hasBack()) {
        std::fill(budget, budget + FloatLeaf::SIZE, thickness);
        return;
    }
    std::fill(budget, budget + FloatLeaf::SIZE, 0.f);
    const SurfacePoint* under = binding.pointsOf(n);
    forActive(leaf, [&](openvdb::Index pos) { budget[pos] = (under++)->triangle < 0 ? 0.f : thickness; });
}

// A budget goes furthest in the softest of the layers, and least far in the hardest.
ShiftReach reachOf(const LayerHardness& hardness, std::optional<double> metalHardness) {
    ShiftReach reach;
    const auto also = [&](double h) {
        reach.least = std::min(reach.least, 1.0 / h);
        reach.most = std::max(reach.most, 1.0 / h);
    };
    std::for_each(hardness.begin(), hardness.end(), also);
    if (metalHardness)
        also(*metalHardness);
    return reach;
}

} // namespace

OperationReport erode(Workpiece& work, double thicknessUm, const ThicknessMap* map, const LayerHardness& hardness,
                      Progress& progress, std::optional<double> metalHardness) {
    OperationReport report;
    LayerVolume& volume = work.volume;
    const double voxelSize = volume.scale().voxelSize;
    if (volume.layerCount() == 0 && !metalHardness)
        return report;
    const double thickness = thicknessUm * volume.scale().unitsPerUm();
    if (metalHardness) {
        const double deeper = thickness / std::min(1.0, *metalHardness) / voxelSize;
        if (ensureInteriorBand(volume, work.binding, metalDepthVoxels(volume) + deeper + 3.0))
            report.grewBand = true;
    }
    progress.checkpoint();
    // Without hardness every layer costs its thickness, and the walk down is one sum.
    const bool walk = !hardness.empty() || metalHardness.value_or(1.0) != 1.0;
    const ShiftReach reach = walk ? reachOf(hardness, metalHardness) : ShiftReach();
    const OpenAir air(volume);
    ShiftField field;
    std::vector<float> rises; // where closed air is behind a wall
    // The same everywhere, at a slope that is 1: no field is needed to say so.
    const bool even = !map && thickness * reach.most <= voxelSize && isThinStack(volume) && !air.anyClosed();
    if (!even) {
        field = makeShiftField(work, thicknessUm, map, false, report, progress, reach);
        if (air.anyClosed())
            rises = sealedRise(work, air, thickness, map, metalHardness.has_value(), progress);
    }

    NestGrids& grids = volume.grids();
    const std::size_t layers = grids.interfaces.size();
    if (metalHardness && !grids.metal)
        grids.metal = grids.base->deepCopy();
    std::vector<std::vector<FloatLeaf*>> leaves{leavesOf(grids.floor().tree())};
    for (auto& interface : grids.interfaces)
        leaves.push_back(leavesOf(interface->tree()));
    LayerHardness costs = hardness;
    costs.resize(layers, 1.0);
    std::vector<char> changed(leaves[0].size(), 0);

    // The new surface c in every voxel of a leaf, not above the old one and, unless the metal goes too, not below the
    // floor.
    const auto nestOf = [&](std::size_t n) {
        std::vector<float*> nest;
        nest.reserve(layers + 1);
        for (std::size_t k = 0; k <= layers; ++k)
            nest.push_back(leaves[k][n]->buffer().data());
        return nest;
    };
    const auto erodedSurface = [&](std::size_t n, const std::vector<float*>& nest, float* surface) {
        const float* const floor = nest[0];
        const float* const top = nest[layers];
        std::copy(top, top + FloatLeaf::SIZE, surface); // also where voxels are not active
        if (even) {
            alignas(64) float budget[FloatLeaf::SIZE];
            evenBudget(*leaves[0][n], work.binding, n, static_cast<float>(thickness), budget);
            if (walk)
                walkDown(nest, costs, metalHardness.value_or(1.0), budget, surface);
            else
                for (openvdb::Index pos = 0; pos < FloatLeaf::SIZE; ++pos)
                    surface[pos] += budget[pos];
        } else {
            std::size_t at = work.binding.leafStart(n);
            forActive(*leaves[0][n], [&](openvdb::Index pos) {
                const std::size_t here = at++;
                const double t = field.thickness[here], budget = field.slope[here] * t;
                double c = top[pos];
                const auto spend = [&](double b) {
                    return walk ? newSurface(nest, pos, b, costs, metalHardness.value_or(1.0)) : c + b;
                };
                if (!rises.empty() && air.isSealed(n, pos)) {
                    c = spend(rises[here]);
                } else if (budget > 0.0) {
                    const double thin = spend(budget);
                    const double depth = walk ? (thin - c) * (t / budget) : t; // of phi by its slope
                    if (!field.distance.empty() && depth > voxelSize) {
                        const double blend = std::clamp(depth / voxelSize - 1.0, 0.0, 1.0);
                        c = thin + blend * (std::max(c, field.distance[here] + depth) - thin);
                    } else {
                        c = thin;
                    }
                }
                surface[pos] = static_cast<float>(c);
            });
        }
        if (!metalHardness)
            for (openvdb::Index pos = 0; pos < FloatLeaf::SIZE; ++pos)
                surface[pos] = std::min(surface[pos], floor[pos]);
        else if (work.binding.hasBack())
            // The edge of a sheet is where the model ends, not a wall that could be eaten away.
            forActive(*leaves[0][n], [&](openvdb::Index pos) {
                if (surface[pos] > floor[pos] &&
                    work.binding.behind(grids.space.position(leaves[0][n]->offsetToGlobalCoord(pos)) * voxelSize))
                    surface[pos] = floor[pos];
            });
    };
    // A front that has come through metal has opened no pore: what is still closed behind it stays as it is.
    std::optional<OpenAir> stillClosed;
    if (!rises.empty()) {
        std::vector<float> level(rises.size());
        tbb::parallel_for(std::size_t(0), leaves[0].size(), [&](std::size_t n) {
            alignas(64) float surface[FloatLeaf::SIZE];
            erodedSurface(n, nestOf(n), surface);
            std::size_t at = work.binding.leafStart(n);
            forActive(*leaves[0][n], [&](openvdb::Index pos) { level[at++] = surface[pos]; });
        });
        stillClosed.emplace(volume, level);
    }

    // Lowers an interface to the new surface; false where it lies deeper anyway.
    const auto lower = [&](float* phi, const float* surface) {
        int cuts = 0;
        for (openvdb::Index pos = 0; pos < FloatLeaf::SIZE; ++pos) {
            cuts |= surface[pos] > phi[pos];
            phi[pos] = std::max(phi[pos], surface[pos]);
        }
        return cuts != 0;
    };
    tbb::parallel_for(std::size_t(0), leaves[0].size(), [&](std::size_t n) {
        const std::vector<float*> nest = nestOf(n);
        const float* const top = nest[layers];
        const FloatLeaf& active = *leaves[0][n];
        alignas(64) float surface[FloatLeaf::SIZE];
        erodedSurface(n, nest, surface);
        if (stillClosed)
            forActive(active, [&](openvdb::Index pos) {
                if (air.isSealed(n, pos) && stillClosed->isSealed(n, pos))
                    surface[pos] = top[pos];
            });
        int eroded = 0;
        for (openvdb::Index pos = 0; pos < FloatLeaf::SIZE; ++pos)
            eroded |= surface[pos] > top[pos];
        if (!eroded)
            return;
        changed[n] = 1;
        const std::size_t lowest = metalHardness ? 0 : 1;
        for (std::size_t k = layers + 1; k-- > lowest;)
            if (!lower(nest[k], surface))
                break; // what lies below is deeper still
    });

    if (metalHardness && metalDepthVoxels(volume) == 0.0)
        grids.metal.reset(); // it did not come so far
    const bool removed = tidyLayers(volume);
    report.changedIds = updateMaterialIds(volume, 1e-3, removed || report.grewBand ? nullptr : &changed);
    return report;
}

} // namespace patina
