#pragma once
// Control meshes that tests of several rooms share.

#include "surface/mesh.h"

#include <cmath>

namespace patina::test {

/// A strip with one half turn, of 2 n triangles. \param radius  of its middle line \param half  of its width
inline Mesh moebiusStrip(double radius, double half, int n) {
    Mesh strip;
    strip.name = "moebius";
    for (int i = 0; i < n; ++i) {
        const double a = 2.0 * M_PI * i / n, turn = 0.5 * a;
        for (const double side : {-half, half}) {
            const double r = radius + side * std::cos(turn);
            strip.positions.emplace_back(r * std::cos(a), r * std::sin(a), side * std::sin(turn));
        }
    }
    for (int i = 0; i < n; ++i) {
        const bool last = i + 1 == n;
        const int a = 2 * i, b = 2 * i + 1, c = last ? 1 : 2 * i + 2, d = last ? 0 : 2 * i + 3;
        strip.faceSizes.insert(strip.faceSizes.end(), 2, 3);
        for (const int v : {a, c, b, b, c, d})
            strip.faceVertices.push_back(v);
    }
    return strip;
}

} // namespace patina::test
