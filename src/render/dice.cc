#include "render/dice.h"

#include "surface/weld.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace patina {

using Imath::V3f;
using Imath::V3i;

namespace {

// From pairs of numbers to a number; open addressing, at most half full.
class PairTable {
  public:
    explicit PairTable(std::size_t pairs) {
        std::size_t slots = 64;
        while (slots < 2 * pairs)
            slots *= 2;
        keys_.assign(slots, none);
        values_.assign(slots, -1);
    }

    /// The pair's value; a new one has -1.
    int& at(int a, int b) {
        if (2 * (used_ + 1) > keys_.size())
            grow();
        const std::uint64_t key = keyOf(a, b);
        const std::size_t slot = slotOf(key);
        if (keys_[slot] == none) {
            keys_[slot] = key;
            ++used_;
        }
        return values_[slot];
    }
    bool has(int a, int b) const { return keys_[slotOf(keyOf(a, b))] != none; }
    std::size_t size() const { return used_; }

  private:
    static constexpr std::uint64_t none = ~std::uint64_t(0);

    static std::uint64_t keyOf(int a, int b) {
        return std::uint64_t(std::min(a, b)) << 32 | std::uint32_t(std::max(a, b));
    }
    std::size_t slotOf(std::uint64_t key) const {
        // Multiplied by 2^64 over the golden ratio, the high bits are well mixed.
        std::size_t slot = std::size_t(key * 0x9e3779b97f4a7c15ull >> 20) & (keys_.size() - 1);
        while (keys_[slot] != none && keys_[slot] != key)
            slot = (slot + 1) & (keys_.size() - 1);
        return slot;
    }
    void grow() {
        std::vector<std::uint64_t> keys(2 * keys_.size(), none);
        std::vector<int> values(keys.size(), -1);
        keys.swap(keys_);
        values.swap(values_);
        for (std::size_t i = 0; i < keys.size(); ++i)
            if (keys[i] != none) {
                const std::size_t slot = slotOf(keys[i]);
                keys_[slot] = keys[i];
                values_[slot] = values[i];
            }
    }

    std::vector<std::uint64_t> keys_;
    std::vector<int> values_;
    std::size_t used_ = 0;
};

class Dicer {
  public:
    Dicer(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options)
        : camera_(camera), options_(options), places_(weldedIndices(surface.positions)) {
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
        // Each round halves edges; 24 halve the largest a float tells from the smallest.
        for (int round = 0; round < 24 && mesh_.triangles.size() <= options_.mostTriangles; ++round)
            if (!splitOnce())
                break;
        return std::move(mesh_);
    }

  private:
    V3f inPicture(const V3f& p) const { return options_.toPicture ? options_.toPicture(p) : p; }

    // No corner's normal comes within 17 degrees of facing the camera; relief on it is as good as never seen.
    bool isTurnedAway(const V3i& t) const {
        for (int i = 0; i < 3; ++i) {
            const V3f& p = mesh_.positions[std::size_t(t[i])];
            const V3f& n = mesh_.normals[std::size_t(t[i])];
            const V3f toCamera = (camera_.position() - seen_[std::size_t(t[i])]).normalized();
            const V3f normal = options_.toPicture ? (inPicture(p + n) - inPicture(p)) : n;
            if ((normal ^ toCamera) > -0.3f * normal.length())
                return false;
        }
        return true;
    }

    bool isTooLong(const V3f& a, const V3f& b) const {
        const float length = (a - b).length();
        if (length > options_.longestEdge)
            return true;
        const V3f middle = 0.5f * (a + b);
        const float depth = std::max((middle - camera_.position()) ^ camera_.forward(), 0.5f * length);
        return length > options_.pixelsPerEdge * camera_.pixelAt(depth, options_.pictureHeight);
    }

    // A triangle lies within its longest edge's length of that edge's middle.
    bool isInView(const V3f& a, const V3f& b, const V3f& c) const {
        const std::array<std::pair<V3f, V3f>, 3> edges{{{a, b}, {b, c}, {c, a}}};
        const auto longest = std::max_element(edges.begin(), edges.end(), [](const auto& e, const auto& f) {
            return (e.first - e.second).length2() < (f.first - f.second).length2();
        });
        return camera_.sees(0.5f * (longest->first + longest->second),
                            (longest->first - longest->second).length() + options_.margin);
    }

