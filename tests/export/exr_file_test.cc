#include "export/exr_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

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

// Chunks of 16 rows that noise leaves uncompressed, that are full of runs, that end early; rows given as they come.
TEST_F(ExrFileTest, AnySizeComesBackHoweverItsRowsAreGiven) {
    std::minstd_rand random(1);
    for (const int size : {1, 7, 16, 33, 100})
        for (const int channels : {1, 3})
            for (const bool isHalf : {false, true})
                for (const bool noise : {false, true}) {
                    MapImage map;
                    map.name = "map";
                    map.size = size;
                    map.channels = channels;
                    map.isHalf = isHalf;
                    const std::size_t values = static_cast<std::size_t>(size) * size * channels;
                    for (std::size_t i = 0; i < values; ++i) {
                        const std::uint32_t bits = noise ? std::uint32_t(random()) ^ std::uint32_t(random()) << 16
                                                         : static_cast<std::uint32_t>(i / 200 * 0x01234567);
                        // No NaN, which is never itself.
                        if (isHalf) {
                            map.halves.emplace_back(Imath::half::FromBits, static_cast<std::uint16_t>(bits & 0xbbff));
                        } else {
                            const std::uint32_t plain = bits & 0xbfffffff;
                            float value;
                            std::memcpy(&value, &plain, 4);
                            map.floats.push_back(value);
                        }
                    }
                    ExrWriter writer(map, folder_ / "map.exr");
                    const auto* rows = isHalf ? reinterpret_cast<const char*>(map.halves.data())
                                              : reinterpret_cast<const char*>(map.floats.data());
                    for (int done = 0, count = 5; done < size; done += count, count += 13) {
                        count = std::min(count, size - done);
                        writer.write(rows + map.pixelBytes() * size * done, count);
                    }
                    writer.finish();
                    writer.commit();
                    const MapImage read = readExr(folder_ / "map.exr");
                    EXPECT_TRUE(read.floats == map.floats && read.size == size && read.channels == channels);
                    ASSERT_EQ(read.halves.size(), map.halves.size());
                    for (std::size_t i = 0; i < map.halves.size(); ++i)
                        ASSERT_EQ(read.halves[i].bits(), map.halves[i].bits());
                }
}

TEST_F(ExrFileTest, FilesWhoseRowsAreMissingAreErrors) {
    MapInfo map;
    map.size = 32;
    ExrWriter writer(map, folder_ / "map.exr");
    writer.write(std::vector<float>(32 * 17).data(), 17);
    EXPECT_THROW(writer.finish(), RunError);
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
