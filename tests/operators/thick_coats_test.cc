// Coats of whole voxels on a film: the distance is the nest's own, not the model's.

#include "operators/coat.h"
#include "support/exact_volume.h"
#include "support/smooth_reader.h"
#include "support/volume_meter.h"

#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetFilter.h>

#include <algorithm>

namespace patina {
namespace {

constexpr double a = 40.0, b = 30.0, c = 20.0;
const Imath::V3d middle(0.31, 0.17, 0.42);

// A box of 40 × 30 × 20, its edges sharp in the mesh.
SurfaceMesh box() {
    SurfaceMesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = -1; side <= 1; side += 2) {
            Imath::V3d n(0.0), u(0.0), v(0.0);
            n[axis] = side;
            u[(axis + 1) % 3] = 1.0;
            v[(axis + 2) % 3] = side;
            const Imath::V3d half(a / 2, b / 2, c / 2);
            const int first = static_cast<int>(mesh.positions.size());
            for (const auto& [i, j] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
                mesh.positions.emplace_back(middle + half * (n + u * i + v * j));
                mesh.normals.emplace_back(n);
            }
            mesh.triangles.emplace_back(first, first + 1, first + 2);
            mesh.triangles.emplace_back(first, first + 2, first + 3);
        }
    return mesh;
}

double steiner(double t) {
    return a * b * c + 2.0 * (a * b + b * c + c * a) * t + M_PI * (a + b + c) * t * t + 4.0 / 3.0 * M_PI * t * t * t;
}

TEST(ThickCoat, OfABoxHasSteinersVolume) {
    for (const double t : {2.0, 5.0, 8.0}) {
        const auto piece = test::makePiece(box(), test::voxelScale());
        const auto bare = piece->volume->grids().base->deepCopy();
        auto work = piece->work();
        coat(work, "soot", t, nullptr, piece->progress);
        const double ours = test::volumeWithin(piece->volume->grids().surface()) / steiner(t) - 1.0;
        EXPECT_NEAR(ours, 0.0, 1e-3) << t;
        openvdb::tools::LevelSetFilter<openvdb::FloatGrid>(*bare).offset(static_cast<float>(-t));
        const double library = test::volumeWithin(*bare) / steiner(t) - 1.0;
        EXPECT_LT(std::abs(ours), std::abs(library)) << t;
        // Again on a film, from whose crossings the distance is taken.
        const auto filmed = test::makePiece(box(), test::voxelScale());
        auto filmedWork = filmed->work();
        coat(filmedWork, "film", 0.01, nullptr, filmed->progress);
        coat(filmedWork, "soot", t - 0.01, nullptr, filmed->progress);
        const double second = test::volumeWithin(filmed->volume->grids().surface()) / steiner(t) - 1.0;
        EXPECT_NEAR(second, 0.0, 1e-3) << t;
        EXPECT_LT(std::abs(second), std::abs(library)) << t;
    }
}

struct CoatErrors {
    double ours = 0.0, library = 0.0;
};

// Four voxels on a film of a hundredth: rms of the exact distance at the new surface's points, ours and the library's.
// `counts`: whether a point of the coat is looked at.
CoatErrors fourVoxels(std::unique_ptr<test::Piece> piece, const test::Distance& base,
                      const std::function<bool(const Imath::V3d&)>& counts) {
    constexpr double film = 0.01;
    Workpiece work = piece->work();
    coat(work, "film", film, nullptr, piece->progress);
    const auto grid = piece->volume->grids().surface().deepCopy();
    coat(work, "thick", 4.0, nullptr, piece->progress);
    openvdb::tools::LevelSetFilter<openvdb::FloatGrid>(*grid).offset(-4.f);
    const auto rms = [&](const openvdb::FloatGrid& surface) {
        const test::SmoothReader reader(surface);
        double sum = 0.0, n = 0.0;
        for (auto voxel = surface.cbeginValueOn(); voxel; ++voxel) {
            if (std::abs(*voxel) > 0.6f)
                continue;
            const Imath::V3d p = reader.ontoSurface(piece->volume->grids().space.position(voxel.getCoord()));
            if (!counts(p))
                continue;
            sum += std::pow(base(p) - 4.0 - film, 2);
            n += 1.0;
        }
        return std::sqrt(sum / n);
    };
    return {rms(piece->volume->grids().surface()), rms(*grid)};
}

TEST(ThickCoat, OfFourVoxelsIsGoodToAFiftiethOfAVoxelWhereRadiiAreTenAndMore) {
    for (const double radius : {10.0, 25.0}) {
        const CoatErrors e = fourVoxels(
            test::makePiece(test::sphere(float(radius), 5), test::voxelScale()),
            [=](const Imath::V3d& p) { return p.length() - radius; }, [](const Imath::V3d&) { return true; });
        EXPECT_LT(e.ours, 0.02) << radius;
    }
}

TEST(ThickCoat, OfFourVoxelsIsBetterThanTheLibrarysAtEdges) {
    const Imath::V3d half(a / 2, b / 2, c / 2);
    const CoatErrors e = fourVoxels(
        test::makePiece(box(), test::voxelScale()),
        [&](const Imath::V3d& p) { return test::boxDistance(p - middle, half); },
        [&](const Imath::V3d& p) { // over an edge or a corner
            const Imath::V3d q = p - middle;
            return (std::abs(q.x) > half.x) + (std::abs(q.y) > half.y) + (std::abs(q.z) > half.z) >= 2;
        });
    EXPECT_LT(e.ours, e.library);
}

} // namespace
} // namespace patina
