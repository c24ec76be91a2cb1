// Only what air reaches is coated: a pore that is closed to the outside stays as it is, whatever happens outside.

#include "operators/coat.h"
#include "operators/convert.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/grow_layer.h"
#include "operators/offset.h"
#include "operators/offset_tangent_sphere.h"
#include "operators/polish.h"
#include "support/hollow_ball.h"
#include "volume/open_air.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace patina {
namespace {

struct Operation {
    const char* name;
    std::function<void(Workpiece&, Progress&)> run;
    bool actsOutside = true;
};

// The present surface's bits in closed air and in all voxels that share a cell with it: the walls of its pores.
std::vector<std::pair<openvdb::Coord, float>> sealedSurface(const LayerVolume& volume, const OpenAir& air) {
    std::set<openvdb::Coord> beside;
    const openvdb::FloatTree& tree = volume.grids().surface().tree();
    const auto leaves = leavesOf(tree);
    for (std::size_t n = 0; n < leaves.size(); ++n)
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel)
            if (*voxel > 0.f && air.isSealed(n, voxel.pos()))
                for (int i = 0; i < 27; ++i)
                    beside.insert(voxel.getCoord().offsetBy(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1));
    std::vector<std::pair<openvdb::Coord, float>> values;
    for (const openvdb::Coord& coord : beside)
        values.emplace_back(coord, tree.getValue(coord));
    return values;
}

const test::FunctionMap& wave() {
    static const test::FunctionMap map([](const MapPoint& point) { return 0.6 + 0.4 * std::sin(point.position.x); });
    return map;
}

std::vector<Operation> operations() {
    return {
        {"a thin coat", [](Workpiece& w, Progress& p) { coat(w, "late", 0.3, nullptr, p); }},
        {"a mapped coat", [](Workpiece& w, Progress& p) { coat(w, "late", 0.3, &wave(), p); }},
        {"a thick coat", [](Workpiece& w, Progress& p) { coat(w, "late", 2.5, nullptr, p); }},
        {"a fill", [](Workpiece& w, Progress& p) { fill(w, "late", 3.0, nullptr, p); }},
        {"a mapped fill", [](Workpiece& w, Progress& p) { fill(w, "late", 3.0, &wave(), p); }},
        {"a fill above smooth", [](Workpiece& w, Progress& p) { fill(w, "late", 3.0, nullptr, p, 8.0); }},
        {"an offset that fits the hollow", [](Workpiece& w, Progress& p) { offset(w, "late", 2.0, false, p); }, false},
        {"an offset that does not", [](Workpiece& w, Progress& p) { offset(w, "late", 7.0, false, p); }, false},
        {"a global offset", [](Workpiece& w, Progress& p) { offset(w, "late", 2.0, true, p); }, false},
        {"tangent spheres", [](Workpiece& w, Progress& p) { offsetTangentSphere(w, "late", 9.0, 0.4, false, p); },
         false},
    };
}

void expectTheHollowStays(const test::Piece& piece, const std::vector<Operation>& all) {
    const OpenAir air(*piece.volume);
    ASSERT_TRUE(air.anyClosed());
    const auto before = sealedSurface(*piece.volume, air);
    ASSERT_GT(before.size(), 150u);
    for (const Operation& operation : all) {
        LayerVolume volume = piece.volume->clone();
        SurfaceBinding binding(volume, piece.surface, piece.closed);
        Workpiece work{volume, binding};
        Progress progress;
        operation.run(work, progress);
        const auto now = volume.grids().surface().getConstAccessor();
        for (const auto& [coord, value] : before)
            ASSERT_EQ(now.getValue(coord), value) << operation.name << " at " << coord;
        // Outside, one voxel above the ball at the south pole, the surface moves.
        const auto was = piece.volume->grids().surface().getConstAccessor();
        const openvdb::Coord south = volume.grids().space.index(0, 0, -13);
        EXPECT_EQ(now.getValue(south) != was.getValue(south), operation.actsOutside) << operation.name;
        for (std::size_t k = 1; k < volume.grids().nest().size(); ++k)
            for (auto voxel = volume.grids().nest()[k]->cbeginValueOn(); voxel; ++voxel)
                ASSERT_LE(*voxel, volume.grids().nest()[k - 1]->tree().getValue(voxel.getCoord())) << operation.name;
    }
}

TEST(ClosedAir, AShellInsideAShellIsNeitherCoatedNorFilled) {
    const auto piece = test::hollowBall(12.f, 6.f, 0.0, 10.0);
    expectTheHollowStays(*piece, operations());
    // Nothing at all has happened where only the hollow could have been filled.
    auto work = piece->work();
    const std::string before = contentHash(*piece->volume);
    offset(work, "late", 7.0, false, piece->progress);
    EXPECT_EQ(piece->volume->layerCount(), 0);
    EXPECT_EQ(contentHash(*piece->volume), before);
}

// A hollow that a coat came into through a channel, which it closed.
std::unique_ptr<test::Piece> closedByACoat() {
    auto piece = test::hollowBall(12.f, 6.f, 1.2, 10.0);
    auto work = piece->work();
    EXPECT_FALSE(OpenAir(*piece->volume).anyClosed());
    coat(work, "tarnish_1", 0.3, nullptr, piece->progress);
    EXPECT_FALSE(OpenAir(*piece->volume).anyClosed());
    coat(work, "crust", 2.2, nullptr, piece->progress);
    return piece;
}

