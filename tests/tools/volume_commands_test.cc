// The commands beside `run`: info, check, bake, render, probe, materials, make, contact-sheet.

#include "base/hash.h"
#include "program.h"
#include "render/exr_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <sstream>

namespace patina::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

// One sphere with 0.35 µm of tarnish and 1 µm of soot on it, made once; every test has a copy.
class VolumeCommands : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        ball = std::make_unique<TemporaryFolder>();
        ball->file("ball.patina", "new copper\ncoat tarnish_1 0.35\ncoat soot 1\n");
        made = vdbPatina(small({"run", "ball.patina", "sphere"}), ball->path());
    }

    static void TearDownTestSuite() { ball.reset(); }

    void SetUp() override {
        ASSERT_EQ(made.exitCode, 0) << made.err;
        std::filesystem::copy(ball->path(), folder.path(), std::filesystem::copy_options::recursive);
        hash = contentHashIn(made.out);
    }

    Outcome run(const Arguments& words, const std::string& input = {}) const {
        return vdbPatina(words, folder.path(), input);
    }

    inline static std::unique_ptr<TemporaryFolder> ball;
    inline static Outcome made;
    TemporaryFolder folder;
    std::string hash;
};

TEST_F(VolumeCommands, InfoTellsGridsLayersThicknessAndProvenance) {
    const Outcome text = run({"info", "ball/ball.vdb"});
    ASSERT_EQ(text.exitCode, 0) << text.err;
    for (const char* part : {"model 'sphere'", "script 'ball'", "1=copper", "2=tarnish_1", "3=soot", "base ",
                             "interface_01_tarnish_1", "interface_02_soot", "material ", "µm on average"})
        EXPECT_THAT(text.out, HasSubstr(part));
    EXPECT_EQ(contentHashIn(text.out), hash);

    const Outcome outcome = run({"info", "--json", "ball/ball.vdb"});
    const json info = json::parse(outcome.out, nullptr, false);
    ASSERT_TRUE(info.is_object()) << outcome.out;
    EXPECT_EQ(info["content_hash"], hash);
    EXPECT_EQ(info["layers"], json({"tarnish_1", "soot"}));
    EXPECT_EQ(info["palette"], json({"air", "copper", "tarnish_1", "soot"}));
    EXPECT_EQ(info["script"], "new copper\ncoat tarnish_1 0.35\ncoat soot 1\n");
    EXPECT_NEAR(info["thickness"][0]["mean_um"].get<double>(), 0.35, 0.0035);
    EXPECT_NEAR(info["thickness"][1]["mean_um"].get<double>(), 1.0, 0.01);

    // Far from its model it still tells the rest.
    std::filesystem::copy(folder.path() / "ball/ball.vdb", folder.path() / "alone.vdb");
    const Outcome alone = run({"info", "alone.vdb"});
    EXPECT_EQ(alone.exitCode, 0);
    EXPECT_THAT(alone.out, HasSubstr("give the model behind the file"));
    EXPECT_THAT(run({"info", "alone.vdb", "sphere"}).out, HasSubstr("µm on average"));
    EXPECT_EQ(run({"info", "alone.vdb", "strip"}).exitCode, 4);
}

TEST_F(VolumeCommands, CheckTellsTheBudgetOfAModel) {
    const Outcome alone = run({"check", "ball.patina"});
    EXPECT_EQ(alone.exitCode, 0);
    EXPECT_EQ(alone.out, "ball.patina: 3 statements, no errors\n");
    const Outcome outcome = run({"check", "ball.patina", "sphere", "--voxels", "64"});
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_THAT(outcome.out, HasSubstr("ball.patina: 3 statements, no errors\nbudget: "));
    EXPECT_EQ(run({"check", "ball.patina", "sphere", "--budget", "0.001"}).exitCode, 5);
    EXPECT_EQ(filesIn(folder.path()), (std::set<std::string>{"ball", "ball.patina"}));
}

