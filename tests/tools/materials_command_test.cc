#include "program.h"

#include "render/film.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

namespace patina {
namespace {

using testing::HasSubstr;

TEST(MaterialsCommand, DrawsASwatchThatEndsInTheOpaqueColour) {
    const test::TemporaryFolder folder;
    const auto outcome = test::vdbPatina({"materials", "brochantite", "-o", "."}, folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const Image swatch = readPng(folder.path() / "brochantite_swatch.png");
    ASSERT_EQ(swatch.width, 760);
    // The first strip: copper on the left, green on the right.
    const int row = 45 + 24 + 28;
    const Imath::V3f left = swatch.rgb(26, row), right = swatch.rgb(760 - 26, row);
    EXPECT_GT(left.x, left.y);
    EXPECT_GT(right.y, right.x);
    EXPECT_EQ(test::vdbPatina({"materials", "copper", "-o", "."}, folder.path()).exitCode, 0);
    EXPECT_EQ(test::vdbPatina({"materials", "brochantite", "--over", "copper"}, folder.path()).exitCode, 2);
    EXPECT_THAT(test::vdbPatina({"materials", "brochantit"}, folder.path()).err,
                HasSubstr("did you mean 'brochantite'?"));
}

TEST(MaterialsCommand, FitsWhatTwoBackingsShow) {
    const test::TemporaryFolder folder;
    const auto write = [&](const char* name, double reflectance) {
        std::ofstream file(folder.path() / name);
        file << "wavelength_nm,reflectance\n";
        for (int nm = 400; nm <= 700; nm += 20)
            file << nm << "," << reflectance << "\n";
        return (folder.path() / name).string();
    };
    // 2 µm of K = 0, S = 0.5: over black R = S d / (1 + S d) = 0.5; over white 1 all comes back, over 0.5 two thirds.
    const std::string black = write("black.csv", 0.5), grey = write("grey.csv", 2.0 / 3.0);
    const auto outcome = test::vdbPatina({"materials", "fit", "--layer", black, "--thickness", "2", "--second", grey,
                                          "--second-backing", "0.5", "--body", "--name", "mine", "-o", "."},
                                         folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("0.5000"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "mine.toml"));
    const auto alike = test::vdbPatina(
        {"materials", "fit", "--layer", black, "--thickness", "2", "--second", grey, "--second-backing", "0", "--body"},
        folder.path());
    EXPECT_EQ(alike.exitCode, 3);
    EXPECT_THAT(alike.err, HasSubstr("backings are too alike"));
    EXPECT_EQ(test::vdbPatina({"materials", "fit"}, folder.path()).exitCode, 2);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "fitted.toml"));
}

} // namespace
} // namespace patina
