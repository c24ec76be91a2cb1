// Close-ups: a box cut out of a model is what it is in the whole, at its own voxel size.

#include "volume/region.h"
#include "volume/region_model.h"
#include "volume/region_voxelize.h"

#include "base/errors.h"
#include "operators/coat.h"
#include "operators/erode.h"
#include "operators/growth/grow.h"
#include "support/test_surfaces.h"
#include "surface/region_charts.h"
#include "surface/region_clip.h"
#include "surface/shapes.h"
#include "volume/nest_sampler.h"
#include "volume/stack_probe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace patina {
namespace {

using Imath::Box3d;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;
using testing::HasSubstr;

Mesh meshOf(const SurfaceMesh& surface) {
    Mesh mesh;
    mesh.name = "model";
    mesh.positions = surface.positions;
    for (const V3i& t : surface.triangles) {
        mesh.faceSizes.push_back(3);
        for (int c = 0; c < 3; ++c)
            mesh.faceVertices.push_back(t[c]);
    }
    return mesh;
}

void append(Mesh& mesh, const Mesh& more) {
    const int first = static_cast<int>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
    mesh.faceSizes.insert(mesh.faceSizes.end(), more.faceSizes.begin(), more.faceSizes.end());
    for (const int v : more.faceVertices)
        mesh.faceVertices.push_back(v + first);
}

Mesh cube(const V3f& low, const V3f& high) {
    Mesh mesh;
    mesh.name = "cube";
    for (int i = 0; i < 8; ++i)
        mesh.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : quads)
        for (const auto& t : {V3i(0, 1, 2), V3i(0, 2, 3)}) {
            mesh.faceSizes.push_back(3);
            for (int c = 0; c < 3; ++c)
                mesh.faceVertices.push_back(q[t[c]]);
        }
    return mesh;
}

void turnInsideOut(Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.faceVertices.size(); i += 3)
        std::swap(mesh.faceVertices[i], mesh.faceVertices[i + 1]);
}

Box3d cubeAround(const V3d& middle, double size) {
    return {middle - V3d(0.5 * size), middle + V3d(0.5 * size)};
}

/// A region with its bare volume.
struct CloseUp {
    RegionModel model;
    ClosedSurface closed;
    LayerVolume volume;
    SurfaceBinding binding;

    CloseUp(Mesh mesh, const Box3d& box, int voxels, double reachVoxels = 8.0,
            const RegionModel::Options& options = {})
        : model(std::move(mesh), makeRegion(box, box.size().x / voxels, reachVoxels), options),
          closed(closeSurface(model.work(), sheetBackVoxels * model.region().localVoxelSize())),
          volume(voxelized(closed, model, reachVoxels)), binding(volume, model.work(), closed) {
        binding.refineBase(volume);
    }

    static LayerVolume voxelized(const ClosedSurface& closed, const RegionModel& model, double reachVoxels) {
        initializeVolumes();
        VoxelizeOptions options;
        options.scale.voxelSize = model.region().localVoxelSize();
        options.scale.metresPerUnit = 1.0 / model.region().magnification;
        options.exteriorBand = reachVoxels;
        Progress progress;
        return voxelizeRegion(closed, model.region(), options, progress);
    }

    void coatUm(const std::string& material, double um) {
        Progress progress;
        Workpiece work{volume, binding};
        coat(work, material, um, nullptr, progress);
    }
    void erodeUm(double um) {
        Progress progress;
        Workpiece work{volume, binding};
        erode(work, um, nullptr, {}, progress);
    }
};

// --- cutting ---

TEST(RegionClip, CutsAtTheSidesWithoutCracks) {
    const SurfaceMesh whole = test::sphere(10.f, 4);
    SurfaceMesh surface = whole;
    surface.triangleFaces.assign(surface.triangles.size(), 0);
    const Box3d box(V3d(1.3, 2.1, 4.0), V3d(6.0, 7.7, 12.0));
    const SurfaceMesh piece = diced(clippedTo(surface, box), 0.37);
    ASSERT_FALSE(piece.triangles.empty());
    std::map<std::pair<int, int>, int> edges;
    for (const V3i& t : piece.triangles)
        for (int c = 0; c < 3; ++c) {
            const int a = t[c], b = t[(c + 1) % 3];
            ++edges[std::minmax(a, b)];
            EXPECT_LE((piece.positions[a] - piece.positions[b]).length(), 0.37 + 1e-6);
        }
    for (const auto& [edge, count] : edges) {
        ASSERT_LE(count, 2);
        if (count == 2)
            continue;
        // An open edge lies in a side of the box.
        bool onSide = false;
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {box.min[axis], box.max[axis]})
                onSide = onSide || (std::abs(piece.positions[edge.first][axis] - side) < 1e-5 &&
                                    std::abs(piece.positions[edge.second][axis] - side) < 1e-5);
        ASSERT_TRUE(onSide);
    }
    // The pieces of a partition add up to the whole.
    double area = 0.0;
    for (int i = 0; i < 8; ++i) {
        Box3d part;
        part.extendBy(V3d(0.7, -1.1, 2.3));
        part.extendBy(V3d(i & 1 ? 20 : -20, i & 2 ? 20 : -20, i & 4 ? 20 : -20));
        area += clippedTo(surface, part).area();
    }
    EXPECT_NEAR(area, whole.area(), 1e-4 * whole.area());
}

