#include "render/plate.h"

#include "base/errors.h"

#include <Imath/ImathBox.h>
#include <gtest/gtest.h>

namespace patina {
namespace {

PlacedImage placed(int row, int column, int size, float grey, int rows = 1) {
    PlacedImage out;
    out.picture = {Image(size, size, 3, grey), ""};
    out.row = row;
    out.column = column;
    out.rows = rows;
    return out;
}

// Rows and columns in which a grey stands.
Imath::Box2i boxOf(const Image& image, float grey) {
    Imath::Box2i box;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (std::abs(image.at(x, y)[0] - grey) < 1e-3f)
                box.extendBy(Imath::V2i(x, y));
    return box;
}

TEST(Plate, ALargePictureStandsBesideTwoSmallOnes) {
    ContactSheetOptions options;
    options.gap = 10;
    const ContactSheet sheet =
        makePlate({placed(0, 0, 40, 0.1f), placed(1, 0, 40, 0.2f), placed(0, 1, 90, 0.3f, 2)}, options);
    // Two of 40 and a gap make room for 90; three gaps and two columns across.
    EXPECT_EQ(sheet.image.width, 10 + 40 + 10 + 90 + 10);
    EXPECT_EQ(sheet.image.height, 10 + 90 + 10);
    EXPECT_EQ(boxOf(sheet.image, 0.1f), Imath::Box2i({10, 10}, {49, 49}));
    EXPECT_EQ(boxOf(sheet.image, 0.2f), Imath::Box2i({10, 60}, {49, 99}));
    EXPECT_EQ(boxOf(sheet.image, 0.3f), Imath::Box2i({60, 10}, {149, 99}));
}

TEST(Plate, RowsGrowForWhatSpansThem) {
    ContactSheetOptions options;
    options.gap = 10;
    const ContactSheet sheet =
        makePlate({placed(0, 0, 40, 0.1f), placed(1, 0, 40, 0.2f), placed(0, 1, 130, 0.3f, 2)}, options);
    EXPECT_EQ(sheet.image.height, 10 + 130 + 10);
    EXPECT_EQ(boxOf(sheet.image, 0.3f).min.y, 10);
    EXPECT_EQ(boxOf(sheet.image, 0.1f).min.y, 20) << "in the middle of a row that is now 60 high";
}

TEST(Plate, RefusesOverlapsAndNothing) {
    EXPECT_THROW(makePlate({}), RunError);
    EXPECT_THROW(makePlate({placed(0, 0, 8, 0.1f, 2), placed(1, 0, 8, 0.1f)}), RunError);
    EXPECT_THROW(makePlate({placed(-1, 0, 8, 0.1f)}), RunError);
}

} // namespace
} // namespace patina
