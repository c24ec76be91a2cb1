#include "render/section_picture.h"

#include "operators/coat.h"
#include "operators/erode.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

const std::vector<SectionMaterial> materials = {
    {"copper", {0.9f, 0.5f, 0.3f}}, {"cuprite_2", {0.4f, 0.1f, 0.1f}}, {"brochantite", {0.3f, 0.7f, 0.5f}}};

SectionPicture picture(double stretch) {
    auto piece = test::makePiece(test::sphere(30.f, 5), test::voxelScale());
    Workpiece work = piece->work();
    coat(work, "cuprite_2", 0.5, nullptr, piece->progress);
    coat(work, "brochantite", 1.0, nullptr, piece->progress);
    SectionOptions options;
    options.at = Imath::V3d(30.0, 0.0, 0.0);
    options.along = Imath::V3d(0.0, 1.0, 0.0);
    options.width = 20.0;
    options.stretch = stretch;
    return drawSection(*piece->volume, materials, options);
}

// Rows of one column that show a colour.
int rowsOf(const Image& image, int column, const Imath::V3f& colour) {
    int rows = 0;
    for (int y = 0; y < image.height; ++y)
        rows += (image.rgb(column, y) - colour).length() < 1e-4f;
    return rows;
}

TEST(SectionPicture, LayersAreAsHighAsTheyAreThick) {
    const SectionPicture section = picture(4.0);
    EXPECT_DOUBLE_EQ(section.stretch, 4.0);
    EXPECT_DOUBLE_EQ(section.cutFraction, 1.0);
    EXPECT_NEAR(section.meanThicknessUm[0], 0.5, 0.01);
    EXPECT_NEAR(section.meanThicknessUm[1], 1.0, 0.01);
    const int column = section.image.width / 4;
    // Both were drawn at the same scale, whatever that is; lines between layers take a row each.
    EXPECT_NEAR(rowsOf(section.image, column, materials[2].colour) /
                    double(rowsOf(section.image, column, materials[1].colour)),
                2.0, 0.1);
}

TEST(SectionPicture, StretchStretchesThicknessOnly) {
    const Image low = picture(2.0).image, high = picture(4.0).image;
    const int column = low.width / 4;
    EXPECT_NEAR(rowsOf(high, column, materials[2].colour) / double(rowsOf(low, column, materials[2].colour)), 2.0,
                0.12);
}

// Metal that was eroded is not drawn: half of the cut stands 3 µm lower.
TEST(SectionPicture, ErodedMetalIsAPit) {
    auto piece = test::makePiece(test::sphere(30.f, 5), test::voxelScale());
    Workpiece work = piece->work();
    const test::FunctionMap pit([](const MapPoint& point) { return point.position.y > 0.0 ? 1.0 : 0.0; });
    erode(work, 3.0, &pit, {}, piece->progress, 1.0);
    coat(work, "cuprite_2", 0.5, nullptr, piece->progress);
    SectionOptions options;
    options.at = Imath::V3d(30.0, 0.0, 0.0);
    options.along = Imath::V3d(0.0, 1.0, 0.0);
    options.width = 20.0;
    for (const double stretch : {0.0, 1.5}) {
        options.stretch = stretch;
        const SectionPicture section = drawSection(*piece->volume, materials, options);
        const int whole = section.image.width / 8, pitted = section.image.width / 2;
        const int missing =
            rowsOf(section.image, whole, materials[0].colour) - rowsOf(section.image, pitted, materials[0].colour);
        EXPECT_NEAR(missing / section.rowsPerUm, 3.0, 0.15) << stretch;
        // The layer lies on the floor of the pit as thick as beside it.
        EXPECT_NEAR(rowsOf(section.image, pitted, materials[1].colour) / section.rowsPerUm, 0.5, 0.1) << stretch;
        EXPECT_GT(rowsOf(section.image, pitted, materials[0].colour), 5) << "there is metal under the pit";
    }
}

TEST(SectionPicture, FindsAStretchThatFits) {
    const SectionPicture section = picture(0.0);
    const int rows = rowsOf(section.image, section.image.width / 4, materials[2].colour);
    EXPECT_GT(rows, section.image.height / 10);
    EXPECT_LT(rows, section.image.height / 2);
}

} // namespace
} // namespace patina
