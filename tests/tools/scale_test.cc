// `--context`, the whole model's fields in a close-up, and `--exaggeration`, films drawn thicker than they are.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace patina::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

// The facets of an STL file of a box.
std::string boxFacets(const double (&low)[3], const double (&high)[3]) {
    std::ostringstream out;
    const auto corner = [&](int c) {
        out << "vertex " << (c & 1 ? high : low)[0] << ' ' << (c & 2 ? high : low)[1] << ' ' << (c & 4 ? high : low)[2]
            << '\n';
    };
    const int faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                              {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (const auto& face : faces) {
        out << "facet normal 0 0 0\nouter loop\n";
        for (const int c : face)
            corner(c);
        out << "endloop\nendfacet\n";
    }
    return out.str();
}

json reportOf(const TemporaryFolder& folder, const std::string& run) {
    return json::parse(readFile(folder.path() / run / "report.json"));
}

const Arguments noPicture = {"--resolution", "64", "--picture", "0"};

Arguments runOf(const std::string& script, const std::string& model, const std::string& out, Arguments more) {
    Arguments line{"run", script, model, "-o", out};
    line.insert(line.end(), noPicture.begin(), noPicture.end());
    line.insert(line.end(), more.begin(), more.end());
    return line;
}

// A slab of 10 × 10 × 2 cm; on the whole model a wall stands 5 mm beside the close-up, which does not show it.
class Context : public testing::Test {
  protected:
    Context() {
        const std::string slab = boxFacets({0.0, 0.0, 0.0}, {0.1, 0.02, 0.1});
        folder_.file("slab.stl", "solid a\n" + slab + "endsolid a\n");
        folder_.file("whole.stl", "solid a\n" + slab + boxFacets({0.0, 0.01, 0.0}, {0.04, 0.06, 0.1}) + "endsolid a\n");
        folder_.file("dirt.patina", "new copper\ncoat dirt 4 exposure(sky=uniform, rays=64)\n");
        folder_.file("bare.patina", "new copper\n");
    }

    Arguments closeUp(const std::string& out, Arguments more, const std::string& script = "dirt.patina") const {
        more.insert(more.end(), {"--region-at", "0.045,0.02,0.05,0.006", "--voxels", "16"});
        return runOf(script, "slab.stl", out, std::move(more));
    }
    double meanDirt(const std::string& run) const { return reportOf(folder_, run)["layers"][0]["mean_um"]; }

    TemporaryFolder folder_;
};

TEST_F(Context, GivesACloseUpTheFieldsOfTheWholeModel) {
    const auto made = vdbPatinaEach({runOf("dirt.patina", "whole.stl", "whole", {"--voxels", "48"}),
                                     runOf("bare.patina", "whole.stl", "bare", {"--voxels", "48"})},
                                    folder_.path());
    ASSERT_EQ(made[0].exitCode, 0) << made[0].err;
    ASSERT_EQ(made[1].exitCode, 0) << made[1].err;
    const auto runs = vdbPatinaEach({closeUp("alone", {}), closeUp("near", {"--context", "whole/dirt.vdb"}),
                                     closeUp("other", {"--context", "bare/bare.vdb"})},
                                    folder_.path());
    for (const Outcome& run : runs)
        ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NEAR(meanDirt("alone"), 4.0, 0.02) << "the slab sees all of the sky";
    // Of a uniform sky, the cosine law, a floor at distance x from a wall of height h sees (1 + x / hypot(x, h)) / 2
    // where the wall is long: 0.562 here. Its ends at 5 cm and voxels of 2 mm leave some hundredths.
    EXPECT_NEAR(meanDirt("near") / 4.0, 0.562, 0.06);
    EXPECT_EQ(reportOf(folder_, "other")["content_hash"], reportOf(folder_, "alone")["content_hash"])
        << "a field that the whole does not have is the close-up's own";

    folder_.file("text.vdb", "no volume\n");
    const auto bad =
        vdbPatinaEach({closeUp("bad", {"--context", "missing.vdb"}), closeUp("bad", {"--context", "text.vdb"}),
                       closeUp("bad", {"--context", "whole/dirt.vdb", "--unit", "mm"}),
                       runOf("dirt.patina", "slab.stl", "bad", {"--context", "whole/dirt.vdb"})},
                      folder_.path());
    const char* says[] = {"missing.vdb: there is no such file", "text.vdb: is damaged", "another unit",
                          "there is no --region"};
    for (std::size_t i = 0; i < bad.size(); ++i) {
        EXPECT_NE(bad[i].exitCode, 0) << i;
        EXPECT_THAT(bad[i].err, HasSubstr(says[i])) << i;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "bad"));
}

TEST(Exaggeration, DrawsFilmsThickerAndReportsThemAsTheyAre) {
    const TemporaryFolder folder;
    folder.file("film.patina", "new copper\ncoat tarnish_1 2\n");
    const auto film = [](const std::string& out, Arguments more) {
        more.insert(more.end(), {"--voxels", "32"});
        return runOf("film.patina", "sphere", out, std::move(more));
    };
    const auto runs = vdbPatinaEach({film("true", {}), film("drawn", {"--exaggeration", "50"}),
                                     film("kept", {"--exaggeration", "50", "--keep-exaggeration"})},
                                    folder.path());
    for (const Outcome& run : runs)
        ASSERT_EQ(run.exitCode, 0) << run.err;
    const json real = reportOf(folder, "true"), drawn = reportOf(folder, "drawn"), kept = reportOf(folder, "kept");
    EXPECT_EQ(real["inputs"]["exaggeration"], 1.0);
    EXPECT_EQ(drawn["inputs"]["exaggeration"], 50.0);
    for (const json& report : {real, drawn, kept})
        EXPECT_NEAR(report["layers"][0]["mean_um"].get<double>(), 2.0, 0.005 * 2.0);
    EXPECT_NE(real["content_hash"], drawn["content_hash"]);
    EXPECT_EQ(kept["content_hash"], drawn["content_hash"]);
    const double height = real["maps"]["max_displacement_units"];
    EXPECT_NEAR(height, 2e-6, 0.1e-6) << "the model is in metres";
    EXPECT_NEAR(drawn["maps"]["max_displacement_units"].get<double>() / height, 1.0, 0.01);
    EXPECT_NEAR(kept["maps"]["max_displacement_units"].get<double>() / height, 50.0, 0.5);

    std::vector<Arguments> bad;
    for (const char* value : {"0", "-1", "nan", "inf", "twice"})
        bad.push_back(film("bad", {"--exaggeration", value}));
    for (const Outcome& run : vdbPatinaEach(bad, folder.path())) {
        EXPECT_EQ(run.exitCode, 2) << run.err;
        EXPECT_THAT(run.err, HasSubstr("is not a number above 0"));
    }
    // A film drawn thicker than memory: `check`'s budget says so, and nothing starts.
    const Outcome vast = vdbPatina(film("bad", {"--exaggeration", "1e300"}), folder.path());
    EXPECT_EQ(vast.exitCode, 5);
    EXPECT_THAT(vast.err, HasSubstr("nothing was started"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "bad"));
}

} // namespace

} // namespace patina::test
