#pragma once
// The GGX distribution of microfacets (Walter et al. 2007) with Smith's height-correlated shadowing (Heitz 2014).
// Local frame: z is the normal. All directions are unit vectors with z > 0.

#include <Imath/ImathVec.h>

namespace patina {

/// D(h), 1/sr.
float ggxDistribution(const Imath::V3f& half, float alpha);
/// Fraction of the microfacets that wo sees which are not hidden.
float smithMasking(const Imath::V3f& direction, float alpha);
/// G2(wo, wi) / (4 cos_o cos_i): all of a microfacet BRDF but D and F; finite towards grazing.
float smithVisibility(const Imath::V3f& wo, const Imath::V3f& wi, float alpha);
/// A normal in proportion to what wo sees of it (Heitz 2018); its density is smithMasking · D · (wo·h) / cos_o.
Imath::V3f sampleVisibleNormal(const Imath::V3f& wo, float alpha, float u1, float u2);

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
/// 2 ∫ albedo c dc.
LobeAlbedo meanLobeAlbedo(float alpha);
/// The least of flat + rising over all angles.
float leastLobeAlbedo(float alpha);

} // namespace patina
