#pragma once
// Volumes straight from closed forms, turned so that no face lies along the lattice.

#include "volume/nest_grids.h"
#include "volume/vdb_file.h"

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

namespace patina::test {

using SignedDistance = std::function<double(const Imath::V3d&)>;

/// The turn that shapes are given: object = turn * lattice.
inline const Imath::M33d& turn() {
    static const Imath::M33d matrix = [] {
        const Imath::V3d a = Imath::V3d(1.0, 0.31, -0.17).normalized();
        const Imath::V3d b = (Imath::V3d(0.2, 1.0, 0.37) - a * a.dot(Imath::V3d(0.2, 1.0, 0.37))).normalized();
        const Imath::V3d c = a.cross(b);
        return Imath::M33d(a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z);
    }();
    return matrix;
}

inline Imath::V3d toObject(const Imath::V3d& lattice) {
    const Imath::M33d& m = turn();
    return {m[0][0] * lattice.x + m[0][1] * lattice.y + m[0][2] * lattice.z,
            m[1][0] * lattice.x + m[1][1] * lattice.y + m[1][2] * lattice.z,
            m[2][0] * lattice.x + m[2][1] * lattice.y + m[2][2] * lattice.z};
}

inline Imath::V3d toLattice(const Imath::V3d& object) {
    const Imath::M33d& m = turn();
    return {m[0][0] * object.x + m[1][0] * object.y + m[2][0] * object.z,
            m[0][1] * object.x + m[1][1] * object.y + m[2][1] * object.z,
            m[0][2] * object.x + m[1][2] * object.y + m[2][2] * object.z};
}

/// A volume of bare metal where `distance` (negative in metal, exact next to its zero set; of object coordinates in
/// voxels, within -extent…extent of the lattice) is negative. The voxel is one scene unit and one micrometre.
inline std::unique_ptr<LayerVolume> volumeOf(const SignedDistance& distance, int extent, double band = 6.0) {
    initializeVolumes();
    auto grids = std::make_unique<NestGrids>();
    grids->base = openvdb::FloatGrid::create(static_cast<float>(band));
    grids->base->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
    auto accessor = grids->base->getAccessor();
    for (int i = -extent; i <= extent; ++i)
        for (int j = -extent; j <= extent; ++j)
            for (int k = -extent; k <= extent; ++k) {
                const double d = distance(toObject(Imath::V3d(i, j, k)));
                if (std::abs(d) < band)
                    accessor.setValue({i, j, k}, static_cast<float>(d));
                else if (d < 0.0)
                    accessor.setValueOff({i, j, k}, static_cast<float>(-band));
            }
    grids->interiorBand = grids->exteriorBand = band - 1.0;
    auto ids = std::make_shared<openvdb::Int32Tree>(grids->base->tree(), 0, openvdb::TopologyCopy());
    grids->material = openvdb::Int32Grid::create(ids);
    VolumeScale scale;
    scale.voxelSize = 1.0;
    scale.metresPerUnit = 1e-6;
    return std::make_unique<LayerVolume>(scale, "copper", std::move(grids));
}

/// The point of such a surface next to x, by steps along the gradient: the closest one where the distance is exact.
inline Imath::V3d closestPoint(const SignedDistance& distance, const Imath::V3d& x) {
    constexpr double h = 1e-5;
    Imath::V3d p = x;
    for (int step = 0; step < 30 && std::abs(distance(p)) > 1e-9; ++step) {
        Imath::V3d gradient;
        for (int axis = 0; axis < 3; ++axis) {
            Imath::V3d along(0.0);
            along[axis] = h;
            gradient[axis] = (distance(p + along) - distance(p - along)) / (2.0 * h);
        }
        if (gradient.length2() > 1e-9)
            p -= gradient * (distance(p) / gradient.length2());
    }
    return p;
}

/// A half-space z < 0 with a slot of width w along y, d deep.
inline SignedDistance slot(double w, double d) {
    return [w, d](const Imath::V3d& p) { return std::max(p.z, -std::max(std::abs(p.x) - 0.5 * w, -d - p.z)); };
}

/// The largest sphere that touches that slot's floor or walls at p; -1 where its rim or an end is too near to say.
inline double slotRadius(double w, double d, const Imath::V3d& p) {
    if (std::abs(p.y) > 10.0 || std::abs(p.x) > 12.0 || p.z > -1.5)
        return -1.0;
    const double x0 = 0.5 * w - std::abs(p.x), z = p.z + d;
    if (z < x0) // floor
        return x0 <= d ? x0 : (x0 * x0 + d * d) / (2.0 * d);
    return std::min(z, 0.5 * w);
}

/// A V-groove along y with its apex at the origin; `half` is the angle between its wall and the vertical, radians.
inline SignedDistance groove(double half) {
    return [half](const Imath::V3d& p) { return p.z * std::sin(half) - std::abs(p.x) * std::cos(half); };
}

/// A block with a cavity of radius 14 around the origin and a neck of radius 5 to its top.
inline SignedDistance bottle() {
    return [](const Imath::V3d& p) {
        const double block = std::max({std::abs(p.x) - 22.0, std::abs(p.y) - 22.0, p.z - 24.0, -p.z - 22.0});
        const double neck = std::max(std::hypot(p.x, p.y) - 5.0, -p.z);
        return std::max(block, -std::min(p.length() - 14.0, neck));
    };
}

} // namespace patina::test