TEST_F(VolumeCommands, BakeGivesTheMapsOfTheRun) {
    const Outcome outcome = run({"bake", "ball/ball.vdb", "sphere", "-o", "baked", "--resolution", "64"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    std::set<std::string> expected = filesIn(folder.path() / "ball");
    for (const char* notBaked : {"ball.vdb", "preview.png"})
        expected.erase(notBaked);
    EXPECT_EQ(filesIn(folder.path() / "baked"), expected);
    for (const char* map : {"displacement.exr", "thickness_02_soot.exr", "diffuse.exr", "normal.exr"})
        EXPECT_EQ(readFile(folder.path() / "baked" / map), readFile(folder.path() / "ball" / map)) << map;

    const json report = json::parse(readFile(folder.path() / "baked/report.json"));
    EXPECT_EQ(report["schema"], 1);
    EXPECT_EQ(report["content_hash"], hash);
    EXPECT_EQ(report["maps"], json::parse(readFile(folder.path() / "ball/report.json"))["maps"]);
    EXPECT_EQ(report["maps"]["fold_fraction"], 0.0);
    EXPECT_EQ(report["outputs"].size() + 1, expected.size()); // and itself

    // Without a model: the mesh that the run left beside the volume.
    const Outcome beside = run({"bake", "ball/ball.vdb", "-o", "beside", "--resolution", "64"});
    ASSERT_EQ(beside.exitCode, 0) << beside.err;
    EXPECT_EQ(filesIn(folder.path() / "beside"), expected);
    EXPECT_EQ(readFile(folder.path() / "beside/displacement.exr"), readFile(folder.path() / "ball/displacement.exr"));

    // Into the run's own folder: its report stays.
    const std::string ofTheRun = readFile(folder.path() / "ball/report.json");
    ASSERT_EQ(run({"bake", "ball/ball.vdb", "-o", "ball", "--resolution", "64"}).exitCode, 0);
    EXPECT_EQ(readFile(folder.path() / "ball/report.json"), ofTheRun);
    EXPECT_EQ(filesIn(folder.path() / "ball").count("bake_report.json"), 1u);

    const Outcome other = run({"bake", "ball/ball.vdb", "strip", "-o", "other", "--resolution", "64"});
    EXPECT_EQ(other.exitCode, 4);
    EXPECT_THAT(other.err, HasSubstr("strip: is not the model that 'ball/ball.vdb' was made from ('sphere')"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "other"));
}

// A grid goes by another name; the file is sealed again, so that nothing else is wrong with it.
TEST_F(VolumeCommands, AMissingGridIsNamedAndNothingIsBaked) {
    std::string bytes = readFile(folder.path() / "ball/ball.vdb");
    constexpr std::size_t sealBytes = 16;
    const std::string name("\x08\0\0\0material", 12), other("\x08\0\0\0somewhat", 12);
    int found = 0;
    for (std::size_t at = bytes.find(name); at != std::string::npos; at = bytes.find(name, at + 1), ++found)
        bytes.replace(at, name.size(), other);
    ASSERT_GE(found, 1);
    ContentHash hashed;
    hashed.add(bytes.data(), bytes.size() - sealBytes);
    const std::uint64_t digest = hashed.digest();
    std::memcpy(bytes.data() + bytes.size() - sizeof digest, &digest, sizeof digest);
    folder.file("ball/other.vdb", bytes);
    const Outcome outcome = run({"bake", "ball/other.vdb", "sphere", "-o", "baked", "--resolution", "64"});
    EXPECT_EQ(outcome.exitCode, 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("error: ball/other.vdb: has no grid 'material'"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "baked"));
}

// Two quads side by side, 1 cm each: the first fills the unit square, the second lies from one u to another.
std::string twoQuads(const std::string& firstU, const std::string& lastU) {
    return "v 0 0 0\nv 0.01 0 0\nv 0.02 0 0\nv 0 0.01 0\nv 0.01 0.01 0\nv 0.02 0.01 0\n"
           "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
           "vt " +
           firstU + " 0\nvt " + lastU + " 0\nvt " + lastU + " 1\nvt " + firstU +
           " 1\n"
           "f 1/1 2/2 5/3 4/4\nf 2/5 3/6 6/7 5/8\n";
}

TEST_F(VolumeCommands, ChartsOnEachOtherAreNamedAndNoFolderIsLeft) {
    folder.file("quads.obj", twoQuads("0", "1"));
    const Outcome outcome = run({"run", "ball.patina", "quads.obj", "-o", "new/charts", "--scheme", "none", "--voxels",
                                 "32", "--resolution", "64", "--picture", "0"});
    EXPECT_EQ(outcome.exitCode, 4) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("faces 1 and 2: lie on each other in the UVs"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "new"));
}

TEST_F(VolumeCommands, SeveralUvTilesGiveSeveralFiles) {
    folder.file("quads.obj", twoQuads("1", "2"));
    const Arguments words =
        small({"run", "ball.patina", "quads.obj", "-o", "tiles", "--scheme", "none", "--picture", "0"});
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto files = filesIn(folder.path() / "tiles");
    for (const char* map : {"displacement", "diffuse", "thickness_02_soot"})
        for (const char* tile : {".1001.exr", ".1002.exr"})
            EXPECT_EQ(files.count(map + std::string(tile)), 1u) << map << tile;
    EXPECT_EQ(files.count("displacement.exr"), 0u);
    EXPECT_THAT(readFile(folder.path() / "tiles/ball.usda"), HasSubstr("@./base_color.<UDIM>.exr@"));
    EXPECT_THAT(readFile(folder.path() / "tiles/ball.mtlx"), HasSubstr("base_color.&lt;UDIM&gt;.exr"));
    EXPECT_EQ(json::parse(readFile(folder.path() / "tiles/report.json"))["maps"]["udims"], (json{1001, 1002}));
    // The mesh beside the volume has the UVs of the maps, a hair inside their tiles.
    const Outcome again = run({"bake", "tiles/ball.vdb", "-o", "again", "--scheme", "none", "--resolution", "64"});
    ASSERT_EQ(again.exitCode, 0) << again.err;
    EXPECT_EQ(readFile(folder.path() / "again/diffuse.1002.exr"), readFile(folder.path() / "tiles/diffuse.1002.exr"));
}

TEST_F(VolumeCommands, ChartsThatCannotBeBakedAreToldBeforeTheRun) {
    const struct {
        std::string obj, error;
    } cases[] = {{twoQuads("0", "1"), "faces 1 and 2"},                            // on each other
                 {twoQuads("1", "0"), "faces 1 and 2"},                            // the same, mirrored
                 {twoQuads("0.5", "1.5"), "face 2: its UV (0.5, 0) lies outside"}, // in two tiles
                 {twoQuads("-1", "0"), "face 2: its UV (-1, 0) lies outside"},     // in none that has a number
                 {twoQuads("11", "12"), "face 2: its UV (11, 0) lies outside"}};
    for (const auto& one : cases) {
        folder.file("quads.obj", one.obj);
        const Outcome outcome = run(small({"run", "ball.patina", "quads.obj", "-o", "no", "--scheme", "none"}));
        EXPECT_EQ(outcome.exitCode, 4) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(one.error));
        EXPECT_THAT(outcome.err, HasSubstr("--atlas"));
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "no"));
    }
    const Outcome outcome =
        run(small({"run", "ball.patina", "quads.obj", "-o", "yes", "--scheme", "none", "--atlas", "--picture", "0"}));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
}

