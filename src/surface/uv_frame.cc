#include "surface/uv_frame.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V2d;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

UvDerivatives uvDerivativesOf(const SurfaceMesh& surface, int triangle) {
    const V3i& uv = surface.triangleUvs[triangle];
    const V3i& corner = surface.triangles[triangle];
    const V2d e1 = V2d(surface.uvs[uv[1]]) - V2d(surface.uvs[uv[0]]);
    const V2d e2 = V2d(surface.uvs[uv[2]]) - V2d(surface.uvs[uv[0]]);
    const double determinant = e1.x * e2.y - e1.y * e2.x;
    UvDerivatives result;
    result.valid = determinant != 0.0 && std::isfinite(determinant);
    result.mirrored = determinant < 0.0;
    if (!result.valid)
        return result;
    const auto derive = [&](const std::vector<V3f>& values, V3d& du, V3d& dv) {
        const V3d p1 = V3d(values[corner[1]]) - V3d(values[corner[0]]);
        const V3d p2 = V3d(values[corner[2]]) - V3d(values[corner[0]]);
        du = (p1 * e2.y - p2 * e1.y) / determinant;
        dv = (p2 * e1.x - p1 * e2.x) / determinant;
    };
    derive(surface.positions, result.du, result.dv);
    derive(surface.normals, result.normalDu, result.normalDv);
    return result;
}

TangentFrames::TangentFrames(const SurfaceMesh& surface)
    : corners_(surface.triangles.size(), V3i(-1)), mirrored_(surface.triangles.size()) {
    // The corners at each vertex, one after the other.
    std::vector<int> first(surface.positions.size() + 1, 0);
    for (const V3i& triangle : surface.triangles)
        for (int c = 0; c < 3; ++c)
            ++first[triangle[c] + 1];
    for (std::size_t v = 1; v < first.size(); ++v)
        first[v] += first[v - 1];
    std::vector<int> codes(3 * surface.triangles.size()), filled(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (int c = 0; c < 3; ++c)
            codes[filled[surface.triangles[t][c]]++] = static_cast<int>(3 * t + c);

    std::vector<V3f> along(surface.triangles.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const UvDerivatives derivatives = uvDerivativesOf(surface, static_cast<int>(t));
        mirrored_[t] = derivatives.mirrored;
        const double length = derivatives.du.length();
        along[t] = length > 0.0 ? V3f(derivatives.du / length) : V3f(0.f);
    }
    for (std::size_t v = 0; v + 1 < first.size(); ++v)
        for (int i = first[v]; i < first[v + 1]; ++i) {
            const int triangle = codes[i] / 3, corner = codes[i] % 3;
            if (corners_[triangle][corner] >= 0)
                continue;
            V3d sum(0.0);
            const V3d normal(surface.normals[v]);
            const auto id = static_cast<int>(tangents_.size());
            for (int j = i; j < first[v + 1]; ++j) {
                const int other = codes[j] / 3, c = codes[j] % 3;
                if (surface.triangleUvs[other][c] != surface.triangleUvs[triangle][corner] ||
                    mirrored_[other] != mirrored_[triangle])
                    continue;
                corners_[other][c] = id;
                const V3d p(surface.positions[v]);
                const auto inPlane = [&](const V3d& vector) { return vector - normal * vector.dot(normal); };
                const V3d a = inPlane(V3d(surface.positions[surface.triangles[other][(c + 1) % 3]]) - p);
                const V3d b = inPlane(V3d(surface.positions[surface.triangles[other][(c + 2) % 3]]) - p);
                const V3d tangent = inPlane(V3d(along[other]));
                const double length = tangent.length();
                if (length > 1e-9)
                    sum += tangent * (std::atan2(a.cross(b).length(), a.dot(b)) / length);
            }
            tangents_.push_back(sum.length() > 0.0 ? V3f(sum.normalized()) : V3f(0.f));
        }
}

// Never along the normal; not unit.
V3d TangentFrames::tangentAt(const SurfacePoint& point, const V3d& normal) const {
    const V3i& corner = corners_[point.triangle];
    const double u = point.u, v = point.v;
    const V3d tangent =
        V3d(tangents_[corner[0]]) * (1.0 - u - v) + V3d(tangents_[corner[1]]) * u + V3d(tangents_[corner[2]]) * v;
    if ((tangent - normal * tangent.dot(normal)).length() > 1e-3)
        return tangent;
    const V3d axis = std::abs(normal.x) < 0.9 ? V3d(1, 0, 0) : V3d(0, 1, 0);
    return axis - normal * axis.dot(normal);
}

TangentFrames::Frame TangentFrames::at(const SurfacePoint& point, const V3d& normal) const {
    V3d tangent = tangentAt(point, normal);
    tangent -= normal * tangent.dot(normal);
    tangent.normalize();
    const V3d bitangent = normal.cross(tangent);
    return {tangent, mirrored_[point.triangle] ? -bitangent : bitangent, normal};
}

TangentFrames::Frame TangentFrames::interpolatedAt(const SurfacePoint& point, const V3d& normal) const {
    const V3d tangent = tangentAt(point, normal).normalized();
    const V3d bitangent = normal.cross(tangent).normalized();
    return {tangent, mirrored_[point.triangle] ? -bitangent : bitangent, normal};
}

} // namespace patina
