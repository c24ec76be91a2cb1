#include "export/map_files.h"

#include "base/errors.h"
#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/temporary_folder.h"
#include "support/test_surfaces.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace patina {
namespace {

namespace fs = std::filesystem;

class MapFilesTest : public testing::Test {
  protected:
    void SetUp() override {
        SurfaceMesh surface = test::sheet(32.f, 16);
        for (auto& uv : surface.uvs)
            uv.x *= 2.f;
        piece_ = test::makePiece(surface, test::voxelScale());
        auto work = piece_->work();
        coat(work, "cuprite_2", 1.5, nullptr, piece_->progress);
        options_.resolution = 48;
        options_.foldMask = true;
    }
    BakeSummary bakeTo(MapSink& sink) {
        return bakeInto(sink, *piece_->volume, piece_->surface, optics_, options_, piece_->progress);
    }
    static std::size_t filesIn(const fs::path& folder) {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
    }

    std::unique_ptr<test::Piece> piece_;
    MaterialLibrary library_ = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    StackOptics optics_{{&library_.at("copper"), &library_.at("cuprite_2")}};
    BakeOptions options_;
    test::TemporaryFolder folder_;
};

TEST_F(MapFilesTest, HoldWhatABakeIntoMemoryHolds) {
    MapFiles files(folder_.path(), {{"patina_model", "sheet"}});
    const BakeSummary summary = bakeTo(files);
    const auto names = files.commit();
    const MapSet maps = bake(*piece_->volume, piece_->surface, optics_, options_, piece_->progress);
    ASSERT_EQ(names.size(), maps.maps.size());
    EXPECT_EQ(names[0], "displacement.1001.exr");
    for (std::size_t i = 0; i < names.size(); ++i) {
        const MapImage map = readExr(folder_.path() / names[i]);
        EXPECT_EQ(map.floats, maps.maps[i].floats) << names[i];
        EXPECT_EQ(map.halves, maps.maps[i].halves) << names[i];
        EXPECT_THAT(map.texts, testing::Contains(testing::Pair("patina_model", "sheet")));
        // What is known only when all is baked stands in the files' attributes as well.
        EXPECT_THAT(map.numbers, testing::IsSupersetOf(maps.maps[i].numbers)) << names[i];
    }
    float most = 0.f;
    for (const MapImage& map : maps.maps)
        if (map.name == "displacement") {
            EXPECT_NEAR(map.floats[24 * 48 + 24], 1.5, 0.02);
            for (const float height : map.floats)
                most = std::max(most, std::abs(height));
        }
    EXPECT_EQ(summary.maxDisplacement, most);
    EXPECT_THAT(readExr(folder_.path() / names[0]).numbers,
                testing::Contains(testing::Pair("patina_max_displacement", summary.maxDisplacement)));
}

TEST_F(MapFilesTest, LeaveNothingWithoutACommit) {
    {
        MapFiles files(folder_.path(), {});
        bakeTo(files);
        files.makeTextures(piece_->progress);
    }
    EXPECT_EQ(filesIn(folder_.path()), 0u);
    piece_->progress.cancel();
    {
        MapFiles files(folder_.path(), {});
        EXPECT_THROW(bakeTo(files), Error);
    }
    EXPECT_EQ(filesIn(folder_.path()), 0u);
}

} // namespace
} // namespace patina
