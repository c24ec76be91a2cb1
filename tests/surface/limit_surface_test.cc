#include "surface/limit_surface.h"

#include "base/errors.h"
#include "surface/mesh_file.h"
#include "test_models.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace patina {
namespace {

using Imath::V2f;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

LimitSurfaceOptions atLevel(int level, SubdivisionScheme scheme = SubdivisionScheme::automatic) {
    LimitSurfaceOptions options;
    options.level = level;
    options.scheme = scheme;
    return options;
}

// The limit of a vertex of valence n among quads is (n² v + 4 Σ edge neighbours + Σ diagonal neighbours) / (n (n + 5))
// (Halstead, Kass & DeRose 1993). For the corner (1,1,1) of the cube of side 2: n = 3, the edge neighbours sum to
// (1,1,1), the diagonal ones to (-1,-1,-1): (9 + 4 - 1) / 24 = 1/2. The first step, 5/9, has to be left behind.
TEST(LimitSurface, cubeCornersLieAtHalfTheirControlPoints) {
    for (const int level : {0, 1, 2, 3}) {
        const SurfaceMesh surface = makeLimitSurface(makeCube(), atLevel(level));
        for (int i = 0; i < 8; ++i)
            EXPECT_LT(distanceTo(surface, 0.5f * makeCube().positions[i]), 2e-6f) << "level " << level;
    }
}

// After one step the middle of a face is (1,0,0), its edge neighbours (3/4, ±3/4, 0) and the like, its diagonal ones
// 5/9 (1,±1,±1): (16 + 4·3 + 20/9) / 36 = 68/81. An edge's middle is (3/4, 3/4, 0), its edge neighbours sum to
// (19/9, 19/9, 0), the diagonal ones to (3/2, 3/2, 0): (12 + 76/9 + 3/2) / 36 = 395/648.
TEST(LimitSurface, cubeFacesAndEdgesLieAtTheirClosedForms) {
    const SurfaceMesh surface = makeLimitSurface(makeCube(), atLevel(2));
    EXPECT_LT(distanceTo(surface, V3f(68.f / 81.f, 0, 0)), 2e-6f);
    EXPECT_LT(distanceTo(surface, V3f(0, 0, -68.f / 81.f)), 2e-6f);
    EXPECT_LT(distanceTo(surface, V3f(395.f / 648.f, 395.f / 648.f, 0)), 2e-6f);
}

TEST(LimitSurface, normalsArePerpendicularToTheLimitSurfaceAndPointOut) {
    const SurfaceMesh surface = makeLimitSurface(makeCube(), atLevel(5));
    ASSERT_EQ(surface.normals.size(), surface.positions.size());
    EXPECT_TRUE(surface.closed);
    for (std::size_t i = 0; i < surface.normals.size(); ++i) {
        EXPECT_NEAR(surface.normals[i].length(), 1.f, 1e-5f);
        EXPECT_GT(surface.normals[i].dot(surface.positions[i].normalized()), 0.9f);
    }
    for (const V3i& triangle : surface.triangles) {
        const V3f& a = surface.positions[triangle.x];
        const V3f face = (surface.positions[triangle.y] - a).cross(surface.positions[triangle.z] - a).normalized();
        // Edges are about 1/32 of the cube's, curvature about 1: the angle stays below a few hundredths.
        EXPECT_GT(face.dot(surface.normals[triangle.x]), 0.995f);
    }
    const V3f diagonal = V3f(1, 1, 1).normalized();
    bool found = false;
    for (std::size_t i = 0; i < surface.normals.size(); ++i)
        if ((surface.positions[i] - V3f(0.5f)).length() < 1e-5f) {
            found = true;
            EXPECT_LT((surface.normals[i] - diagonal).length(), 1e-4f);
        }
    EXPECT_TRUE(found);
}

// Loop's limit is (1 - n χ) v + χ Σ neighbours, χ = 1 / (n + 3 / (8 β)), β(4) = (5/8 - (3/8)²) / 4: χ = 31/220. The
// octahedron's neighbours cancel: 1 - 4·31/220 = 24/55.
TEST(LimitSurface, octahedronUnderLoopLiesAtItsClosedForm) {
    Mesh mesh;
    mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.faceSizes.assign(8, 3);
    mesh.faceVertices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    const SurfaceMesh surface = makeLimitSurface(mesh, atLevel(2, SubdivisionScheme::loop));
    EXPECT_EQ(surface.triangles.size(), 8u * 16u);
    for (const V3f& vertex : mesh.positions)
        EXPECT_LT(distanceTo(surface, vertex * (24.f / 55.f)), 2e-6f);
    EXPECT_TRUE(surface.closed);
}

TEST(LimitSurface, flatSheetKeepsItsOutlineUvsAndFaces) {
    const Mesh sheet = makeSheet(3, 2);
    const SurfaceMesh surface = makeLimitSurface(sheet, atLevel(3));
    EXPECT_FALSE(surface.closed);
    EXPECT_NEAR(surface.area(), 6.0, 1e-5);
    EXPECT_EQ(surface.triangles.size(), 6u * 64u * 2u);
    for (const V3f& corner : {V3f(0, 0, 0), V3f(3, 0, 0), V3f(3, 2, 0), V3f(0, 2, 0)})
        EXPECT_LT(distanceTo(surface, corner), 1e-6f);
    std::vector<double> areas(sheet.faceCount());
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        const V3i& triangle = surface.triangles[i];
        for (int corner = 0; corner < 3; ++corner) {
            const V3f& p = surface.positions[triangle[corner]];
            const V2f& uv = surface.uvs[surface.triangleUvs[i][corner]];
            // On a regular cage both rules reproduce linear functions, at the border as inside.
            EXPECT_NEAR(uv.x, p.x / 3.f, 1e-6f);
            EXPECT_NEAR(uv.y, p.y / 2.f, 1e-6f);
        }
        const V3d a(surface.positions[triangle.x]);
        areas[surface.triangleFaces[i]] +=
            0.5 * (V3d(surface.positions[triangle.y]) - a).cross(V3d(surface.positions[triangle.z]) - a).z;
    }
    double sum = 0.0;
    for (const double area : areas) {
        EXPECT_GT(area, 0.5);
        sum += area;
    }
    EXPECT_NEAR(sum, 6.0, 1e-5);
}

