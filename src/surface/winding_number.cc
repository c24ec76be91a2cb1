#include "surface/winding_number.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

constexpr int mostInLeaf = 8;
constexpr double farAway = 3.0; // radii: taken together from there on

/// Nodes that a subtree of so many triangles takes.
int nodesFor(int triangles) {
    if (triangles <= mostInLeaf)
        return 1;
    const int half = triangles / 2;
    return 1 + nodesFor(half) + nodesFor(triangles - half);
}

/// Van Oosterom & Strackee 1983: tan(omega / 2) of a triangle seen from the origin.
double solidAngle(const V3d& a, const V3d& b, const V3d& c) {
    const double la = a.length(), lb = b.length(), lc = c.length();
    const double volume = a.dot(b.cross(c));
    const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    return volume == 0.0 ? 0.0 : 2.0 * std::atan2(volume, below);
}

} // namespace

WindingNumber::WindingNumber(const std::vector<V3f>& positions, const std::vector<V3i>& triangles) {
    const int count = static_cast<int>(triangles.size());
    std::vector<V3d> centroids(triangles.size());
    order_.resize(triangles.size());
    for (int t = 0; t < count; ++t) {
        order_[t] = t;
        const V3i& c = triangles[t];
        centroids[t] = (V3d(positions[c.x]) + V3d(positions[c.y]) + V3d(positions[c.z])) / 3.0;
    }
    if (count == 0)
        return;
    // The tree's shape follows from the number of triangles alone, so that its halves can be built side by side.
    nodes_.resize(nodesFor(count));
    nodes_[0].count = count;
    corners_.resize(3 * triangles.size());
    build(0, centroids);
    for (std::size_t i = 0; i < order_.size(); ++i)
        for (int c = 0; c < 3; ++c)
            corners_[3 * i + c] = V3d(positions[triangles[order_[i]][c]]);
    for (std::size_t n = nodes_.size(); n-- > 0;) {
        Node& node = nodes_[n];
        node.vectorArea = node.centre = V3d(0.0);
        for (int i = node.first; i < node.first + node.count && node.left < 0; ++i) {
            const V3d &a = corners_[3 * i], &b = corners_[3 * i + 1], &c = corners_[3 * i + 2];
            const V3d vector = (b - a).cross(c - a) * 0.5;
            const double weight = vector.length();
            node.vectorArea += vector;
            node.centre += (a + b + c) * (weight / 3.0);
            node.area += weight;
        }
        if (node.left >= 0) {
            // Children come behind their parent: they are done.
            node.vectorArea = nodes_[node.left].vectorArea + nodes_[node.right].vectorArea;
            const Node &left = nodes_[node.left], &right = nodes_[node.right];
            node.area = left.area + right.area;
            node.centre = node.area > 0.0 ? (left.centre * left.area + right.centre * right.area) / node.area
                                          : left.centre;
            node.radius = std::max((left.centre - node.centre).length() + left.radius,
                                   (right.centre - node.centre).length() + right.radius);
            continue;
        }
        node.centre = node.area > 0.0 ? node.centre / node.area : corners_[3 * node.first];
        for (int i = 3 * node.first; i < 3 * (node.first + node.count); ++i)
            node.radius = std::max(node.radius, (corners_[i] - node.centre).length());
    }
}

void WindingNumber::build(int at, const std::vector<V3d>& centroids) {
    Node& node = nodes_[at];
    if (node.count <= mostInLeaf)
        return;
    V3d low(1e300), high(-1e300);
    for (int i = node.first; i < node.first + node.count; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], centroids[order_[i]][axis]);
            high[axis] = std::max(high[axis], centroids[order_[i]][axis]);
        }
    const V3d size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const int half = node.count / 2;
    std::nth_element(order_.begin() + node.first, order_.begin() + node.first + half,
                     order_.begin() + node.first + node.count, [&](int a, int b) {
                         const double x = centroids[a][axis], y = centroids[b][axis];
                         return x < y || (x == y && a < b);
                     });
    node.left = at + 1;
    node.right = node.left + nodesFor(half);
    nodes_[node.left].first = node.first;
    nodes_[node.left].count = half;
    nodes_[node.right].first = node.first + half;
    nodes_[node.right].count = node.count - half;
    const int left = node.left, right = node.right;
    if (node.count > 20000) {
        tbb::parallel_invoke([&] { build(left, centroids); }, [&] { build(right, centroids); });
    } else {
        build(left, centroids);
        build(right, centroids);
    }
}

double WindingNumber::sum(int at, const V3d& point) const {
    const Node& node = nodes_[at];
    const V3d to = node.centre - point;
    const double distance = to.length();
    if (distance > farAway * node.radius && distance > 0.0)
        return node.vectorArea.dot(to) / (distance * distance * distance);
    if (node.left >= 0)
        return sum(node.left, point) + sum(node.right, point);
    double total = 0.0;
    for (int i = 3 * node.first; i < 3 * (node.first + node.count); i += 3)
        total += solidAngle(corners_[i] - point, corners_[i + 1] - point, corners_[i + 2] - point);
    return total;
}

double WindingNumber::at(const V3d& point) const {
    return nodes_.empty() ? 0.0 : sum(0, point) / (4.0 * 3.14159265358979323846);
}

} // namespace patina
