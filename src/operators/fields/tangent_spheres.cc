#include "operators/fields/tangent_spheres.h"

#include "volume/index_space.h"
#include "volume/patch_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace patina {

using Imath::V3f;
using Imath::V3i;

namespace {

constexpr int brickShift = 2;   // bricks of 4³ voxels hold about 25 points of a surface
constexpr int clusterShift = 4; // clusters of 16³ voxels hold about 25 bricks
constexpr int lanes =
    ContactBounds::lanes; // points of a brick are padded to a multiple, so that their loop is straight

V3i cellOf(const V3f& point, int shift) {
    return {static_cast<int>(std::floor(point.x)) >> shift, static_cast<int>(std::floor(point.y)) >> shift,
            static_cast<int>(std::floor(point.z)) >> shift};
}

struct Box {
    V3f low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};

    void extend(const V3f& p) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], p[i]);
            high[i] = std::max(high[i], p[i]);
        }
    }
    float squaredDistance(const V3f& c) const {
        float sum = 0.f;
        for (int i = 0; i < 3; ++i) {
            const float d = std::max(std::max(low[i] - c[i], c[i] - high[i]), 0.f);
            sum += d * d;
        }
        return sum;
    }
};

struct Brick {
    Box box;
    std::uint32_t begin = 0, end = 0; ///< of the padded points
};

struct Cluster {
    Box box;
    std::uint32_t begin = 0, end = 0; ///< of the bricks
};

constexpr float t = contactTolerance;

// k of a point.
float curvature(const V3f& p, const V3f& n, float x, float y, float z) {
    const float dx = x - p.x, dy = y - p.y, dz = z - p.z;
    const float along = n.x * dx + n.y * dy + n.z * dz - t;
    const float squared = std::max(dx * dx + dy * dy + dz * dz - t * t, 1e-3f);
    return along / squared;
}

// A sphere at p that gives way to what stands in it.
struct Shrinking {
    V3f p, n;
    float most;   // k, so far
    float radius; // 1 / 2k
    V3f centre;
    int stop = -1;

    Shrinking(const V3f& point, const V3f& normal, float fewest) : p(point), n(normal) { shrinkTo(fewest); }
    void shrinkTo(float k) {
        most = k;
        radius = 0.5f / k;
        centre = p + n * radius;
    }
    float squaredReach() const { return ContactBounds::squaredReach(radius); }

    void meet(const V3f& seed, const SurfaceContacts& contacts, int number) {
        for (const V3f& contact : contacts.of(static_cast<std::size_t>(number))) {
            const V3f q = seed + contact;
            const float k = curvature(p, n, q.x, q.y, q.z);
            if (k > most) {
                stop = number;
                shrinkTo(k);
            }
        }
    }
};

} // namespace

struct TangentSpheres::Blocks {
    std::vector<float> x, y, z;
    std::vector<int> index; ///< of each padded point; -1 for padding
    ContactBounds bounds;   ///< of its patch
    const SurfaceContacts* contacts = nullptr;
    std::vector<V3f> points;
    std::vector<Brick> bricks;
    std::vector<Cluster> clusters;
    V3i low{0}, size{0};             ///< of the table, in clusters
    std::vector<std::int32_t> table; ///< cluster at a place, or -1

    std::int32_t clusterAt(int i, int j, int k) const { return table[(std::size_t(i) * size.y + j) * size.z + k]; }
    void build(const SurfaceContacts& from, const IndexSpace& space);

    template <typename Visit>
    void clustersWithin(const V3f& low, const V3f& high, Visit&& visit) const {
        const V3i a = cellOf(low, clusterShift) - this->low, b = cellOf(high, clusterShift) - this->low;
        for (int i = std::max(a.x, 0); i <= std::min(b.x, size.x - 1); ++i)
            for (int j = std::max(a.y, 0); j <= std::min(b.y, size.y - 1); ++j)
                for (int k = std::max(a.z, 0); k <= std::min(b.z, size.z - 1); ++k)
                    if (const std::int32_t c = clusterAt(i, j, k); c >= 0)
                        visit(clusters[c]);
    }
};

