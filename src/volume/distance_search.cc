#include "volume/distance_search.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace patina {

namespace {

// Half the side and half the diagonal between the outermost voxel centres of a cube of 8, 4, 2 voxels.
constexpr float halfSide[3] = {3.5f, 1.5f, 0.5f};
constexpr float halfDiagonal[3] = {6.0621778f, 2.5980762f, 0.8660254f};
constexpr std::size_t lanes = 8;

// Squared distances of points to (cx, cy, cz), and the smallest. Arrays are padded to whole lanes.
float squaredDistances(const float* x, const float* y, const float* z, std::size_t count, float cx, float cy, float cz,
                       float* squared) {
    float least[lanes];
    std::fill(least, least + lanes, std::numeric_limits<float>::max());
    for (std::size_t i = 0; i < count; i += lanes)
        for (std::size_t l = 0; l < lanes; ++l) {
            const float dx = x[i + l] - cx, dy = y[i + l] - cy, dz = z[i + l] - cz;
            const float d = dx * dx + dy * dy + dz * dz;
            squared[i + l] = d;
            least[l] = d < least[l] ? d : least[l];
        }
    return *std::min_element(least, least + lanes);
}

// Fills the lanes behind a list's `count` points with points so far away that they never count.
void pad(NearestInBlock::List& list, std::size_t count) {
    for (std::size_t i = count; i < count + lanes; ++i) {
        list.x[i] = list.y[i] = list.z[i] = 1e9f;
        list.id[i] = -1;
    }
}

float limitOf(float leastSquared, float half) {
    const float limit = std::sqrt(leastSquared) + 2.f * half + 1e-3f; // a little more, for rounding
    return limit * limit;
}

// Where in `squared` the smallest value stands.
std::size_t indexOf(float least, const float* squared, std::size_t count) {
    std::size_t i = 0;
    while (i + 1 < count && squared[i] != least)
        ++i;
    return i;
}

// Appends to `to` those of the points `first` … `last` - 1 of `from` that may be nearer than point (bx, by, bz) to some
// voxel of a cube: |x - c|² - |x - b|² is linear in x, and its least value in the cube is that at the middle, d² -
// d_b², less the cube's side times |b - c| in the sum norm. `to` may be `from`.
void keepUndominated(const NearestInBlock::List& from, std::size_t first, std::size_t last, float bx, float by, float bz,
                     float leastSquared, float half, NearestInBlock::List& to) {
    const float side = 2.f * half;
    std::size_t n = to.count;
    for (std::size_t i = first; i < last; i += lanes) {
        unsigned char may[lanes];
        // Whole lanes: what lies behind the last is allocated, and not looked at.
        for (std::size_t l = 0; l < lanes; ++l) {
            const float apart = std::abs(from.x[i + l] - bx) + std::abs(from.y[i + l] - by) + std::abs(from.z[i + l] - bz);
            // A little more, for rounding.
            may[l] = from.squared[i + l] - leastSquared <= side * apart + 1e-3f + 1e-5f * leastSquared;
        }
        std::uint64_t any;
        std::memcpy(&any, may, lanes);
        if (!any)
            continue;
        for (std::size_t l = 0; l < lanes && i + l < last; ++l) {
            to.x[n] = from.x[i + l];
            to.y[n] = from.y[i + l];
            to.z[n] = from.z[i + l];
            to.id[n] = from.id[i + l];
            to.squared[n] = from.squared[i + l];
            n += may[l];
        }
    }
    to.count = n;
}

// Of `from`, what may be nearest to some voxel of the cube around (cx, cy, cz).
// Returns a reason to leave the whole cube out, or 0.
std::int32_t filter(NearestInBlock::List& from, float cx, float cy, float cz, int level, const SearchWindow& window,
                    NearestInBlock::List& to) {
    const float least =
        squaredDistances(from.x.data(), from.y.data(), from.z.data(), from.count, cx, cy, cz, from.squared.data());
    const float distance = std::sqrt(least), half = halfDiagonal[level];
    if (distance - half > window.furthest)
        return NearestInBlock::further;
    if (distance + half < window.nearest)
        return NearestInBlock::closer;
    to.reserve(from.count + lanes);
    to.count = 0;
    const std::size_t b = indexOf(least, from.squared.data(), from.count);
    keepUndominated(from, 0, from.count, from.x[b], from.y[b], from.z[b], least, halfSide[level], to);
    pad(to, to.count);
    if (window.relevant &&
        std::none_of(to.id.begin(), to.id.begin() + to.count, [&](std::int32_t id) { return window.relevant[id]; }))
        return NearestInBlock::further;
    return 0;
}

bool wantsAny(const SearchWindow& window, int x, int y, int z, int size) {
    if (!window.mask)
        return true;
    const std::uint64_t row = ((std::uint64_t(1) << size) - 1) << z;
    std::uint64_t slab = 0;
    for (int j = 0; j < size; ++j)
        slab |= row << (8 * (y + j));
    for (int i = 0; i < size; ++i)
        if (window.mask[x + i] & slab)
            return true;
    return false;
}

void mark(NearestInBlock& result, int x, int y, int z, int size, std::int32_t reason) {
    for (int i = x; i < x + size; ++i)
        for (int j = y; j < y + size; ++j)
            for (int k = z; k < z + size; ++k)
                result.point[64 * i + 8 * j + k] = reason;
}

// The nearest point for the eight voxels of a cube of 2, one lane each.
void nearestOfCube(const NearestInBlock::List& list, int x, int y, int z, NearestInBlock& result) {
    float best[8];
    std::int32_t index[8];
    std::fill(best, best + 8, std::numeric_limits<float>::max());
    std::fill(index, index + 8, 0);
    for (std::size_t i = 0; i < list.count; ++i) {
        const float ax = list.x[i] - float(x), ay = list.y[i] - float(y), az = list.z[i] - float(z);
        const float bx = ax - 1.f, by = ay - 1.f, bz = az - 1.f;
        const float ax2 = ax * ax, ay2 = ay * ay, az2 = az * az, bx2 = bx * bx, by2 = by * by, bz2 = bz * bz;
        const float aa = ax2 + ay2, ab = ax2 + by2, ba = bx2 + ay2, bb = bx2 + by2;
        const float d[8] = {aa + az2, aa + bz2, ab + az2, ab + bz2, ba + az2, ba + bz2, bb + az2, bb + bz2};
        const auto here = static_cast<std::int32_t>(i);
        for (int l = 0; l < 8; ++l) {
            index[l] = d[l] < best[l] ? here : index[l];
            best[l] = d[l] < best[l] ? d[l] : best[l];
        }
    }
    for (int l = 0; l < 8; ++l)
        result.point[64 * (x + (l >> 2)) + 8 * (y + ((l >> 1) & 1)) + z + (l & 1)] = list.id[index[l]];
}

} // namespace

