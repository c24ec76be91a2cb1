#include "export/texture_file.h"

#include "base/errors.h"
#include "export/exr_file.h"
#include "support/temporary_folder.h"

#include <OpenImageIO/imagebuf.h>

#include <gmock/gmock.h>

namespace patina {
namespace {

TEST(TextureFile, KeepsTheHeightsAndAddsTilesAndLevels) {
    test::TemporaryFolder folder;
    MapImage map;
    map.size = 128;
    for (int i = 0; i < 128 * 128; ++i)
        map.floats.push_back(-1e-6f * float(i % 977) * 1.1f);
    map.texts.emplace_back("patina_units", "scene units");
    writeExr(map, folder / "displacement.exr");
    writeTx(folder / "displacement.exr", folder / "displacement.tx");
    OIIO::ImageBuf texture((folder / "displacement.tx").string());
    ASSERT_TRUE(texture.read(0, 0, true, OIIO::TypeDesc::FLOAT)) << texture.geterror();
    EXPECT_EQ(texture.spec().tile_width, 64);
    EXPECT_EQ(texture.nmiplevels(), 8); // 128, 64 … 1
    EXPECT_EQ(texture.nchannels(), 1);
    EXPECT_EQ(texture.spec().get_string_attribute("patina_units"), "scene units");
    for (int i = 0; i < 128 * 128; ++i)
        ASSERT_EQ(texture.getchannel(i % 128, i / 128, 0, 0), map.floats[i]) << i;
}

TEST(TextureFile, FailsWithAnErrorAndLeavesNothing) {
    test::TemporaryFolder folder;
    EXPECT_THROW(writeTx(folder / "missing.exr", folder / "missing.tx"), RunError);
    EXPECT_FALSE(std::filesystem::exists(folder / "missing.tx"));
}

} // namespace
} // namespace patina
