#include "surface/atlas.h"

#include "base/random.h"
#include "test_models.h"

#include <cmath>
#include <vector>

namespace patina {
namespace {

using Imath::V2f;

/// Faces of 3, 4, 5 and more corners; positions are the corners of a wobbly disc.
Mesh mixedFaces(int count, int largest) {
    const KeyedRandom random(7, "mixed", "atlas");
    Mesh mesh;
    for (int face = 0; face < count; ++face) {
        const int size = 3 + static_cast<int>(random.words(0, face, 0, 0)[0] % static_cast<unsigned>(largest - 2));
        mesh.faceSizes.push_back(size);
        for (int i = 0; i < size; ++i) {
            const double radius = 1.0 + 0.5 * random.uniforms(1, face, i, 0)[0], angle = 2 * M_PI * i / size;
            mesh.faceVertices.push_back(static_cast<int>(mesh.positions.size()));
            mesh.positions.emplace_back(static_cast<float>(radius * std::cos(angle)),
                                        static_cast<float>(radius * std::sin(angle)), static_cast<float>(face));
        }
    }
    return mesh;
}

bool contains(const std::vector<V2f>& polygon, double x, double y) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
        if ((polygon[i].y > y) != (polygon[j].y > y) &&
            x < (polygon[j].x - polygon[i].x) * (y - polygon[i].y) / (polygon[j].y - polygon[i].y) + polygon[i].x)
            inside = !inside;
    return inside;
}

/// Every texel belongs to at most one face, and texels of different faces never touch, not even by a corner.
void expectGaps(const Mesh& mesh, int resolution) {
    std::vector<int> owner(static_cast<std::size_t>(resolution) * resolution, -1);
    std::size_t start = 0;
    for (std::size_t face = 0; face < mesh.faceCount(); ++face) {
        std::vector<V2f> polygon;
        double area = 0.0;
        for (int i = 0; i < mesh.faceSizes[face]; ++i) {
            polygon.push_back(mesh.uvs[mesh.faceUvs[start + i]]);
            EXPECT_GT(polygon.back().x, 0.f);
            EXPECT_LT(polygon.back().x, 1.f);
            EXPECT_GT(polygon.back().y, 0.f);
            EXPECT_LT(polygon.back().y, 1.f);
        }
        for (std::size_t i = 0; i < polygon.size(); ++i)
            area += polygon[i].cross(polygon[(i + 1) % polygon.size()]);
        EXPECT_GT(area, 0.0) << "mirrored or empty";
        int texels = 0;
        for (int y = 0; y < resolution; ++y)
            for (int x = 0; x < resolution; ++x)
                if (contains(polygon, (x + 0.5) / resolution, (y + 0.5) / resolution)) {
                    int& texel = owner[static_cast<std::size_t>(y) * resolution + x];
                    ASSERT_EQ(texel, -1) << "two faces on one texel";
                    texel = static_cast<int>(face);
                    ++texels;
                }
        EXPECT_GT(texels, 0);
        start += mesh.faceSizes[face];
    }
    for (int y = 0; y + 1 < resolution; ++y)
        for (int x = 1; x + 1 < resolution; ++x) {
            const int here = owner[static_cast<std::size_t>(y) * resolution + x];
            const std::size_t below = static_cast<std::size_t>(y + 1) * resolution + x;
            for (const int other : {owner[static_cast<std::size_t>(y) * resolution + x + 1], owner[below - 1],
                                    owner[below], owner[below + 1]})
                EXPECT_TRUE(here < 0 || other < 0 || here == other) << x << ' ' << y;
        }
}

TEST(Atlas, tilesHaveAGapOfTexelsBetweenThem) {
    Mesh mesh = mixedFaces(60, 8);
    makeFaceAtlas(mesh, 256);
    ASSERT_EQ(mesh.faceUvs.size(), mesh.faceVertices.size());
    expectGaps(mesh, 256);
}

TEST(Atlas, pairsOfTrianglesShareATileWithAGapAcrossIt) {
    Mesh mesh = mixedFaces(98, 3);
    makeFaceAtlas(mesh, 128); // 49 tiles of 18 texels
    expectGaps(mesh, 128);
}

TEST(Atlas, quadsFillTheirTiles) {
    Mesh mesh = makeSheet(4, 4);
    makeFaceAtlas(mesh, 512);
    EXPECT_EQ(mesh.uvs.size(), 64u);
    // 16 tiles of 128 texels, 2 texels in from each side.
    EXPECT_FLOAT_EQ(mesh.uvs[0].x, 2.f / 512.f);
    EXPECT_FLOAT_EQ(mesh.uvs[2].x, 126.f / 512.f);
}

TEST(Atlas, moreFacesThanTexelsStillHaveTilesOfTheirOwn) {
    Mesh mesh = makeSheet(40, 40);
    makeFaceAtlas(mesh, 16);
    for (std::size_t face = 0; face < mesh.faceCount(); ++face) {
        const V2f low = mesh.uvs[4 * face], high = mesh.uvs[4 * face + 2];
        EXPECT_LT(low.x, high.x);
        EXPECT_LT(low.y, high.y);
        EXPECT_EQ(static_cast<int>(low.x * 40), static_cast<int>(high.x * 40));
    }
}

} // namespace
} // namespace patina
