// Buried films outlive everything that happens above them.

#include "operators/coat.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/polish.h"
#include "support/test_surfaces.h"
#include "volume/stack_probe.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

class Films : public testing::TestWithParam<float> {};

// 60 voxels are what is promised; 20 are quick, and run by default.
INSTANTIATE_TEST_SUITE_P(Radius, Films, testing::Values(PATINA_FILMS_RADIUS));

TEST_P(Films, SurviveTenCyclesOfCoatErodePolishAndFill) {
    const auto piece = test::makePiece(test::sphere(GetParam(), GetParam() > 30.f ? 6 : 5), test::voxelScale(), 8.0);
    auto work = piece->work();
    const std::vector<double> films = {0.05, 0.3, 1.2, 2.0};
    double stack = 0.0;
    for (std::size_t k = 0; k < films.size(); ++k) {
        coat(work, "film" + std::to_string(k), films[k], nullptr, piece->progress);
        stack += films[k];
    }
    for (int cycle = 0; cycle < 10; ++cycle) {
        const test::FunctionMap map([&](const MapPoint& point) {
            return 0.6 + 0.4 * std::sin(point.position.dot({0.2, 0.1 * cycle, 0.15}));
        });
        coat(work, "dust", 0.5, &map, piece->progress);
        erode(work, 0.15, &map, {}, piece->progress);
        fill(work, "wax", stack + 0.1, nullptr, piece->progress);
        polish(work, stack + 0.2, nullptr, piece->progress);
    }
    const StackProbe probe(*piece->volume);
    std::vector<double> um(piece->volume->layerCount()), squares(films.size(), 0.0);
    for (std::size_t v = 0; v < piece->surface.positions.size(); ++v) {
        probe.read(Imath::V3d(piece->surface.positions[v]), Imath::V3d(piece->surface.normals[v]), um.data());
        for (std::size_t k = 0; k < films.size(); ++k)
            squares[k] += std::pow(um[k] - films[k], 2);
    }
    for (std::size_t k = 0; k < films.size(); ++k) {
        const double rms = std::sqrt(squares[k] / static_cast<double>(piece->surface.positions.size()));
        RecordProperty("film" + std::to_string(k) + "_rms", std::to_string(rms));
        EXPECT_LT(rms, 0.01 * std::max(1.0, 60.0 / GetParam())) << films[k]; // curvature's part grows as 1 / R
    }
}

} // namespace
} // namespace patina
