#include "volume/nest_sampler.h"

#include <cmath>

namespace patina {

NestSampler::NestSampler(const NestGrids& grids) {
    for (const openvdb::FloatGrid* grid : grids.nest()) {
        std::vector<const float*> buffers;
        for (const FloatLeaf* leaf : leavesOf(grid->tree()))
            buffers.push_back(leaf->buffer().data());
        buffers_.push_back(std::move(buffers));
        background_.push_back(grid->background());
    }

    const auto leaves = leavesOf(grids.base->tree());
    openvdb::CoordBBox box;
    for (const FloatLeaf* leaf : leaves)
        box.expand(openvdb::Coord(leaf->origin() >> 3));
    if (leaves.empty())
        box = openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(0));
    low_ = box.min();
    size_ = box.dim();
    leafIndex_.assign(std::size_t(size_.x()) * size_.y() * size_.z(), -1);

    // What lies between leaves is a tile: far inside or far outside.
    openvdb::FloatGrid::ConstAccessor accessor = grids.base->getConstAccessor();
    std::size_t at = 0;
    for (int i = 0; i < size_.x(); ++i)
        for (int j = 0; j < size_.y(); ++j)
            for (int k = 0; k < size_.z(); ++k, ++at)
                if (accessor.getValue((low_ + openvdb::Coord(i, j, k)) << 3) < 0.f)
                    leafIndex_[at] = -2;
    for (std::size_t n = 0; n < leaves.size(); ++n) {
        const openvdb::Coord c = (leaves[n]->origin() >> 3) - low_;
        leafIndex_[(std::size_t(c.x()) * size_.y() + c.y()) * size_.z() + c.z()] = static_cast<std::int32_t>(n);
    }
}

std::int32_t NestSampler::leafAt(int i, int j, int k) const {
    i -= low_.x();
    j -= low_.y();
    k -= low_.z();
    if (i < 0 || j < 0 || k < 0 || i >= size_.x() || j >= size_.y() || k >= size_.z())
        return -1;
    return leafIndex_[(std::size_t(i) * size_.y() + j) * size_.z() + k];
}

NestCell NestSampler::locate(const Imath::V3d& point) const {
    NestCell cell;
    const double fx = std::floor(point.x), fy = std::floor(point.y), fz = std::floor(point.z);
    const int i = static_cast<int>(fx), j = static_cast<int>(fy), k = static_cast<int>(fz);
    cell.x = point.x - fx;
    cell.y = point.y - fy;
    cell.z = point.z - fz;
    const bool sameLeaf = (i & 7) != 7 && (j & 7) != 7 && (k & 7) != 7;
    if (sameLeaf) {
        const std::int32_t leaf = leafAt(i >> 3, j >> 3, k >> 3);
        const int first = ((i & 7) << 6) | ((j & 7) << 3) | (k & 7);
        for (int c = 0; c < 8; ++c) {
            cell.leaf[c] = leaf;
            cell.voxel[c] = static_cast<std::int16_t>(first + ((c & 4) ? 64 : 0) + ((c & 2) ? 8 : 0) + (c & 1));
        }
        return cell;
    }
    for (int c = 0; c < 8; ++c) {
        const int ci = i + ((c >> 2) & 1), cj = j + ((c >> 1) & 1), ck = k + (c & 1);
        cell.leaf[c] = leafAt(ci >> 3, cj >> 3, ck >> 3);
        cell.voxel[c] = static_cast<std::int16_t>(((ci & 7) << 6) | ((cj & 7) << 3) | (ck & 7));
    }
    return cell;
}

void NestSampler::corners(int k, const NestCell& cell, double* c) const {
    const auto& buffers = buffers_[k];
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

float NestSampler::voxel(int k, const openvdb::Coord& coord) const {
    const std::int32_t leaf = leafAt(coord.x() >> 3, coord.y() >> 3, coord.z() >> 3);
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