TEST(RegionCharts, FillTheTileWithoutOverlapOrStretch) {
    for (const double size : {4.0, 40.0}) { // a patch that faces one way, a whole sphere
        SurfaceMesh surface = test::sphere(10.f, 4);
        surface.triangleFaces.assign(surface.triangles.size(), 0);
        SurfaceMesh piece = clippedTo(surface, cubeAround({0.0, 0.0, 10.0}, size));
        makeProjectedCharts(piece, {0, 1, 0}, 512);
        double covered = 0.0;
        std::map<std::pair<int, int>, int> texels; // coarse: triangles' middles
        for (std::size_t t = 0; t < piece.triangles.size(); ++t) {
            const V3i& c = piece.triangleUvs[t];
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 2; ++j) {
                    ASSERT_GE(piece.uvs[c[i]][j], 0.f);
                    ASSERT_LE(piece.uvs[c[i]][j], 1.f);
                }
            const Imath::V2d e(piece.uvs[c[1]] - piece.uvs[c[0]]), f(piece.uvs[c[2]] - piece.uvs[c[0]]);
            const double area = 0.5 * (e.x * f.y - e.y * f.x);
            ASSERT_GE(area, -1e-12) << "mirrored";
            covered += area;
            const Imath::V2f middle = (piece.uvs[c[0]] + piece.uvs[c[1]] + piece.uvs[c[2]]) / 3.f;
            ++texels[{int(middle.x * 4096), int(middle.y * 4096)}];
        }
        EXPECT_GT(covered, size < 10 ? 0.8 : 0.35);
        EXPECT_LE(covered, 1.0);
        for (const auto& [texel, count] : texels)
            EXPECT_LE(count, 2);
    }
}

TEST(RegionText, ReadsBackToTheBit) {
    Region region = makeRegion(cubeAround({0.0123456789, -0.3, 1.0 / 3.0}, 0.0005), 0.0005 / 512, 11.5);
    region.pieceHash = "0123456789abcdef";
    const Region back = Region::fromText(region.text(), "x.vdb");
    EXPECT_EQ(back.text(), region.text());
    EXPECT_EQ(back.box.min, region.box.min);
    EXPECT_EQ(back.origin(), region.origin());
    EXPECT_EQ(back.magnification, 1024.0);
    EXPECT_THROW(Region::fromText("box 1 2 3", "x.vdb"), RunError);
}

// --- the base ---

TEST(RegionVolume, HasTheSignsAndDistancesOfTheWholeAndNoWallsAtItsSides) {
    // Ten centimetres, half a millimetre of it: facets of the geodesic sphere are far larger than the box.
    const double radius = 0.05;
    const Mesh mesh = meshOf(test::sphere(float(radius), 6));
    const V3d place = V3d(0.3, 0.5, 0.8).normalized() * (radius - 2e-6);
    CloseUp closeUp(mesh, cubeAround(place, 0.0005), 64);
    const Region& region = closeUp.model.region();
    const NestSampler sampler(closeUp.volume.grids());
    const Imath::Box3i sides = region.voxelSides();
    // Against the facets themselves.
    const SurfaceMesh& whole = closeUp.model.whole();
    std::vector<int> nearby;
    for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
        Box3d own;
        for (int c = 0; c < 3; ++c)
            own.extendBy(V3d(whole.positions[whole.triangles[t][c]]));
        if (own.intersects(Box3d(region.surfaceBox())))
            nearby.push_back(static_cast<int>(t));
    }
    const double voxel = region.localVoxelSize();
    std::size_t inside = 0, outside = 0;
    for (int i = sides.min.x; i <= sides.max.x; i += 3)
        for (int j = sides.min.y; j <= sides.max.y; j += 3)
            for (int k = sides.min.z; k <= sides.max.z; k += 3) {
                const V3d x = region.toModel(V3d(i, j, k) * voxel);
                // A convex body: outside where beyond the plane of any facet, by the farthest.
                double distance = -1.0;
                for (const int t : nearby) {
                    const V3i& c = whole.triangles[t];
                    const V3d a(whole.positions[c[0]]), b(whole.positions[c[1]]), d(whole.positions[c[2]]);
                    distance = std::max(distance, (x - a).dot((b - a).cross(d - a).normalized()));
                }
                if (std::abs(distance) < 1e-3 * region.voxelSize)
                    continue;
                const float phi = sampler.voxel(0, sampler.space().index(i, j, k));
                ASSERT_EQ(phi < 0.f, distance < 0.0) << i << " " << j << " " << k;
                (distance < 0.0 ? inside : outside) += 1;
                if (distance > -3.0 * region.voxelSize && distance < 0.0) {
                    ASSERT_NEAR(phi, distance * region.magnification, 2e-3 * voxel);
                }
            }
    EXPECT_GT(inside, 1000u);
    EXPECT_GT(outside, 1000u);
}