TEST(LimitSurface, attributesAreCarriedAndKeepTheirRange) {
    Mesh cube = makeCube();
    for (const V3f& position : cube.positions)
        cube.vertexAttributes["height"].push_back(position.z);
    const SurfaceMesh surface = makeLimitSurface(cube, atLevel(3));
    const std::vector<float>& height = surface.vertexAttributes.at("height");
    ASSERT_EQ(height.size(), surface.positions.size());
    EXPECT_EQ(*std::min_element(height.begin(), height.end()), -1.f);
    EXPECT_EQ(*std::max_element(height.begin(), height.end()), 1.f);
    for (std::size_t i = 0; i < height.size(); ++i)
        if (std::abs(height[i]) < 1e-6f) {
            EXPECT_LT(std::abs(surface.positions[i].z), 1e-5f);
        }
}

TEST(LimitSurface, edgesReachTheirTarget) {
    LimitSurfaceOptions options;
    options.targetEdge = 0.3; // 2 / 2³
    const SurfaceMesh surface = makeLimitSurface(makeCube(), options);
    EXPECT_EQ(surface.triangles.size(), 6u * 64u * 2u);
    options.targetEdge = 1e-9;
    EXPECT_EQ(makeLimitSurface(makeCube(), options).triangles.size(), 6u * 16384u * 2u) << "seven levels at most";
}

TEST(LimitSurface, trianglesStayAsTheyAreUnlessLoopIsAsked) {
    Mesh mesh = makeCube();
    mesh.faceSizes = {3, 3};
    mesh.faceVertices = {0, 1, 2, 2, 1, 3};
    const SurfaceMesh surface = makeLimitSurface(mesh, LimitSurfaceOptions{});
    EXPECT_EQ(surface.triangles.size(), 2u);
    EXPECT_EQ(surface.positions, mesh.positions);
    EXPECT_THROW(makeLimitSurface(makeCube(), atLevel(1, SubdivisionScheme::loop)), ModelError);
    EXPECT_THROW(makeLimitSurface(makeCube(), atLevel(20)), ModelError);
    EXPECT_THROW(makeLimitSurface(Mesh{}, LimitSurfaceOptions{}), ModelError);
}

TEST(LimitSurface, nonManifoldCageStillGivesASurface) {
    // Three squares on one edge.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}, {-1, 1, 0}, {-1, 1, 1}, {-1, -1, 0}, {-1, -1, 1}};
    mesh.faceSizes.assign(3, 4);
    mesh.faceVertices = {0, 2, 3, 1, 0, 4, 5, 1, 0, 6, 7, 1};
    const SurfaceMesh surface = makeLimitSurface(mesh, atLevel(3));
    EXPECT_FALSE(surface.closed);
    EXPECT_GT(surface.area(), 3.0);
    for (const V3f& normal : surface.normals)
        EXPECT_NEAR(normal.length(), 1.f, 1e-5f);
}

TEST(LimitSurface, spotKeepsItsSeams) {
    PATINA_NEEDS_MODEL("spot_control_mesh.obj");
    const Mesh spot = readMesh(sharedModel("spot_control_mesh.obj"));
    const SurfaceMesh surface = makeLimitSurface(spot, atLevel(3));
    EXPECT_TRUE(surface.closed);
    ASSERT_TRUE(surface.hasUvs());
    EXPECT_EQ(surface.triangles.size(), spot.faceVertices.size() * 16 * 2);
    // Corners on a seam (their vertex has several UVs) stand where they stood.
    std::map<int, std::set<int>> uvsOfVertex;
    for (std::size_t i = 0; i < spot.faceVertices.size(); ++i)
        uvsOfVertex[spot.faceVertices[i]].insert(spot.faceUvs[i]);
    int seams = 0;
    for (const auto& [vertex, uvs] : uvsOfVertex) {
        if (uvs.size() < 2)
            continue;
        for (const int uv : uvs) {
            ++seams;
            float nearest = 1e30f;
            for (const V2f& candidate : surface.uvs)
                nearest = std::min(nearest, (candidate - spot.uvs[uv]).length());
            EXPECT_LT(nearest, 1e-6f);
        }
    }
    EXPECT_GT(seams, 50);
    // The limit surface lies within the cage's box.
    EXPECT_LE(surface.bounds().max.x, spot.bounds().max.x + 1e-5f);
    EXPECT_GE(surface.bounds().min.y, spot.bounds().min.y - 1e-5f);
}

TEST(LimitSurface, closednessOfTheSharedModelsIsKnown) {
    const std::pair<const char*, bool> models[] = {
        {"happy_buddha_60k_uv.obj", true}, {"stanford_bunny_holes.obj", false},
        {"rocker_arm_genus1.obj", true},   {"woody_flat_sheet.obj", false},
        {"beetle_nonmanifold.obj", false}, {"copper_strip_sheet.obj", false},
        {"igea_268k.ply", true},           {"suzanne.obj", false}};
    for (const auto& [name, closed] : models) {
        PATINA_NEEDS_MODEL(name);
        EXPECT_EQ(makeLimitSurface(readMesh(sharedModel(name)), atLevel(1)).closed, closed) << name;
    }
}

} // namespace
} // namespace patina
