#pragma once
// Kubelka–Munk in forms that hold everywhere: K = 0, S = 0, d = 0, d = infinity, in single precision too.
// K and S are absorption and backscattering per micrometre, d is in micrometres.

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

/// Reflectance over black and transmittance of one layer; both 0…1, R + T <= 1.
template <typename Real>
struct LayerLight {
    Real reflectance = 0;
    Real transmittance = 1;
};

/// (1 - exp(-x)) / x, which is 1 at 0 and 0 at infinity.
template <typename Real>
Real oneMinusExpOverX(Real x) {
    if (x < Real(1e-3)) {
        return Real(1) - x * (Real(0.5) - x * (Real(1) / 6 - x / 24));
    }
    return -std::expm1(-x) / x;
}

/// Reflectance and transmittance of a layer (paper §4.1; the closed forms of Kubelka 1948).
/// With kappa = sqrt(K (K + 2 S)), e = exp(-kappa d) and g = d (1 - exp(-2 kappa d)) / (2 kappa d), dividing sinh and
/// cosh of the printed forms by exp(kappa d) leaves R = S g / D, T = e / D, D = (S + K) g + (1 + e²) / 2: nothing
/// overflows and nothing cancels. An infinitely thick layer that neither absorbs nor scatters is taken as clear.
template <typename Real>
LayerLight<Real> kubelkaMunkLayer(Real absorption, Real scattering, Real thickness) {
    const Real kappa = std::sqrt(absorption * (absorption + 2 * scattering));
    if (!(thickness > 0) || (absorption == 0 && scattering == 0)) {
        return {Real(0), Real(1)};
    }
    if (std::isinf(thickness)) {
        return {kappa == 0 ? Real(1) : scattering / (scattering + absorption + kappa), Real(0)};
    }
    const Real tau = kappa * thickness;
    const Real e = std::exp(-tau);
    const Real g = thickness * oneMinusExpOverX(2 * tau);
    const Real divisor = (scattering + absorption) * g + (1 + e * e) / 2;
    return {scattering * g / divisor, e / divisor};
}

/// Reflectance of an infinitely thick layer: the root below 1 (the paper prints the one above 1).
template <typename Real>
Real infiniteReflectance(Real absorption, Real scattering) {
    if (absorption == 0) {
        return scattering > 0 ? Real(1) : Real(0);
    }
    return scattering / (scattering + absorption + std::sqrt(absorption * (absorption + 2 * scattering)));
}

/// K/S of an opaque sample from its reflectance, (1 - R)² / (2 R); infinite for 0.
template <typename Real>
Real absorptionOverScattering(Real infiniteReflectance) {
    const Real loss = 1 - infiniteReflectance;
    return loss * loss / (2 * infiniteReflectance);
}

/// The sum of a series of interreflections, T / (1 - R g), where R + T <= 1 and g <= 1: so it is at most 1, and where
/// rounding (or a white layer without end over white) leaves nothing of the divisor, T stands in for it.
template <typename Real>
Real interreflected(Real transmittance, Real reflectance, Real other) {
    return transmittance > 0 ? transmittance / std::max(1 - reflectance * other, transmittance) : Real(0);
}

/// Reflectance of a layer over an opaque background, all interreflections included (paper §4.2). \param background  0…1
template <typename Real>
Real overBackground(const LayerLight<Real>& layer, Real background) {
    return layer.reflectance +
           layer.transmittance * background * interreflected(layer.transmittance, layer.reflectance, background);
}

/// A stack of layers: reflectance differs from above and from below, transmittance does not (Kubelka 1954).
template <typename Real>
struct StackLight {
    Real reflectanceAbove = 0;
    Real reflectanceBelow = 0;
    Real transmittance = 1;

    StackLight() = default;
    StackLight(const LayerLight<Real>& layer)
        : reflectanceAbove(layer.reflectance), reflectanceBelow(layer.reflectance), transmittance(layer.transmittance) {
    }
};

/// The stack `top` lying on the stack `bottom`. Associative.
template <typename Real>
StackLight<Real> onTop(const StackLight<Real>& top, const StackLight<Real>& bottom) {
    const Real down = interreflected(top.transmittance, top.reflectanceBelow, bottom.reflectanceAbove);
    const Real up = interreflected(bottom.transmittance, bottom.reflectanceAbove, top.reflectanceBelow);
    StackLight<Real> result;
    result.reflectanceAbove = top.reflectanceAbove + top.transmittance * bottom.reflectanceAbove * down;
    result.reflectanceBelow = bottom.reflectanceBelow + bottom.transmittance * top.reflectanceBelow * up;
    result.transmittance = bottom.transmittance * down;
    return result;
}

/// What a layer's two coefficients are, times its thickness: K d and S d.
template <typename Real>
struct OpticalThickness {
    Real absorption = 0;
    Real scattering = 0;
};

/// K d and S d of a layer from its reflectance over black and over a background.
/// a = (R + (R0 - R + Rg) / (R0 Rg)) / 2, S d = atanh(b R0 / (1 - a R0)) / b, K d = (a - 1) S d.
/// \param overBlack, overBacking  in (0, 1), overBacking >= overBlack; \param backing  in (0, 1].
/// NaN where no layer has these reflectances. Computed in double: a² - 1 takes half the digits of a float.
template <typename Real>
OpticalThickness<Real> fromTwoBackings(Real overBlack, Real overBacking, Real backing) {
    const double r0 = overBlack, r = overBacking, g = backing;
    const double a = (r + (r0 - r + g) / (r0 * g)) / 2;
    const double b = std::sqrt(a * a - 1);
    const double scattering = b > 0 ? std::atanh(b * r0 / (1 - a * r0)) / b : r0 / (1 - r0);
    return {static_cast<Real>((a - 1) * scattering), static_cast<Real>(scattering)};
}

/// S d of a layer from its reflectance over black and the reflectance of an opaque sample of the same material
/// (ISO 9416, TAPPI T 1214): S d = R / (1 - R²) ln(R (1 - R0 R) / (R - R0)), R the opaque one; 0 <= R0 < R < 1.
template <typename Real>
OpticalThickness<Real> fromOpaqueAndThin(Real opaque, Real overBlack) {
    const double infinite = opaque, r0 = overBlack;
    const double scattering =
        infinite / (1 - infinite * infinite) * std::log(infinite * (1 - r0 * infinite) / (infinite - r0));
    return {static_cast<Real>(absorptionOverScattering(infinite) * scattering), static_cast<Real>(scattering)};
}

} // namespace patina
