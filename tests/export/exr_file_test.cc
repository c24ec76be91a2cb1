#include "export/exr_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>

namespace patina {
namespace {

namespace fs = std::filesystem;

class ExrFileTest : public testing::Test {
  protected:
    test::TemporaryFolder folder_;
};

TEST_F(ExrFileTest, FloatsComeBackBitForBit) {
    MapImage map;
    map.size = 16;
    for (int i = 0; i < 256; ++i)
        map.floats.push_back(1e-6f * float(i) * 1.1f);
    map.numbers.emplace_back("patina_max_displacement", 0.25f);
    map.texts.emplace_back("patina_units", "scene units");
    writeExr(map, folder_ / "displacement.exr");
    const MapImage read = readExr(folder_ / "displacement.exr");
    EXPECT_EQ(read.floats, map.floats);
    EXPECT_EQ(read.channels, 1);
    EXPECT_FALSE(read.isColour);
    EXPECT_THAT(read.numbers, testing::Contains(testing::Pair("patina_max_displacement", 0.25f)));
    EXPECT_THAT(read.texts, testing::Contains(testing::Pair("patina_colour_space", "data")));
}

TEST_F(ExrFileTest, HalfColoursComeBackInTheirOrder) {
    MapImage map;
    map.size = 2;
    map.channels = 3;
    map.isColour = true;
    for (int i = 0; i < 12; ++i)
        map.halves.push_back(Imath::half(float(i) / 8.f));
    writeExr(map, folder_ / "diffuse.exr");
    const MapImage read = readExr(folder_ / "diffuse.exr");
    ASSERT_EQ(read.halves.size(), 12u);
    for (int i = 0; i < 12; ++i)
        EXPECT_EQ(float(read.halves[i]), float(i) / 8.f);
    EXPECT_TRUE(read.isColour);
    EXPECT_THAT(read.texts, testing::Contains(testing::Pair("patina_colour_space", "lin_rec709")));
}

TEST_F(ExrFileTest, FilesThatAreNoMapsAreErrors) {
    writeTextFile(folder_ / "text.exr", "not an image");
    EXPECT_THROW(readExr(folder_ / "text.exr"), RunError);
    EXPECT_THROW(readExr(folder_ / "nothing.exr"), RunError);
    MapImage map;
    map.size = 1;
    map.floats = {1.f};
    EXPECT_THROW(writeExr(map, folder_ / "no" / "a.exr"), RunError);
}

} // namespace
} // namespace patina
