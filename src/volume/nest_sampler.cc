#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace patina {

namespace {

// std::floor is a call where the processor's own is not taken for granted.
double floorOf(double x) {
    const double whole = static_cast<int>(x);
    return whole > x ? whole - 1.0 : whole;
}

} // namespace

NestSampler::NestSampler(const NestGrids& grids)
    : space_(grids.space), sides_(grids.sides.empty() ? grids.sides
                                                      : openvdb::CoordBBox(grids.sides.min() - grids.space.origin(),
                                                                           grids.sides.max() - grids.space.origin())),
      lattice_(leavesOf(std::as_const(grids.base->tree()))) {
    auto nest = grids.nest();
    interfaces_ = static_cast<int>(nest.size());
    if (grids.metal) {
        reference_ = interfaces_;
        nest.push_back(grids.base.get());
    }
    for (const openvdb::FloatGrid* grid : nest) {
        std::vector<const float*> buffers;
        for (const FloatLeaf* leaf : leavesOf(grid->tree()))
            buffers.push_back(leaf->buffer().data());
        buffers_.push_back(std::move(buffers));
        background_.push_back(grid->background());
    }

    // What lies between leaves is a tile: far inside or far outside.
    const openvdb::CoordBBox& box = lattice_.box();
    tbb::parallel_for(box.min().x(), box.max().x() + 1, [&](int i) {
        openvdb::FloatGrid::ConstAccessor accessor = grids.base->getConstAccessor();
        std::size_t slot = lattice_.slot({i, box.min().y(), box.min().z()});
        for (int j = box.min().y(); j <= box.max().y(); ++j)
            for (int k = box.min().z(); k <= box.max().z(); ++k, ++slot)
                if (lattice_.marked(slot) < 0 && accessor.getValue(openvdb::Coord(i, j, k) << 3) < 0.f)
                    lattice_.mark(slot, -2);
    });
}

NestCell NestSampler::locate(const Imath::V3d& point) const {
    NestCell cell;
    double fx = floorOf(point.x), fy = floorOf(point.y), fz = floorOf(point.z);
    if (!sides_.empty()) {
        const openvdb::Coord &low = sides_.min(), &high = sides_.max();
        fx = std::clamp(fx, double(low.x()), double(high.x() - 1));
        fy = std::clamp(fy, double(low.y()), double(high.y() - 1));
        fz = std::clamp(fz, double(low.z()), double(high.z() - 1));
    }
    const openvdb::Coord& origin = space_.origin();
    const int i = static_cast<int>(fx) + origin.x(), j = static_cast<int>(fy) + origin.y(),
              k = static_cast<int>(fz) + origin.z();
    cell.x = point.x - fx;
    cell.y = point.y - fy;
    cell.z = point.z - fz;
    if (!sides_.empty()) {
        cell.x = std::clamp(cell.x, -2.0, 3.0);
        cell.y = std::clamp(cell.y, -2.0, 3.0);
        cell.z = std::clamp(cell.z, -2.0, 3.0);
    }
    const bool sameLeaf = (i & 7) != 7 && (j & 7) != 7 && (k & 7) != 7;
    if (sameLeaf) {
        const std::int32_t leaf = lattice_.at(i >> 3, j >> 3, k >> 3);
        const int first = ((i & 7) << 6) | ((j & 7) << 3) | (k & 7);
        for (int c = 0; c < 8; ++c) {
            cell.leaf[c] = leaf;
            cell.voxel[c] = static_cast<std::int16_t>(first + ((c & 4) ? 64 : 0) + ((c & 2) ? 8 : 0) + (c & 1));
        }
        return cell;
    }
    for (int c = 0; c < 8; ++c) {
        const int ci = i + ((c >> 2) & 1), cj = j + ((c >> 1) & 1), ck = k + (c & 1);
        cell.leaf[c] = lattice_.at(ci >> 3, cj >> 3, ck >> 3);
        cell.voxel[c] = static_cast<std::int16_t>(((ci & 7) << 6) | ((cj & 7) << 3) | (ck & 7));
    }
    return cell;
}

const NestCell& NestSampler::follow(const Imath::V3d& point, NestPlace& place) const {
    const Imath::V3d lower(floorOf(point.x), floorOf(point.y), floorOf(point.z));
    const Imath::V3i whole(lower);
    // At a region's sides cells end.
    if (whole == place.lower && sides_.empty()) {
        place.cell.x = point.x - lower.x;
        place.cell.y = point.y - lower.y;
        place.cell.z = point.z - lower.z;
    } else {
        place.cell = locate(point);
        place.lower = whole;
    }
    return place.cell;
}

void NestSampler::corners(int k, const NestCell& cell, double* c) const {
    const auto& buffers = buffers_[k];
    const int first = cell.voxel[0];
    // Within one leaf the last corner lies one row further along each axis; elsewhere an index has wrapped.
    if (cell.voxel[7] - first == 64 + 8 + 1 && cell.leaf[0] >= 0) {
        const float* values = buffers[cell.leaf[0]] + first;
        for (int n = 0; n < 8; ++n)
            c[n] = values[((n & 4) ? 64 : 0) + ((n & 2) ? 8 : 0) + (n & 1)];
        return;
    }
    for (int n = 0; n < 8; ++n) {
        const std::int32_t leaf = cell.leaf[n];
        c[n] = leaf >= 0 ? buffers[leaf][cell.voxel[n]] : leaf == -1 ? background_[k] : -background_[k];
    }
}

