// Erode, fill and polish on plane, sphere, groove, sinusoid and Gaussian field: heights, volumes, exposed area.

#include "operators/coat.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/polish.h"
#include "support/relief_surfaces.h"

#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

#include <numeric>
#include <utility>

namespace patina {
namespace {

// A point of the base that speaks for an area, and the map's factor there.
struct Place {
    Imath::V3d position, normal;
    double area, factor;
};

struct Base {
    std::string name;
    std::function<SurfaceMesh()> surface;
    std::function<std::vector<Place>()> places;
    std::function<double(const Imath::V3d&)> factor;
};

// A sheet of 60 voxels; what is measured is off its edges. The map runs across the lattice.
Base reliefBase(const std::string& name, test::Height height, double beside = 0.0) {
    const auto factor = [](const Imath::V3d& p) {
        return 0.5 + 0.5 * std::sin(2.0 * M_PI * (0.96 * p.y + 0.28 * p.x) / 30.0);
    };
    const auto places = [height, beside, factor] {
        constexpr int count = 150;
        std::vector<Place> all;
        for (int i = 0; i < count; ++i)
            for (int j = 0; j < count; ++j) {
                const double x = 15.0 + 30.0 * (i + 0.5) / count, y = 15.0 + 30.0 * (j + 0.5) / count, e = 1e-4;
                if (std::abs(x - 30.0) < beside)
                    continue;
                const Imath::V3d up(-(height(x + e, y) - height(x - e, y)) / (2 * e),
                                    -(height(x, y + e) - height(x, y - e)) / (2 * e), 1.0);
                const Imath::V3d p(x, y, height(x, y));
                all.push_back({p, up.normalized(), up.length(), factor(p)});
            }
        return all;
    };
    return {name, [height] { return test::relief(60.f, 120, height); }, places, factor};
}

Base sphereBase() {
    const auto factor = [](const Imath::V3d& p) { return 0.5 + 0.5 * p.z / 30.0; };
    const auto places = [factor] {
        // Equal areas: even in z, turned by the golden angle.
        constexpr int count = 20000;
        std::vector<Place> all;
        for (int i = 0; i < count; ++i) {
            const double z = 1.0 - 2.0 * (i + 0.5) / count, s = std::sqrt(1.0 - z * z), turn = 2.399963229728653 * i;
            const Imath::V3d n(s * std::cos(turn), s * std::sin(turn), z);
            all.push_back({n * 30.0, n, 1.0, factor(n * 30.0)});
        }
        return all;
    };
    return {"sphere", [] { return test::sphere(30.f, 6); }, places, factor};
}

std::vector<Base> bases() {
    const test::GaussianField field;
    return {reliefBase("plane", [](double, double) { return 0.0; }), sphereBase(),
            reliefBase(
                "groove", [](double x, double) { return std::abs(x - 30.0); }, 4.0), // no one normal at its bottom
            reliefBase("sinusoid", [](double x, double) { return 2.0 * std::sin(2.0 * M_PI * x / 30.0); }),
            reliefBase("Gaussian field", [field](double x, double y) { return 0.5 * field(x, y); })};
}

class Reliefs : public testing::TestWithParam<int> {
  protected:
    Base base_ = bases()[GetParam()];
    std::unique_ptr<test::Piece> piece_ = test::makePiece(base_.surface(), test::voxelScale(), 6.0);
    test::FunctionMap map_{[this](const MapPoint& point) { return base_.factor(point.position); }};

    // The layers expected, in every voxel: phi_0 less their height at the model's closest point.
    LayerVolume exactLayers(const std::function<std::vector<double>(double factor)>& layersAt) const {
        LayerVolume exact = piece_->volume->clone();
        NestGrids& grids = exact.grids();
        const SurfaceBinding& binding = *piece_->binding;
        const auto base = leavesOf(std::as_const(grids.base->tree()));
        for (std::size_t k = 0; k < grids.interfaces.size(); ++k) {
            const auto interface = leavesOf(grids.interfaces[k]->tree());
            for (std::size_t n = 0; n < base.size(); ++n) {
                std::size_t at = binding.leafStart(n);
                forActive(*base[n], [&](openvdb::Index pos) {
                    const SurfacePoint& under = binding.at(at++);
                    if (under.triangle < 0)
                        return;
                    const std::vector<double> um = layersAt(base_.factor(positionAt(binding.surface(), under)));
                    const double height = std::accumulate(um.begin(), um.begin() + std::ptrdiff_t(k) + 1, 0.0);
                    interface[n]->buffer().data()[pos] = base[n]->buffer().data()[pos] - float(height);
                });
            }
        }
        return exact;
    }

