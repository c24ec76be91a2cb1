#include "operators/erode.h"

#include "operators/interface_foot.h"
#include "operators/nest_layers.h"
#include "operators/shift_field.h"
#include "operators/slope_reader.h"
#include "volume/interior_band.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>
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

// g(p) t of the same t everywhere, where the whole stack is a small part of a voxel: p is the model's closest point.
class EvenShift {
  public:
    EvenShift(const Workpiece& work, double thickness)
        : binding_(work.binding), leaves_(leavesOf(std::as_const(work.volume.grids().surface().tree()))),
          lattice_(leaves_), inverseVoxelSize_(static_cast<float>(1.0 / work.volume.scale().voxelSize)),
          thickness_(static_cast<float>(thickness)), sampler_(work.volume.grids()) {}

    // Fills budget[position] for the active voxels of leaf n.
    void read(std::size_t n, float* budget) const {
        const SlopeReader slopes(lattice_, leaves_, n, inverseVoxelSize_);
        const SurfaceMesh& surface = binding_.surface();
        std::size_t at = binding_.leafStart(n);
        forActive(*leaves_[n], [&](openvdb::Index pos) {
            const SurfacePoint& under = binding_.at(at++);
            budget[pos] = 0.f;
            if (under.triangle < 0)
                return;
            const Imath::V3i& corners = surface.triangles[under.triangle];
            const Imath::V3f& a = surface.positions[corners[0]];
            const Imath::V3f p = (a + (surface.positions[corners[1]] - a) * under.u +
                                  (surface.positions[corners[2]] - a) * under.v) *
                                 inverseVoxelSize_;
            float slope = slopes.at(p);
            if (slope < 0.f)
                slope = far(p);
            budget[pos] = slope * thickness_;
        });
    }

  private:
    // A foot more than a leaf away, in a wide band.
    float far(const Imath::V3f& p) const {
        Imath::V3d gradient;
        sampler_.valueAndGradient(sampler_.interfaceCount() - 1, sampler_.locate(Imath::V3d(p)), gradient);
        return static_cast<float>(gradient.length()) * inverseVoxelSize_;
    }

    const SurfaceBinding& binding_;
    std::vector<const FloatLeaf*> leaves_;
    LeafLattice lattice_;
    float inverseVoxelSize_, thickness_;
    NestSampler sampler_;
};

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
    std::optional<EvenShift> even;
    ShiftField field;
    if (!map && thickness <= voxelSize && isThinStack(volume))
        even.emplace(work, thickness);
    else
        field = makeShiftField(work, thicknessUm, map, false, report, progress);

    NestGrids& grids = volume.grids();
    const std::size_t layers = grids.interfaces.size();
    // The budgets of all leaves are read from the surface as it is before any leaf of it changes: leaf by leaf where
    // they are in `field`; an even shift reads slopes across leaves, so it keeps them.
    std::vector<float> budgets;
    if (even) {
        budgets.resize(volume.leafCount() * FloatLeaf::SIZE);
        tbb::parallel_for(std::size_t(0), volume.leafCount(),
                          [&](std::size_t n) { even->read(n, &budgets[n * FloatLeaf::SIZE]); });
        even.reset();
    }
    if (metalHardness && !grids.metal)
        grids.metal = grids.base->deepCopy();
    std::vector<std::vector<FloatLeaf*>> leaves{leavesOf(grids.floor().tree())};
    for (auto& interface : grids.interfaces)
        leaves.push_back(leavesOf(interface->tree()));
    // Without hardness every layer costs its thickness, and the walk down is one sum.
    const bool walk = !hardness.empty() || metalHardness.value_or(1.0) != 1.0;
    LayerHardness costs = hardness;
    costs.resize(layers, 1.0);
    std::vector<char> changed(leaves[0].size(), 0);

    tbb::parallel_for(std::size_t(0), leaves[0].size(), [&](std::size_t n) {
        std::vector<float*> nest;
        for (std::size_t k = 0; k <= layers; ++k)
            nest.push_back(leaves[k][n]->buffer().data());
        float* const floor = nest[0];
        const float* const top = nest[layers];
        const FloatLeaf& active = *leaves[0][n];

        // The new surface c in every voxel, not above the old one and, unless the metal goes too, not below the floor.
        alignas(64) float surface[FloatLeaf::SIZE];
        if (!budgets.empty() && !walk) {
            const float* budget = &budgets[n * FloatLeaf::SIZE];
            forActive(active, [&](openvdb::Index pos) { surface[pos] = top[pos] + budget[pos]; });
        } else {
            std::size_t at = work.binding.leafStart(n);
            forActive(active, [&](openvdb::Index pos) {
                const std::size_t here = at++;
                const double t = budgets.empty() ? double(field.thickness[here]) : thickness;
                const double budget =
                    budgets.empty() ? field.slope[here] * t : double(budgets[n * FloatLeaf::SIZE + pos]);
                double c = top[pos];
                if (budget > 0.0) {
                    c = walk ? newSurface(nest, pos, budget, costs, metalHardness.value_or(1.0)) : c + budget;
                    if (!field.distance.empty() && t > voxelSize && !walk) {
                        const double blend = std::clamp(t / voxelSize - 1.0, 0.0, 1.0);
                        c += blend * (std::max(double(top[pos]), field.distance[here] + t) - c);
                    }
                }
                surface[pos] = static_cast<float>(c);
            });
        }
        if (!metalHardness)
            forActive(active, [&](openvdb::Index pos) { surface[pos] = std::min(surface[pos], floor[pos]); });
        int eroded = 0;
        forActive(active, [&](openvdb::Index pos) { eroded |= surface[pos] > top[pos]; });
        if (!eroded)
            return;
        changed[n] = 1;
        for (std::size_t k = metalHardness ? 0 : 1; k <= layers; ++k) {
            float* phi = nest[k];
            forActive(active, [&](openvdb::Index pos) { phi[pos] = std::max(phi[pos], surface[pos]); });
        }
    });

    if (metalHardness && metalDepthVoxels(volume) == 0.0)
        grids.metal.reset(); // it did not come so far
    const bool removed = tidyLayers(volume);
    report.changedIds = updateMaterialIds(volume, 1e-3, removed ? nullptr : &changed);
    return report;
}

} // namespace patina
