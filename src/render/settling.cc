#include "render/settling.h"

#include "volume/interface_mesh.h"

#include <tbb/parallel_for.h>

#include <atomic>
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
        shorten(std::vector<char>(way_.size(), 1));
    }

    V3f position(std::size_t v) const { return flat_.positions[v] + flat_.normals[v] * way_[v]; }

    // Halves the ways that turn triangles over. False where there are none.
    bool giveIn() {
        Marks turned(way_.size());
        tbb::parallel_for(std::size_t(0), flat_.triangles.size(), [&](std::size_t t) {
            const Imath::V3i& corners = flat_.triangles[t];
            const auto a = std::size_t(corners.x), b = std::size_t(corners.y), c = std::size_t(corners.z);
            const V3f is = areaVector(position(a), position(b), position(c));
            const V3f was = areaVector(flat_.positions[a], flat_.positions[b], flat_.positions[c]);
            if ((is ^ was) < 0.1f * is.length() * was.length())
                for (const std::size_t v : {a, b, c})
                    turned[v].store(1, std::memory_order_relaxed);
        });
        std::vector<char> halved(way_.size());
        bool any = false;
        for (std::size_t v = 0; v < way_.size(); ++v)
            if (turned[v] && way_[v] != 0.f) {
                way_[v] *= 0.5f;
                halved[v] = 1;
                any = true;
            }
        if (any)
            shorten(std::move(halved));
        return any;
    }

  private:
    using Marks = std::vector<std::atomic<char>>;

    template <typename Visit>
    void alongEdges(std::size_t t, const Visit& visit) const {
        for (int i = 0; i < 3; ++i) {
            const auto a = std::size_t(flat_.triangles[t][i]), b = std::size_t(flat_.triangles[t][(i + 1) % 3]);
            visit(a, b, (flat_.positions[a] - flat_.positions[b]).length());
        }
    }

    // Neighbours that went opposite ways further than they lie apart: neither is to be believed.
    void endOpposite() {
        Marks ended(way_.size());
        tbb::parallel_for(std::size_t(0), flat_.triangles.size(), [&](std::size_t t) {
            alongEdges(t, [&](std::size_t a, std::size_t b, float length) {
                if (way_[a] * way_[b] < 0.f && std::abs(way_[a] - way_[b]) > length) {
                    ended[a].store(1, std::memory_order_relaxed);
                    ended[b].store(1, std::memory_order_relaxed);
                }
            });
        });
        for (std::size_t v = 0; v < way_.size(); ++v)
            if (ended[v])
                way_[v] = 0.f;
    }

    // No way is longer than a neighbour's by more than lies between them. From round to round only the triangles of
    // vertices that have changed are looked at, at first those of `changed`; all read the round before, so that their
    // order is nothing.
    void shorten(std::vector<char> changed) {
        std::vector<std::atomic<float>> least(way_.size());
        tbb::parallel_for(std::size_t(0), way_.size(), [&](std::size_t v) { least[v] = std::abs(way_[v]); });
        const auto lower = [&](std::size_t v, float length) {
            float before = least[v].load(std::memory_order_relaxed);
            while (length < before && !least[v].compare_exchange_weak(before, length, std::memory_order_relaxed))
                ;
        };
        std::atomic<bool> any{true};
        constexpr int mostRounds = 256; // a way is a voxel at most: so many edges of a pixel that is not wider
        for (int round = 0; round < mostRounds && any; ++round) {
            any = false;
            tbb::parallel_for(std::size_t(0), flat_.triangles.size(), [&](std::size_t t) {
                const Imath::V3i& corners = flat_.triangles[t];
                if (!changed[std::size_t(corners.x)] && !changed[std::size_t(corners.y)] &&
                    !changed[std::size_t(corners.z)])
                    return;
                alongEdges(t, [&](std::size_t a, std::size_t b, float length) {
                    if (std::abs(way_[a]) < std::abs(way_[b]))
                        std::swap(a, b);
                    const float most = std::abs(way_[b]) + length;
                    if (std::abs(way_[a]) > most * 1.001f)
                        lower(a, most);
                });
            });
            tbb::parallel_for(std::size_t(0), way_.size(), [&](std::size_t v) {
                changed[v] = least[v] < std::abs(way_[v]);
                if (changed[v]) {
                    way_[v] = std::copysign(least[v].load(std::memory_order_relaxed), way_[v]);
                    any.store(true, std::memory_order_relaxed);
                }
            });
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
