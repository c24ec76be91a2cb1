// Particles that occupy voxels, and the interface they leave.

#include "operators/growth/voxel_growth.h"

#include "growth_test_shapes.h"
#include "operators/growth/cell_lookup.h"
#include "operators/growth/voxel_interface.h"
#include "operators/coat.h"
#include "operators/growth/nest_relief.h"
#include "support/temporary_folder.h"
#include "support/test_surfaces.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/stack_probe.h"

#include <gtest/gtest.h>

#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <numeric>

namespace patina {
namespace {

VoxelGrowth growthOf(GrowthModel model, double age) {
    VoxelGrowth growth;
    growth.options.model = model;
    growth.options.step = growth.options.total = age;
    growth.seed = 7;
    growth.label = "soot";
    growth.cubes = true;
    return growth;
}

/// A sheet at z = 0 whose band is a box over it, as a close-up's is: `height` voxels of air and nothing beside it.
std::unique_ptr<test::Piece> plateInABox(int side, int height) {
    initializeVolumes();
    auto piece = std::make_unique<test::Piece>();
    piece->surface = test::sheet(float(side), 16);
    piece->closed = closeSurface(piece->surface, sheetBackVoxels);
    auto grids = std::make_unique<NestGrids>();
    grids->base = openvdb::FloatGrid::create(float(height));
    grids->base->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
    grids->base->setGridClass(openvdb::GRID_LEVEL_SET);
    auto access = grids->base->getAccessor();
    for (int x = 0; x < side; ++x)
        for (int y = 0; y < side; ++y)
            for (int z = -4; z < height; ++z)
                access.setValue({x, y, z}, float(z));
    grids->material = openvdb::Int32Grid::create(0);
    grids->material->setTransform(grids->base->transformPtr()->copy());
    grids->material->tree().topologyUnion(grids->base->tree());
    grids->interiorBand = 4;
    grids->exteriorBand = height;
    piece->volume = std::make_unique<LayerVolume>(test::voxelScale(), "copper", std::move(grids));
    piece->binding = std::make_unique<SurfaceBinding>(*piece->volume, piece->surface, piece->closed);
    return piece;
}

VoxelGrowthReport coatPiece(test::Piece& piece, double thickness, const VoxelGrowth& growth, double cell = 1.0) {
    auto work = piece.work();
    const GrowthLattice lattice = surfaceLattice(piece.surface, cell);
    return coatByVoxelGrowth(work, "soot", thickness, lattice, growth, piece.progress);
}

/// Voxels of a material per height (in whole voxels above phi_0) over a square of a plate at z = 0.
std::vector<double> filledByHeight(const LayerVolume& volume, const std::string& material, int from, int to) {
    const auto ids = volume.grids().material->getConstAccessor();
    const std::int32_t id = volume.findMaterialId(material);
    std::vector<double> filled;
    for (int z = 1; z < 400; ++z) {
        std::size_t count = 0;
        for (int x = from; x < to; ++x)
            for (int y = from; y < to; ++y)
                count += ids.getValue(volume.grids().space.index(x, y, z)) == id;
        filled.push_back(double(count) / (double(to - from) * (to - from)));
    }
    return filled;
}

TEST(VoxelGrowth, aBallisticLayerOnAPlateHasTheKnownDensity) {
    const auto piece = plateInABox(128, 205);
    const auto report = coatPiece(*piece, 60.0, growthOf(GrowthModel::ballisticDeposition, 60));
    // Counted in the file.
    const test::TemporaryFolder folder;
    writeVolume(*piece->volume, folder / "plate.vdb");
    const LayerVolume read = readVolume(folder / "plate.vdb");
    const auto filled = filledByHeight(read, "soot", 12, 116);
    double density = 0.0, total = 0.0;
    for (int z = 100; z < 150; ++z)
        density += filled[std::size_t(z - 1)] / 50.0;
    for (const double f : filled)
        total += f;
    RecordProperty("density", std::to_string(density));
    EXPECT_NEAR(density, 0.303, 0.004);
    // Every particle is a voxel.
    EXPECT_NEAR(total, double(report.statistics.particles) / (128.0 * 128.0), 0.2);
}

Imath::V3d anyTangent(const Imath::V3d& normal) {
    const Imath::V3d other = std::abs(normal.x) < 0.9 ? Imath::V3d(1, 0, 0) : Imath::V3d(0, 1, 0);
    return (other % normal).normalized();
}

/// Solid thickness along the normal minus what is expected at the place, over the middle of a plane.
struct Deviation {
    double mean = 0.0, spread = 0.0;
};
Deviation deviation(const test::Piece& piece, const Imath::V3d& centre, const Imath::V3d& normal, double half,
                    const std::function<double(const Imath::V3d&)>& expected) {
    const Imath::V3d u = anyTangent(normal), v = normal % u;
    const StackProbe probe(*piece.volume);
    std::vector<double> um(std::size_t(piece.volume->layerCount()));
    double sum = 0.0, second = 0.0, count = 0.0;
    for (double a = -half; a < half; a += 0.37)
        for (double b = -half; b < half; b += 0.41) {
            const Imath::V3d p = centre + u * a + v * b;
            probe.read(p, normal, um.data());
            const double d = um[0] - expected(p);
            sum += d;
            second += d * d;
            count += 1.0;
        }
    return {sum / count, std::sqrt(std::max(0.0, second / count - sum / count * sum / count))};
}

const Imath::V3d squareCentre(0.137, -0.211, 0.318);

/// Occupied voxels, whole levels of them, made into an interface.
TEST(VoxelInterface, wholeLevelsOnSlantedPlanesHaveNeitherBiasNorTerraces) {
    for (const Imath::V3d& direction : {Imath::V3d(1, 2, 3), Imath::V3d(1, 1, 1), Imath::V3d(0, 1, 3)})
        for (const int levels : {1, 2, 5}) {
            const Imath::V3d normal = direction.normalized();
            const auto piece = test::makePiece(test::square(normal, 40.0), test::voxelScale(), 9.0);
            NestGrids& grids = piece->volume->grids();
            auto offsets = grids.base->deepCopy();
            for (auto voxel = offsets->beginValueOn(); voxel; ++voxel) {
                const float level = std::max(0.f, std::ceil(*voxel)); // solid up to `levels`
                voxel.setValue(level <= float(levels) ? std::min(0.f, *voxel - level) : *voxel - (level - 1.f));
            }
            interfaceOfVoxels(*grids.base, *offsets, 1.0, true, piece->progress);
            piece->volume->pushLayer("soot");
            piece->volume->grids().interfaces.back() = offsets;
            const auto d = deviation(*piece, squareCentre, normal, 12.0, [&](const auto&) { return double(levels); });
            EXPECT_NEAR(d.mean, 0.0, 0.02) << direction << " " << levels;
            EXPECT_LT(d.spread, 0.02) << direction << " " << levels;
        }
}

TEST(VoxelInterface, wholeLevelsOnASmallSphereHaveNeitherBiasNorTerraces) {
    for (const int levels : {1, 3}) {
        const auto piece = test::makePiece(test::sphere(16.f, 5), test::voxelScale(), 8.0);
        NestGrids& grids = piece->volume->grids();
        auto offsets = grids.base->deepCopy();
        for (auto voxel = offsets->beginValueOn(); voxel; ++voxel) {
            const float level = std::max(0.f, std::ceil(*voxel));
            voxel.setValue(level <= float(levels) ? std::min(0.f, *voxel - level) : *voxel - (level - 1.f));
        }
        interfaceOfVoxels(*grids.base, *offsets, 1.0, true, piece->progress);
        piece->volume->pushLayer("soot");
        piece->volume->grids().interfaces.back() = offsets;
        const StackProbe probe(*piece->volume);
        double um = 0.0, sum = 0.0, second = 0.0;
        for (std::size_t i = 0; i < piece->surface.positions.size(); ++i) {
            probe.read(Imath::V3d(piece->surface.positions[i]), Imath::V3d(piece->surface.normals[i]), &um);
            sum += um - levels;
            second += (um - levels) * (um - levels);
        }
        const double n = double(piece->surface.positions.size()), mean = sum / n;
        RecordProperty("bias", std::to_string(mean));
        EXPECT_NEAR(mean, 0.0, 0.02) << levels;
        EXPECT_LT(std::sqrt(second / n - mean * mean), 0.02) << levels;
    }
}

TEST(VoxelInterface, aColumnAPoreAndAnOverhangOfOneVoxelSurvive) {
    const auto piece = plateInABox(16, 16);
    NestGrids& grids = piece->volume->grids();
    const auto solid = [](const openvdb::Coord& c) {
        const auto [x, y, z] = std::array{c.x(), c.y(), c.z()};
        if (z <= 0)
            return true;
        const bool column = x == 4 && y == 4 && z <= 6, arm = x >= 4 && x <= 6 && y == 4 && z == 6; // an overhang
        const bool slab = x >= 10 && x <= 14 && y >= 3 && y <= 12 && z <= 5, pore = x == 12 && y == 6 && z == 3;
        return column || arm || (slab && !pore);
    };
    auto offsets = grids.base->deepCopy();
    for (auto voxel = offsets->beginValueOn(); voxel; ++voxel)
        voxel.setValue(*voxel <= 0.f ? *voxel : solid(voxel.getCoord()) ? 0.f : 1.f);
    interfaceOfVoxels(*grids.base, *offsets, 1.0, true, piece->progress);
    piece->volume->pushLayer("soot");
    piece->volume->grids().interfaces.back() = offsets;
    updateMaterialIds(*piece->volume);
    const auto phi = piece->volume->grids().interfaces.back()->getConstAccessor();
    const auto ids = piece->volume->grids().material->getConstAccessor();
    const std::int32_t soot = piece->volume->findMaterialId("soot");
    for (auto voxel = grids.base->cbeginValueOn(); voxel; ++voxel) {
        const openvdb::Coord c = voxel.getCoord();
        ASSERT_EQ(phi.getValue(c) <= 0.f, solid(c)) << c;
        if (c.z() > 0) {
            ASSERT_EQ(ids.getValue(c) == soot, solid(c)) << c;
        }
    }
    // A line through the arm meets a voxel of it, one through the pore two voxels and two.
    const StackProbe probe(*piece->volume);
    double um = 0.0;
    const double arm = probe.read({6, 4, 0}, {0, 0, 1}, &um).height;
    EXPECT_NEAR(arm, 6.5, 0.2);
    EXPECT_NEAR(um, 1.3, 0.1); // thickest in its middle: the arm's volume is what counts
    EXPECT_NEAR(probe.read({12, 6, 0}, {0, 0, 1}, &um).height, 5.0, 0.1); // five whole levels, and a pore in one
    EXPECT_NEAR(um, 4.0, 0.1);
    double volume = 0.0;
    for (double x = 3.05; x < 8.0; x += 0.1)
        for (double y = 3.05; y < 5.0; y += 0.1) {
            probe.read({x, y, 0}, {0, 0, 1}, &um);
            volume += um * 0.01;
        }
    RecordProperty("columnAndArm", std::to_string(volume));
    EXPECT_NEAR(volume, 8.0, 0.4); // six voxels of the column and two of the arm
}

TEST(VoxelGrowth, compactColumnsStandAsHighAsTheirModelSays) {
    for (const Imath::V3d& direction :
         {Imath::V3d(1, 2, 3), Imath::V3d(1, 1, 1), Imath::V3d(0, 1, 3), Imath::V3d(0, 0, 1)}) {
        const Imath::V3d normal = direction.normalized();
        for (const GrowthModel model :
             {GrowthModel::relaxation, GrowthModel::randomDeposition, GrowthModel::directedPercolation}) {
            const double t = 7.3;
            const auto piece = test::makePiece(test::square(normal, 50.0), test::voxelScale(), 12.0);
            auto work = piece->work();
            const GrowthLattice lattice = surfaceLattice(piece->surface, 1.0);
            const VoxelGrowth growth = growthOf(model, 20.0);
            coatByVoxelGrowth(work, "soot", t, lattice, growth, piece->progress);
            const auto factor = grow(lattice, growth.options, growth.seed, growth.label).factor;
            const CellLookup lookup(lattice);
            const auto d = deviation(*piece, squareCentre, normal, 17.0, [&](const Imath::V3d& p) {
                const int cell = lookup.cellAt(p + Imath::V3d(0.25), normal);
                return cell < 0 ? 0.0 : t * factor[std::size_t(cell)];
            });
            const std::string name = growthModelName(model);
            RecordProperty(name + std::to_string(int(9 * direction.x + 3 * direction.y + direction.z)),
                           std::to_string(d.mean));
            // DPD's columns are steep cliffs, whose sides the lookup above splits finer than voxels can.
            EXPECT_NEAR(d.mean, 0.0, model == GrowthModel::directedPercolation ? 0.05 : 0.02) << direction << name;
        }
    }
}

// A layer so mature that its columns are all but alike: what is left are bias and terraces of the lattice.
VoxelGrowth mature(GrowthModel model) {
    VoxelGrowth growth = growthOf(model, 400.0);
    return growth;
}

TEST(VoxelGrowth, evenLayersOnSlantedPlanesAndASmallSphereHaveNeitherBiasNorTerraces) {
    constexpr double t = 5.3;
    const VoxelGrowth growth = mature(GrowthModel::relaxation);
    const double expected = t * expectedScale(growth.options).mean / expectedScale(growth.options).top();
    EXPECT_NEAR(expected, t, 0.04);
    for (const Imath::V3d& direction : {Imath::V3d(1, 2, 3), Imath::V3d(1, 1, 1), Imath::V3d(0, 1, 3)}) {
        const Imath::V3d normal = direction.normalized();
        const auto piece = test::makePiece(test::square(normal, 40.0), test::voxelScale(), 10.0);
        coatPiece(*piece, t, growth);
        const auto d = deviation(*piece, squareCentre, normal, 12.0, [&](const auto&) { return expected; });
        RecordProperty("plane" + std::to_string(int(9 * direction.x + 3 * direction.y + direction.z)),
                       std::to_string(d.mean) + " " + std::to_string(d.spread));
        EXPECT_NEAR(d.mean, 0.0, 0.02) << direction;
        EXPECT_LT(d.spread, 0.02) << direction;
    }
    const auto piece = test::makePiece(test::sphere(16.f, 5), test::voxelScale(), 10.0);
    coatPiece(*piece, t, growth);
    const StackProbe probe(*piece->volume);
    double um = 0.0, sum = 0.0, second = 0.0;
    for (std::size_t i = 0; i < piece->surface.positions.size(); ++i) {
        probe.read(Imath::V3d(piece->surface.positions[i]), Imath::V3d(piece->surface.normals[i]), &um);
        sum += um - expected;
        second += (um - expected) * (um - expected);
    }
    const double n = double(piece->surface.positions.size()), mean = sum / n;
    RecordProperty("sphere", std::to_string(mean) + " " + std::to_string(std::sqrt(second / n - mean * mean)));
    EXPECT_NEAR(mean, 0.0, 0.02);
    EXPECT_LT(std::sqrt(second / n - mean * mean), 0.02);
}

/// Solid voxels of each column of a plate at z = 0.
std::vector<int> solidByColumn(const LayerVolume& volume, int from, int to) {
    const auto ids = volume.grids().material->getConstAccessor();
    const std::int32_t id = volume.findMaterialId("soot");
    std::vector<int> solid;
    for (int x = from; x < to; ++x)
        for (int y = from; y < to; ++y) {
            solid.push_back(0);
            for (int z = 1; z < 100; ++z)
                solid.back() += ids.getValue(volume.grids().space.index(x, y, z)) == id;
        }
    return solid;
}

TEST(VoxelGrowth, aBallisticLayerSinceAStepIsTheRestOfItsHistory) {
    const auto grownFrom = [](double since, double step, double cell) {
        const auto piece = plateInABox(40, 80);
        VoxelGrowth growth = growthOf(GrowthModel::ballisticDeposition, 10.0);
        growth.options.step = step;
        growth.options.ofFull = true;
        growth.since = since;
        growth.cubes = cell == 1.0;
        coatPiece(*piece, 16.0, growth, cell);
        return solidByColumn(*piece->volume, 8, 32);
    };
    for (const double cell : {1.0, 2.0}) { // cubes, and particles of a size that the script gave
        const auto whole = grownFrom(0, 10, cell), early = grownFrom(0, 5, cell), late = grownFrom(5, 10, cell);
        double wrong = 0.0, sum = 0.0, lateSum = 0.0;
        for (std::size_t i = 0; i < whole.size(); ++i) {
            wrong += std::abs(whole[i] - early[i] - late[i]);
            sum += whole[i];
            lateSum += late[i];
        }
        EXPECT_GT(lateSum, 0.4 * sum);
        if (cell == 1.0) {
            EXPECT_EQ(wrong, 0.0);
        } else {
            // Levels are no whole number of voxels: which of them a voxel's centre lies in is rounded anew.
            EXPECT_LT(wrong / sum, 0.2);
            EXPECT_NEAR(lateSum, std::accumulate(whole.begin(), whole.end(), 0.0) -
                                     std::accumulate(early.begin(), early.end(), 0.0),
                        0.02 * sum);
        }
    }
}

TEST(VoxelGrowth, layersGrowOnTheReliefAndInTheShadowsThatAreThere) {
    // A wall eight voxels high on a plate.
    const auto isWall = [](double x) { return x > 20.5 && x < 25.5; };
    const test::FunctionMap wall([&](const MapPoint& p) { return isWall(p.position.x) ? 1.0 : 0.0; });
    const auto piece = test::makePiece(test::sheet(48.f, 48), test::voxelScale(), 30.0);
    auto work = piece->work();
    coat(work, "cuprite", 8.0, &wall, piece->progress);
    const GrowthLattice lattice = surfaceLattice(piece->surface, 1.0);
    const auto heights = nestHeights(*piece->volume, lattice, Imath::V3d(0.0), 1.0);
    const NestShadow shadow(*piece->volume);
    const Imath::V3d up(0, 0, 1), slanting = Imath::V3d(1, 0, 1).normalized();
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        const Imath::V3d p(lattice.centres[i]);
        if (std::min(p.x, p.y) < 4.0 || std::max(p.x, p.y) > 44.0)
            continue;
        const bool side = std::abs(p.x - 20.5) < 1.5 || std::abs(p.x - 25.5) < 1.5;
        if (!side) {
            ASSERT_NEAR(heights[i], isWall(p.x) ? 8.0 : 0.0, 0.1) << p;
            ASSERT_FALSE(shadow.falls(p, up, up, 0.5)) << p;
            // From +x at 45 degrees: to the wall's lee as far as it is high.
            if (std::abs(p.x - 13.0) > 1.5) {
                ASSERT_EQ(shadow.falls(p, up, slanting, 0.5), p.x > 13.0 && p.x < 20.5) << p;
            }
        }
    }
    // Particles stick to the wall's sides: pores at its foot that a layer on a bare plate has not.
    const auto bare = test::makePiece(test::sheet(48.f, 48), test::voxelScale(), 30.0);
    VoxelGrowth growth = growthOf(GrowthModel::ballisticDeposition, 4.0);
    for (test::Piece* on : {piece.get(), bare.get()})
        coatPiece(*on, 6.0, growth);
    const StackProbe withWall(*piece->volume), without(*bare->volume);
    double um[2], a = 0.0, b = 0.0;
    for (double y = 8.5; y < 40.0; y += 1.0) {
        a += withWall.read({19.5, y, 0.0}, up, um).height / 32.0;
        b += without.read({19.5, y, 0.0}, up, um).height / 32.0;
    }
    EXPECT_GT(a, b + 2.0);
}

} // namespace
} // namespace patina
