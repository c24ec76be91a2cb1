#include "operators/fields/field_store.h"

#include "base/errors.h"
#include "field_test_shapes.h"
#include "operators/coat.h"
#include "operators/fields/drainage.h"
#include "operators/fields/field_grid.h"
#include "operators/offset_tangent_sphere.h"
#include "support/test_surfaces.h"
#include "volume/stack_probe.h"

#include <gtest/gtest.h>
#include <openvdb/tools/ValueTransformer.h>

namespace patina {
namespace {

using Imath::V3d;

/// A block of w × h × d standing on y = 0 about the y axis, flat-shaded.
SurfaceMesh block(float w, float h, float d) {
    SurfaceMesh surface;
    const Imath::V3f low(-w / 2, 0.f, -d / 2), size(w, h, d);
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int first = static_cast<int>(surface.positions.size());
            Imath::V3f normal(0.f);
            normal[axis] = side ? 1.f : -1.f;
            for (int corner = 0; corner < 4; ++corner) {
                Imath::V3f p = low;
                p[axis] += side ? size[axis] : 0.f;
                p[(axis + 1) % 3] += (corner & 1) ? size[(axis + 1) % 3] : 0.f;
                p[(axis + 2) % 3] += (corner & 2) ? size[(axis + 2) % 3] : 0.f;
                surface.positions.push_back(p);
                surface.normals.push_back(normal);
            }
            if (side) {
                surface.triangles.emplace_back(first, first + 1, first + 3);
                surface.triangles.emplace_back(first, first + 3, first + 2);
            } else {
                surface.triangles.emplace_back(first, first + 3, first + 1);
                surface.triangles.emplace_back(first, first + 2, first + 3);
            }
        }
    return surface;
}

struct Stand {
    std::unique_ptr<test::Piece> piece;
    std::unique_ptr<FieldStore> store;