    /// Compares the stack with the layers expected at a factor of the map.
    ///
    /// Trilinear reading rounds off the edge of a plateau between two voxels, by up to an eighth of the change of
    /// slope, and what is curved: also of a nest that is exact in every voxel it is up to 0.028 voxel off. So single
    /// heights are compared with what is read of that nest; means and volumes with the closed form.
    ///
    /// Exposed is where the outermost layer is not. A film that runs out over a slope does so at the next voxel, so the
    /// area is carried on to zero from those where it is thinner than 0.1, 0.2, 0.3 voxel.
    void expectLayers(const std::function<std::vector<double>(double factor)>& layersAt) {
        const LayerVolume exact = exactLayers(layersAt);
        const StackProbe probe(*piece_->volume), exactProbe(exact);
        const std::size_t count = layersAt(0.5).size();
        ASSERT_EQ(std::size_t(piece_->volume->layerCount()), count);
        std::vector<double> exactUm(count), um(count), volume(count, 0.0), expectedVolume(count, 0.0);
        double area = 0.0, thinner[3] = {}, bare = 0.0, worst = 0.0, ofReading = 0.0, ofOperator = 0.0, squares = 0.0,
               total = 0.0, expectedTotal = 0.0;
        for (const Place& place : base_.places()) {
            const auto reading = probe.read(place.position, place.normal, um.data());
            ASSERT_TRUE(reading.found);
            const std::vector<double> expected = layersAt(place.factor);
            const auto exactly = exactProbe.read(place.position, place.normal, exactUm.data());
            double height = 0.0;
            for (std::size_t k = 0; k < count; ++k) {
                volume[k] += um[k] * place.area;
                expectedVolume[k] += expected[k] * place.area;
                height += expected[k];
            }
            total += reading.height * place.area;
            expectedTotal += height * place.area;
            worst = std::max(worst, std::abs(reading.height - height));
            squares += std::pow(reading.height - height, 2) * place.area;
            ofReading = std::max(ofReading, std::abs(exactly.height - height));
            ofOperator = std::max(ofOperator, std::abs(reading.height - exactly.height));
            area += place.area;
            for (int i = 0; i < 3; ++i)
                thinner[i] += um.back() < 0.1 * (i + 1) ? place.area : 0.0;
            bare += expected.back() <= 0.0 ? place.area : 0.0;
        }
        const double rms = std::sqrt(squares / area), exposed = 3.0 * thinner[0] - 3.0 * thinner[1] + thinner[2];
        RecordProperty("base", base_.name);
        RecordProperty("height_rms", std::to_string(rms));
        RecordProperty("height_worst", std::to_string(worst));
        RecordProperty("height_worst_of_reading", std::to_string(ofReading));
        RecordProperty("height_worst_of_operator", std::to_string(ofOperator));
        RecordProperty("volume_percent", std::to_string(100.0 * (total / expectedTotal - 1.0)));
        RecordProperty("exposed_percent", std::to_string(100.0 * (exposed - bare) / area));
        EXPECT_LT(rms, 0.01) << base_.name;
        EXPECT_LT(ofOperator, 0.01) << base_.name;
        EXPECT_LT(ofReading, 0.03) << base_.name;
        EXPECT_LT(worst, 0.035) << base_.name;
        EXPECT_NEAR(total / expectedTotal, 1.0, 0.005) << base_.name;
        for (std::size_t k = 0; k < count; ++k) {
            EXPECT_NEAR(volume[k] / expectedVolume[k], 1.0, 0.005) << base_.name << ", layer " << k + 1;
        }
        EXPECT_NEAR(exposed / area, bare / area, 0.005) << base_.name;
    }
};

INSTANTIATE_TEST_SUITE_P(All, Reliefs, testing::Range(0, 5));

TEST_P(Reliefs, ErodeTakesItsDepth) {
    Workpiece work = piece_->work();
    coat(work, "soot", 0.6, nullptr, piece_->progress);
    coat(work, "dirt", 0.5, nullptr, piece_->progress);
    erode(work, 0.9, &map_, {}, piece_->progress);
    expectLayers([](double factor) -> std::vector<double> {
        return {std::min(0.6, 1.1 - 0.9 * factor), std::max(0.0, 0.5 - 0.9 * factor)};
    });
}

TEST_P(Reliefs, FillStandsAtItsHeight) {
    Workpiece work = piece_->work();
    coat(work, "soot", 0.3, nullptr, piece_->progress);
    fill(work, "dirt", 0.9, &map_, piece_->progress);
    expectLayers([](double factor) -> std::vector<double> { return {0.3, std::max(0.0, 0.9 * factor - 0.3)}; });
}

TEST_P(Reliefs, PolishCutsToItsHeight) {
    Workpiece work = piece_->work();
    coat(work, "soot", 0.6, nullptr, piece_->progress);
    coat(work, "dirt", 0.5, nullptr, piece_->progress);
    polish(work, 1.2, &map_, piece_->progress);
    expectLayers([](double factor) -> std::vector<double> {
        return {std::min(0.6, 1.2 * factor), std::clamp(1.2 * factor - 0.6, 0.0, 0.5)};
    });
}

} // namespace
} // namespace patina