double NestSampler::value(int k, const NestCell& cell) const {
    double c[8];
    corners(k, cell, c);
    const double x = cell.x, y = cell.y, z = cell.z;
    const double c00 = c[0] + z * (c[1] - c[0]), c01 = c[2] + z * (c[3] - c[2]);
    const double c10 = c[4] + z * (c[5] - c[4]), c11 = c[6] + z * (c[7] - c[6]);
    const double c0 = c00 + y * (c01 - c00), c1 = c10 + y * (c11 - c10);
    return c0 + x * (c1 - c0);
}

double NestSampler::valueAndGradient(int k, const NestCell& cell, Imath::V3d& gradient) const {
    double c[8];
    corners(k, cell, c);
    const double x = cell.x, y = cell.y, z = cell.z;
    const double c00 = c[0] + z * (c[1] - c[0]), c01 = c[2] + z * (c[3] - c[2]);
    const double c10 = c[4] + z * (c[5] - c[4]), c11 = c[6] + z * (c[7] - c[6]);
    const double c0 = c00 + y * (c01 - c00), c1 = c10 + y * (c11 - c10);
    const double dz0 = (c[1] - c[0]) + y * ((c[3] - c[2]) - (c[1] - c[0]));
    const double dz1 = (c[5] - c[4]) + y * ((c[7] - c[6]) - (c[5] - c[4]));
    gradient.x = c1 - c0;
    gradient.y = (c01 - c00) + x * ((c11 - c10) - (c01 - c00));
    gradient.z = dz0 + x * (dz1 - dz0);
    return c0 + x * (c1 - c0);
}

double NestSampler::slope(int k, const Imath::V3d& point) const {
    const Imath::V3i lower(int(floorOf(point.x)), int(floorOf(point.y)), int(floorOf(point.z)));
    Imath::V3d gradient(0.0);
    if (!sides_.empty() && !(sides_.isInside(openvdb::Coord(lower.x - 1, lower.y - 1, lower.z - 1)) &&
                             sides_.isInside(openvdb::Coord(lower.x + 2, lower.y + 2, lower.z + 2)))) {
        valueAndGradient(k, locate(point), gradient);
        return gradient.length();
    }
    // Four lattice points along each axis, which lie in one leaf or two.
    const openvdb::Coord first = space_.index(lower - Imath::V3i(1)), leaf = first >> 3;
    const Imath::V3i start(first.x() & 7, first.y() & 7, first.z() & 7);
    const float* values[8] = {};
    double outside[8] = {};
    for (int c = 0; c < 8; ++c) {
        const Imath::V3i step(c >> 2, c >> 1 & 1, c & 1);
        if ((step.x && start.x < 5) || (step.y && start.y < 5) || (step.z && start.z < 5))
            continue; // not reached
        const std::int32_t at = lattice_.at(leaf.x() + step.x, leaf.y() + step.y, leaf.z() + step.z);
        if (at >= 0)
            values[c] = buffers_[k][at];
        else
            outside[c] = at == -1 ? background_[k] : -background_[k];
    }
    const auto value = [&](int x, int y, int z) -> double {
        x += start.x, y += start.y, z += start.z;
        const int c = (x >> 3) << 2 | (y >> 3) << 1 | z >> 3;
        return values[c] ? values[c][(x & 7) << 6 | (y & 7) << 3 | (z & 7)] : outside[c];
    };
    const Imath::V3d in = point - Imath::V3d(lower);
    for (int c = 0; c < 8; ++c) {
        const int x = 1 + (c >> 2), y = 1 + (c >> 1 & 1), z = 1 + (c & 1);
        const double weight =
            0.5 * (x == 1 ? 1.0 - in.x : in.x) * (y == 1 ? 1.0 - in.y : in.y) * (z == 1 ? 1.0 - in.z : in.z);
        gradient +=
            weight * Imath::V3d(value(x + 1, y, z) - value(x - 1, y, z), value(x, y + 1, z) - value(x, y - 1, z),
                                value(x, y, z + 1) - value(x, y, z - 1));
    }
    return gradient.length();
}

float NestSampler::voxel(int k, const openvdb::Coord& coord) const {
    const std::int32_t leaf = lattice_.at(coord.x() >> 3, coord.y() >> 3, coord.z() >> 3);
    if (leaf < 0)
        return leaf == -1 ? background_[k] : -background_[k];
    return buffers_[k][leaf][((coord.x() & 7) << 6) | ((coord.y() & 7) << 3) | (coord.z() & 7)];
}

Imath::V3d NestSampler::centralGradient(int k, const openvdb::Coord& c) const {
    return {0.5 * (double(voxel(k, c.offsetBy(1, 0, 0))) - voxel(k, c.offsetBy(-1, 0, 0))),
            0.5 * (double(voxel(k, c.offsetBy(0, 1, 0))) - voxel(k, c.offsetBy(0, -1, 0))),
            0.5 * (double(voxel(k, c.offsetBy(0, 0, 1))) - voxel(k, c.offsetBy(0, 0, -1)))};
}

} // namespace patina