TEST_F(VolumeCommands, RenderMakesAPictureWithOrWithoutTheModel) {
    for (const Arguments& model : {Arguments{}, Arguments{"sphere"}}) {
        Arguments words{"render", "ball/ball.vdb"};
        words.insert(words.end(), model.begin(), model.end());
        for (const char* word : {"-o", "pictures", "--picture", "32", "--samples", "1"})
            words.emplace_back(word);
        const Outcome outcome = run(words);
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "pictures/ball.png\n");
        EXPECT_EQ(readFile(folder.path() / "pictures/ball.png").substr(1, 3), "PNG");
        std::filesystem::remove(folder.path() / "pictures/ball.png");
    }
    EXPECT_EQ(run({"render", "ball/ball.vdb", "--picture", "0"}).exitCode, 2);

    const auto small = [&](Arguments words) {
        words.insert(words.begin(), {"render", "ball/ball.vdb", "--picture", "48", "--samples", "2", "-o", "lit"});
        return run(words);
    };
    for (const Arguments& words :
         {Arguments{"--light", "sky", "--sun", "20,10"}, Arguments{"--light", "overcast", "--no-floor"},
          Arguments{"--from", "volume", "--exr"}, Arguments{"--camera", "30,20,0.5,30", "--f-stop", "2"},
          Arguments{"--closeup", "0.05,0.05,0,0.01", "--view", "srgb", "--exposure", "-1"}})
        EXPECT_EQ(small(words).exitCode, 0) << words[0];
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "lit/ball.exr"));
    for (const Arguments& words :
         {Arguments{"--light", "moon"}, Arguments{"--camera", "30"}, Arguments{"--sun", "x,1", "--light", "sky"},
          Arguments{"--closeup", "5,5,5,0.01"}, Arguments{"--closeup", "0.05,0.05,0,0"}, Arguments{"--from", "air"}})
        EXPECT_EQ(small(words).exitCode, 2) << words[1];
    EXPECT_EQ(small({"--camera", "0,0,0.01"}).exitCode, 1); // inside the metal
}

