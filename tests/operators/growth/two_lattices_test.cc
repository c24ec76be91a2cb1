// One script, one look: surface cells against voxels, coarse voxels against fine ones, every direction alike.

#include "growth_test_shapes.h"
#include "operators/coat.h"
#include "operators/growth/growth_map.h"
#include "operators/growth/voxel_growth.h"
#include "optics/colour.h"
#include "optics/layer_stack.h"
#include "optics/material_library.h"
#include "support/correlation_length.h"
#include "support/test_surfaces.h"
#include "volume/nest_grids.h"
#include "volume/stack_probe.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace patina {
namespace {

VoxelGrowth growthOf(GrowthModel model, double step, double total) {
    VoxelGrowth growth;
    growth.options.model = model;
    growth.options.step = step;
    growth.options.total = total;
    growth.seed = 3;
    growth.label = "brochantite";
    growth.cubes = true;
    return growth;
}

VoxelGrowthReport growOn(test::Piece& piece, double thicknessUm, const VoxelGrowth& growth, double cell) {
    auto work = piece.work();
    return coatByVoxelGrowth(work, "brochantite", thicknessUm, surfaceLattice(piece.surface, cell), growth,
                             piece.progress);
}

/// The same coat as a map of thickness.
void coatByCells(test::Piece& piece, double thicknessUm, const VoxelGrowth& growth, double cell) {
    auto work = piece.work();
    const GrowthLattice lattice = surfaceLattice(piece.surface, cell);
    const double voxel = piece.volume->scale().voxelSize;
    const GrowthMap map(lattice, grow(lattice, growth.options, growth.seed, growth.label).factor,
                        readingWidth(cell, voxel), readingShift(cell, cell, voxel));
    coat(work, "brochantite", thicknessUm, &map, piece.progress);
}

/// Means over the surface, a strip along its edge left out: thickness, and colour as CIE Lab.
constexpr double plate = 96.0; // its side, voxels
struct Look {
    double um = 0.0;
    Imath::V3d lab;
};
Look lookOf(const test::Piece& piece, const MaterialLibrary& materials) {
    const StackProbe probe(*piece.volume);
    const StackOptics optics({&materials.at("copper"), &materials.at("brochantite")});
    Appearance look;
    Look mean;
    Imath::V3d colour(0.0);
    const SurfaceMesh& mesh = piece.surface;
    double count = 0.0;
    for (const Imath::V3i& t : mesh.triangles) {
        // Everywhere between voxel centres alike.
        const Imath::V3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const double u = std::fmod(0.7548776662 * count, 1.0), v = std::fmod(0.5698402910 * count, 1.0);
        const double root = std::sqrt(u);
        const Imath::V3d p = a * (1.0 - root) + b * (root * (1.0 - v)) + c * (root * v);
        const Imath::V3d normal(mesh.normals[std::size_t(t.x)]);
        if (!mesh.closed && (std::min(p.x, p.y) < 12.0 || std::max(p.x, p.y) > plate - 12.0))
            continue;
        double um = 0.0;
        probe.read(p, normal, &um);
        const auto thickness = static_cast<float>(um);
        optics.evaluate(&thickness, look);
        mean.um += um;
        colour += Imath::V3d(look.baseColour);
        count += 1.0;
    }
    mean.um /= count;
    colour /= count;
    mean.lab = labFromXyz(xyzFromLinearRec709(colour));
    return mean;
}

TEST(TwoLattices, cellsAndVoxelsHaveTheSameMeanThicknessAndColour) {
    const MaterialLibrary materials = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    for (const GrowthModel model : {GrowthModel::randomDeposition, GrowthModel::relaxation,
                                    GrowthModel::ballisticDeposition, GrowthModel::directedPercolation}) {
        const VoxelGrowth growth = growthOf(model, 10, 20);
        const double thickness = 12.0;
        const bool porous = model == GrowthModel::ballisticDeposition;
        // Porous layers three times as high as they are thick have less solid over a ball, whose columns spread: a
        // plate.
        const auto body = [&] { return porous ? test::sheet(float(plate), 96) : test::sphere(24.f, 5); };
        const auto cells = test::makePiece(body(), test::voxelScale(), 16.0);
        const auto voxels = test::makePiece(body(), test::voxelScale(), porous ? 60.0 : 16.0);
        coatByCells(*cells, thickness, growth, 1.0);
        growOn(*voxels, thickness, growth, 1.0);
        const Look a = lookOf(*cells, materials), b = lookOf(*voxels, materials);
        const std::string name = growthModelName(model);
        RecordProperty(name + "_thickness", std::to_string(b.um / a.um));
        RecordProperty(name + "_colour", std::to_string(deltaE2000(a.lab, b.lab)));
        EXPECT_NEAR(b.um / a.um, 1.0, 0.02) << name;
        EXPECT_LT(deltaE2000(a.lab, b.lab), 2.0) << name;
    }
}

TEST(TwoLattices, solidMassPerAreaIsTheSameInEveryDirection) {
    for (const GrowthModel model :
         {GrowthModel::randomDeposition, GrowthModel::relaxation, GrowthModel::ballisticDeposition}) {
        constexpr double radius = 40.0;
        const bool porous = model == GrowthModel::ballisticDeposition;
        const auto piece = test::makePiece(test::sphere(float(radius), 5), test::voxelScale(), porous ? 40.0 : 14.0);
        growOn(*piece, 10.0, growthOf(model, 20, 20), 1.0);
        const StackProbe probe(*piece->volume);
        double sum[3] = {}, count[3] = {}, envelope[3] = {};
        const Imath::V3d kinds[3] = {{1, 0, 0}, Imath::V3d(1, 1, 0).normalized(), Imath::V3d(1, 1, 1).normalized()};
        for (const Imath::V3i& t : piece->surface.triangles) {
            const auto& at = piece->surface.positions;
            const Imath::V3d n = Imath::V3d(at[t.x] + at[t.y] + at[t.z]).normalized();
            Imath::V3d c(std::abs(n.x), std::abs(n.y), std::abs(n.z));
            std::sort(&c.x, &c.x + 3, std::greater<>());
            for (int k = 0; k < 3; ++k)
                if (c.dot(kinds[k]) > 0.97) {
                    double um = 0.0;
                    envelope[k] += probe.read(n * radius, n, &um).height;
                    sum[k] += um;
                    count[k] += 1.0;
                }
        }
        const std::string name = growthModelName(model);
        const double axis = sum[0] / count[0], edge = sum[1] / count[1] / axis, corner = sum[2] / count[2] / axis;
        RecordProperty(name + "_edge", std::to_string(edge));
        RecordProperty(name + "_corner", std::to_string(corner));
        if (porous) {
            // Columns are aligned with the surface, but levels stand on cells of other areas: less dense on slants.
            for (int k = 0; k < 3; ++k)
                RecordProperty(std::string("density_") + std::to_string(k), std::to_string(sum[k] / envelope[k]));
            EXPECT_NEAR(sum[0] / envelope[0], 0.36, 0.05);
        }
        EXPECT_NEAR(edge, 1.0, 0.02) << name;
        EXPECT_NEAR(corner, 1.0, 0.02) << name;
    }
}

// Columns of RD one, two and three voxels wide: the interface cuts their edges as much as it fills the shafts between.
TEST(TwoLattices, singleColumnsKeepTheirSolid) {
    const MaterialLibrary materials = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    for (const auto& [age, um] :
         {std::pair(4.0, 4.0), std::pair(4.0, 8.0), std::pair(10.0, 5.0), std::pair(40.0, 12.0)})
        for (const double cell : {1.0, 2.0, 3.0}) {
            const auto piece = test::makePiece(test::sheet(float(plate), 96), test::voxelScale(), um + 6.0);
            const GrowthStatistics grown =
                growOn(*piece, um, growthOf(GrowthModel::randomDeposition, age, age), cell).statistics;
            const double solid = grown.density * grown.mean * grown.levelUm, read = lookOf(*piece, materials).um;
            RecordProperty(std::to_string(age) + "_" + std::to_string(um) + "_" + std::to_string(cell),
                           std::to_string(read / solid));
            EXPECT_NEAR(read / solid, 1.0, 0.02) << age << " " << um << " " << cell;
        }
}

TEST(TwoLattices, levelsThinnerThanAVoxelKeepTheirSolid) {
    const MaterialLibrary materials = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    for (const auto& [age, factor] :
         {std::pair(4.0, 1.0), std::pair(4.0, 0.42), std::pair(4.0, 0.15), std::pair(10.0, 0.42)}) {
        const VoxelGrowth whole = growthOf(GrowthModel::ballisticDeposition, age, age);
        const auto piece =
            test::makePiece(test::sheet(float(plate), 48), test::voxelScale(), factor < 1.0 ? 22.0 : 32.0);
        VoxelGrowth growth = whole;
        growth.factor.assign(surfaceLattice(piece->surface, 1.0).size(), float(factor));
        const GrowthStatistics grown = growOn(*piece, 10.0, growth, 1.0).statistics;
        const double solid = grown.density * grown.mean * grown.levelUm * factor, um = lookOf(*piece, materials).um;
        RecordProperty(std::to_string(age) + "_" + std::to_string(factor), std::to_string(um / solid));
        // Of the single voxels of a layer of 0.7, their reading is good to 0.03.
        EXPECT_NEAR(um, solid, std::max(0.02 * solid, 0.03)) << age << " " << factor;
    }
}

// One, two and four voxels to a cell, as 256, 512 and 1024 along the longest side are to cells of 1/256 of it.
TEST(TwoLattices, patternsHaveTheSameGrainAtAnyVoxelSize) {
    constexpr double side = 24.0;
    for (const GrowthModel model :
         {GrowthModel::relaxation, GrowthModel::ballisticDeposition, GrowthModel::directedPercolation}) {
        VoxelGrowth growth = growthOf(model, 10, 20);
        growth.cubes = false;
        growth.options.firstSeeds = 1e-2;
        growth.options.patch = 4;
        for (const bool byCells : {true, false}) {
            // In voxels BD's particles are at least half as high as wide (growsInVoxels()): half a voxel to two.
            const bool particles = !byCells && model == GrowthModel::ballisticDeposition;
            if (particles)
                growth.options.step = growth.options.total = 4;
            double length[3];
            for (const int n : {0, 1, 2}) {
                const int fine = 1 << n;
                VolumeScale scale = test::voxelScale();
                scale.voxelSize = 1.0 / fine;
                const double thickness = particles ? 4.6 : 6.0, height = particles ? 22.0 : thickness + 3.0;
                const auto piece = test::makePiece(test::sheet(float(side), 16), scale, height * fine);
                if (byCells)
                    coatByCells(*piece, thickness, growth, 1.0);
                else
                    growOn(*piece, thickness, growth, 1.0);
                length[n] = test::correlationLength(*piece->volume, side);
                RecordProperty(growthModelName(model) + (byCells ? "_cells_" : "_voxels_") + std::to_string(fine),
                               std::to_string(length[n]));
            }
            for (const double l : length)
                EXPECT_NEAR(l / length[2], 1.0, 0.1) << growthModelName(model) << (byCells ? " cells" : " voxels");
        }
    }
}

bool sameBits(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    auto other = b.getConstAccessor();
    for (auto voxel = a.cbeginValueOn(); voxel; ++voxel)
        if (other.getValue(voxel.getCoord()) != *voxel)
            return false;
    return a.activeVoxelCount() == b.activeVoxelCount();
}

TEST(VoxelGrowth, bitsDoNotDependOnThreadsAndTheNestStaysNested) {
    for (const GrowthModel model : {GrowthModel::randomDeposition, GrowthModel::relaxation,
                                    GrowthModel::ballisticDeposition, GrowthModel::directedPercolation}) {
        openvdb::FloatGrid::Ptr first;
        openvdb::Int32Grid::Ptr firstIds;
        for (const std::size_t threads : {1, 2}) {
            const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
            const auto piece = test::makePiece(test::sphere(10.f, 4), test::voxelScale(), 8.0);
            auto work = piece->work();
            coat(work, "cuprite", 0.4, nullptr, piece->progress);
            growOn(*piece, 6.0, growthOf(model, 10, 20), 1.0);
            const NestGrids& grids = piece->volume->grids();
            const auto below = grids.interfaces.front()->getConstAccessor(), base = grids.base->getConstAccessor();
            for (auto voxel = grids.interfaces.back()->cbeginValueOn(); voxel; ++voxel) {
                ASSERT_LE(*voxel, below.getValue(voxel.getCoord()));
                ASSERT_LE(below.getValue(voxel.getCoord()), base.getValue(voxel.getCoord()));
            }
            if (!first) {
                first = grids.interfaces.back()->deepCopy();
                firstIds = grids.material->deepCopy();
                continue;
            }
            EXPECT_TRUE(sameBits(*first, *grids.interfaces.back())) << growthModelName(model) << threads;
            for (auto voxel = firstIds->cbeginValueOn(); voxel; ++voxel)
                ASSERT_EQ(*voxel, grids.material->getConstAccessor().getValue(voxel.getCoord()));
        }
    }
}

TEST(VoxelGrowth, laterStepsContainEarlierOnes) {
    for (const GrowthModel model : {GrowthModel::randomDeposition, GrowthModel::relaxation,
                                    GrowthModel::ballisticDeposition, GrowthModel::directedPercolation}) {
        std::unique_ptr<test::Piece> last;
        for (const double step : {5.0, 10.0}) {
            auto piece = test::makePiece(test::sheet(24.f, 8), test::voxelScale(), 50.0);
            VoxelGrowth growth = growthOf(model, step, 10);
            growth.options.ofFull = true;
            growth.options.firstSeeds = 1e-2;
            growth.options.patch = 4;
            growOn(*piece, 10.0, growth, 1.0);
            if (last) {
                // Voxels whose centres are solid. (IDs also tell of what reaches into a voxel from beside it.)
                const auto later = piece->volume->grids().surface().getConstAccessor();
                const auto base = last->volume->grids().base->getConstAccessor();
                std::size_t count = 0, lost = 0;
                for (auto voxel = last->volume->grids().surface().cbeginValueOn(); voxel; ++voxel)
                    if (*voxel < 0.f && base.getValue(voxel.getCoord()) > 0.f) {
                        ++count;
                        lost += !(later.getValue(voxel.getCoord()) < 0.f);
                    }
                EXPECT_GT(count, 400u) << growthModelName(model);
                EXPECT_EQ(lost, 0u) << growthModelName(model);
            }
            last = std::move(piece);
        }
    }
}

TEST(VoxelGrowth, whereNothingLandsNoBitChanges) {
    const auto piece = test::makePiece(test::sphere(20.f, 5), test::voxelScale(), 8.0);
    auto work = piece->work();
    coat(work, "cuprite", 0.4, nullptr, piece->progress);
    const auto before = piece->volume->grids().surface().deepCopy();
    const GrowthLattice lattice = surfaceLattice(piece->surface, 1.0);
    for (const GrowthModel model : {GrowthModel::relaxation, GrowthModel::ballisticDeposition}) {
        VoxelGrowth growth = growthOf(model, 10, 20);
        for (const Imath::V3f& n : lattice.normals)
            growth.factor.push_back(n.z > 0.f ? 1.f : 0.f);
        LayerVolume volume = piece->volume->clone();
        Workpiece copy{volume, *piece->binding};
        coatByVoxelGrowth(copy, "brochantite", 6.0, lattice, growth, piece->progress);
        const auto& grown = volume.grids().surface();
        const auto old = before->getConstAccessor();
        std::size_t same = 0;
        for (auto voxel = grown.cbeginValueOn(); voxel; ++voxel) {
            const openvdb::Coord c = voxel.getCoord();
            const float was = old.getValue(c);
            if (volume.grids().space.place(c).z > -4 || std::abs(was) > 1.5f)
                continue;
            ASSERT_EQ(*voxel, was) << c << growthModelName(model);
            ++same;
        }
        EXPECT_GT(same, 1000u);
    }
}

} // namespace
} // namespace patina
