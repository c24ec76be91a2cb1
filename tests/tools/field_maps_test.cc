// Fields from a script into the volume, and from there into images: what `run --fields` writes, `bake --fields` reads out
// of the .vdb bit for bit.

#include "program.h"

#include "export/exr_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace patina::test {
namespace {

namespace fs = std::filesystem;

// Whichever of the two a file holds.
std::vector<float> valuesOf(const MapImage& map) {
    if (!map.floats.empty())
        return map.floats;
    return {map.halves.begin(), map.halves.end()};
}

TEST(FieldMaps, GoThroughTheVolumeIntoImagesUnchanged) {
    const TemporaryFolder folder;
    folder.file("open_air.patina", "new copper\ncoat soot 0.5 wetness(sky=uniform, rays=64)\n"
                                   "coat dirt 0.2 exposure(sky=uniform, rays=64)\ncoat wax 0.1 accessibility(80mm)\n");
    const Arguments size = {"--voxels", "40", "--resolution", "64", "--picture", "0", "--fields"};
    Arguments run = {"run", "open_air.patina", "sphere", "-o", "a"};
    Arguments bake = {"bake", "a/open_air.vdb", "sphere", "-o", "b"};
    run.insert(run.end(), size.begin(), size.end());
    bake.insert(bake.end(), {"--resolution", "64", "--fields"});
    const Outcome ran = vdbPatina(run, folder.path());
    ASSERT_EQ(ran.exitCode, 0) << ran.err;
    const Outcome baked = vdbPatina(bake, folder.path());
    ASSERT_EQ(baked.exitCode, 0) << baked.err;
    for (const char* name : {"wetness_uniform_nosun_rays64", "exposure_uniform_nosun_rays64", "accessibility_80mm"}) {
        const std::string file = std::string("field_") + name + ".exr";
        ASSERT_TRUE(fs::exists(folder.path() / "a" / file)) << file;
        ASSERT_TRUE(fs::exists(folder.path() / "b" / file)) << file;
        const std::vector<float> first = valuesOf(readExr(folder.path() / "a" / file));
        EXPECT_EQ(first, valuesOf(readExr(folder.path() / "b" / file))) << file;
        ASSERT_FALSE(first.empty()) << file;
        for (const float value : first)
            ASSERT_TRUE(value >= 0.f && value <= 1.f) << file;
    }
    // A ball is bright on top and dark below, and every place of it can be reached.
    const auto light = valuesOf(readExr(folder.path() / "a/field_exposure_uniform_nosun_rays64.exr"));
    EXPECT_GT(*std::max_element(light.begin(), light.end()), 0.97f);
    const auto reach = valuesOf(readExr(folder.path() / "a/field_accessibility_80mm.exr"));
    EXPECT_GT(*std::max_element(reach.begin(), reach.end()), 0.99f);
    EXPECT_GT(std::count_if(reach.begin(), reach.end(), [](float v) { return v > 0.99f; }),
              std::count_if(reach.begin(), reach.end(), [](float v) { return v > 0.01f && v < 0.99f; }));
}

} // namespace
} // namespace patina::test
