#pragma once
// Orthonormal frames: of the world's up axis, and of a surface point.

#include <Imath/ImathVec.h>

#include <cmath>

namespace patina {

/// The axis that points away from the ground.
enum class UpAxis { y, z };

/// A right-handed orthonormal frame; `local` vectors have their z along `normal`.
struct Frame {
    Imath::V3f tangent{1, 0, 0};
    Imath::V3f bitangent{0, 1, 0};
    Imath::V3f normal{0, 0, 1};

    Imath::V3f toLocal(const Imath::V3f& world) const { return {world ^ tangent, world ^ bitangent, world ^ normal}; }
    Imath::V3f toWorld(const Imath::V3f& local) const {
        return tangent * local.x + bitangent * local.y + normal * local.z;
    }
};

/// A vector that is not 0 and not tiny, made as long as 1.
inline Imath::V3f unit(const Imath::V3f& v) {
    return v * (1.f / std::sqrt(v.length2()));
}

/// A frame around a unit normal, without a branch that jumps except at normal.z = 0 (Duff et al. 2017, "Building an
/// Orthonormal Basis, Revisited", JCGT 6(1)).
inline Frame frameAround(const Imath::V3f& normal) {
    const float sign = std::copysign(1.f, normal.z);
    const float a = -1.f / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    return {{1.f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
            {b, sign + normal.y * normal.y * a, -normal.y},
            normal};
}

/// The frame of a set: `normal` is up, `-bitangent` the way to the viewer who stands at azimuth 0 (the front of a
/// model: -y where z is up, +z where y is up), turned about up by `azimuthDegrees`, counter-clockwise seen from above.
inline Frame uprightFrame(UpAxis up, float azimuthDegrees = 0.f) {
    const Frame standing = up == UpAxis::z ? Frame{} : Frame{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
    const float angle = azimuthDegrees * float(M_PI) / 180.f;
    const Imath::V3f tangent = standing.tangent * std::cos(angle) + standing.bitangent * std::sin(angle);
    const Imath::V3f bitangent = standing.bitangent * std::cos(angle) - standing.tangent * std::sin(angle);
    return {tangent, bitangent, standing.normal};
}

} // namespace patina