TEST_F(VolumeCommands, RenderSaysWhatItCannotMakeAPictureOf) {
    const auto tried = [&](Arguments words) {
        words.insert(words.begin(), {"render", "ball/ball.vdb", "--samples", "1", "-o", "no"});
        return run(words);
    };
    EXPECT_EQ(run({"render", "ball/ball.vdb", "--samples", "0"}).exitCode, 2);
    // Whatever the volume is: its size is known to be too large before anything is read.
    folder.file("broken.vdb", "this is no volume");
    for (const Arguments& more : {Arguments{"--exr"}, Arguments{"--closeup", "0,0,0,1"}}) {
        Arguments words{"render", "broken.vdb", "--picture", "16384", "-o", "no"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome large = run(words);
        EXPECT_EQ(large.exitCode, 5) << more[0] << ": " << large.err;
        EXPECT_THAT(large.err, HasSubstr("more than the 4 allowed"));
    }
    // As wide as it might be this one would fit: it is refused when the volume has said how wide it is.
    const Outcome whole = tried({"--picture", "16384"});
    EXPECT_EQ(whole.exitCode, 5) << whole.err;
    EXPECT_THAT(whole.err, HasSubstr("more than the 4 allowed"));
    EXPECT_EQ(run({"render", "broken.vdb", "--picture", "64", "-o", "no"}).exitCode, 1);
    const Outcome inside = tried({"--picture", "32", "--camera", "0,0,0.01"});
    EXPECT_EQ(inside.exitCode, 1);
    EXPECT_THAT(inside.err, HasSubstr("inside the object"));

    Image wide(64, 20, 3, 1.f), hole(64, 32, 3, 1.f), good = hole;
    hole.at(5, 3)[1] = std::numeric_limits<float>::quiet_NaN();
    writeExrPicture(wide, nullptr, folder.path() / "wide.exr");
    writeExrPicture(hole, nullptr, folder.path() / "hole.exr");
    writeExrPicture(good, nullptr, folder.path() / "good.exr");
    const Outcome wrongSize = tried({"--picture", "32", "--light", "wide.exr"});
    EXPECT_EQ(wrongSize.exitCode, 1);
    EXPECT_THAT(wrongSize.err, HasSubstr("64 × 20"));
    const Outcome notANumber = tried({"--picture", "32", "--light", "hole.exr"});
    EXPECT_EQ(notANumber.exitCode, 1);
    EXPECT_THAT(notANumber.err, HasSubstr("column 5, row 3"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "no/ball.png"));
    EXPECT_EQ(tried({"--picture", "32", "--light", "good.exr", "--clamp", "0"}).exitCode, 0);
}

TEST_F(VolumeCommands, ProbeReadsTheStackAtPoints) {
    const Outcome text = run({"probe", "ball/ball.vdb", "--at", "0.05,0.05,0", "--at", "-0.05,0.05,0"});
    ASSERT_EQ(text.exitCode, 0) << text.err;
    for (const char* part : {"soot ", "tarnish_1 ", "copper ", "bulk", "L*a*b*", "roughness"})
        EXPECT_THAT(text.out, HasSubstr(part));
    EXPECT_LT(text.out.find("soot"), text.out.find("tarnish_1")) << "the top layer stands on top";

    const std::string points = "x,y,z\n# the sphere stands on y = 0\n0.05,0.05,0\n-0.05 0.05 0\n\n0 0.1 0\n";
    folder.file("points.csv", points);
    const Outcome csv = run({"probe", "ball/ball.vdb", "sphere", "--csv", "--points", "points.csv"});
    ASSERT_EQ(csv.exitCode, 0) << csv.err;
    std::istringstream lines(csv.out);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "x,y,z,L,a,b,roughness,tarnish_1_um,soot_um");
    int count = 0;
    for (; std::getline(lines, line); ++count) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream values(line);
        double x, y, z, l, a, b, roughness, tarnish, soot;
        ASSERT_TRUE(values >> x >> y >> z >> l >> a >> b >> roughness >> tarnish >> soot) << line;
        // Even coats on a sphere of 16 voxels' radius: the lattice gives a percent.
        EXPECT_NEAR(tarnish, 0.35, 0.01);
        EXPECT_NEAR(soot, 1.0, 0.03);
        EXPECT_LT(l, 20.0) << "a micrometre of soot is dark";
    }
    EXPECT_EQ(count, 3);
    EXPECT_EQ(run({"probe", "ball/ball.vdb", "--csv", "--points", "-"}, points).out, csv.out);
}