TEST(RegionVolume, CarriesTheModelsCoordinatesInItsTransform) {
    const double radius = 0.05;
    CloseUp closeUp(meshOf(test::sphere(float(radius), 5)), cubeAround({0.0, 0.0, radius}, 0.0005), 32);
    const Region& region = closeUp.model.region();
    const auto& base = *closeUp.volume.grids().base;
    const openvdb::Vec3d world = base.indexToWorld(closeUp.volume.grids().space.index(3, -5, 7));
    const V3d model = region.toModel(V3d(3, -5, 7) * region.localVoxelSize());
    EXPECT_NEAR(world.x() / region.magnification, model.x, 1e-12);
    EXPECT_NEAR(world.y() / region.magnification, model.y, 1e-12);
    EXPECT_NEAR(world.z() / region.magnification, model.z, 1e-12);
}

TEST(RegionVolume, SettlesModelsTurnedInsideOutAndPartsInsideOthers) {
    Mesh mesh = cube(V3f(0.f), V3f(0.1f));
    append(mesh, cube(V3f(0.03f, 0.03f, 0.05f), V3f(0.06f, 0.06f, 0.12f))); // a chimney that stands deep in it
    for (const bool inverted : {false, true}) {
        Mesh model = mesh;
        if (inverted)
            turnInsideOut(model);
        // Around the foot of the chimney: its lower part and the cube's face below it are no surface.
        CloseUp closeUp(model, cubeAround({0.03, 0.045, 0.1}, 0.004), 48);
        const NestSampler sampler(closeUp.volume.grids());
        const Region& region = closeUp.model.region();
        const auto phi = [&](double x, double y, double z) {
            return sampler.value(0, sampler.locate(region.toLocal({x, y, z}) / region.localVoxelSize()));
        };
        EXPECT_LT(phi(0.0285, 0.045, 0.0995), 0.0); // in the cube
        EXPECT_LT(phi(0.0305, 0.045, 0.1005), 0.0); // in the chimney
        EXPECT_LT(phi(0.0305, 0.045, 0.0995), 0.0); // in both
        EXPECT_GT(phi(0.0295, 0.045, 0.1005), 0.0); // in the air
        // Twice half the box: face and wall, nothing below.
        const double side = 0.004;
    
        const double area = closeUp.model.shown().area() / (region.magnification * region.magnification);
        EXPECT_NEAR(area, side * side, 0.04 * side * side);
    }
}

TEST(RegionModelErrors, SayWhereTheNearestSurfaceIs) {
    const Mesh mesh = cube(V3f(0.f), V3f(0.1f));
    const auto messageAt = [&](const V3d& place) {
        try {
            const RegionModel model(mesh, makeRegion(cubeAround(place, 0.001), 1e-5, 8.0), {});
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::commandLine);
            return error.message() + "; " + error.remedy();
        }
        return std::string("no error");
    };
    EXPECT_THAT(messageAt({0.05, 0.05, 0.11}), testing::AllOf(HasSubstr("in the air"), HasSubstr("0.05,0.05,0.1")));
    EXPECT_THAT(messageAt({0.05, 0.05, 0.09}), HasSubstr("in the metal"));
    EXPECT_THROW(makeRegion(cubeAround({1e6, 0, 0}, 1e-3), 1e-5, 8.0), RunError);
}

// --- layers at true scale ---

