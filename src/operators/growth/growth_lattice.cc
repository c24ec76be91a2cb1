#include "operators/growth/growth_lattice.h"

#include "base/errors.h"

#include <cmath>
#include <limits>

namespace patina {

GrowthLattice flatLattice(int width, int height, bool periodic, double cell) {
    if (width < 1 || height < 1 || double(width) * height > std::numeric_limits<int>::max() || !(cell > 0.0))
        throw RunError("growth lattice", "a flat lattice needs positive sides and a positive cell");
    const std::size_t count = std::size_t(width) * height;
    GrowthLattice lattice;
    lattice.cell = cell;
    lattice.keys.reserve(count);
    lattice.neighbours.reserve(count);
    lattice.centres.reserve(count);
    lattice.areas.assign(count, 1.f);
    lattice.normals.assign(count, Imath::V3f(0.f, 0.f, 1.f));
    lattice.axes.assign(count, 2);
    if (periodic)
        lattice.period = {width * cell, height > 1 ? height * cell : 0.0, 0.0};
    const auto wrap = [periodic](int i, int n) {
        if (i >= 0 && i < n)
            return i;
        return periodic && n > 2 ? (i + n) % n : -1;
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            lattice.keys.emplace_back(x, y, 0);
            lattice.centres.emplace_back(float((x + 0.5) * cell), float((y + 0.5) * cell), 0.f);
            const auto at = [&](int i, int j) {
                i = wrap(i, width);
                j = wrap(j, height);
                return i < 0 || j < 0 ? GrowthLattice::noCell : j * width + i;
            };
            lattice.neighbours.push_back({at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)});
        }
    return lattice;
}

Imath::V3d linkVector(const GrowthLattice& lattice, int from, int to) {
    Imath::V3d link = Imath::V3d(lattice.centres[to]) - Imath::V3d(lattice.centres[from]);
    for (int axis = 0; axis < 3; ++axis)
        if (lattice.period[axis] > 0.0)
            link[axis] -= lattice.period[axis] * std::round(link[axis] / lattice.period[axis]);
    return link;
}

double linkGauge(const GrowthLattice& lattice, int cell) {
    const Imath::V3f& n = lattice.normals[cell];
    const int axis = lattice.axes[cell];
    const double depth = n[axis], a = n[(axis + 1) % 3], b = n[(axis + 2) % 3];
    if (depth == 0.0)
        return 1.0;
    // Stepping one cell along a tangential axis climbs n_a / n_d cells; the area of the parallelogram is 1 / |n_d|.
    const double stepA = std::sqrt(1.0 + a * a / (depth * depth)), stepB = std::sqrt(1.0 + b * b / (depth * depth));
    return std::sqrt(1.0 / (std::abs(depth) * stepA * stepB));
}

} // namespace patina
