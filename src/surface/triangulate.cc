#include "surface/triangulate.h"

#include <cmath>

namespace patina {

using Imath::V2d;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

/// Beyond this clipping could take minutes on a comb-shaped polygon; a fan is good enough for what is left.
constexpr int mostCornersToClip = 1024;

double areaOf(const V2d& a, const V2d& b, const V2d& c) {
    return (b - a).cross(c - a);
}

/// Seen along its normal the polygon is counter-clockwise; dropping the largest component of the normal keeps that
/// without a square root.
std::vector<V2d> project(const std::vector<V3f>& positions, const int* corners, int count, const V3d& normal) {
    const V3d size(std::abs(normal.x), std::abs(normal.y), std::abs(normal.z));
    int axis = 0;
    if (size.y > size[axis])
        axis = 1;
    if (size.z > size[axis])
        axis = 2;
    int first = (axis + 1) % 3, second = (axis + 2) % 3;
    if (normal[axis] < 0.0)
        std::swap(first, second);
    std::vector<V2d> points(count);
    for (int i = 0; i < count; ++i)
        points[i] = V2d(positions[corners[i]][first], positions[corners[i]][second]);
    return points;
}

void fan(int count, std::vector<V3i>& triangles) {
    for (int i = 2; i < count; ++i)
        triangles.emplace_back(0, i - 1, i);
}

void cutQuad(const std::vector<V3f>& positions, const int* corners, std::vector<V3i>& triangles) {
    const V3d p[4] = {V3d(positions[corners[0]]), V3d(positions[corners[1]]), V3d(positions[corners[2]]),
                      V3d(positions[corners[3]])};
    const V3d normal = (p[2] - p[0]).cross(p[3] - p[1]);
    // A diagonal is inside where both its triangles face the way the whole quad does.
    const auto faces = [&](int a, int b, int c) { return (p[b] - p[a]).cross(p[c] - p[a]).dot(normal) > 0.0; };
    const bool first = faces(0, 1, 2) && faces(0, 2, 3);
    const bool second = faces(0, 1, 3) && faces(1, 2, 3);
    const bool shorter = (p[2] - p[0]).length2() <= (p[3] - p[1]).length2();
    if (first == second ? shorter : first) {
        triangles.emplace_back(0, 1, 2);
        triangles.emplace_back(0, 2, 3);
    } else {
        triangles.emplace_back(0, 1, 3);
        triangles.emplace_back(1, 2, 3);
    }
}

/// What is left of a polygon while ears are cut off, as a ring.
struct Ring {
    std::vector<V2d> points;
    std::vector<int> next, previous;

    bool convex(int i) const { return areaOf(points[previous[i]], points[i], points[next[i]]) > 0.0; }

    /// An ear is convex and holds no other corner; only reflex corners can be inside.
    bool isEar(int i) const {
        const V2d &a = points[previous[i]], &b = points[i], &c = points[next[i]];
        if (!(areaOf(a, b, c) > 0.0))
            return false;
        for (int j = next[next[i]]; j != previous[i]; j = next[j]) {
            const V2d& p = points[j];
            if (convex(j) || p == a || p == b || p == c)
                continue;
            if (areaOf(a, b, p) >= 0.0 && areaOf(b, c, p) >= 0.0 && areaOf(c, a, p) >= 0.0)
                return false;
        }
        return true;
    }
};

/// Corners in a straight line cut nothing but would leave a triangle without area in place of an ear.
bool allConvex(const Ring& ring) {
    for (int i = 0; i < static_cast<int>(ring.points.size()); ++i)
        if (!ring.convex(i))
            return false;
    return true;
}

void clipEars(Ring& ring, std::vector<V3i>& triangles) {
    int left = static_cast<int>(ring.points.size());
    int at = 0;
    while (left > 3) {
        int ear = -1;
        int candidate = at;
        for (int tried = 0; tried < left; ++tried, candidate = ring.next[candidate])
            if (ring.isEar(candidate)) {
                ear = candidate;
                break;
            }
        if (ear < 0) // self-intersecting or flat: any corner will do
            ear = at;
        const int before = ring.previous[ear], after = ring.next[ear];
        triangles.emplace_back(before, ear, after);
        ring.next[before] = after;
        ring.previous[after] = before;
        // Going on two corners further spreads the cuts around the polygon rather than making slivers from one corner.
        at = ring.next[after];
        --left;
    }
    triangles.emplace_back(ring.previous[at], at, ring.next[at]);
}

} // namespace

V3d polygonAreaVector(const std::vector<V3f>& positions, const int* corners, int count) {
    const V3d origin(positions[corners[0]]);
    V3d sum(0.0);
    V3d last = V3d(positions[corners[1]]) - origin;
    for (int i = 2; i < count; ++i) {
        const V3d current = V3d(positions[corners[i]]) - origin;
        sum += last.cross(current);
        last = current;
    }
    return sum;
}

void triangulatePolygon(const std::vector<V3f>& positions, const int* corners, int count, std::vector<V3i>& triangles) {
    if (count == 3) {
        triangles.emplace_back(0, 1, 2);
        return;
    }
    if (count == 4) {
        cutQuad(positions, corners, triangles);
        return;
    }
    const V3d normal = polygonAreaVector(positions, corners, count);
    if (!(normal.length2() > 0.0) || count > mostCornersToClip) {
        fan(count, triangles);
        return;
    }
    Ring ring;
    ring.points = project(positions, corners, count, normal);
    ring.next.resize(count);
    ring.previous.resize(count);
    for (int i = 0; i < count; ++i) {
        ring.next[i] = (i + 1) % count;
        ring.previous[i] = (i + count - 1) % count;
    }
    if (allConvex(ring)) {
        // Zigzag: the triangles of a regular polygon come out better than in a fan.
        int low = 0, high = count - 1;
        bool fromLow = true;
        while (high - low >= 2) {
            triangles.emplace_back(low, fromLow ? low + 1 : high - 1, high);
            fromLow ? ++low : --high;
            fromLow = !fromLow;
        }
        return;
    }
    clipEars(ring, triangles);
}

} // namespace patina