struct Errors {
    double rms = 0.0, worst = 0.0;
    std::size_t count = 0;
};

Errors thicknessErrors(const CloseUp& closeUp, std::size_t layer, double um, const std::function<bool(const V3d&)>& counts) {
    const StackProbe probe(closeUp.volume);
    const SurfaceMesh& shown = closeUp.model.shown();
    std::vector<double> read(std::max(1, closeUp.volume.layerCount()));
    Errors errors;
    double squares = 0.0;
    for (std::size_t t = 0; t < shown.triangles.size(); ++t) {
        const SurfacePoint centre{static_cast<int>(t), 1.f / 3.f, 1.f / 3.f};
        const V3d p = positionAt(shown, centre);
        if (!counts(closeUp.model.region().toModel(p)))
            continue;
        const auto reading = probe.read(p, normalAt(shown, centre), read.data());
        EXPECT_TRUE(reading.found);
        const double error = read[layer] / um - 1.0;
        squares += error * error;
        errors.worst = std::max(errors.worst, std::abs(error));
        ++errors.count;
    }
    errors.rms = std::sqrt(squares / std::max<std::size_t>(1, errors.count));
    return errors;
}

TEST(RegionLayers, OnASphereHaveTheirThicknessUpToTheBoxesSides) {
    // 200 µm of ten centimetres; voxels of 1.6 µm, films of 0.2 to 2 voxels. Finer facets than any scan's.
    const double radius = 0.05;
    const V3d place = V3d(0.3, -0.5, 0.8).normalized() * radius;
    CloseUp closeUp(meshOf(test::sphere(float(radius), 6)), cubeAround(place, 0.0002), 128, 9.0);
    closeUp.coatUm("tarnish_1", 0.35);
    closeUp.coatUm("cuprite_2", 1.2);
    closeUp.coatUm("marine_patina_3", 3.0);
    closeUp.coatUm("marine_patina_4", 1.8);
    closeUp.erodeUm(0.5);
    const double expected[] = {0.35, 1.2, 3.0, 1.3};
    for (std::size_t k = 0; k < 4; ++k) {
        const Errors errors = thicknessErrors(closeUp, k, expected[k], [](const V3d&) { return true; });
        EXPECT_GT(errors.count, 5000u);
        EXPECT_LT(errors.rms, 0.005) << expected[k] << " µm";
        EXPECT_LT(errors.worst, 0.02) << expected[k] << " µm";
    }
}

TEST(RegionLayers, AcrossAnEdgeHaveTheirThicknessOnBothFaces) {
    CloseUp closeUp(cube(V3f(0.f), V3f(0.1f)), cubeAround({0.1, 0.05, 0.1}, 0.0004), 128, 6.0);
    closeUp.coatUm("tarnish_1", 0.35);
    closeUp.coatUm("cuprite_2", 1.2);
    closeUp.coatUm("marine_patina_3", 3.0);
    closeUp.erodeUm(0.5);
    const double voxel = closeUp.model.region().voxelSize;
    const auto awayFromEdge = [&](const V3d& p) { return std::min(0.1 - p.x, 0.1 - p.z) < 0.1 * voxel &&
                                                         std::max(0.1 - p.x, 0.1 - p.z) > 4.0 * voxel; };
    const double expected[] = {0.35, 1.2, 2.5};
    for (std::size_t k = 0; k < 3; ++k) {
        const Errors errors = thicknessErrors(closeUp, k, expected[k], awayFromEdge);
        EXPECT_GT(errors.count, 5000u);
        EXPECT_LT(errors.rms, 0.005) << expected[k] << " µm";
        EXPECT_LT(errors.worst, 0.02) << expected[k] << " µm";
    }
}

TEST(RegionLayers, AreTheSameInASmallerBox) {
    // What the sides do to a region stays in its margin: the smaller one sees what the larger one does.
    const double radius = 0.05;
    const V3d place = V3d(0.3, -0.5, 0.8).normalized() * radius;
    const Mesh mesh = meshOf(test::sphere(float(radius), 5));
    CloseUp large(mesh, cubeAround(place, 0.0004), 128, 9.0);
    CloseUp small(mesh, cubeAround(place, 0.0002), 64, 9.0);
    for (CloseUp* closeUp : {&large, &small}) {
        closeUp->coatUm("tarnish_1", 0.35);
        closeUp->coatUm("marine_patina_3", 6.0);
        closeUp->erodeUm(0.5);
        closeUp->coatUm("soot", 9.0);
    }
    const StackProbe inLarge(large.volume), inSmall(small.volume);
    const SurfaceMesh& shown = small.model.shown();
    double a[3], b[3];
    for (std::size_t t = 0; t < shown.triangles.size(); t += 7) {
        const SurfacePoint centre{static_cast<int>(t), 1.f / 3.f, 1.f / 3.f};
        const V3d p = positionAt(shown, centre), n = normalAt(shown, centre);
        inSmall.read(p, n, a);
        inLarge.read(large.model.region().toLocal(small.model.region().toModel(p)), n, b);
        for (int k = 0; k < 3; ++k)
            ASSERT_NEAR(a[k], b[k], 0.002 * b[k]) << k;
    }
}

