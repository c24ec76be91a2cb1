#include "render/dice.h"

#include "render/dice_rule.h"
#include "surface/weld.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace patina {

using Imath::V3f;
using Imath::V3i;

namespace {

// A side of triangles. Those of the two sides of a UV seam are two, of one place.
struct Edge {
    int first, second; ///< vertices; the first is that of the lower place, so halves at one place have one order
    int place;         ///< the same for all between the same two places
};

// The edges of triangles: each triangle's three, edge i from its corner i on.
struct EdgeList {
    std::vector<Edge> edges;
    std::vector<V3i> ofTriangle;
    std::size_t places = 0;

    EdgeList(const std::vector<V3i>& triangles, const std::vector<int>& placeOfVertex) : ofTriangle(triangles.size()) {
        struct Side {
            std::pair<int, int> places, vertices;
            std::uint32_t slot; // 3 x triangle + corner
            auto key() const { return std::tie(places, vertices, slot); }
        };
        std::vector<Side> sides(3 * triangles.size());
        tbb::parallel_for(std::size_t(0), sides.size(), [&](std::size_t s) {
            const V3i& t = triangles[s / 3];
            const int a = t[int(s % 3)], b = t[int((s + 1) % 3)];
            std::pair<int, int> from{placeOfVertex[std::size_t(a)], a}, to{placeOfVertex[std::size_t(b)], b};
            if (to < from)
                std::swap(from, to);
            sides[s] = {{from.first, to.first}, {from.second, to.second}, static_cast<std::uint32_t>(s)};
        });
        tbb::parallel_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.key() < b.key(); });
        const Side* last = nullptr;
        for (const Side& side : sides) {
            const bool newPlace = !last || side.places != last->places;
            places += newPlace;
            if (newPlace || side.vertices != last->vertices)
                edges.push_back({side.vertices.first, side.vertices.second, int(places) - 1});
            ofTriangle[side.slot / 3][int(side.slot % 3)] = int(edges.size()) - 1;
            last = &side;
        }
    }
};

// Numbers those of `count` that are chosen, from `start` on, and the rest with -1; returns the number after the last.
template <typename Chosen>
int numbered(std::size_t count, int start, std::vector<int>& numbers, Chosen&& chosen) {
    numbers.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        numbers[i] = chosen(i) ? start++ : -1;
    return start;
}

class Dicer {
  public:
    Dicer(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options)
        : rule_(camera, options), options_(options), list_(surface.triangles, weldedIndices(surface.positions)) {
        mesh_.positions = surface.positions;
        mesh_.normals = surface.normals;
        mesh_.triangles = surface.triangles;
        mesh_.closed = surface.closed;
        seen_.reserve(mesh_.positions.size());
        for (const V3f& p : mesh_.positions)
            seen_.push_back(inPicture(p));
        turnedAway_.reserve(mesh_.triangles.size());
        for (const V3i& t : mesh_.triangles)
            turnedAway_.push_back(mesh_.closed && isTurnedAway(t));
    }

    SurfaceMesh run() {
        for (int round = 0; round < mostDiceRounds && mesh_.triangles.size() <= options_.mostTriangles; ++round)
            if (!splitOnce())
                break;
        return std::move(mesh_);
    }

  private:
    const Edge& edgeOf(std::size_t triangle, int side) const {
        return list_.edges[std::size_t(list_.ofTriangle[triangle][side])];
    }

    V3f inPicture(const V3f& p) const { return options_.toPicture ? options_.toPicture(p) : p; }

    DiceRule::Corners seenCorners(const V3i& t) const {
        return {seen_[std::size_t(t.x)], seen_[std::size_t(t.y)], seen_[std::size_t(t.z)]};
    }

    bool isTurnedAway(const V3i& t) const {
        DiceRule::Corners normals;
        for (int i = 0; i < 3; ++i) {
            const V3f &p = mesh_.positions[std::size_t(t[i])], &n = mesh_.normals[std::size_t(t[i])];
            normals[std::size_t(i)] = options_.toPicture ? inPicture(p + n) - inPicture(p) : n;
        }
        return rule_.isTurnedAway(seenCorners(t), normals);
    }

