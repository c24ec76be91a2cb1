#include "base/errors.h"
#include "growth_test_shapes.h"
#include "operators/growth/grow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

namespace patina {
namespace {

using test::latticeArea;
using test::meshArea;

void expectSymmetricLinks(const GrowthLattice& lattice) {
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        auto links = lattice.neighbours[i];
        for (const int next : links) {
            if (next == GrowthLattice::noCell)
                continue;
            ASSERT_NE(next, int(i));
            const auto& back = lattice.neighbours[next];
            ASSERT_NE(std::find(back.begin(), back.end(), int(i)), back.end()) << "cell " << i << " and " << next;
        }
        std::sort(links.begin(), links.end());
        for (int s = 1; s < 4; ++s)
            ASSERT_TRUE(links[s] == GrowthLattice::noCell || links[s] != links[s - 1]) << "linked twice: " << i;
    }
}

double shareWithFourNeighbours(const GrowthLattice& lattice) {
    std::size_t full = 0;
    for (const auto& links : lattice.neighbours)
        full += std::find(links.begin(), links.end(), GrowthLattice::noCell) == links.end();
    return double(full) / double(lattice.size());
}

TEST(FlatLattice, joinsBordersOnlyWherePeriodic) {
    const GrowthLattice open = flatLattice(5, 4, false), closed = flatLattice(5, 4, true);
    EXPECT_EQ(open.neighbours[0], (std::array<int, 4>{-1, 1, -1, 5}));
    EXPECT_EQ(closed.neighbours[0], (std::array<int, 4>{4, 1, 15, 5}));
    const GrowthLattice line = flatLattice(8, 1, true);
    EXPECT_EQ(line.neighbours[0], (std::array<int, 4>{7, 1, -1, -1}));
    EXPECT_NEAR(linkVector(closed, 0, 4).x, -1.0, 1e-12);
    EXPECT_THROW(flatLattice(0, 3, true), RunError);
}

TEST(SurfaceLattice, platesHaveTheirAreaInEveryOrientation) {
    for (const Imath::V3d& n : {Imath::V3d(0, 0, 1), Imath::V3d(1, 2, 3), Imath::V3d(1, 1, 1), Imath::V3d(0, 1, 3),
                                Imath::V3d(-1, 1, 0), Imath::V3d(0.3, -0.8, 0.5)}) {
        const SurfaceMesh plate = test::square(n, 100.0);
        const GrowthLattice lattice = surfaceLattice(plate, 0.5);
        EXPECT_NEAR(latticeArea(lattice) / meshArea(plate), 1.0, 0.01) << n;
        expectSymmetricLinks(lattice);
        EXPECT_GT(shareWithFourNeighbours(lattice), 0.97) << n; // all but the border
    }
}

TEST(SurfaceLattice, onAPlateAlongTheAxesIsTheSquareLattice) {
    SurfaceMesh plate = test::square({0, 0, 1}, 1.0);
    for (auto& p : plate.positions)
        p += Imath::V3f(0.5f, 0.5f, 0.f) - Imath::V3f(0.137f, -0.211f, 0.318f);
    for (auto& p : plate.positions)
        p = {std::round(p.x), std::round(p.y), 0.f};
    const GrowthLattice lattice = surfaceLattice(plate, 1.0 / 64.0);
    EXPECT_EQ(lattice.size(), 64u * 64u);
    std::size_t links = 0;
    for (const auto& n : lattice.neighbours)
        links += std::size_t(4 - std::count(n.begin(), n.end(), GrowthLattice::noCell));
    EXPECT_EQ(links, 4u * 64u * 63u);
}

TEST(SurfaceLattice, sphereHasItsAreaAndFourNeighboursAlmostEverywhere) {
    const SurfaceMesh ball = test::sphere(1.0, 40);
    const GrowthLattice lattice = surfaceLattice(ball, 0.01);
    EXPECT_NEAR(latticeArea(lattice) / meshArea(ball), 1.0, 0.01);
    expectSymmetricLinks(lattice);
    EXPECT_GT(shareWithFourNeighbours(lattice), 0.97);
    for (std::size_t i = 0; i < lattice.size(); ++i)
        for (const int next : lattice.neighbours[i])
            if (next != GrowthLattice::noCell) {
                ASSERT_LE(linkVector(lattice, int(i), next).length(), 3.001 * lattice.cell);
            }
}

TEST(SurfaceLattice, boxIsJoinedRoundItsEdges) {
    // 20 cells a side: without links over the edges it would fall apart into six faces.
    SurfaceMesh box = test::sphere(1.0, 2);
    for (auto& p : box.positions) {
        const float most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        p /= most;
    }
    for (auto& p : box.positions)
        p = p * 10.f + Imath::V3f(0.3f, 0.1f, 0.2f);
    const GrowthLattice lattice = surfaceLattice(box, 1.0);
    expectSymmetricLinks(lattice);
    EXPECT_NEAR(latticeArea(lattice) / 2400.0, 1.0, 0.01);
    EXPECT_EQ(measureHeights(lattice, std::vector<float>(lattice.size(), 1.f)).patches, 1u);
}

TEST(SurfaceLattice, sidesOfASheetThinnerThanACellStayApart) {
    SurfaceMesh sheet = test::square({0, 0, 1}, 40.0);
    const SurfaceMesh back = test::square({0, 0, -1}, 40.0);
    for (const auto& p : back.positions)
        sheet.positions.push_back(p - Imath::V3f(0.f, 0.f, 0.2f));
    sheet.normals.insert(sheet.normals.end(), back.normals.begin(), back.normals.end());
    for (const auto& t : back.triangles)
        sheet.triangles.push_back(t + Imath::V3i(4));
    const GrowthLattice lattice = surfaceLattice(sheet, 1.0);
    EXPECT_NEAR(latticeArea(lattice), 3200.0, 32.0);
    EXPECT_EQ(measureHeights(lattice, std::vector<float>(lattice.size(), 1.f)).patches, 2u);
}

TEST(SurfaceLattice, hostileMeshesMakeNoTrouble) {
    EXPECT_EQ(surfaceLattice(SurfaceMesh{}, 1.0).size(), 0u);
    SurfaceMesh flat = test::square({0, 0, 1}, 10.0);
    flat.triangles = {{0, 0, 1}, {0, 1, 1}, {2, 2, 2}};
    EXPECT_EQ(surfaceLattice(flat, 1.0).size(), 0u);
    EXPECT_THROW(surfaceLattice(flat, 0.0), RunError);
    EXPECT_THROW(surfaceLattice(flat, 1e-12), RunError);
}

TEST(SurfaceLattice, depositsTheSameThicknessInEveryDirection) {
    const GrowthLattice lattice = surfaceLattice(test::sphere(1.0, 40), 0.01);
    for (const GrowthModel model :
         {GrowthModel::randomDeposition, GrowthModel::relaxation, GrowthModel::ballisticDeposition}) {
        GrowthOptions options;
        options.model = model;
        options.step = options.total = model == GrowthModel::ballisticDeposition ? 20 : 25;
        const auto height = growHeights(lattice, options, 3, "sphere");
        const auto meanAlong = [&](Imath::V3d d) {
            d.normalize();
            double sum = 0.0, area = 0.0;
            for (std::size_t i = 0; i < lattice.size(); ++i) {
                // The direction and all its mirror images and turns: |components| sorted.
                double c[3] = {std::abs(lattice.normals[i].x), std::abs(lattice.normals[i].y),
                               std::abs(lattice.normals[i].z)};
                std::sort(c, c + 3, std::greater<>());
                if (c[0] * d.x + c[1] * d.y + c[2] * d.z < 0.97)
                    continue;
                sum += double(lattice.areas[i]) * height[i];
                area += lattice.areas[i];
            }
            return sum / area;
        };
        const double axis = meanAlong({1, 0, 0}), edge = meanAlong({1, 1, 0}), corner = meanAlong({1, 1, 1});
        EXPECT_NEAR(edge / axis, 1.0, 0.02) << growthModelName(model);
        EXPECT_NEAR(corner / axis, 1.0, 0.02) << growthModelName(model);
        if (model != GrowthModel::ballisticDeposition) {
            EXPECT_NEAR(axis, 25.0, 0.5);
        }
    }
}

TEST(SurfaceLattice, patchesGrowAsLargeInEveryDirection) {
    const GrowthLattice lattice = surfaceLattice(test::sphere(150.0, 60), 1.0);
    GrowthOptions options;
    options.model = GrowthModel::directedPercolation;
    options.step = options.total = 12;
    options.firstSeeds = options.seeding = options.thickening = 0.0;
    std::vector<Imath::V3f> directions;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x || y || z)
                    directions.push_back(Imath::V3f(float(x), float(y), float(z)).normalized());
    const auto nearest = [&](const Imath::V3f& n) {
        std::size_t best = 0;
        for (std::size_t d = 1; d < directions.size(); ++d)
            if ((directions[d] ^ n) > (directions[best] ^ n))
                best = d;
        return best;
    };
    options.seedCells.assign(directions.size(), 0);
    for (std::size_t d = 0; d < directions.size(); ++d)
        for (std::size_t i = 0; i < lattice.size(); ++i)
            if ((directions[d] ^ lattice.normals[i]) > (directions[d] ^ lattice.normals[options.seedCells[d]]))
                options.seedCells[d] = int(i);
    double area[4] = {}, patches[4] = {};
    for (int seed = 0; seed < 6; ++seed) {
        const auto height = growHeights(lattice, options, std::uint64_t(seed), "patches");
        const auto kind = [&](std::size_t d) {
            const Imath::V3f n = directions[d];
            return (n.x != 0.f) + (n.y != 0.f) + (n.z != 0.f);
        };
        for (std::size_t i = 0; i < lattice.size(); ++i)
            if (height[i] > 0.f)
                area[kind(nearest(lattice.normals[i]))] += lattice.areas[i];
        for (std::size_t d = 0; d < directions.size(); ++d)
            patches[kind(d)] += 1.0;
    }
    const double axis = std::sqrt(area[1] / patches[1]);
    RecordProperty("edge", std::to_string(std::sqrt(area[2] / patches[2]) / axis));
    RecordProperty("corner", std::to_string(std::sqrt(area[3] / patches[3]) / axis));
    EXPECT_GT(axis, 20.0); // large against a cell
    EXPECT_NEAR(std::sqrt(area[2] / patches[2]) / axis, 1.0, 0.05);
    EXPECT_NEAR(std::sqrt(area[3] / patches[3]) / axis, 1.0, 0.05);
}

} // namespace
} // namespace patina