void NearestInBlock::List::reserve(std::size_t n) {
    if (x.size() >= n)
        return;
    n += n / 2;
    x.resize(n);
    y.resize(n);
    z.resize(n);
    id.resize(n);
    squared.resize(n);
}

// The points that may be nearest to some voxel of the block, ring by ring of blocks around it.
bool NearestPoints::gather(const openvdb::Coord& block, const SearchWindow& window, NearestInBlock& result) const {
    NearestInBlock::List& list = result.lists[0];
    list.count = 0;
    constexpr float half = halfDiagonal[0], middle = 3.5f;
    float least = std::numeric_limits<float>::max();
    Imath::V3f best(0.f); // the nearest to the middle
    const openvdb::CoordBBox& box = points_.lattice.box();
    const auto take = [&](const openvdb::Coord& at) {
        const std::int32_t number = points_.lattice.numbers()[points_.lattice.slot(at)];
        if (number < 0)
            return;
        const PointBlocks::Block& found = points_.blocks[number];
        const float ox = 8.f * float(at.x() - block.x()), oy = 8.f * float(at.y() - block.y()),
                    oz = 8.f * float(at.z() - block.z());
        // No point of that block is closer than its box.
        const auto gap = [](float o) { return std::max({0.f, o - middle, middle - (o + 8.f)}); };
        const float gx = gap(ox), gy = gap(oy), gz = gap(oz);
        if (gx * gx + gy * gy + gz * gz > limitOf(least, half))
            return;
        const std::size_t count = found.end - found.begin;
        if (list.x.size() < list.count + count + lanes) {
            list.reserve(2 * (list.count + count) + lanes);
        }
        for (std::size_t i = 0; i < count; ++i) {
            list.x[list.count + i] = points_.x[found.begin + i] + ox;
            list.y[list.count + i] = points_.y[found.begin + i] + oy;
            list.z[list.count + i] = points_.z[found.begin + i] + oz;
            list.id[list.count + i] = static_cast<std::int32_t>(found.begin + i);
        }
        pad(list, list.count + count);
        float* squared = list.squared.data() + list.count;
        const float nearest = squaredDistances(list.x.data() + list.count, list.y.data() + list.count,
                                               list.z.data() + list.count, count, middle, middle, middle, squared);
        if (nearest < least) {
            least = nearest;
            const std::size_t at = list.count + indexOf(least, squared, count);
            best = Imath::V3f(list.x[at], list.y[at], list.z[at]);
        }
        keepUndominated(list, list.count, list.count + count, best.x, best.y, best.z, least, halfSide[0], list);
    };

    for (int ring = 0;; ++ring) {
        // Blocks of this ring are at least so far from the middle.
        const float reach = 8.f * float(ring) - 4.5f;
        if (reach > window.furthest + half + (list.count ? 2.f * half : 0.f) ||
            (list.count && reach > 0.f && reach * reach > limitOf(least, half)))
            break;
        const openvdb::Coord low = block.offsetBy(-ring), high = block.offsetBy(ring);
        if (low.x() < box.min().x() && low.y() < box.min().y() && low.z() < box.min().z() &&
            high.x() > box.max().x() && high.y() > box.max().y() && high.z() > box.max().z())
            break;
        const openvdb::Coord from = openvdb::Coord::maxComponent(low, box.min()),
                             to = openvdb::Coord::minComponent(high, box.max());
        for (int i = from.x(); i <= to.x(); ++i)
            for (int j = from.y(); j <= to.y(); ++j) {
                const bool face = i == low.x() || i == high.x() || j == low.y() || j == high.y();
                if (face) {
                    for (int k = from.z(); k <= to.z(); ++k)
                        take({i, j, k});
                } else {
                    if (low.z() >= box.min().z() && low.z() <= box.max().z())
                        take({i, j, low.z()});
                    if (ring > 0 && high.z() >= box.min().z() && high.z() <= box.max().z())
                        take({i, j, high.z()});
                }
            }
    }
    if (list.count == 0)
        return false;
    // What came early was measured against a looser limit.
    list.reserve(list.count + lanes);
    const std::size_t gathered = std::exchange(list.count, 0);
    keepUndominated(list, 0, gathered, best.x, best.y, best.z, least, halfSide[0], list);
    pad(list, list.count);
    const float distance = std::sqrt(least);
    if (distance - half > window.furthest)
        return false;
    if (distance + half < window.nearest) {
        result.point.fill(NearestInBlock::closer);
        return false;
    }
    return !window.relevant ||
           std::any_of(list.id.begin(), list.id.begin() + list.count, [&](std::int32_t id) { return window.relevant[id]; });
}

