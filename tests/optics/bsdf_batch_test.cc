#include "optics/bsdf_batch.h"

#include "base/random.h"
#include "optics_test_support.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Imath::V3f;

V3f directionOf(const KeyedRandom& random, std::uint32_t event, int lane) {
    const auto r = random.uniforms(event, lane, 0, 0);
    const float z = float(r[0]) * 1.1f - 0.1f, turn = float(r[1] * 2.0 * M_PI),
                s = std::sqrt(std::max(0.f, 1.f - z * z));
    return {s * std::cos(turn), s * std::sin(turn), z};
}

Appearance lookOf(const KeyedRandom& random, int lane, OpticsModel model) {
    const auto r = random.uniforms(7, lane, 0, 0);
    Appearance look;
    look.model = model;
    look.diffuse = V3f(float(r[0]), float(r[1]), float(r[2])) * (lane % 5 == 0 ? 0.f : 0.4f);
    for (int k = 0; k < lane % 4; ++k) {
        const auto s = random.uniforms(8, lane, k, 0), t = random.uniforms(9, lane, k, 0);
        Lobe lobe;
        lobe.air = lane % 3 == 0 ? 0.f : 0.04f * float(s[3]);
        lobe.airEdge = lane % 3 == 0 ? 0.f : 0.2f;
        lobe.colour = V3f(float(s[0]), float(s[1]), float(s[2])) * 0.3f + V3f(lobe.air);
        lobe.edgeColour = V3f(0.3f) + V3f(lobe.airEdge);
        lobe.roughness = float(t[0]);
        lobe.alpha = float(t[1] * t[1]);
        look.lobes.push_back(lobe);
    }
    return look;
}

class BsdfBatchOf : public testing::TestWithParam<OpticsModel> {};

// Lanes with none to three lobes side by side, in numbers that do not fill a group.
TEST_P(BsdfBatchOf, eachLaneIsItsBsdfToTheBit) {
    const KeyedRandom random(3, "batch", "test");
    BsdfBatch batch;
    for (const std::size_t count : {1u, 16u, 133u}) {
        const std::size_t lanes = BsdfBatch::padded(count);
        VectorLanes wo, wi, u, drawn, value;
        for (VectorLanes* of : {&wo, &wi, &u, &drawn, &value})
            of->resize(lanes);
        std::vector<float> pdf(lanes);
        std::vector<PatinaBsdf> bsdfs;
        batch.begin(count);
        for (std::size_t i = 0; i < count; ++i) {
            bsdfs.emplace_back(lookOf(random, int(i), GetParam()));
            batch.set(i, bsdfs.back());
            wo.set(i, directionOf(random, 1, int(i)));
            wi.set(i, directionOf(random, 2, int(i)));
            const auto r = random.uniforms(3, int(i), 0, 0);
            u.set(i, V3f(float(r[0]), float(r[1]), float(r[2])) * 0.999999f);
        }
        batch.seenFrom(wo);
        batch.evaluate(wi, value, pdf);
        for (std::size_t i = 0; i < count; ++i) {
            const BsdfValue one = SeenBsdf(bsdfs[i], wo[i]).evaluate(wi[i]);
            EXPECT_EQ(value[i], one.value) << i;
            EXPECT_EQ(pdf[i], one.pdf) << i;
        }
        batch.sample(u, drawn, value, pdf);
        std::size_t seen = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const BsdfSample one = SeenBsdf(bsdfs[i], wo[i]).sample(u[i]);
            EXPECT_EQ(pdf[i], one.pdf) << i;
            if (!(one.pdf > 0.f))
                continue;
            ++seen;
            EXPECT_EQ(drawn[i], one.wi) << i;
            EXPECT_EQ(value[i] * (drawn[i].z / pdf[i]), one.weight) << i;
        }
        EXPECT_GE(4 * seen, 2 * count - 2);
    }
}

INSTANTIATE_TEST_SUITE_P(EachModel, BsdfBatchOf, testing::Values(OpticsModel::energyConserving, OpticsModel::paper));

} // namespace
} // namespace patina
