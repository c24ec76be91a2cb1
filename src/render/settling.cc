#include "render/settling.h"

#include "volume/interface_mesh.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace patina {

using Imath::V3f;

namespace {

// Along the normal, twice the area long.
V3f areaVector(const V3f& a, const V3f& b, const V3f& c) {
    return (b - a).cross(c - a);
}

// How far each vertex moved along its normal, so that nothing is turned over: where surfaces face each other within a
// voxel, neighbours may have settled past each other, or one of them not at all.
class Ways {
  public:
    Ways(const SurfaceMesh& flat, const std::vector<V3f>& settled) : flat_(flat), way_(settled.size()) {
        for (std::size_t v = 0; v < way_.size(); ++v)
            way_[v] = (settled[v] - flat.positions[v]) ^ flat.normals[v];
        endOpposite();
        shorten();
    }

    V3f position(std::size_t v) const { return flat_.positions[v] + flat_.normals[v] * way_[v]; }

    // Halves the ways that turn triangles over. False where there are none.
    bool giveIn() {
        std::vector<char> turns(flat_.triangles.size()), shorter(way_.size());
        tbb::parallel_for(std::size_t(0), turns.size(), [&](std::size_t t) {
            const Imath::V3i& corners = flat_.triangles[t];
            const auto a = std::size_t(corners.x), b = std::size_t(corners.y), c = std::size_t(corners.z);
            const V3f is = areaVector(position(a), position(b), position(c));
            const V3f was = areaVector(flat_.positions[a], flat_.positions[b], flat_.positions[c]);
            turns[t] = (is ^ was) < 0.1f * is.length() * was.length();
        });
        bool any = false;
        for (std::size_t t = 0; t < turns.size(); ++t)
            for (int i = 0; turns[t] && i < 3; ++i) {
                const auto v = std::size_t(flat_.triangles[t][i]);
                any = any || way_[v] != 0.f;
                shorter[v] = 1;
            }
        for (std::size_t v = 0; v < way_.size(); ++v)
            if (shorter[v])
                way_[v] *= 0.5f;
        if (any)
            shorten();
        return any;
    }

  private:
    template <typename Visit>
    void alongEdges(std::size_t t, const Visit& visit) const {
        for (int i = 0; i < 3; ++i) {
            const auto a = std::size_t(flat_.triangles[t][i]), b = std::size_t(flat_.triangles[t][(i + 1) % 3]);
            visit(a, b, (flat_.positions[a] - flat_.positions[b]).length());
        }
    }

    // Neighbours that went opposite ways further than they lie apart: neither is to be believed.
    void endOpposite() {
        const std::vector<float> first = way_;
        for (std::size_t t = 0; t < flat_.triangles.size(); ++t)
            alongEdges(t, [&](std::size_t a, std::size_t b, float length) {
                if (first[a] * first[b] < 0.f && std::abs(first[a] - first[b]) > length)
                    way_[a] = way_[b] = 0.f;
            });
    }

    // No way is longer than a neighbour's by more than lies between them.
    void shorten() {
        bool changed = true;
        const auto compare = [&](std::size_t a, std::size_t b, float length) {
            if (std::abs(way_[a]) < std::abs(way_[b]))
                std::swap(a, b);
            const float most = std::abs(way_[b]) + length;
            if (std::abs(way_[a]) <= most * 1.001f)
                return;
            way_[a] = std::copysign(most, way_[a]);
            changed = true;
        };
        // There and back, as neighbours mostly follow each other in the list.
        const std::size_t count = flat_.triangles.size();
        for (int round = 0; round < 32 && changed; ++round) {
            changed = false;
            for (std::size_t i = 0; i < count; ++i)
                alongEdges(round % 2 == 0 ? i : count - 1 - i, compare);
        }
    }

    const SurfaceMesh& flat_;
    std::vector<float> way_;
};

} // namespace

void settle(const LayerVolume& volume, SurfaceMesh& cut) {
    std::vector<V3f> positions = cut.positions;
    settleOnInterface(volume, volume.layerCount(), cut);
    std::swap(positions, cut.positions);
    Ways ways(cut, positions);
    constexpr int halvings = 8; // then what is left of a voxel is no more seen
    for (int i = 0; i < halvings && ways.giveIn(); ++i)
        ;
    for (std::size_t v = 0; v < positions.size(); ++v)
        positions[v] = ways.position(v);
    cut.positions = std::move(positions);
}

} // namespace patina
