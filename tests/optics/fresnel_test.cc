#include "optics/fresnel.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Fresnel, normalIncidence) {
    EXPECT_NEAR(normalReflectance(1.5, 0.0), 0.04, 1e-12);
    EXPECT_NEAR(normalReflectance(0.0, 3.0), 1.0, 1e-12);
    EXPECT_NEAR(dielectricReflectance(1.0, 1.5), 0.04, 1e-12);
    EXPECT_NEAR(dielectricReflectance(0.0, 1.5), 1.0, 1e-12);
    EXPECT_NEAR(normalReflectance(1.5, 0.0, 1.5), 0.0, 1e-12);
}

TEST(Fresnel, nothingPassesBeyondTheCriticalAngle) {
    EXPECT_EQ(dielectricReflectance(0.7, 1.0 / 1.5), 1.0);
    EXPECT_LT(dielectricReflectance(0.8, 1.0 / 1.5), 1.0);
}

TEST(Fresnel, diffuseReflectanceHasThePublishedValues) {
    const struct {
        double index, external, internal;
    } values[] = {{1.33, 0.06593, 0.47195},
                  {1.5, 0.09178, 0.59635},
                  {1.55, 0.09907, 0.62500},
                  {2.0, 0.16060, 0.79015},
                  {2.7, 0.24441, 0.89635}};
    for (const auto& value : values) {
        EXPECT_NEAR(diffuseInterface(value.index).external, value.external, 2e-5) << value.index;
        EXPECT_NEAR(diffuseInterface(value.index).internal, value.internal, 2e-5) << value.index;
    }
    EXPECT_NEAR(diffuseInterface(1.0).internal, 0.0, 1e-12);
}

TEST(Saunderson, givesThePublishedValuesAndItsInverseUndoesIt) {
    EXPECT_NEAR(saunderson(0.5, 0.04, 0.6), 0.314286, 1e-6);
    EXPECT_NEAR(saunderson(0.8, 0.04, 0.6), 0.630769, 1e-6);
    EXPECT_NEAR(saunderson(1.0, 0.04, 0.6), 1.0, 1e-12);
    for (double r : {0.0, 0.1, 0.5, 1.0}) {
        EXPECT_NEAR(inverseSaunderson(saunderson(r, 0.04, 0.6), 0.04, 0.6), r, 1e-12);
    }
    EXPECT_EQ(inverseSaunderson(0.01, 0.04, 0.6), 0.0);
}

} // namespace
} // namespace patina