    int middleOf(int a, int b, PairTable& vertices, PairTable& places) {
        int& vertex = vertices.at(a, b);
        if (vertex >= 0)
            return vertex;
        vertex = int(mesh_.positions.size());
        const auto i = std::size_t(a), j = std::size_t(b);
        // Sums of two have the same bits either way round: both sides of a seam get the same place.
        mesh_.positions.push_back(0.5f * (mesh_.positions[i] + mesh_.positions[j]));
        const V3f normal = mesh_.normals[i] + mesh_.normals[j];
        mesh_.normals.push_back(normal.length2() > 1e-12f ? normal.normalized() : mesh_.normals[i]);
        seen_.push_back(inPicture(mesh_.positions.back()));
        int& place = places.at(places_[i], places_[j]);
        if (place < 0)
            place = vertex;
        places_.push_back(place);
        return vertex;
    }

    bool splitOnce() {
        const std::vector<V3i>& old = mesh_.triangles;
        // Which of each triangle's edges are too long, seen from this triangle alone.
        std::vector<unsigned char> wanted(old.size(), 0);
        tbb::parallel_for(std::size_t(0), old.size(), [&](std::size_t t) {
            const V3f corner[3] = {seen_[std::size_t(old[t].x)], seen_[std::size_t(old[t].y)],
                                   seen_[std::size_t(old[t].z)]};
            if (turnedAway_[t])
                return;
            for (int i = 0; i < 3; ++i)
                if (isTooLong(corner[i], corner[(i + 1) % 3]))
                    wanted[t] |= static_cast<unsigned char>(1 << i);
            if (wanted[t] && !isInView(corner[0], corner[1], corner[2]))
                wanted[t] = 0;
        });
        PairTable splits(old.size() / 4);
        for (std::size_t t = 0; t < old.size(); ++t)
            for (int i = 0; i < 3; ++i)
                if (wanted[t] >> i & 1)
                    splits.at(places_[std::size_t(old[t][i])], places_[std::size_t(old[t][(i + 1) % 3])]);
        if (splits.size() == 0)
            return false;

        PairTable vertices(splits.size()), places(splits.size());
        std::vector<V3i> triangles;
        std::vector<char> turnedAway;
        triangles.reserve(old.size() + 2 * splits.size());
        turnedAway.reserve(triangles.capacity());
        for (std::size_t t = 0; t < old.size(); ++t) {
            const V3i corners = old[t];
            int middle[3] = {-1, -1, -1};
            int count = 0;
            for (int i = 0; i < 3; ++i) {
                const int a = corners[i], b = corners[(i + 1) % 3];
                if (splits.has(places_[std::size_t(a)], places_[std::size_t(b)])) {
                    middle[i] = middleOf(a, b, vertices, places);
                    ++count;
                }
            }
            appendParts(corners, middle, count, triangles);
            turnedAway.resize(triangles.size(), turnedAway_[t]);
        }
        mesh_.triangles.swap(triangles);
        turnedAway_.swap(turnedAway);
        return true;
    }

    // The parts of a triangle whose edge i, from corner i on, has a middle where middle[i] is not -1.
    void appendParts(const V3i& corners, const int* middle, int count, std::vector<V3i>& out) const {
        if (count == 0) {
            out.push_back(corners);
            return;
        }
        if (count == 3) {
            for (int i = 0; i < 3; ++i)
                out.emplace_back(corners[i], middle[i], middle[(i + 2) % 3]);
            out.emplace_back(middle[0], middle[1], middle[2]);
            return;
        }
        int first = 0; // turned so that edge 0 is split and, of two, edge 2 is not
        while (middle[first] < 0 || (count == 2 && middle[(first + 2) % 3] >= 0))
            ++first;
        const int a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
        const int ab = middle[first], bc = middle[(first + 1) % 3];
        if (count == 1) {
            out.emplace_back(a, ab, c);
            out.emplace_back(ab, b, c);
            return;
        }
        out.emplace_back(ab, b, bc);
        const auto at = [this](int v) { return mesh_.positions[std::size_t(v)]; };
        if ((at(a) - at(bc)).length2() <= (at(ab) - at(c)).length2()) {
            out.emplace_back(a, ab, bc);
            out.emplace_back(a, bc, c);
        } else {
            out.emplace_back(a, ab, c);
            out.emplace_back(ab, bc, c);
        }
    }

    const Camera& camera_;
    const DiceOptions& options_;
    SurfaceMesh mesh_;
    std::vector<V3f> seen_;        ///< positions where the camera is
    std::vector<int> places_;      ///< of each vertex: the same number for all at one place
    std::vector<char> turnedAway_; ///< of each triangle, as those it was cut from
};

} // namespace

SurfaceMesh diced(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options) {
    return Dicer(surface, camera, options).run();
}

} // namespace patina
