#include "surface/mesh_repair.h"

#include "base/errors.h"
#include "surface/ray_scene.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

constexpr double thinVoxels = 2.0;
constexpr double mostVoxels = 8192.0; // a person would try
constexpr std::size_t mostTriangles = 1000000; // beyond that every other, third, … is looked at

std::string placeOf(const SurfaceMesh& surface, std::size_t triangle, const V3d& p) {
    return fmt::format("face {}, at ({:.4g}, {:.4g}, {:.4g})", surface.triangleFaces[triangle] + 1, p.x, p.y, p.z);
}

/// Faces that another's edge goes through.
void findPierced(const SurfaceMesh& surface, const RayScene& scene, MeshReport& report) {
    const std::size_t count = surface.triangles.size();
    std::vector<int> other(count, -1);
    std::vector<V3f> where(count);
    const std::size_t step = 1 + count / mostTriangles;
    tbb::parallel_for(std::size_t(0), (count + step - 1) / step, [&](std::size_t i) {
        const std::size_t t = i * step;
        const V3i& corners = surface.triangles[t];
        for (int c = 0; c < 3; ++c) {
            const V3f a = surface.positions[corners[c]], b = surface.positions[corners[(c + 1) % 3]];
            const auto hit = scene.intersect(a, b - a, 1e-3f, 1.f - 1e-3f);
            // A patch does not pierce itself where it was only diced: rays graze its own triangles.
            if (!hit || surface.triangleFaces[hit->point.triangle] == surface.triangleFaces[t])
                continue;
            // Neighbours do not count, whether they share vertices or only their places.
            const V3i& far = surface.triangles[hit->point.triangle];
            bool shares = false;
            for (int d = 0; d < 3; ++d)
                shares = shares || surface.positions[far[d]] == a || surface.positions[far[d]] == b;
            if (shares || hit->geometricNormal.length2() == 0.f)
                continue;
            other[t] = hit->point.triangle;
            where[t] = a + (b - a) * hit->distance;
            break;
        }
    });
    std::vector<int> faces;
    for (std::size_t t = 0; t < count; ++t)
        if (other[t] >= 0) {
            if (faces.empty())
                report.piercedFaces.where =
                    fmt::format("faces {} and {}, at ({:.4g}, {:.4g}, {:.4g})", surface.triangleFaces[t] + 1,
                                surface.triangleFaces[other[t]] + 1, where[t].x, where[t].y, where[t].z);
            faces.push_back(surface.triangleFaces[t]);
            faces.push_back(surface.triangleFaces[other[t]]);
        }
    std::sort(faces.begin(), faces.end());
    report.piercedFaces.count = static_cast<std::size_t>(std::unique(faces.begin(), faces.end()) - faces.begin());
}

} // namespace

const char* nameOf(MeshReport::ShellKind kind) {
    switch (kind) {
    case MeshReport::ShellKind::solid:
        return "solid";
    case MeshReport::ShellKind::cavity:
        return "cavity";
    case MeshReport::ShellKind::hidden:
        return "hidden";
    case MeshReport::ShellKind::sheet:
        return "sheet";
    }
    return "";
}

RepairMode repairModeNamed(const std::string& word) {
    if (word == "holes")
        return RepairMode::holes;
    if (word == "sheet")
        return RepairMode::sheet;
    if (word == "none")
        return RepairMode::none;
    return RepairMode::automatic;
}

void checkWalls(const SurfaceMesh& surface, double voxelSize, double longestSide, MeshReport& report) {
    const RayScene scene(surface.positions, surface.triangles);
    findPierced(surface, scene, report);
    if (report.piercedFaces.count > 0)
        report.notices.push_back(fmt::format("faces that pierce each other: {} ({}); what lies inside is hidden",
                                             report.piercedFaces.count, report.piercedFaces.where));

    struct Wall {
        float thickness;
        std::size_t triangle;
        double area;
    };
    const std::size_t count = surface.triangles.size();
    const std::size_t step = 1 + count / mostTriangles;
    std::vector<Wall> walls((count + step - 1) / step);
    const double wide = 16.0 * voxelSize;
    tbb::parallel_for(std::size_t(0), walls.size(), [&](std::size_t i) {
        const std::size_t t = i * step;
        const V3i& c = surface.triangles[t];
        const V3d a(surface.positions[c.x]), b(surface.positions[c.y]), d(surface.positions[c.z]);
        const V3d cross = (b - a).cross(d - a);
        const double twice = cross.length();
        walls[i] = {std::numeric_limits<float>::infinity(), t, 0.5 * twice};
        if (twice <= 0.0)
            return;
        const V3d inward = cross / -twice, middle = (a + b + d) / 3.0;
        const auto hit = scene.intersect(V3f(middle), V3f(inward), static_cast<float>(1e-4 * voxelSize),
                                         static_cast<float>(wide));
        // Only where the other side looks back: edges of wedges are thin anywhere.
        if (hit && V3d(hit->geometricNormal).normalized().dot(inward) > 0.5)
            walls[i].thickness = hit->distance;
    });
    std::sort(walls.begin(), walls.end(), [](const Wall& a, const Wall& b) {
        return a.thickness < b.thickness || (a.thickness == b.thickness && a.triangle < b.triangle);
    });
    double area = 0.0, thinArea = 0.0, sofar = 0.0;
    for (const Wall& wall : walls) {
        area += wall.area;
        thinArea += wall.thickness < thinVoxels * voxelSize ? wall.area : 0.0;
    }
    if (!(thinArea > 1e-3 * area))
        return;
    MeshReport::ThinWalls& thin = report.thinWalls;
    thin.fraction = thinArea / area;
    thin.thinnest = walls[0].thickness;
    for (const Wall& wall : walls) {
        sofar += wall.area;
        thin.thin = wall.thickness;
        if (sofar >= 1e-3 * area)
            break;
    }
    const V3i& c = surface.triangles[walls[0].triangle];
    const V3d place = (V3d(surface.positions[c.x]) + V3d(surface.positions[c.y]) + V3d(surface.positions[c.z])) / 3.0;
    thin.where = placeOf(surface, walls[0].triangle, place);
    const double needed = std::ceil(thinVoxels * longestSide / std::max(thin.thin, 1e-6 * longestSide));
    const std::string remedy = needed <= mostVoxels
                                   ? fmt::format("--voxels {:.0f} would do for all but a thousandth", needed)
                                   : "some of it no number of voxels would do for";
    report.warnings.push_back(
        fmt::format("{:.2g} % of the surface lies on walls thinner than two voxels, the thinnest {:.2g} ({}); {}",
                    100.0 * thin.fraction, thin.thinnest / voxelSize, thin.where, remedy));
}

} // namespace patina