    // The sides of each triangle that are too long, seen from this triangle alone, as bits.
    unsigned wantedOf(std::size_t t) const {
        if (turnedAway_[t])
            return 0;
        const DiceRule::Corners corners = seenCorners(mesh_.triangles[t]);
        unsigned wanted = 0;
        for (std::size_t i = 0; i < 3; ++i)
            if (rule_.isTooLong(corners[i], corners[(i + 1) % 3]))
                wanted |= 1u << i;
        return wanted && rule_.isInView(corners) ? wanted : 0;
    }

    bool splitOnce() {
        // A place is split where one of its triangles wants it.
        std::vector<std::atomic<char>> wanted(list_.places);
        tbb::parallel_for(std::size_t(0), mesh_.triangles.size(), [&](std::size_t t) {
            const unsigned sides = wantedOf(t);
            for (int i = 0; i < 3; ++i)
                if (sides >> i & 1)
                    wanted[std::size_t(edgeOf(t, i).place)].store(1, std::memory_order_relaxed);
        });
        std::vector<int> halfPlace; // the second half's place; the first half keeps the edge's
        const int places = numbered(list_.places, int(list_.places), halfPlace,
                                    [&](std::size_t p) { return wanted[p].load(std::memory_order_relaxed) != 0; });
        if (places == int(list_.places))
            return false;

        const auto edges = list_.edges.size(), vertices = mesh_.positions.size();
        Middles middles;
        const int newEdges = numbered(edges, int(edges), middles.secondHalf,
                                      [&](std::size_t e) { return halfPlace[std::size_t(list_.edges[e].place)] >= 0; });
        const std::size_t split = std::size_t(newEdges) - edges;
        middles.shift = int(vertices) - int(edges);
        mesh_.positions.resize(vertices + split);
        mesh_.normals.resize(vertices + split);
        seen_.resize(vertices + split);
        list_.edges.resize(edges + split);
        tbb::parallel_for(std::size_t(0), edges, [&](std::size_t e) {
            if (const int vertex = middles.of(e); vertex >= 0)
                splitEdge(e, vertex, middles.secondHalf[e], halfPlace[std::size_t(list_.edges[e].place)]);
        });
        list_.places = std::size_t(places);
        splitTriangles(middles);
        return true;
    }

    // Of the edges that are split in this round.
    struct Middles {
        std::vector<int> secondHalf; ///< the edge from the middle on, -1 where it is not split
        int shift = 0;               ///< from its number to that of the vertex in the middle

        int of(std::size_t edge) const { return secondHalf[edge] < 0 ? -1 : secondHalf[edge] + shift; }
    };

    void splitEdge(std::size_t e, int vertex, int secondHalf, int secondPlace) {
        Edge& edge = list_.edges[e];
        const auto i = std::size_t(edge.first), j = std::size_t(edge.second), v = std::size_t(vertex);
        // Sums of two have the same bits either way round: both sides of a seam get the same place.
        mesh_.positions[v] = 0.5f * (mesh_.positions[i] + mesh_.positions[j]);
        const V3f normal = mesh_.normals[i] + mesh_.normals[j];
        mesh_.normals[v] = normal.length2() > 1e-12f ? normal.normalized() : mesh_.normals[i];
        seen_[v] = inPicture(mesh_.positions[v]);
        list_.edges[std::size_t(secondHalf)] = {vertex, edge.second, secondPlace};
        edge.second = vertex;
    }

