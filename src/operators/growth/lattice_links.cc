#include "operators/growth/lattice_links.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr int none = GrowthLattice::noCell;

/// The first cell of each voxel, in an open-addressing table.
class VoxelTable {
  public:
    explicit VoxelTable(const std::vector<CellPlace>& places) : places_(places) {
        std::size_t size = 16;
        while (size < places.size() * 2)
            size *= 2;
        mask_ = size - 1;
        slots_.assign(size, none);
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (i > 0 && places[i].voxel == places[i - 1].voxel)
                continue;
            std::size_t slot = hash(places[i].voxel) & mask_;
            while (slots_[slot] != none)
                slot = (slot + 1) & mask_;
            slots_[slot] = static_cast<int>(i);
        }
    }
    template <class Visit>
    void visit(const Imath::V3i& voxel, Visit&& visit) const {
        std::size_t slot = hash(voxel) & mask_;
        while (slots_[slot] != none && !(places_[slots_[slot]].voxel == voxel))
            slot = (slot + 1) & mask_;
        if (slots_[slot] == none)
            return;
        for (std::size_t i = slots_[slot]; i < places_.size() && places_[i].voxel == voxel; ++i)
            visit(static_cast<int>(i));
    }

  private:
    static std::size_t hash(const Imath::V3i& v) {
        std::uint64_t h = std::uint64_t(std::uint32_t(v.x)) * 0x9e3779b97f4a7c15u;
        h = (h ^ std::uint32_t(v.y)) * 0xbf58476d1ce4e5b9u;
        h = (h ^ (h >> 29) ^ std::uint32_t(v.z)) * 0x94d049bb133111ebu;
        return h ^ (h >> 32);
    }
    const std::vector<CellPlace>& places_;
    std::vector<int> slots_;
    std::size_t mask_ = 0;
};

class Linker {
  public:
    Linker(GrowthLattice& lattice, const std::vector<CellPlace>& places)
        : lattice_(lattice), places_(places), table_(places), wishes_(lattice.size(), {none, none, none, none}) {
        lattice.neighbours.assign(lattice.size(), {none, none, none, none});
    }

    void link() {
        forAll([this](int cell) {
            for (int slot = 0; slot < 4; ++slot)
                wishes_[cell][slot] = nextColumn(cell, slot);
        });
        joinSameFacet();
        // Seams: first along the surface as it is foreseen from a cell, then to whatever is near.
        for (int round = 0; round < 6; ++round) {
            const bool foreseen = round < 3;
            forAll([this, foreseen](int cell) {
                wishes_[cell] = {none, none, none, none};
                for (int slot = 0; slot < 4; ++slot)
                    if (lattice_.neighbours[cell][slot] == none)
                        wishes_[cell][slot] = nearestFree(cell, slot, foreseen);
            });
            joinMutual();
        }
    }

  private:
    template <class Work>
    void forAll(Work&& work) {
        tbb::parallel_for(tbb::blocked_range<int>(0, static_cast<int>(lattice_.size()), 1024), [&](const auto& range) {
            for (int cell = range.begin(); cell < range.end(); ++cell)
                work(cell);
        });
    }
    int tangent(int cell, int slot) const { return (lattice_.axes[cell] + 1 + slot / 2) % 3; }
    static int direction(int slot) { return slot % 2 ? 1 : -1; }
    Imath::V3d centre(int cell) const { return Imath::V3d(lattice_.centres[cell]) / lattice_.cell; }
    Imath::V3d normal(int cell) const { return Imath::V3d(lattice_.normals[cell]); }

    /// One column on along the slot's direction, in the cell's tangent plane; in cells.
    Imath::V3d foreseen(int cell, int slot) const {
        const int axis = lattice_.axes[cell], along = tangent(cell, slot);
        const Imath::V3d n = normal(cell);
        Imath::V3d step(0.0);
        step[along] = direction(slot);
        // The shading normal may lean more than the surface does; a digital surface climbs at most about one a step.
        step[axis] = std::clamp(-direction(slot) * n[along] / n[axis], -1.2, 1.2);
        return step;
    }

    int nextColumn(int cell, int slot) const {
        const int axis = lattice_.axes[cell], along = tangent(cell, slot);
        const Imath::V3d target = centre(cell) + foreseen(cell, slot);
        Imath::V3i voxel = places_[cell].voxel;
        voxel[along] += direction(slot);
        const int depth = static_cast<int>(std::lround(target[axis]));
        int best = none;
        double bestMiss = 1.2;
        for (int k = depth - 1; k <= depth + 1; ++k) {
            voxel[axis] = k;
            table_.visit(voxel, [&](int other) {
                if (places_[other].facet != places_[cell].facet || (normal(other) ^ normal(cell)) < 0.1)
                    return;
                const double miss = std::abs(centre(other)[axis] - target[axis]);
                if (miss < bestMiss) {
                    bestMiss = miss;
                    best = other;
                }
            });
        }
        return best;
    }

    bool linked(int cell, int other) const {
        const auto& n = lattice_.neighbours[cell];
        return std::find(n.begin(), n.end(), other) != n.end();
    }
    bool hasFreeSide(int cell) const { return linked(cell, none); }

    int nearestFree(int cell, int slot, bool bySight) const {
        const Imath::V3d from = centre(cell), step = foreseen(cell, slot);
        const Imath::V3d target = from + step;
        const Imath::V3i middle(int(std::floor(target.x)), int(std::floor(target.y)), int(std::floor(target.z)));
        int best = none;
        double bestScore = bySight ? 1.6 : 2.5;
        for (int x = -2; x <= 2; ++x)
            for (int y = -2; y <= 2; ++y)
                for (int z = -2; z <= 2; ++z)
                    table_.visit(middle + Imath::V3i(x, y, z), [&](int other) {
                        if (other == cell || !hasFreeSide(other) || linked(cell, other) || taken(cell, slot, other))
                            return;
                        const Imath::V3d way = centre(other) - from;
                        // Forwards, near, and not through to the back of a thin sheet.
                        if ((way ^ step) <= 0.0 || way.length() > 3.0 || (normal(other) ^ normal(cell)) < -0.3)
                            return;
                        const double score = bySight ? (centre(other) - target).length() : way.length();
                        if (score < bestScore) {
                            bestScore = score;
                            best = other;
                        }
                    });
        return best;
    }
    bool taken(int cell, int slot, int other) const {
        for (int s = 0; s < slot; ++s)
            if (wishes_[cell][s] == other)
                return true;
        return false;
    }

    void joinSameFacet() {
        forAll([this](int cell) {
            for (int slot = 0; slot < 4; ++slot) {
                const int other = wishes_[cell][slot];
                if (other != none && wishes_[other][slot ^ 1] == cell)
                    lattice_.neighbours[cell][slot] = other;
            }
        });
    }
    void joinMutual() {
        forAll([this](int cell) {
            for (int slot = 0; slot < 4; ++slot) {
                const int other = wishes_[cell][slot];
                if (other == none)
                    continue;
                const auto& theirs = wishes_[other];
                if (std::find(theirs.begin(), theirs.end(), cell) != theirs.end())
                    lattice_.neighbours[cell][slot] = other;
            }
        });
    }

    GrowthLattice& lattice_;
    const std::vector<CellPlace>& places_;
    VoxelTable table_;
    std::vector<std::array<int, 4>> wishes_;
};

} // namespace

void linkCells(GrowthLattice& lattice, const std::vector<CellPlace>& places) {
    Linker(lattice, places).link();
}

} // namespace patina