TEST_F(VolumeCommands, ProbeTellsWhatIsNoPoint) {
    EXPECT_EQ(run({"probe", "ball/ball.vdb"}).exitCode, 2);
    for (const char* point : {"0,0", "0,0,0,0", "a,b,c", "nan,0,0", ""})
        EXPECT_EQ(run({"probe", "ball/ball.vdb", "--at", point}).exitCode, 2) << point;
    folder.file("points.csv", "0,0,0\n1,2\n");
    const Outcome wrong = run({"probe", "ball/ball.vdb", "--points", "points.csv"});
    EXPECT_EQ(wrong.exitCode, 1);
    EXPECT_THAT(wrong.err, HasSubstr("points.csv:2: '1,2' is not a point"));
    EXPECT_EQ(run({"probe", "ball/ball.vdb", "--points", "nosuch.csv"}).exitCode, 1);
}

TEST_F(VolumeCommands, ContactSheetPutsPicturesSideBySide) {
    const Outcome outcome = run({"contact-sheet", "ball/preview.png", "ball/preview.png", "--label", "left", "--label",
                                 "right", "--title", "Twice", "-o", "sheet.png"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "sheet.png\n");
    EXPECT_EQ(readFile(folder.path() / "sheet.png").substr(1, 3), "PNG");
    const Outcome labels =
        run({"contact-sheet", "ball/preview.png", "--label", "a", "--label", "b", "-o", "other.png"});
    EXPECT_EQ(labels.exitCode, 2);
    EXPECT_THAT(labels.err, HasSubstr("2 labels for 1 pictures"));
    EXPECT_EQ(run({"contact-sheet", "nosuch.png", "-o", "other.png"}).exitCode, 1);
    EXPECT_EQ(run({"contact-sheet", "ball.patina", "-o", "other.png"}).exitCode, 1);
    EXPECT_EQ(run({"contact-sheet", "ball/preview.png", "-o", "nowhere/sheet.png"}).exitCode, 1);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "other.png"));
}

