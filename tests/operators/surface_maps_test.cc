#include "base/errors.h"
#include "operators/maps/combined_map.h"
#include "operators/maps/geometry_map.h"
#include "operators/maps/texture_map.h"
#include "operators/maps/vertex_map.h"
#include "support/temporary_folder.h"
#include "support/test_surfaces.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <limits>

namespace patina {
namespace {

namespace fs = std::filesystem;

MapPoint pointOn(const SurfaceMesh& surface, int triangle, float u, float v) {
    const SurfacePoint p{triangle, u, v};
    return {positionAt(surface, p), normalAt(surface, p), triangle, u, v};
}

class TextureMapTest : public testing::Test {
  protected:
    // 2 × 2 float pixels, R: 0 1 / 0 1 (rising with u), G: 1 1 / 0 0 (rising with v).
    std::string writeImage() {
        const std::string file = (folder_ / "ramp.exr").string();
        const float pixels[12] = {0, 1, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0};
        auto out = OIIO::ImageOutput::create(file);
        out->open(file, OIIO::ImageSpec(2, 2, 3, OIIO::TypeDesc::FLOAT));
        out->write_image(OIIO::TypeDesc::FLOAT, pixels);
        out->close();
        return file;
    }
    test::TemporaryFolder folder_;
    SurfaceMesh sheet_ = test::sheet(1.f, 1);
};

TEST_F(TextureMapTest, IsReadByUvWithVUpwards) {
    const std::string file = writeImage();
    const auto red = makeTextureMap(sheet_, file, "R"), green = makeTextureMap(sheet_, file, "G");
    // Triangle 0 is (0,0), (1,0), (1,1): the barycentric point (u, v) has the UV (u + v, v).
    EXPECT_NEAR(red->value(pointOn(sheet_, 0, 0.5f, 0.25f)), 1.0, 1e-6); // u = 0.75: a texel's centre
    EXPECT_NEAR(green->value(pointOn(sheet_, 0, 0.5f, 0.25f)), 0.0, 1e-6);
    EXPECT_NEAR(green->value(pointOn(sheet_, 0, 0.0f, 0.75f)), 1.0, 1e-6);
    EXPECT_NEAR(red->value(pointOn(sheet_, 0, 0.25f, 0.25f)), 0.5, 1e-6); // between the columns
}

TEST_F(TextureMapTest, AnUnknownChannelNamesThoseThereAre) {
    const std::string file = writeImage();
    try {
        makeTextureMap(sheet_, file, "height");
        FAIL();
    } catch (const RunError& error) {
        EXPECT_THAT(error.remedy(), testing::HasSubstr("R, G, B"));
    }
}

TEST_F(TextureMapTest, AMissingFileOrMissingUvsAreErrors) {
    EXPECT_THROW(makeTextureMap(sheet_, folder_ / "nothing.png", ""), RunError);
    SurfaceMesh bare = sheet_;
    bare.triangleUvs.clear();
    EXPECT_THROW(makeTextureMap(bare, writeImage(), ""), ModelError);
}

TEST(VertexMap, InterpolatesLinearlyAndNamesWhatThereIs) {
    SurfaceMesh surface = test::sheet(1.f, 1);
    surface.vertexAttributes["wet"] = {0.f, 1.f, 0.f, 1.f}; // rises with x
    const auto map = makeVertexMap(surface, "wet");
    EXPECT_NEAR(map->value(pointOn(surface, 0, 0.25f, 0.25f)), 0.5, 1e-6);
    try {
        makeVertexMap(surface, "dry");
        FAIL();
    } catch (const ModelError& error) {
        EXPECT_THAT(error.remedy(), testing::HasSubstr("wet"));
    }
}

TEST(GeometryMaps, SlopeFacingAndElevation) {
    MapPoint point;
    point.normal = Imath::V3d(0.0, std::sqrt(0.5), std::sqrt(0.5));
    point.position = Imath::V3d(0.0, 3.0, 0.0);
    EXPECT_NEAR(makeSlopeMap({0, 1, 0})->value(point), std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(makeFacingMap({0, 0, 5})->value(point), std::sqrt(0.5), 1e-12);
    EXPECT_EQ(makeFacingMap({0, -1, 0})->value(point), 0.0);
    const Imath::Box3d box(Imath::V3d(-1.0), Imath::V3d(1.0, 7.0, 1.0));
    EXPECT_NEAR(makeElevationMap({0, 1, 0}, box)->value(point), 0.5, 1e-12);
    EXPECT_NEAR(makeElevationMap({0, -1, 0}, box)->value(point), 0.5, 1e-12);
}

TEST(CombinedMap, CombinesAndNeverGivesWhatIsNotANumber) {
    const auto quotient =
        makeCombinedMap({makeConstantMap(1.0), makeConstantMap(0.0)}, [](const double* v) { return v[0] / v[1]; });
    EXPECT_EQ(quotient->value({}), 0.0);
    const auto sum =
        makeCombinedMap({makeConstantMap(1.0), makeConstantMap(2.5)}, [](const double* v) { return v[0] + v[1]; });
    EXPECT_EQ(sum->value({}), 3.5);
}

} // namespace
} // namespace patina
