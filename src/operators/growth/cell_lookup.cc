#include "operators/growth/cell_lookup.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patina {

namespace {

/// A lattice line: its facet and its place in the plane across it (27 bits each, see surfaceLattice()).
std::uint64_t lineKey(int facet, std::int64_t a, std::int64_t b) {
    constexpr std::uint64_t mask = (1u << 28) - 1;
    return (std::uint64_t(facet) << 56 | (std::uint64_t(a) & mask) << 28 | (std::uint64_t(b) & mask)) + 1;
}

std::size_t scatter(std::uint64_t key) {
    key ^= key >> 29;
    key *= 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(key >> 20);
}

} // namespace

CellLookup::CellLookup(const GrowthLattice& lattice) : lattice_(lattice) {
    std::vector<std::pair<std::uint64_t, std::int32_t>> lines(lattice.size());
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        const int axis = lattice.axes[i];
        const Imath::V3f& c = lattice.centres[i];
        const auto index = [&](int along) { return static_cast<std::int64_t>(std::floor(c[along] / lattice.cell)); };
        const int facet = axis * 2 + (lattice.normals[i][axis] < 0.f);
        lines[i] = {lineKey(facet, index((axis + 1) % 3), index((axis + 2) % 3)), static_cast<std::int32_t>(i)};
    }
    std::sort(lines.begin(), lines.end());
    std::size_t size = 16;
    while (size < 2 * lines.size())
        size *= 2;
    slots_.resize(size);
    order_.resize(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
        order_[i] = lines[i].second;
        std::size_t at = scatter(lines[i].first) & (size - 1);
        while (slots_[at].cell >= 0 && slots_[at].key != lines[i].first)
            at = (at + 1) & (size - 1);
        if (slots_[at].cell < 0)
            slots_[at] = {lines[i].first, static_cast<std::int32_t>(i), 0};
        ++slots_[at].count;
    }
}

const CellLookup::Slot* CellLookup::find(int facet, std::int64_t a, std::int64_t b) const {
    const std::uint64_t key = lineKey(facet, a, b);
    for (std::size_t at = scatter(key) & (slots_.size() - 1); slots_[at].cell >= 0; at = (at + 1) & (slots_.size() - 1))
        if (slots_[at].key == key)
            return &slots_[at];
    return nullptr;
}

void CellLookup::nearest(int facet, std::int64_t a, std::int64_t b, const Imath::V3d& position, double& best,
                         int& cell) const {
    const Slot* slot = find(facet, a, b);
    if (!slot)
        return;
    for (std::int32_t i = 0; i < slot->count; ++i) {
        const int candidate = order_[std::size_t(slot->cell + i)];
        const double squared = (Imath::V3d(lattice_.centres[candidate]) - position).length2();
        if (squared < best) {
            best = squared;
            cell = candidate;
        }
    }
}

int CellLookup::cellAt(const Imath::V3d& position, const Imath::V3d& normal) const {
    int axes[3] = {0, 1, 2};
    std::sort(axes, axes + 3, [&](int a, int b) {
        const double x = std::abs(normal[a]), y = std::abs(normal[b]);
        return x != y ? x > y : a < b;
    });
    std::int64_t place[3];
    for (int i = 0; i < 3; ++i)
        place[i] = static_cast<std::int64_t>(std::floor(position[i] / lattice_.cell));
    const auto facetOf = [&](int axis) { return axis * 2 + (normal[axis] < 0.0); };
    const double size = lattice_.cell;

    int cell = GrowthLattice::noCell;
    double best = 4.0 * size * size;
    nearest(facetOf(axes[0]), place[(axes[0] + 1) % 3], place[(axes[0] + 2) % 3], position, best, cell);
    if (cell >= 0)
        return cell;
    for (const int reach : {1, 3}) {
        best = 12.0 * reach * reach * size * size;
        for (int i = 0; i < 3; ++i) {
            const int axis = axes[i];
            for (std::int64_t a = -reach; a <= reach; ++a)
                for (std::int64_t b = -reach; b <= reach; ++b)
                    nearest(facetOf(axis), place[(axis + 1) % 3] + a, place[(axis + 2) % 3] + b, position, best, cell);
        }
        if (cell >= 0)
            return cell;
    }
    return cell;
}

} // namespace patina