void NearestPoints::search(const openvdb::Coord& block, const SearchWindow& window, NearestInBlock& result) const {
    result.point.fill(NearestInBlock::further);
    result.any = false;
    if (!gather(block, window, result))
        return;
    for (int a = 0; a < 8; ++a) {
        const int x4 = 4 * (a >> 2), y4 = 4 * ((a >> 1) & 1), z4 = 4 * (a & 1);
        if (!wantsAny(window, x4, y4, z4, 4))
            continue;
        if (const auto reason = filter(result.lists[0], float(x4) + 1.5f, float(y4) + 1.5f, float(z4) + 1.5f,
                                       1, window, result.lists[1])) {
            mark(result, x4, y4, z4, 4, reason);
            continue;
        }
        for (int b = 0; b < 8; ++b) {
            const int x2 = x4 + 2 * (b >> 2), y2 = y4 + 2 * ((b >> 1) & 1), z2 = z4 + 2 * (b & 1);
            if (!wantsAny(window, x2, y2, z2, 2))
                continue;
            if (const auto reason = filter(result.lists[1], float(x2) + 0.5f, float(y2) + 0.5f, float(z2) + 0.5f,
                                           2, window, result.lists[2])) {
                mark(result, x2, y2, z2, 2, reason);
                continue;
            }
            nearestOfCube(result.lists[2], x2, y2, z2, result);
            result.any = true;
        }
    }
}

} // namespace patina
