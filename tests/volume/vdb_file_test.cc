#include "volume/vdb_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "operators/coat.h"
#include "support/coated_ball.h"
#include "support/moved_volume.h"
#include "support/temporary_folder.h"
#include "volume/nest_grids.h"

#include <gmock/gmock.h>

#include <fstream>

namespace patina {
namespace {

namespace fs = std::filesystem;

class VdbFileTest : public testing::Test {
  protected:
    void SetUp() override {
        piece_ = test::coatedBall();
        piece_->volume->provenance.script = "new copper;\n";
        piece_->volume->provenance.seed = 18446744073709551615ull;
    }

    int filesInFolder() const {
        return static_cast<int>(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
    }

    test::TemporaryFolder folder_;
    std::unique_ptr<test::Piece> piece_;
};

TEST_F(VdbFileTest, ComesBackBitForBit) {
    writeVolume(*piece_->volume, folder_ / "a.vdb");
    const LayerVolume read = readVolume(folder_ / "a.vdb");
    EXPECT_EQ(contentHash(read), contentHash(*piece_->volume));
    EXPECT_EQ(read.grids().space, piece_->volume->grids().space);
    EXPECT_EQ(read.layers(), piece_->volume->layers());
    EXPECT_EQ(read.palette(), piece_->volume->palette());
    EXPECT_EQ(read.scale().metresPerUnit, 1e-6);
    EXPECT_EQ(read.provenance.script, "new copper;\n");
    EXPECT_EQ(read.provenance.seed, 18446744073709551615ull);
    EXPECT_EQ(read.grids().exteriorBand, piece_->volume->grids().exteriorBand);
    EXPECT_EQ(filesInFolder(), 1);
}

// As files of this program were before volumes had a place of their own in index space: without a translation.
TEST_F(VdbFileTest, AVolumeAroundIndexZeroOpensAndGoesOnBitForBit) {
    LayerVolume old = piece_->volume->clone();
    test::moveTo(old, openvdb::Coord(0));
    writeVolume(old, folder_ / "old.vdb");
    LayerVolume read = readVolume(folder_ / "old.vdb");
    EXPECT_EQ(read.grids().space, IndexSpace());
    EXPECT_EQ(read.grids().base->transform().indexToWorld(openvdb::Vec3d(0.0)), openvdb::Vec3d(0.0));
    EXPECT_EQ(contentHash(read), contentHash(*piece_->volume));
    SurfaceBinding binding(read, piece_->surface, piece_->closed);
    Workpiece work{read, binding}, here = piece_->work();
    for (Workpiece* w : {&work, &here})
        coat(*w, "dirt", 2.5, nullptr, piece_->progress);
    EXPECT_EQ(contentHash(read), contentHash(*piece_->volume));
}

TEST_F(VdbFileTest, HoldsThePromisedGrids) {
    writeVolume(*piece_->volume, folder_ / "a.vdb");
    openvdb::io::File file((folder_ / "a.vdb").string());
    file.open();
    for (const char* name : {"base", "surface", "interface_01_tarnish_1", "interface_02_soot", "material"})
        EXPECT_TRUE(file.hasGrid(name)) << name;
    const auto base = file.readGridMetadata("base");
    EXPECT_EQ(base->getGridClass(), openvdb::GRID_LEVEL_SET);
    EXPECT_EQ(base->valueType(), "float");
    EXPECT_FALSE(base->saveFloatAsHalf());
    EXPECT_EQ(file.readGridMetadata("material")->valueType(), "int32");
    // Readers other than ours may not follow shared trees: the surface is whole.
    const auto surface = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
    const auto top = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("interface_02_soot"));
    EXPECT_EQ(surface->activeVoxelCount(), top->activeVoxelCount());
    EXPECT_GT(surface->activeVoxelCount(), 0u);
}

TEST_F(VdbFileTest, BrokenFilesAreErrorsThatNameTheFile) {
    writeVolume(*piece_->volume, folder_ / "a.vdb");
    const std::string whole = readTextFile(folder_ / "a.vdb");
    const auto expectRefused = [&](const std::string& bytes) {
        writeTextFile(folder_ / "broken.vdb", bytes);
        try {
            readVolume(folder_ / "broken.vdb");
            FAIL() << "was read";
        } catch (const RunError& error) {
            EXPECT_THAT(error.place(), testing::HasSubstr("broken.vdb"));
        }
    };
    for (const std::size_t size :
         {std::size_t(0), std::size_t(10), std::size_t(300), whole.size() / 2, whole.size() - 1})
        expectRefused(whole.substr(0, size));
    for (const std::size_t at : {std::size_t(3), std::size_t(500), whole.size() / 2, whole.size() - 20}) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
        expectRefused(bytes);
    }
    writeTextFile(folder_ / "text.vdb", "this is no volume at all, but text");
    EXPECT_THROW(readVolume(folder_ / "text.vdb"), RunError);
    EXPECT_THROW(readVolume(folder_ / "nothing.vdb"), RunError);
    EXPECT_THROW(readVolume(folder_.path()), RunError);
}

TEST_F(VdbFileTest, AForeignVolumeIsRefused) {
    openvdb::io::File file((folder_ / "foreign.vdb").string());
    file.write({openvdb::FloatGrid::create()});
    file.close();
    EXPECT_THROW(readVolume(folder_ / "foreign.vdb"), RunError);
}

TEST_F(VdbFileTest, AnUnwritableFolderIsAnErrorAndLeavesNothing) {
    EXPECT_THROW(writeVolume(*piece_->volume, folder_ / "no" / "a.vdb"), RunError);
    EXPECT_EQ(filesInFolder(), 0);
}

} // namespace
} // namespace patina
