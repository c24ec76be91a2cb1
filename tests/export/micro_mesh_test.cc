// The displaced surface as a mesh: what its vertices say is what the maps say.

#include "export/micro_mesh.h"

#include "base/errors.h"
#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/temporary_folder.h"
#include "support/test_surfaces.h"
#include "surface/mesh_file.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

class MicroMeshTest : public testing::Test {
  protected:
    // A sheet of 4 cm, drawn 500 times life size, half of it with 3 µm of patina over 1 µm of cuprite.
    void SetUp() override {
        VolumeScale scale;
        scale.voxelSize = 0.001;
        scale.exaggeration = 500.0;
        piece_ = test::makePiece(test::sheet(0.04f, 40), scale, 8.0);
        auto work = piece_->work();
        const test::FunctionMap half([](const MapPoint& point) { return point.position.x > 0.0205 ? 1.0 : 0.0; });
        coat(work, "cuprite_2", 1.0, nullptr, piece_->progress);
        coat(work, "marine_patina_3", 3.0, &half, piece_->progress);
    }
    SurfaceMesh make(bool keepExaggeration) const {
        Progress progress;
        const StackOptics optics({&library_.at("copper"), &library_.at("cuprite_2"), &library_.at("marine_patina_3")});
        return makeMicroMesh(*piece_->volume, piece_->surface, optics, keepExaggeration, progress);
    }

    std::unique_ptr<test::Piece> piece_;
    MaterialLibrary library_ = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
};

// Away from the sheet's rim and from the step at its middle.
bool isInner(const Imath::V3f& p) {
    return p.y > 0.01f && p.y < 0.03f && (std::abs(p.x - 0.01f) < 0.005f || std::abs(p.x - 0.03f) < 0.005f);
}

TEST_F(MicroMeshTest, VerticesStandAtTheStacksHeightAndKnowItsLayers) {
    const SurfaceMesh drawn = make(true), real = make(false);
    const auto& ids = real.vertexAttributes.at("material_id");
    const auto& first = real.vertexAttributes.at("thickness_01_cuprite_2");
    const auto& second = real.vertexAttributes.at("thickness_02_marine_patina_3");
    int inner = 0;
    for (std::size_t i = 0; i < real.positions.size(); ++i) {
        const Imath::V3f& flat = piece_->surface.positions[i];
        if (!isInner(flat))
            continue;
        ++inner;
        const bool coated = flat.x > 0.02f;
        EXPECT_NEAR(first[i], 1.f, 0.01f);
        EXPECT_NEAR(second[i], coated ? 3.f : 0.f, 0.03f);
        EXPECT_EQ(ids[i], static_cast<float>(piece_->volume->findMaterialId(coated ? "marine_patina_3" : "cuprite_2")));
        const double heightUm = coated ? 4.0 : 1.0;
        EXPECT_NEAR(real.positions[i].z, heightUm * 1e-6, 0.03 * heightUm * 1e-6);
        EXPECT_NEAR(drawn.positions[i].z, 500.0 * heightUm * 1e-6, 0.03 * 500.0 * heightUm * 1e-6);
        EXPECT_GT(drawn.normals[i].z, 0.999f);
    }
    EXPECT_GT(inner, 200);
}

// Copper oxide is dark and red, marine patina green: colours are of the right layer, and encoded.
TEST_F(MicroMeshTest, ColoursAreThoseOfTheTopLayerAsSrgb) {
    const SurfaceMesh mesh = make(false);
    const auto& red = mesh.vertexAttributes.at("red");
    const auto& green = mesh.vertexAttributes.at("green");
    const StackOptics optics({&library_.at("copper"), &library_.at("cuprite_2"), &library_.at("marine_patina_3")});
    Appearance look;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Imath::V3f& flat = piece_->surface.positions[i];
        if (!isInner(flat))
            continue;
        const float thicknesses[] = {mesh.vertexAttributes.at("thickness_01_cuprite_2")[i],
                                     mesh.vertexAttributes.at("thickness_02_marine_patina_3")[i]};
        optics.evaluate(thicknesses, look);
        const double encoded = 1.055 * std::pow(double(look.baseColour.y), 1.0 / 2.4) - 0.055;
        EXPECT_NEAR(green[i], encoded, 1e-4);
        EXPECT_EQ(green[i] > red[i], flat.x > 0.02f);
    }
}

TEST_F(MicroMeshTest, PlyHoldsAllOfIt) {
    const SurfaceMesh mesh = make(true);
    const test::TemporaryFolder folder;
    writePly(mesh, folder / "micro.ply");
    const Mesh read = readMesh(folder / "micro.ply");
    EXPECT_EQ(read.faceSizes.size(), mesh.triangles.size());
    for (const char* name : {"thickness_01_cuprite_2", "thickness_02_marine_patina_3", "material_id"}) {
        ASSERT_EQ(read.vertexAttributes.count(name), 1u) << name;
        EXPECT_EQ(read.vertexAttributes.at(name), mesh.vertexAttributes.at(name)) << name;
    }
    ASSERT_EQ(read.vertexAttributes.count("green"), 1u);
    for (std::size_t i = 0; i < read.positions.size(); ++i)
        EXPECT_NEAR(read.vertexAttributes.at("green")[i], mesh.vertexAttributes.at("green")[i], 0.5 / 255.0 + 1e-6);
}

} // namespace
} // namespace patina