TEST(RegionLayers, OfACageFollowItsLimitSurface) {
    const Mesh cage = makeShape("sphere");
    RegionModel::Options options;
    LimitSurfaceOptions limit;
    limit.level = 4;
    const SurfaceMesh fine = makeLimitSurface(cage, limit);
    const V3d place(fine.positions[fine.positions.size() / 3]);
    CloseUp closeUp(cage, cubeAround(place, 0.0004), 64, 8.0, options);
    EXPECT_TRUE(closeUp.model.shown().closed);
    // The limit point itself lies on the base, to the chord of whole-model refinement at most.
    const Region& region = closeUp.model.region();
    const NestSampler sampler(closeUp.volume.grids());
    EXPECT_NEAR(sampler.value(0, sampler.locate(region.toLocal(place) / region.localVoxelSize())), 0.0,
                0.02 * region.localVoxelSize());
    closeUp.coatUm("marine_patina_3", 3.0);
    const Errors errors = thicknessErrors(closeUp, 0, 3.0, [](const V3d&) { return true; });
    EXPECT_LT(errors.rms, 0.005);
    EXPECT_LT(errors.worst, 0.02);
}

TEST(RegionLayers, OfAnOpenSheetHaveABackAndNoRim) {
    CloseUp closeUp(meshOf(test::sheet(0.1f, 4)), cubeAround({0.04, 0.05, 0.0}, 0.0004), 64);
    EXPECT_FALSE(closeUp.model.work().closed);
    closeUp.coatUm("tarnish_1", 0.35);
    closeUp.coatUm("marine_patina_3", 12.0);
    for (std::size_t k = 0; k < 2; ++k) {
        const double um = k == 0 ? 0.35 : 12.0;
        const Errors errors = thicknessErrors(closeUp, k, um, [](const V3d&) { return true; });
        EXPECT_LT(errors.worst, 0.005) << um;
    }
}

// --- patterns ---

TEST(RegionGrowth, IsThatOfTheWholeBitForBit) {
    SurfaceMesh surface = test::sphere(1.f, 5);
    const Mesh mesh = meshOf(surface);
    const RegionModel model(mesh, makeRegion(cubeAround(V3d(0.3, 0.5, 0.81), 0.3), 0.3 / 64, 4.0), {});
    const double cell = 0.01;
    for (const GrowthModel kind : {GrowthModel::ballisticDeposition, GrowthModel::directedPercolation,
                                   GrowthModel::relaxation, GrowthModel::steadyThickening}) {
        GrowthOptions options;
        options.model = kind;
        options.step = 3;
        options.total = 20;
        options.pointSpacing = 4;
        options.patch = 4;
        options.firstSeeds = 3e-3;
        const GrowthLattice whole = surfaceLattice(model.whole(), cell);
        const GrowthLattice piece =
            surfaceLattice(model.growthSurface(growthMarginCells(options) * cell, cell), cell);
        ASSERT_LT(piece.size(), whole.size());
        const auto inWhole = growHeights(whole, options, 7, "coat", nullptr);
        const auto inPiece = growHeights(piece, options, 7, "coat", nullptr);
        std::map<std::tuple<int, int, int>, float> heights;
        for (std::size_t i = 0; i < whole.size(); ++i)
            heights[{whole.keys[i].x, whole.keys[i].y, whole.keys[i].z}] = inWhole[i];
        std::size_t compared = 0;
        const Box3d box = model.region().surfaceBox();
        for (std::size_t i = 0; i < piece.size(); ++i) {
            if (!box.intersects(V3d(piece.centres[i])))
                continue;
            const auto found = heights.find({piece.keys[i].x, piece.keys[i].y, piece.keys[i].z});
            ASSERT_NE(found, heights.end());
            ASSERT_EQ(found->second, inPiece[i]);
            ++compared;
        }
        EXPECT_GT(compared, 500u);
    }
}

} // namespace
} // namespace patina
