// A region cut out of a model grows as it does in the whole.

#include "growth_test_shapes.h"
#include "operators/growth/grow.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>
#include <utility>

namespace patina {
namespace {

using Key = std::tuple<int, int, int>;

std::map<Key, int> cellsByKey(const GrowthLattice& lattice) {
    std::map<Key, int> cells;
    for (std::size_t i = 0; i < lattice.size(); ++i)
        cells[{lattice.keys[i].x, lattice.keys[i].y, lattice.keys[i].z}] = int(i);
    return cells;
}

SurfaceMesh cap(const SurfaceMesh& mesh, float above) {
    SurfaceMesh part = mesh;
    part.triangles.clear();
    for (const Imath::V3i& t : mesh.triangles)
        if (std::max({mesh.positions[t.x].z, mesh.positions[t.y].z, mesh.positions[t.z].z}) > above)
            part.triangles.push_back(t);
    part.closed = false;
    return part;
}

class Cut : public ::testing::Test {
  protected:
    const SurfaceMesh ball = test::sphere(120.0, 50);
    const GrowthLattice whole = surfaceLattice(ball, 1.0);
    const GrowthLattice piece = surfaceLattice(cap(ball, -20.f), 1.0);
    const std::map<Key, int> wholeCells = cellsByKey(whole);

    int inWhole(std::size_t i) const {
        const auto found = wholeCells.find({piece.keys[i].x, piece.keys[i].y, piece.keys[i].z});
        return found == wholeCells.end() ? -1 : found->second;
    }
};

TEST_F(Cut, hasTheCellsAndLinksOfTheWhole) {
    EXPECT_LT(piece.size(), whole.size());
    std::size_t compared = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
        const int w = inWhole(i);
        ASSERT_GE(w, 0);
        ASSERT_EQ(piece.areas[i], whole.areas[w]);
        ASSERT_EQ(piece.centres[i], whole.centres[w]);
        if (piece.centres[i].z < -20.f + latticeMarginCells)
            continue;
        ++compared;
        for (int s = 0; s < 4; ++s) {
            const int a = piece.neighbours[i][s], b = whole.neighbours[w][s];
            ASSERT_EQ(a < 0, b < 0);
            if (a >= 0) {
                ASSERT_EQ(piece.keys[a], whole.keys[b]);
            }
        }
    }
    EXPECT_GT(compared, whole.size() / 4);
}

TEST_F(Cut, growsAsTheWholeDoesBeyondTheMargin) {
    const Imath::V3d none(0.0), slanting(0.6, 0.0, 0.8);
    for (const auto& [model, from] :
         {std::pair(GrowthModel::steadyThickening, none), std::pair(GrowthModel::randomDeposition, none),
          std::pair(GrowthModel::relaxation, none), std::pair(GrowthModel::ballisticDeposition, none),
          std::pair(GrowthModel::ballisticDeposition, slanting), std::pair(GrowthModel::directedPercolation, none),
          std::pair(GrowthModel::barabasiStanley, none)}) {
        GrowthOptions options;
        options.model = model;
        options.from = from;
        options.step = 2.5;
        options.total = 10;
        options.pointSpacing = 6;
        options.firstSeeds = 2e-3;
        const double margin = growthMarginCells(options);
        ASSERT_LT(margin, 135.0);
        const auto a = growHeights(piece, options, 4, "cut"), b = growHeights(whole, options, 4, "cut");
        std::size_t compared = 0;
        for (std::size_t i = 0; i < piece.size(); ++i) {
            if (piece.centres[i].z < -20.0 + margin)
                continue;
            ++compared;
            ASSERT_EQ(a[i], b[inWhole(i)]) << growthModelName(model) << " at " << piece.centres[i];
        }
        EXPECT_GT(compared, 1000u) << growthModelName(model);
    }
}

} // namespace
} // namespace patina
