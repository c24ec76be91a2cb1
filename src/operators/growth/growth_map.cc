#include "operators/growth/growth_map.h"

#include "base/errors.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace patina {

namespace {

/// What a lookup needs of a cell: 36 bytes.
struct Entry {
    Imath::V3f centre; // in cells
    Imath::V3f normal;
    float value;
    float area;
    std::uint32_t axis;
};

} // namespace

/// Cells by cubes of `side` cells, found through an open-addressing table.
struct GrowthMap::Index {
    double cell = 1.0;
    double radius = 1.0; ///< half width of the tents, cells
    float shift = 0.f;   ///< cells
    double side = 4.0;
    std::vector<Entry> entries;
    struct Cube {
        Imath::V3i place;
        std::uint32_t first = 0, last = 0; ///< empty where equal
    };
    std::vector<Cube> table;
    std::size_t mask = 0;

    static std::size_t hash(const Imath::V3i& v) {
        std::uint64_t h = std::uint64_t(std::uint32_t(v.x)) * 0x9e3779b97f4a7c15u;
        h = (h ^ std::uint32_t(v.y)) * 0xbf58476d1ce4e5b9u;
        h = (h ^ (h >> 29) ^ std::uint32_t(v.z)) * 0x94d049bb133111ebu;
        return h ^ (h >> 32);
    }
    Imath::V3i cubeOf(const Imath::V3d& p) const {
        return {int(std::floor(p.x / side)), int(std::floor(p.y / side)), int(std::floor(p.z / side))};
    }
    const Cube* find(const Imath::V3i& place) const {
        std::size_t slot = hash(place) & mask;
        while (table[slot].first != table[slot].last) {
            if (table[slot].place == place)
                return &table[slot];
            slot = (slot + 1) & mask;
        }
        return nullptr;
    }
    template <class Visit>
    void visitAround(const Imath::V3d& p, double reach, Visit&& visit) const {
        const Imath::V3i low = cubeOf(p - Imath::V3d(reach)), high = cubeOf(p + Imath::V3d(reach));
        for (int x = low.x; x <= high.x; ++x)
            for (int y = low.y; y <= high.y; ++y)
                for (int z = low.z; z <= high.z; ++z)
                    if (const Cube* cube = find({x, y, z}))
                        for (std::uint32_t i = cube->first; i < cube->last; ++i)
                            visit(entries[i]);
    }
};

double readingWidth(double grain, double pitch) {
    const double x = grain > 0.0 ? pitch / grain : 0.0;
    return x <= 0.5 ? grain : x <= 1.0 ? grain * (1.25 - 0.5 * x) : 0.75 * pitch;
}

double readingShift(double cell, double grain, double pitch) {
    return 0.25 * cell * std::clamp(2.0 * pitch / grain - 1.0, 0.0, 1.0);
}

GrowthMap::GrowthMap(const GrowthLattice& lattice, const std::vector<float>& values, double filterWidth,
                     double shift) {
    if (values.size() != lattice.size())
        throw RunError("growth map", "a growth map needs one value per cell of its lattice");
    auto index = std::make_unique<Index>();
    index->cell = lattice.cell;
    index->radius = filterWidth > 0.0 ? std::max(0.75, filterWidth / lattice.cell) : 1.0;
    index->shift = static_cast<float>(shift / lattice.cell);
    index->side = std::max(4.0, index->radius);

    std::vector<std::pair<Imath::V3i, std::uint32_t>> order(lattice.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = {index->cubeOf(Imath::V3d(lattice.centres[i]) / lattice.cell), static_cast<std::uint32_t>(i)};
    tbb::parallel_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
        if (a.first.x != b.first.x)
            return a.first.x < b.first.x;
        if (a.first.y != b.first.y)
            return a.first.y < b.first.y;
        return a.first.z != b.first.z ? a.first.z < b.first.z : a.second < b.second;
    });
    std::size_t cubes = 0;
    for (std::size_t i = 0; i < order.size(); ++i)
        cubes += i == 0 || !(order[i].first == order[i - 1].first);
    std::size_t size = 16;
    while (size < 2 * cubes)
        size *= 2;
    index->mask = size - 1;
    index->table.resize(size);
    index->entries.reserve(order.size());
    for (std::size_t i = 0; i < order.size();) {
        Index::Cube cube;
        cube.place = order[i].first;
        cube.first = static_cast<std::uint32_t>(i);
        for (; i < order.size() && order[i].first == cube.place; ++i) {
            const std::uint32_t c = order[i].second;
            index->entries.push_back({Imath::V3f(Imath::V3d(lattice.centres[c]) / lattice.cell), lattice.normals[c],
                                      values[c], lattice.areas[c], lattice.axes[c]});
        }
        cube.last = static_cast<std::uint32_t>(i);
        std::size_t slot = Index::hash(cube.place) & index->mask;
        while (index->table[slot].first != index->table[slot].last)
            slot = (slot + 1) & index->mask;
        index->table[slot] = cube;
    }
    index_ = std::move(index);
}

GrowthMap::~GrowthMap() = default;

double GrowthMap::value(const MapPoint& point) const {
    const Index& index = *index_;
    const Imath::V3d position = point.position / index.cell;
    if (!(position.length2() < 1e18)) // not a number, or beyond what cubes can count
        return 0.0;
    const Imath::V3f origin(position), normal(point.normal), shift(index.shift);
    const float inverse = static_cast<float>(1.0 / index.radius);
    double weights = 0.0, sum = 0.0;
    // Across one tangential tent a surface within 55 degrees of its column climbs at most about 1.4 of it.
    index.visitAround(position, 1.5 * index.radius + std::abs(index.shift), [&](const Entry& entry) {
        const Imath::V3f d = origin - entry.centre;
        const Imath::V3f at = d + shift;
        const float tents[3] = {1.f - std::abs(at.x) * inverse, 1.f - std::abs(at.y) * inverse,
                                1.f - std::abs(at.z) * inverse};
        const float tentA = tents[entry.axis == 0], tentB = tents[2 - (entry.axis == 2)];
        if (tentA <= 0.f || tentB <= 0.f)
            return;
        const float facing = entry.normal ^ normal;
        const float off = 1.f - std::abs(d ^ entry.normal) * inverse * 0.5f;
        if (facing <= 0.f || off <= 0.f)
            return;
        const double weight = tentA * tentB * std::min(1.f, 2.f * facing) * off * entry.area;
        weights += weight;
        sum += weight * entry.value;
    });
    if (weights > 1e-6)
        return sum / weights;

    // At sharp edges and small gaps: the nearest cell, one that faces the same way if there is any.
    double nearest = 16.0 * (index.radius * index.radius), value = 0.0;
    index.visitAround(position, 4.0 * index.radius, [&](const Entry& entry) {
        const double away = (position - Imath::V3d(entry.centre)).length2() *
                            ((Imath::V3d(entry.normal) ^ point.normal) > 0.0 ? 1.0 : 4.0);
        if (away < nearest) {
            nearest = away;
            value = entry.value;
        }
    });
    return value;
}

} // namespace patina