    explicit Stand(SurfaceMesh surface, V3d up = {0, 1, 0})
        : piece(test::makePiece(std::move(surface), test::voxelScale(), 8.0)) {
        FieldStore::Scene scene;
        scene.volume = piece->volume.get();
        scene.binding = piece->binding.get();
        scene.up = up;
        const Imath::Box3f box = piece->surface.bounds();
        scene.lowest = box.min.y;
        scene.highest = box.max.y;
        store = std::make_unique<FieldStore>(scene);
    }
    static double at(const ThicknessMapPtr& map, const V3d& p) {
        MapPoint point;
        point.position = p;
        return map->value(point);
    }
};

TEST(FieldGrid, HoldsTheSurfacesValuesThroughTheWholeBand) {
    const auto volume = test::volumeOf([](const V3d& p) { return p.length() - 20.0; }, 30);
    const SurfaceVoxels surface = findSurfaceVoxels(*volume, 0);
    const auto truth = [](const V3d& p) { return 0.5 + 0.4 * std::sin(0.3 * p.x); };
    std::vector<float> values;
    for (const auto& foot : surface.feet)
        values.push_back(static_cast<float>(truth(V3d(foot))));
    storeField(*volume, "test", 0, surface, values);
    const openvdb::FloatGrid& grid = *volume->grids().fields.at("test");
    EXPECT_TRUE(grid.tree().hasSameTopology(volume->grids().base->tree()));
    const ThicknessMapPtr map = makeFieldMap(*volume, "test");
    double worst = 0.0;
    for (const auto& foot : surface.feet)
        for (const double away : {-3.0, 0.0, 1.0, 4.0}) {
            const V3d on(foot), p = on + on.normalized() * away;
            worst = std::max(worst, std::abs(Stand::at(map, p) - truth(on)));
        }
    EXPECT_LT(worst, 0.08); // a voxel's step of the pattern is 0.12
    EXPECT_THROW(makeFieldMap(*volume, "none"), RunError);
}

TEST(FieldStore, ComputesAFieldOnceForEachStateOfTheSurface) {
    Stand stand(test::sphere(14.f, 4));
    ExposureRequest request;
    request.rays = 16;
    Progress progress;
    const ThicknessMapPtr first = stand.store->exposure(request, progress);
    EXPECT_EQ(stand.store->exposure(request, progress), first);
    Workpiece work = stand.piece->work();
    coat(work, "soot", 0.05, nullptr, progress); // a film: the metal still stands for the surface
    EXPECT_EQ(stand.store->exposure(request, progress), first);
    coat(work, "soot", 1.5, nullptr, progress);
    const ThicknessMapPtr second = stand.store->exposure(request, progress);
    EXPECT_NE(second, first);
    EXPECT_EQ(stand.store->exposure(request, progress), second);
    EXPECT_TRUE(stand.piece->volume->grids()
                    .fields.at(request.fieldName())
                    ->tree()
                    .hasSameTopology(stand.piece->volume->grids().base->tree()));
}

// A field that came with the volume is read, not computed: told from a fresh one by a value that nothing computes.
TEST(FieldStore, ReadsWhatCameWithTheVolumeAsLongAsAllItWasMadeFromIsTheSame) {
    Stand stand(test::sphere(14.f, 4));
    ExposureRequest request;
    request.rays = 16;
    Progress progress;
    stand.store->exposure(request, progress);
    const V3d top(0, 14, 0);
    auto& field = stand.piece->volume->grids().fields.at(request.fieldName());
    openvdb::tools::foreach (field->beginValueOn(), [](const auto& voxel) { voxel.setValue(0.123f); });

    const auto another = [&](const V3d& up) {
        FieldStore::Scene scene;
        scene.volume = stand.piece->volume.get();
        scene.binding = stand.piece->binding.get();
        scene.up = up;
        scene.lowest = stand.piece->surface.bounds().min.y;
        scene.highest = stand.piece->surface.bounds().max.y;
        return FieldStore(scene);
    };
    FieldStore later = another({0, 1, 0});
    EXPECT_FLOAT_EQ(Stand::at(later.exposure(request, progress), top), 0.123f);
    EXPECT_GT(Stand::at(another({0, 0, 1}).exposure(request, progress), {0, 0, 14}), 0.5);
    EXPECT_GT(Stand::at(another({0, 1, 0}).exposure(request, progress), top), 0.5);

    // On another surface it is computed, though its grid is there.
    openvdb::tools::foreach (field->beginValueOn(), [](const auto& voxel) { voxel.setValue(0.123f); });
    Workpiece work = stand.piece->work();
    coat(work, "soot", 1.5, nullptr, progress);
    EXPECT_GT(Stand::at(another({0, 1, 0}).exposure(request, progress), top), 0.5);
}

// A cell at an edge holds values of both faces; each is read from its own, whether computed or come with the volume.
TEST(FieldStore, ReadsTheFacesOfAnEdgeEachForItself) {
    Stand stand(block(24.f, 24.f, 24.f));
    ExposureRequest request;
    request.light.sky = uniformSky;
    request.light.sun = false;
    request.rays = 1024;
    Progress progress;
    const ThicknessMapPtr computed = stand.store->exposure(request, progress);
    FieldStore::Scene scene;
    scene.volume = stand.piece->volume.get();
    scene.binding = stand.piece->binding.get();
    scene.lowest = stand.piece->surface.bounds().min.y;
    scene.highest = stand.piece->surface.bounds().max.y;
    FieldStore later(scene);
    const ThicknessMapPtr read = later.exposure(request, progress);
    const V3d up(0, 1, 0), out(1, 0, 0);
    for (double away = 0.1; away < 6.0; away += 0.3)
        for (const double z : {-3.3, 0.2, 4.1}) {
            MapPoint top, side;
            top.position = {12.0 - away, 24.0, z};
            top.normal = up;
            side.position = {12.0, 24.0 - away, z};
            side.normal = out;
            EXPECT_NEAR(computed->value(top), 1.0, 0.01) << away;
            EXPECT_NEAR(computed->value(side), 0.5, 0.01) << away;
            EXPECT_EQ(read->value(top), computed->value(top)) << away;
            EXPECT_EQ(read->value(side), computed->value(side)) << away;
        }
    // Asked without a normal, an edge is neither face.
    const double between = Stand::at(computed, {12.0, 24.0, 0.2});
    EXPECT_GT(between, 0.55);
    EXPECT_LT(between, 0.95);
}

TEST(FieldStore, NamesFieldsAfterTheirArguments) {
    AccessibilityRequest access;
    access.radiusUm = 3000.0;
    EXPECT_EQ(access.fieldName(), "accessibility_3mm");
    access.global = true;
    EXPECT_EQ(access.fieldName(), "accessibility_3mm_global");
    access.soft = 0.5;
    access.softUm = 500.0;
    EXPECT_EQ(access.fieldName(), "accessibility_3mm_soft500um_global");
    ExposureRequest light;
    EXPECT_EQ(light.fieldName(), "exposure");
    light.light.sky = overcastSky;
    light.light.latitudeDegrees = 52.5;
    light.light.firstMonth = 4;
    light.light.lastMonth = 9;
    EXPECT_EQ(light.fieldName("wetness"), "wetness_overcast_latitude52.5_months4to9");
}

TEST(FieldStore, ASphereIsDarkerBelowAndBrighterTowardsTheEquator) {
    Stand stand(test::sphere(16.f, 4));
    ExposureRequest request;
    request.light.latitudeDegrees = 50.0;
    Progress progress;
    const ThicknessMapPtr map = stand.store->exposure(request, progress);
    const double up = Stand::at(map, {0, 16, 0}), down = Stand::at(map, {0, -16, 0});
    const double north = Stand::at(map, {0, 0, -16}), south = Stand::at(map, {0, 0, 16}); // north is -z where y is up
    EXPECT_GT(up, 0.7);
    EXPECT_LT(down, 0.02);
    EXPECT_GT(south, 1.5 * north);
}

TEST(FieldStore, FieldsThatNeedAnUpAxisSaySo) {
    Stand stand(test::sphere(10.f, 3), {0, 0, 0});
    Progress progress;
    EXPECT_THROW(stand.store->exposure({}, progress), RunError);
    EXPECT_THROW(stand.store->wetness({}, progress), RunError);
}

TEST(Wetness, WaterStaysOnTopAndAtTheFootNotOnWallsNorUnderneath) {
    Stand stand(block(16.f, 60.f, 16.f));
    Progress progress;
    const ThicknessMapPtr map = stand.store->wetness({}, progress);
    const double top = Stand::at(map, {0, 60, 0}), southWall = Stand::at(map, {0, 40, 8});
    const double northWall = Stand::at(map, {0, 40, -8}), foot = Stand::at(map, {0, 1.5, 8});
    EXPECT_GT(top, 1.3 * southWall);
    EXPECT_GT(northWall, southWall); // daylight dries
    EXPECT_GT(foot, 1.5 * southWall);
    for (const auto& [name, field] : stand.piece->volume->grids().fields)
        for (auto voxel = field->cbeginValueOn(); voxel; ++voxel)
            ASSERT_TRUE(*voxel >= 0.f && *voxel <= 1.f) << name;
}

TEST(Drainage, WaterOfAConeCollectsTowardsItsFoot) {
    // Rain on a cone of 45° runs down all around: what passes at a height is what fell above it, over the
    // circumference.
    const auto cone = test::volumeOf(
        [](const V3d& p) { return std::max((std::hypot(p.x, p.y) + p.z - 25.0) * std::sqrt(0.5), -15.0 - p.z); }, 44);
    const SurfaceVoxels surface = findSurfaceVoxels(*cone, 0);
    const V3d up = test::toLattice({0, 0, 1});
    const Drainage drainage = drain(surface, up, std::vector<float>(surface.size(), 1.f));
    const auto mean = [&](double low, double high) {
        double sum = 0.0;
        int count = 0;
        for (std::size_t i = 0; i < surface.size(); ++i)
            if (const double z = test::toObject(V3d(surface.feet[i])).z; z > low && z < high) {
                sum += drainage.passing[i];
                ++count;
            }
        return sum / count;
    };
    // Radius 10 and 30 from the axis: the catch per width is proportional to the radius.
    EXPECT_NEAR(mean(-7, -3) / mean(13, 17), 3.0, 0.75);
    EXPECT_LT(mean(-16, -14.5), mean(-7, -3)); // underneath
}

TEST(OffsetTangentSphere, CoatsWhereTheSphereIsSmallerAndNowhereElse) {
    // A block with a groove of 90°: spheres smaller than 6 at less than 6 from the apex (tan 45° = 1).
    SurfaceMesh mesh = block(60.f, 24.f, 40.f);
    // Cut the top face in two slopes: rebuild as a prism along z with a V in its top.
    const std::vector<V3d> profile = {{-30, 0, 0}, {30, 0, 0},   {30, 24, 0}, {14, 24, 0},
                                      {0, 10, 0},  {-14, 24, 0}, {-30, 24, 0}};
    mesh = SurfaceMesh();
    const auto quad = [&](const V3d& a, const V3d& b, const V3d& c, const V3d& d) {
        const int first = static_cast<int>(mesh.positions.size());
        const V3d n = (b - a).cross(d - a).normalized();
        for (const V3d& p : {a, b, c, d}) {
            mesh.positions.emplace_back(p);
            mesh.normals.emplace_back(n);
        }
        mesh.triangles.emplace_back(first, first + 1, first + 2);
        mesh.triangles.emplace_back(first, first + 2, first + 3);
    };
    const V3d back(0, 0, -20), front(0, 0, 20);
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const V3d a = profile[i], b = profile[(i + 1) % profile.size()];
        quad(a + back, b + back, b + front, a + front);
    }
    for (const auto& [a, b, c, d] : {std::array<int, 4>{0, 4, 5, 6}, {0, 1, 4, 4}, {1, 2, 3, 4}}) {
        quad(profile[a] + front, profile[b] + front, profile[c] + front, profile[d] + front);
        quad(profile[d] + back, profile[c] + back, profile[b] + back, profile[a] + back);
    }
    for (Imath::V3i& t : mesh.triangles) { // walls are given inside out
        const Imath::V3f& n = mesh.normals[t.x];
        const V3d face =
            V3d(mesh.positions[t.y] - mesh.positions[t.x]).cross(V3d(mesh.positions[t.z] - mesh.positions[t.x]));
        if (face.dot(V3d(n)) < 0.0)
            std::swap(t.y, t.z);
    }
    Stand stand(std::move(mesh));
    Progress progress;
    Workpiece work = stand.piece->work();
    offsetTangentSphere(work, "wax", 6.0, 0.5, false, progress);
    const StackProbe probe(*stand.piece->volume);
    double um[1];
    const double h = std::sqrt(0.5);
    for (const double s : {2.0, 4.0, 5.0, 7.0, 9.0, 14.0}) {
        probe.read({s * h, 10.0 + s * h, 0.0}, {-h, h, 0.0}, um);
        EXPECT_NEAR(um[0], s < 6.0 ? 0.5 : 0.0, 0.03) << s;
    }
    EXPECT_TRUE(stand.piece->volume->grids().fields.empty());
    EXPECT_THROW(offsetTangentSphere(work, "wax", 0.0, 0.5, false, progress), RunError);
}

} // namespace
} // namespace patina
