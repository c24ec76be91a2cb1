#include "surface/shapes.h"

#include "base/errors.h"
#include "surface/limit_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace patina {
namespace {

using Imath::Box2f;
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

class EveryShape : public testing::TestWithParam<std::string> {
  protected:
    Mesh mesh = makeShape(GetParam());
    bool isSheet() const { return GetParam() == "plate" || GetParam() == "strip"; }
};

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, testing::ValuesIn(shapeNames()),
                         [](const auto& info) { return info.param; });

std::vector<int> groups(std::size_t count, const std::vector<int>& corners) { // of things that share a quad
    std::vector<int> parent(count);
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int i) {
        while (parent[i] != i)
            i = parent[i] = parent[parent[i]];
        return i;
    };
    for (std::size_t q = 0; q < corners.size(); q += 4)
        for (int k = 1; k < 4; ++k)
            parent[root(corners[q + k])] = root(corners[q]);
    std::vector<int> group(count);
    for (std::size_t i = 0; i < count; ++i)
        group[i] = root(static_cast<int>(i));
    return group;
}

TEST_P(EveryShape, IsMadeOfQuadsWithUvsOverFinitePoints) {
    EXPECT_EQ(mesh.name, GetParam());
    ASSERT_GT(mesh.faceCount(), 100u);
    EXPECT_LT(mesh.faceCount(), 80000u);
    EXPECT_THAT(mesh.faceSizes, testing::Each(4));
    ASSERT_EQ(mesh.faceVertices.size(), 4 * mesh.faceCount());
    ASSERT_EQ(mesh.faceUvs.size(), mesh.faceVertices.size());
    std::vector<bool> used(mesh.positions.size(), false);
    for (const int v : mesh.faceVertices) {
        ASSERT_GE(v, 0);
        ASSERT_LT(v, static_cast<int>(mesh.positions.size()));
        used[static_cast<std::size_t>(v)] = true;
    }
    EXPECT_THAT(used, testing::Each(true)) << "no vertex is left over";
    for (const V3f& p : mesh.positions)
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
}

TEST_P(EveryShape, IsManifoldAndClosedUnlessASheet) {
    std::map<std::pair<int, int>, int> edges; // directed
    for (std::size_t q = 0; q < mesh.faceVertices.size(); q += 4)
        for (int k = 0; k < 4; ++k) {
            const int a = mesh.faceVertices[q + k], b = mesh.faceVertices[q + (k + 1) % 4];
            ASSERT_NE(a, b);
            ASSERT_EQ(++(edges[{a, b}]), 1) << "an edge is passed once in each direction";
        }
    int open = 0;
    for (const auto& [edge, count] : edges)
        open += edges.count({edge.second, edge.first}) == 0;
    if (isSheet())
        EXPECT_GT(open, 0);
    else
        EXPECT_EQ(open, 0);
}

TEST_P(EveryShape, FacesOutwards) {
    if (isSheet()) {
        for (std::size_t q = 0; q < mesh.faceVertices.size(); q += 4) {
            const auto at = [&](int k) { return mesh.positions[static_cast<std::size_t>(mesh.faceVertices[q + k])]; };
            EXPECT_GT((at(2) - at(0)).cross(at(3) - at(1)).z, 0.f);
        }
        return;
    }
    // Each connected part encloses a positive volume.
    const std::vector<int> part = groups(mesh.positions.size(), mesh.faceVertices);
    std::map<int, double> volumes;
    for (std::size_t q = 0; q < mesh.faceVertices.size(); q += 4) {
        const auto at = [&](int k) { return V3d(mesh.positions[static_cast<std::size_t>(mesh.faceVertices[q + k])]); };
        volumes[part[static_cast<std::size_t>(mesh.faceVertices[q])]] +=
            (at(0).dot(at(1).cross(at(2))) + at(0).dot(at(2).cross(at(3)))) / 6.0;
    }
    for (const auto& [id, volume] : volumes)
        EXPECT_GT(volume, 0.0);
}

TEST_P(EveryShape, UvsCoverNothingTwice) {
    constexpr int size = 2048;
    std::vector<unsigned char> covered(size * size, 0);
    for (std::size_t q = 0; q < mesh.faceUvs.size(); q += 4) {
        V2f corner[4];
        for (int k = 0; k < 4; ++k) {
            corner[k] = mesh.uvs[static_cast<std::size_t>(mesh.faceUvs[q + k])];
            ASSERT_GE(std::min(corner[k].x, corner[k].y), 0.f);
            ASSERT_LE(std::max(corner[k].x, corner[k].y), 1.f);
        }
        ASSERT_GT((corner[2] - corner[0]).cross(corner[3] - corner[1]), 0.f) << "neither flat nor mirrored";
        Box2f box;
        for (const V2f& c : corner)
            box.extendBy(c);
        for (int y = static_cast<int>(box.min.y * size); y <= static_cast<int>(box.max.y * size) && y < size; ++y)
            for (int x = static_cast<int>(box.min.x * size); x <= static_cast<int>(box.max.x * size) && x < size; ++x) {
                const V2f texel((x + 0.5f) / size, (y + 0.5f) / size);
                bool inside = true;
                for (int k = 0; k < 4; ++k)
                    inside = inside && (corner[(k + 1) % 4] - corner[k]).cross(texel - corner[k]) > 1e-10f;
                if (inside) {
                    ASSERT_EQ(++covered[static_cast<std::size_t>(y) * size + x], 1);
                }
            }
    }
    const double share = static_cast<double>(std::count(covered.begin(), covered.end(), 1)) / (size * size);
    RecordProperty("coveredShare", std::to_string(share));
    EXPECT_GT(share, GetParam() == "strip" ? 0.3 : 0.4) << "the map is put to use";
}

