#pragma once
// The GGX distribution of microfacets (Walter et al. 2007) with Smith's height-correlated shadowing (Heitz 2014).
// Local frame: z is the normal. All directions are unit vectors with z > 0.

#include "base/turns.h"

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>

namespace patina {

/// D(h), 1/sr.
inline float ggxDistribution(const Imath::V3f& half, float alpha) {
    const float a2 = alpha * alpha;
    // cos² (a² - 1) + 1 = cos² a² + sin²: without the cancellation where alpha is small.
    const float sine2 = half.x * half.x + half.y * half.y;
    const float t = half.z * half.z * a2 + sine2;
    return a2 / (3.14159265358979f * t * t);
}
/// Fraction of the microfacets that wo sees which are not hidden.
float smithMasking(const Imath::V3f& direction, float alpha);
/// G2(wo, wi) / (4 cos_o cos_i): all of a microfacet BRDF but D and F; finite towards grazing.
float smithVisibility(const Imath::V3f& wo, const Imath::V3f& wi, float alpha);
/// A normal in proportion to what wo = (x, y, z) sees of it (Heitz 2018), as (nx, ny, nz); its density is
/// smithMasking · D · (wo·h) / cos_o. In plain numbers, which loops over lanes can take many of.
inline void sampleVisibleNormal(float x, float y, float z, float alpha, float u1, float u2, float& nx, float& ny,
                                float& nz) {
    float sx = alpha * x, sy = alpha * y, sz = z; // stretched
    const float aside2 = sx * sx + sy * sy;
    const float scale = 1.f / std::sqrt(aside2 + sz * sz);
    sx *= scale;
    sy *= scale;
    sz *= scale;
    // Two axes across it: (-y, x, 0) made as long as 1, and the cross product with that.
    const float aside = std::sqrt(aside2) * scale, turned = 1.f / (aside > 1e-7f ? aside : 1.f);
    const float x1 = aside > 1e-7f ? -sy * turned : 1.f, y1 = aside > 1e-7f ? sx * turned : 0.f;
    const float acrossX = -sz * y1, acrossY = sz * x1, acrossZ = sx * y1 - sy * x1;
    const float radius = std::sqrt(u1);
    const CirclePoint direction = circlePoint(u2);
    const float p1 = radius * direction.cosine, left = 0.f < 1.f - p1 * p1 ? 1.f - p1 * p1 : 0.f;
    const float s = 0.5f * (1.f + sz);
    const float p2 = (1.f - s) * std::sqrt(left) + s * radius * direction.sine;
    const float rest = 0.f < left - p2 * p2 ? left - p2 * p2 : 0.f;
    const float p3 = std::sqrt(rest);
    const float upward = p2 * acrossZ + p3 * sz;
    const float hx = alpha * (p1 * x1 + p2 * acrossX + p3 * sx), hy = alpha * (p1 * y1 + p2 * acrossY + p3 * sy);
    const float hz = 1e-6f < upward ? upward : 1e-6f;
    const float inverse = 1.f / std::sqrt(hx * hx + hy * hy + hz * hz);
    nx = hx * inverse;
    ny = hy * inverse;
    nz = hz * inverse;
}
inline Imath::V3f sampleVisibleNormal(const Imath::V3f& wo, float alpha, float u1, float u2) {
    Imath::V3f n;
    sampleVisibleNormal(wo.x, wo.y, wo.z, alpha, u1, u2, n.x, n.y, n.z);
    return n;
}

/// Schlick's (1 - c)^5.
inline float schlickWeight(float cosine) {
    const float m = cosine < 1.f ? 1.f - cosine : 0.f;
    const float m2 = m * m;
    return m2 * m2 * m;
}

/// Directional albedo of a GGX lobe with F = (1 - s) c0 + s c1, s Schlick's weight: flat · c0 + rising · c1.
struct LobeAlbedo {
    float flat = 1.f;
    float rising = 0.f;
};
/// From a table (40 cosines by 32 alphas) that never says less than the integral, and at most some 0.01 more.
LobeAlbedo lobeAlbedo(float cosine, float alpha);
/// The same in two steps, for many of one width or at one angle. Places are in the table.
struct AlbedoPlace {
    int below = 0;
    float weight = 0.f;
};
AlbedoPlace albedoColumn(float cosine);
AlbedoPlace albedoRow(float alpha);
LobeAlbedo lobeAlbedo(const AlbedoPlace& column, const AlbedoPlace& row);
/// The table itself, for who looks up many at once: flat and rising of each place, one width after the other.
struct AlbedoGrid {
    const float* values;
    int columns; ///< cosines of a width
};
AlbedoGrid albedoGrid();
/// 2 ∫ albedo c dc.
LobeAlbedo meanLobeAlbedo(float alpha);
/// The least of flat + rising over all angles.
float leastLobeAlbedo(float alpha);

} // namespace patina