TEST(Materials, AreListedAndToldInDetail) {
    const TemporaryFolder folder;
    const Outcome list = vdbPatina({"materials"}, folder.path());
    ASSERT_EQ(list.exitCode, 0) << list.err;
    for (const char* name : {"copper", "tarnish_1", "cuprite_2", "marine_patina_3", "soot"})
        EXPECT_THAT("\n" + list.out, HasSubstr(std::string("\n") + name + " "));
    const Outcome one = vdbPatina({"materials", "cuprite_2"}, folder.path());
    EXPECT_EQ(one.exitCode, 0);
    for (const char* part : {"cuprite_2: ", "L*a*b*", "refractive index", "wavelength/nm", "source: "})
        EXPECT_THAT(one.out, HasSubstr(part));
    const Outcome unknown = vdbPatina({"materials", "cuprite_22"}, folder.path());
    EXPECT_EQ(unknown.exitCode, 2);
    EXPECT_THAT(unknown.err,
                HasSubstr("error: cuprite_22: there is no material of this name (did you mean 'cuprite_2'?)"));
}

struct Extent {
    int vertices = 0, faces = 0, uvs = 0;
    double lowest[3] = {1e30, 1e30, 1e30}, highest[3] = {-1e30, -1e30, -1e30};

    explicit Extent(const std::string& obj) {
        std::istringstream lines(obj);
        for (std::string line; std::getline(lines, line);) {
            std::istringstream words(line);
            std::string word;
            words >> word;
            faces += word == "f";
            uvs += word == "vt";
            if (word != "v")
                continue;
            ++vertices;
            for (int axis = 0; axis < 3; ++axis) {
                double value = 0.0;
                words >> value;
                lowest[axis] = std::min(lowest[axis], value);
                highest[axis] = std::max(highest[axis], value);
            }
        }
    }
    double side(int axis) const { return highest[axis] - lowest[axis]; }
};

TEST(Make, WritesEveryShapeUprightOnTheGround) {
    const TemporaryFolder folder;
    folder.file("a.patina", "new copper\n");
    const std::vector<std::string> shapes{"plate", "strip", "sphere", "groove", "tower", "statuette"};
    std::vector<Arguments> makes, checks;
    for (const std::string& shape : shapes) {
        makes.push_back({"make", shape, "-o", "shapes"});
        checks.push_back({"check", "a.patina", "shapes/" + shape + ".obj", "--voxels", "32"});
    }
    const std::vector<Outcome> made = vdbPatinaEach(makes, folder.path());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const std::string& shape = shapes[i];
        const Outcome& outcome = made[i];
        SCOPED_TRACE(shape);
        const std::string file = "shapes/" + shape + ".obj";
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_THAT(outcome.out, testing::StartsWith(file + ": "));
        const Extent extent(readFile(folder.path() / file));
        EXPECT_GT(extent.faces, 0);
        EXPECT_GT(extent.uvs, 0);
        EXPECT_NEAR(extent.lowest[1], 0.0, 2e-4) << "y is up, and it stands on y = 0";
        if (shape == "tower" || shape == "statuette") {
            EXPECT_GT(extent.side(1), std::max(extent.side(0), extent.side(2)));
        }
        if (shape == "plate" || shape == "strip") {
            EXPECT_NEAR(extent.side(1), 0.0, 1e-6);
        }
    }
    // The program reads what it writes.
    for (const Outcome& outcome : vdbPatinaEach(checks, folder.path()))
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(vdbPatina({"make", "sphere"}, folder.path()).out.substr(0, 12), "./sphere.obj");
}

} // namespace

} // namespace patina::test