TEST(ClosedAir, APoreClosedByAnEarlierCoatStaysAsItIs) {
    const auto piece = closedByACoat();
    std::vector<Operation> all = operations();
    all.erase(all.begin() + 3, all.end()); // the crust is higher than what is poured
    all.push_back({"a fill", [](Workpiece& w, Progress& p) { fill(w, "late", 4.0, nullptr, p); }});
    all.push_back({"an offset", [](Workpiece& w, Progress& p) { offset(w, "late", 3.0, false, p); }, false});
    all.push_back({"a thin erosion", [](Workpiece& w, Progress& p) { erode(w, 0.4, nullptr, {}, p); }});
    all.push_back({"a mapped erosion", [](Workpiece& w, Progress& p) { erode(w, 0.4, &wave(), {}, p); }});
    all.push_back({"by hardness", [](Workpiece& w, Progress& p) { erode(w, 0.4, nullptr, {2.0, 0.5}, p); }});
    all.push_back({"a polish", [](Workpiece& w, Progress& p) { polish(w, 1.5, nullptr, p); }});
    all.push_back({"growth of the crust", [](Workpiece& w, Progress& p) { growLayer(w, "crust", 0.4, nullptr, p); }});
    all.push_back(
        {"growth of the tarnish", [](Workpiece& w, Progress& p) { growLayer(w, "tarnish_1", 0.4, nullptr, p); }});
    all.push_back(
        {"a conversion", [](Workpiece& w, Progress& p) { convertLayers(w, "crust", "late", 0.5, nullptr, p); }, false});
    expectTheHollowStays(*piece, all);
}

TEST(ClosedAir, APoreThatIsOpenedIsNoLongerClosed) {
    const auto piece = closedByACoat();
    ASSERT_TRUE(OpenAir(*piece->volume).anyClosed());
    auto work = piece->work();
    // Through the crust over the channel, the plug in it and the crust below.
    erode(work, 12.0, nullptr, {}, piece->progress);
    EXPECT_FALSE(OpenAir(*piece->volume).anyClosed());
    coat(work, "late", 0.3, nullptr, piece->progress);
    // Now the bottom of the hollow is coated like the outside.
    const auto before = work.volume.grids().nest();
    const openvdb::Coord bottom = work.volume.grids().space.index(0, 0, -5);
    EXPECT_LT(before.back()->tree().getValue(bottom), before[before.size() - 2]->tree().getValue(bottom));
}

TEST(ClosedAir, ErosionComesThroughAWallFromOutsideOnly) {
    // A wall of six voxels loses two and a half: what is left is thick enough to see both sides apart.
    const auto piece = test::hollowBall(12.f, 6.f, 0.0, 4.0);
    auto work = piece->work();
    erode(work, 2.5, nullptr, {}, piece->progress, 1.0);
    ASSERT_NE(piece->volume->grids().metal, nullptr);
    const auto metal = piece->volume->grids().metal->getConstAccessor(),
               base = piece->volume->grids().base->getConstAccessor();
    int inside = 0;
    for (auto voxel = piece->volume->grids().base->cbeginValueOn(); voxel; ++voxel) {
        const auto c = voxel.getCoord();
        const Imath::V3d x = piece->volume->grids().space.position(c);
        const double r = x.length();
        if (r < 7.5) { // nearer to the hollow than to what is left of the outside, 9.5
            ASSERT_EQ(metal.getValue(c), base.getValue(c)) << c;
            ++inside;
        }
        if (r > 8.7 && r < 10.3) {
            EXPECT_NEAR(metal.getValue(c), r - 9.5, 0.06) << c;
        }
    }
    EXPECT_GT(inside, 500);
}

TEST(ClosedAir, AnErosionThatOpensAPoreTakesNothingFromBehindThinMetal) {
    // A wall of two voxels of metal, coated on both sides through a channel that the coat closes.
    const auto piece = test::hollowBall(14.f, 12.f, 1.2, 10.0);
    auto work = piece->work();
    coat(work, "tarnish_1", 0.3, nullptr, piece->progress);
    coat(work, "crust", 2.2, nullptr, piece->progress);
    ASSERT_TRUE(OpenAir(*piece->volume).anyClosed());
    const LayerVolume before = piece->volume->clone();
    // From the crust's top over the channel to the air in the hollow it is some seven voxels; so it is through the
    // metal.
    erode(work, 9.0, nullptr, {}, piece->progress);
    ASSERT_FALSE(OpenAir(*piece->volume).anyClosed());
    const auto was = before.grids().surface().getConstAccessor(),
               is = piece->volume->grids().surface().getConstAccessor(),
               base = piece->volume->grids().base->getConstAccessor();
    int kept = 0;
    for (auto voxel = before.grids().base->cbeginValueOn(); voxel; ++voxel) {
        const auto c = voxel.getCoord();
        const Imath::V3d x = piece->volume->grids().space.position(c);
        const double r = x.length();
        if (r < 12.0 && x.z < 0.0) { // the hollow, away from the channel
            ASSERT_EQ(is.getValue(c), was.getValue(c)) << c;
            ++kept;
        }
        if (r > 14.0 && x.z < 0.0) { // outside all is gone
            ASSERT_EQ(is.getValue(c), base.getValue(c)) << c;
        }
    }
    EXPECT_GT(kept, 1000);
    // Beside the channel's mouth in the hollow the front has come in.
    EXPECT_GT(is.getValue(piece->volume->grids().space.index(0, 0, 11)), 0.f);
}

} // namespace
} // namespace patina
