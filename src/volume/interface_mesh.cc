#include "volume/interface_mesh.h"

#include "base/errors.h"
#include "volume/nest_grids.h"
#include "volume/nest_sampler.h"

#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace patina {

namespace {

// Whether every edge is passed once in each direction.
bool isClosed(const std::vector<Imath::V3i>& triangles) {
    std::vector<std::pair<int, int>> edges;
    edges.reserve(3 * triangles.size());
    std::int64_t balance = 0;
    for (const Imath::V3i& t : triangles)
        for (int i = 0; i < 3; ++i) {
            const int a = t[i], b = t[(i + 1) % 3];
            edges.emplace_back(std::min(a, b), std::max(a, b));
            balance += a < b ? 1 : -1;
        }
    if (balance != 0)
        return false;
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i;
        while (end < edges.size() && edges[end] == edges[i])
            ++end;
        if ((end - i) % 2 != 0)
            return false;
        i = end;
    }
    return true;
}

// Of phi_k, over a voxel each way; scene units.
Imath::V3d slopeAt(const NestSampler& sampler, int k, const Imath::V3d& at) {
    Imath::V3d slope;
    for (int axis = 0; axis < 3; ++axis) {
        Imath::V3d half(0.0);
        half[axis] = 0.5;
        slope[axis] = sampler.value(k, sampler.locate(at + half)) - sampler.value(k, sampler.locate(at - half));
    }
    return slope;
}

Imath::V3f normalOf(const Imath::V3d& slope) {
    return slope.length() > 0.0 ? Imath::V3f(slope.normalized()) : Imath::V3f(0, 0, 1);
}

std::vector<Imath::V3f> slopesOf(const NestSampler& sampler, int k, double voxelSize,
                                 const std::vector<Imath::V3f>& points) {
    std::vector<Imath::V3f> slopes(points.size());
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
        slopes[i] = Imath::V3f(slopeAt(sampler, k, Imath::V3d(points[i]) / voxelSize) / voxelSize);
    });
    return slopes;
}

// How far from a point the solid of phi_k is left when going along a unit direction; voxels, -1 to 1, of several the
// nearest on the side that the point's own sign tells, or else on the other.
std::optional<double> wayOut(const NestSampler& sampler, int k, const Imath::V3d& from, const Imath::V3d& along) {
    constexpr int steps = 8; // within an eighth of a voxel no gap opens and closes that pictures show
    const auto phi = [&](double way) { return sampler.value(k, sampler.locate(from + along * way)); };
    const double here = phi(0.0);
    for (const double side : here < 0.0 ? std::array{1.0, -1.0} : std::array{-1.0, 1.0}) {
        double before = 0.0, phiBefore = here;
        for (int step = 1; step <= steps; ++step) {
            double after = side * step / steps, phiAfter = phi(after);
            const double inner = side > 0.0 ? phiBefore : phiAfter, outer = side > 0.0 ? phiAfter : phiBefore;
            if (inner < 0.0 && outer >= 0.0) {
                // The secant of a bracket, its older end halved where it stays (Illinois): phi is nearly linear here.
                for (int turn = 0; turn < 16 && std::abs(after - before) > 1e-6; ++turn) {
                    const double next = before - phiBefore * (after - before) / (phiAfter - phiBefore);
                    const double phiNext = phi(next);
                    if ((phiNext < 0.0) == (phiAfter < 0.0))
                        phiBefore *= 0.5;
                    else
                        before = after, phiBefore = phiAfter;
                    after = next, phiAfter = phiNext;
                    if (std::abs(phiAfter) < 1e-5 * std::abs(outer - inner))
                        break;
                }
                return after;
            }
            before = after, phiBefore = phiAfter;
        }
    }
    return std::nullopt;
}

} // namespace

SurfaceMesh interfaceMesh(const LayerVolume& volume, int layer) {
    if (layer < 0 || layer > volume.layerCount())
        throw RunError("volume", "it has no such interface", "ask for 0, the metal, up to the number of its layers");
    const NestGrids& grids = volume.grids();
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    // In scene units from the origin of the nest: a region's transform moves its grids into the model's coordinates.
    const double voxelSize = volume.scale().voxelSize;
    openvdb::FloatGrid view(const_cast<openvdb::FloatGrid&>(*grids.nest()[layer]), openvdb::ShallowCopy());
    view.setTransform(grids.space.transform(voxelSize));
    openvdb::tools::volumeToMesh(view, points, triangles, quads, 0.0, 0.0);
    if (triangles.empty() && quads.empty())
        throw RunError("volume", "the interface crosses no voxel");

    SurfaceMesh mesh;
    mesh.positions.resize(points.size());
    mesh.normals.resize(points.size());
    const NestSampler sampler(grids);
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
        const Imath::V3d at = Imath::V3d(points[i].x(), points[i].y(), points[i].z()) * (1.0 / voxelSize);
        mesh.positions[i] = Imath::V3f(at * voxelSize);
        mesh.normals[i] = normalOf(slopeAt(sampler, layer, at));
    });
    mesh.triangles.reserve(triangles.size() + 2 * quads.size());
    // OpenVDB's are clockwise from outside.
    for (const openvdb::Vec3I& t : triangles)
        mesh.triangles.emplace_back(t[0], t[2], t[1]);
    for (const openvdb::Vec4I& q : quads) {
        mesh.triangles.emplace_back(q[0], q[2], q[1]);
        mesh.triangles.emplace_back(q[0], q[3], q[2]);
    }
    mesh.closed = isClosed(mesh.triangles);
    return mesh;
}

void settleOnInterface(const LayerVolume& volume, int layer, SurfaceMesh& mesh) {
    const NestSampler sampler(volume.grids());
    const double voxelSize = volume.scale().voxelSize;
    tbb::parallel_for(std::size_t(0), mesh.positions.size(), [&](std::size_t i) {
        const Imath::V3d start = Imath::V3d(mesh.positions[i]) / voxelSize, along(mesh.normals[i]);
        if (const auto way = wayOut(sampler, layer, start, along))
            mesh.positions[i] = Imath::V3f((start + along * *way) * voxelSize);
    });
}

std::vector<Imath::V3f> interfaceSlopes(const LayerVolume& volume, int layer, const std::vector<Imath::V3f>& points) {
    const NestSampler sampler(volume.grids());
    return slopesOf(sampler, layer, volume.scale().voxelSize, points);
}

std::vector<Imath::V3f> baseSlopes(const LayerVolume& volume, const std::vector<Imath::V3f>& points) {
    const NestSampler sampler(volume.grids());
    return slopesOf(sampler, sampler.reference(), volume.scale().voxelSize, points);
}

std::vector<float> baseDistances(const LayerVolume& volume, const std::vector<Imath::V3f>& points) {
    const NestSampler sampler(volume.grids());
    const double voxelSize = volume.scale().voxelSize;
    std::vector<float> distances(points.size());
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
        const NestCell cell = sampler.locate(Imath::V3d(points[i]) / voxelSize);
        distances[i] = float(sampler.value(sampler.reference(), cell) / voxelSize);
    });
    return distances;
}

bool isInsideVolume(const LayerVolume& volume, const Imath::V3f& point) {
    const NestSampler sampler(volume.grids());
    const NestCell cell = sampler.locate(Imath::V3d(point) / volume.scale().voxelSize);
    return sampler.value(volume.layerCount(), cell) < 0.0;
}

} // namespace patina