TEST_P(EveryShape, UvChartsKeepApart) {
    const std::vector<int> chart = groups(mesh.uvs.size(), mesh.faceUvs);
    std::map<int, Box2f> boxes;
    for (std::size_t i = 0; i < mesh.uvs.size(); ++i)
        boxes[chart[i]].extendBy(mesh.uvs[i]);
    // Charts are upright rectangles: their boxes tell how far they are apart.
    for (auto a = boxes.begin(); a != boxes.end(); ++a)
        for (auto b = std::next(a); b != boxes.end(); ++b) {
            const Box2f &p = a->second, &q = b->second;
            const float gap = std::max({q.min.x - p.max.x, p.min.x - q.max.x, q.min.y - p.max.y, p.min.y - q.max.y});
            EXPECT_GE(gap, 0.01f);
        }
}

TEST_P(EveryShape, UvsGiveEverySurfaceItsShareOfTheMap) {
    std::vector<double> density;
    double total = 0.0, sparse = 0.0;
    for (std::size_t q = 0; q < mesh.faceUvs.size(); q += 4) {
        const auto at = [&](int k) { return V3d(mesh.positions[static_cast<std::size_t>(mesh.faceVertices[q + k])]); };
        const auto uv = [&](int k) { return mesh.uvs[static_cast<std::size_t>(mesh.faceUvs[q + k])]; };
        const double area = (at(2) - at(0)).cross(at(3) - at(1)).length();
        density.push_back((uv(2) - uv(0)).cross(uv(3) - uv(1)) / std::max(area, 1e-18));
        total += area;
    }
    std::vector<double> sorted = density;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    const double median = sorted[sorted.size() / 2];
    for (std::size_t f = 0; f < density.size(); ++f) {
        const auto at = [&](int k) {
            return V3d(mesh.positions[static_cast<std::size_t>(mesh.faceVertices[4 * f + k])]);
        };
        if (density[f] < 0.2 * median)
            sparse += (at(2) - at(0)).cross(at(3) - at(1)).length();
    }
    EXPECT_LT(sparse, 0.05 * total) << "hardly any surface has less than a fifth of the usual texels";
}

TEST_P(EveryShape, IsTheSameEveryTime) {
    const Mesh again = makeShape(GetParam());
    EXPECT_EQ(again.positions, mesh.positions);
    EXPECT_EQ(again.uvs, mesh.uvs);
    EXPECT_EQ(again.faceVertices, mesh.faceVertices);
}

TEST(Shapes, HaveTheirSizesInMetresAndStandOnTheGround) {
    const auto size = [](const char* name) { return makeShape(name).bounds().size(); };
    EXPECT_LT((size("plate") - V3f(0.1f, 0.1f, 0.f)).length(), 1e-6f);
    EXPECT_LT((size("strip") - V3f(0.3f, 0.1f, 0.f)).length(), 1e-6f);
    EXPECT_LT((size("groove") - V3f(0.12f, 0.06f, 0.02f)).length(), 1e-6f);
    EXPECT_NEAR(size("sphere").z, 0.1f, 2e-4f);
    EXPECT_NEAR(size("statuette").z, 0.25f, 1e-3f);
    EXPECT_NEAR(size("tower").z, 6.3f, 1e-3f);
    for (const std::string& name : shapeNames())
        EXPECT_NEAR(makeShape(name).bounds().min.z, 0.f, 1e-4f) << name;
}

TEST(Shapes, SphereHasItsRadiusOnTheLimitSurface) {
    LimitSurfaceOptions options;
    options.level = 1;
    const SurfaceMesh limit = makeLimitSurface(makeShape("sphere"), options);
    for (const V3f& p : limit.positions) // a spline is not a circle between its points
        ASSERT_NEAR((p - V3f(0.f, 0.f, 0.05f)).length(), 0.05f, 1e-5f);
}

TEST(Shapes, GroovesAreCrispWhenSubdivided) {
    LimitSurfaceOptions options;
    options.level = 1;
    const SurfaceMesh limit = makeLimitSurface(makeShape("groove"), options);
    EXPECT_TRUE(limit.closed);
    // The floor of the slots is 10 mm deep, and the land between stays level.
    float lowest = 1.f;
    int onLand = 0, onFloor = 0;
    for (const V3f& p : limit.positions)
        if (std::abs(p.y) < 0.02f && std::abs(p.x) < 0.055f && p.z > 0.005f) {
            lowest = std::min(lowest, p.z);
            onLand += p.z > 0.02f - 2e-5f;
            onFloor += p.z < 0.01f + 2e-5f;
        }
    EXPECT_NEAR(lowest, 0.01f, 3e-4f);
    EXPECT_GT(onLand, 500);
    EXPECT_GT(onFloor, 500);
}

TEST(Shapes, StatuetteLooksTowardsTheViewer) {
    // Above the shoulders nothing stands as far to the front as the tip of the nose, which is in the middle of the
    // face.
    const Mesh mesh = makeShape("statuette");
    V3f foremost(0.f, 1.f, 0.f);
    for (const V3f& p : mesh.positions)
        if (p.z > 0.19f && p.y < foremost.y)
            foremost = p;
    EXPECT_LT(foremost.y, -0.02f);
    EXPECT_LT(std::abs(foremost.x), 0.001f);
}

TEST(Shapes, AnUnknownNameGetsTheNearestOne) {
    try {
        makeShape("statuete");
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::commandLine);
        EXPECT_EQ(error.message(), "unknown shape 'statuete'");
        EXPECT_THAT(error.remedy(), testing::HasSubstr("'statuette'"));
    }
    try {
        makeShape("zeppelin");
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_THAT(error.remedy(), testing::HasSubstr("plate strip sphere groove tower statuette"));
    }
}

} // namespace
} // namespace patina