    void splitTriangles(const Middles& middles) {
        const std::size_t old = mesh_.triangles.size();
        // Each split side makes one more triangle and one more edge inside.
        std::vector<std::size_t> before(old + 1, 0); // split sides of the triangles before this one
        for (std::size_t t = 0; t < old; ++t) {
            before[t + 1] = before[t];
            for (int i = 0; i < 3; ++i)
                before[t + 1] += middles.secondHalf[std::size_t(list_.ofTriangle[t][i])] >= 0;
        }
        Parts parts{std::vector<V3i>(old + before[old]), std::vector<V3i>(old + before[old])};
        std::vector<char> turnedAway(old + before[old]);
        const std::size_t edges = list_.edges.size();
        list_.edges.resize(edges + before[old]);
        tbb::parallel_for(std::size_t(0), old, [&](std::size_t t) {
            appendParts(t, middles, parts, t + before[t], edges + before[t]);
            std::fill(turnedAway.begin() + std::ptrdiff_t(t + before[t]),
                      turnedAway.begin() + std::ptrdiff_t(t + 1 + before[t + 1]), turnedAway_[t]);
        });
        // An edge inside a triangle is of a place of its own.
        for (std::size_t e = edges; e < list_.edges.size(); ++e)
            list_.edges[e].place = int(list_.places++);
        mesh_.triangles.swap(parts.corners);
        list_.ofTriangle.swap(parts.edges);
        turnedAway_.swap(turnedAway);
    }

    struct Parts {
        std::vector<V3i> corners, edges;

        void set(std::size_t at, const V3i& corner, const V3i& edge) {
            corners[at] = corner;
            edges[at] = edge;
        }
    };

    // The parts of a triangle, from `at` on; edges inside it have the numbers from `inside` on.
    void appendParts(std::size_t t, const Middles& middles, Parts& parts, std::size_t at, std::size_t inside) {
        const V3i &corners = mesh_.triangles[t], &sides = list_.ofTriangle[t];
        int middle[3], count = 0;
        for (int i = 0; i < 3; ++i)
            count += (middle[i] = middles.of(std::size_t(sides[i]))) >= 0;
        if (count == 0)
            return parts.set(at, corners, sides);
        const int first = DiceRule::firstCorner(count, [&](int i) { return middle[i] >= 0; });
        const int next = (first + 1) % 3, last = (first + 2) % 3;
        const int a = corners[first], b = corners[next], c = corners[last];
        const int ab = middle[first], bc = middle[next], ca = middle[last];
        // The half of a side at this corner.
        const auto half = [&](int side, int corner) {
            const int e = sides[side];
            return list_.edges[std::size_t(e)].first == corner ? e : middles.secondHalf[std::size_t(e)];
        };
        const auto join = [&](int from, int to) {
            list_.edges[inside] = {from, to, -1};
            return int(inside++);
        };
        if (count == 1) {
            const int across = join(ab, c);
            parts.set(at, {a, ab, c}, {half(first, a), across, sides[last]});
            parts.set(at + 1, {ab, b, c}, {half(first, b), sides[next], across});
            return;
        }
        const int overB = join(ab, bc);
        if (count == 3) {
            const int overC = join(bc, ca), overA = join(ca, ab);
            parts.set(at, {a, ab, ca}, {half(first, a), overA, half(last, a)});
            parts.set(at + 1, {b, bc, ab}, {half(next, b), overB, half(first, b)});
            parts.set(at + 2, {c, ca, bc}, {half(last, c), overC, half(next, c)});
            parts.set(at + 3, {ab, bc, ca}, {overB, overC, overA});
            return;
        }
        parts.set(at, {ab, b, bc}, {half(first, b), half(next, b), overB});
        const auto place = [this](int v) { return mesh_.positions[std::size_t(v)]; };
        if (DiceRule::isCutFromA(place(a), place(ab), place(bc), place(c))) {
            const int across = join(a, bc);
            parts.set(at + 1, {a, ab, bc}, {half(first, a), overB, across});
            parts.set(at + 2, {a, bc, c}, {across, half(next, c), sides[last]});
        } else {
            const int across = join(ab, c);
            parts.set(at + 1, {a, ab, c}, {half(first, a), across, sides[last]});
            parts.set(at + 2, {ab, bc, c}, {overB, half(next, c), across});
        }
    }

    const DiceRule rule_;
    const DiceOptions& options_;
    SurfaceMesh mesh_;
    std::vector<V3f> seen_; ///< positions where the camera is
    EdgeList list_;
    std::vector<char> turnedAway_; ///< of each triangle, as those it was cut from
};

} // namespace

SurfaceMesh diced(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options) {
    return Dicer(surface, camera, options).run();
}

} // namespace patina