void TangentSpheres::Blocks::build(const SurfaceContacts& all, const IndexSpace& space) {
    contacts = &all;
    const SurfaceSeeds& from = all.seeds();
    points.reserve(from.points.size());
    for (const PointBlocks::Block& block : from.points.blocks) {
        const V3i origin = space.place(block.block << 3);
        for (std::uint32_t s = block.begin; s < block.end; ++s)
            points.emplace_back(float(origin.x) + from.points.x[s], float(origin.y) + from.points.y[s],
                                float(origin.z) + from.points.z[s]);
    }
    if (points.empty())
        return;
    V3i lowest(std::numeric_limits<int>::max()), highest(std::numeric_limits<int>::lowest());
    for (const V3f& p : points) {
        const V3i c = cellOf(p, clusterShift);
        for (int i = 0; i < 3; ++i) {
            lowest[i] = std::min(lowest[i], c[i]);
            highest[i] = std::max(highest[i], c[i]);
        }
    }
    low = lowest;
    size = highest - lowest + V3i(1);
    table.assign(std::size_t(size.x) * size.y * size.z, -1);

    // Sorted by cluster, then by brick within it, then by number.
    const auto keyOf = [&](const V3f& p) {
        const V3i c = cellOf(p, clusterShift) - low, b = cellOf(p, brickShift);
        const std::uint64_t place = (std::uint64_t(c.x) * size.y + c.y) * size.z + c.z;
        return place << 6 | std::uint64_t(((b.x & 3) << 4) | ((b.y & 3) << 2) | (b.z & 3));
    };
    std::vector<std::pair<std::uint64_t, int>> order(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        order[i] = {keyOf(points[i]), static_cast<int>(i)};
    std::sort(order.begin(), order.end());

    for (std::size_t i = 0; i < order.size();) {
        const std::uint64_t key = order[i].first;
        if (clusters.empty() || table[key >> 6] < 0) {
            table[key >> 6] = static_cast<std::int32_t>(clusters.size());
            clusters.emplace_back();
            clusters.back().begin = static_cast<std::uint32_t>(bricks.size());
        }
        Brick brick;
        brick.begin = static_cast<std::uint32_t>(x.size());
        for (; i < order.size() && order[i].first == key; ++i) {
            const V3f& p = points[order[i].second];
            x.push_back(p.x);
            y.push_back(p.y);
            z.push_back(p.z);
            index.push_back(order[i].second);
            bounds.add(p, all, static_cast<std::size_t>(order[i].second));
            brick.box.extend(p);
            clusters.back().box.extend(p);
        }
        while (x.size() % lanes != 0) { // so far away that it stops nothing
            x.push_back(1e9f);
            y.push_back(1e9f);
            z.push_back(1e9f);
            index.push_back(-1);
        }
        bounds.pad();
        brick.end = static_cast<std::uint32_t>(x.size());
        bricks.push_back(brick);
        clusters.back().end = static_cast<std::uint32_t>(bricks.size());
    }
}

TangentSpheres::TangentSpheres(const SurfaceContacts& contacts, const IndexSpace& space) {
    auto blocks = std::make_unique<Blocks>();
    blocks->build(contacts, space);
    blocks_ = std::move(blocks);
}

TangentSpheres::~TangentSpheres() = default;
TangentSpheres::TangentSpheres(TangentSpheres&&) noexcept = default;

TangentSpheres::Touch TangentSpheres::largest(const V3f& p, const V3f& n, float limit, int guess) const {
    const Blocks& blocks = *blocks_;
    const SurfaceContacts& contacts = *blocks.contacts;
    Shrinking sphere(p, n, 0.5f / limit);
    if (guess >= 0)
        sphere.meet(blocks.points[guess], contacts, guess);

    const auto visitBrick = [&](const Brick& brick) {
        if (brick.box.squaredDistance(sphere.centre) > sphere.squaredReach())
            return;
        // The seeds themselves are of the surface, and quick to ask.
        float best[lanes];
        for (float& b : best)
            b = sphere.most;
        for (std::uint32_t i = brick.begin; i < brick.end; i += lanes)
            for (int l = 0; l < lanes; ++l) {
                const float k = curvature(p, n, blocks.x[i + l], blocks.y[i + l], blocks.z[i + l]);
                best[l] = k > best[l] ? k : best[l];
            }
        float found = sphere.most;
        for (const float b : best)
            found = b > found ? b : found;
        if (found > sphere.most) {
            for (std::uint32_t i = brick.begin; i < brick.end; ++i)
                if (curvature(p, n, blocks.x[i], blocks.y[i], blocks.z[i]) == found) {
                    sphere.stop = blocks.index[i];
                    break;
                }
            sphere.shrinkTo(found);
        }
        // Then the patches of those that are near enough.
        for (std::uint32_t i = brick.begin; i < brick.end; i += lanes) {
            unsigned near = blocks.bounds.near(i, sphere.centre, std::max(sphere.radius - t, 0.f));
            for (int l = 0; near; ++l, near >>= 1)
                if (near & 1u) {
                    const int seed = blocks.index[i + l];
                    sphere.meet(blocks.points[seed], contacts, seed);
                }
        }
    };
    const auto visitCluster = [&](const Cluster& cluster) {
        if (cluster.box.squaredDistance(sphere.centre) > sphere.squaredReach())
            return;
        for (std::uint32_t b = cluster.begin; b < cluster.end; ++b)
            visitBrick(blocks.bricks[b]);
    };
    if (guess < 0)
        blocks.clustersWithin(p, p, visitCluster);
    const V3f around(sphere.radius + 1.f);
    blocks.clustersWithin(sphere.centre - around, sphere.centre + around, visitCluster);
    return {std::min(sphere.radius, limit), sphere.stop};
}

} // namespace patina
