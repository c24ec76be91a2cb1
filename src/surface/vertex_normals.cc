#include "surface/vertex_normals.h"

#include "surface/weld.h"

#include <cmath>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

std::vector<V3f> angleWeightedNormals(const std::vector<V3f>& positions, const std::vector<V3i>& triangles) {
    std::vector<V3d> own(positions.size(), V3d(0.0));
    for (const V3i& triangle : triangles) {
        const V3d p[3] = {V3d(positions[triangle.x]), V3d(positions[triangle.y]), V3d(positions[triangle.z])};
        const V3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
        const double length = cross.length();
        if (!(length > 0.0))
            continue;
        const V3d normal = cross / length;
        for (int i = 0; i < 3; ++i) {
            // |a × b| is the same at all three corners: twice the area.
            const double angle = std::atan2(length, (p[(i + 1) % 3] - p[i]).dot(p[(i + 2) % 3] - p[i]));
            own[triangle[i]] += angle * normal;
        }
    }
    const std::vector<int> place = weldedIndices(positions);
    std::vector<V3d> shared(positions.size(), V3d(0.0));
    for (std::size_t i = 0; i < positions.size(); ++i)
        shared[place[i]] += own[i];

    std::vector<V3f> normals(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const V3d& together = shared[place[i]];
        // The two sides of a sheet cancel or oppose each other: each then keeps its own.
        const double ownLength = own[i].length(), togetherLength = together.length();
        const bool agree = togetherLength > 0.0 && together.dot(own[i]) >= 0.1 * togetherLength * ownLength;
        const V3d& normal = agree ? together : own[i];
        const double length = agree ? togetherLength : ownLength;
        normals[i] = length > 0.0 ? V3f(normal / length) : V3f(0.f, 0.f, 1.f);
    }
    return normals;
}

} // namespace patina
