#include "optics/colour.h"

#include <Imath/ImathMatrix.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

using Imath::V3d;

// Row-major matrices times column vectors (Imath's own convention is row vectors).
struct Matrix3 {
    double m[3][3];
    V3d operator*(const V3d& v) const {
        return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
    }
};

Matrix3 inverse(const Matrix3& a) {
    const auto& m = a.m;
    const double c00 = m[1][1] * m[2][2] - m[1][2] * m[2][1];
    const double c01 = m[1][2] * m[2][0] - m[1][0] * m[2][2];
    const double c02 = m[1][0] * m[2][1] - m[1][1] * m[2][0];
    const double scale = 1.0 / (m[0][0] * c00 + m[0][1] * c01 + m[0][2] * c02);
    return {{{c00 * scale, (m[0][2] * m[2][1] - m[0][1] * m[2][2]) * scale,
              (m[0][1] * m[1][2] - m[0][2] * m[1][1]) * scale},
             {c01 * scale, (m[0][0] * m[2][2] - m[0][2] * m[2][0]) * scale,
              (m[0][2] * m[1][0] - m[0][0] * m[1][2]) * scale},
             {c02 * scale, (m[0][1] * m[2][0] - m[0][0] * m[2][1]) * scale,
              (m[0][0] * m[1][1] - m[0][1] * m[1][0]) * scale}}};
}

/// XYZ of a chromaticity with Y = 1.
V3d xyzOfChromaticity(double x, double y) {
    return {x / y, 1.0, (1.0 - x - y) / y};
}

Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    Matrix3 result{};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            for (int i = 0; i < 3; ++i) {
                result.m[row][column] += a.m[row][i] * b.m[i][column];
            }
        }
    }
    return result;
}

/// RGB to XYZ of three primaries, scaled so that (1, 1, 1) gives `white` exactly.
Matrix3 fromPrimaries(const V3d& red, const V3d& green, const V3d& blue, const V3d& white) {
    Matrix3 result = {{{red.x, green.x, blue.x}, {red.y, green.y, blue.y}, {red.z, green.z, blue.z}}};
    const V3d amounts = inverse(result) * white;
    for (auto& row : result.m) {
        row[0] *= amounts.x;
        row[1] *= amounts.y;
        row[2] *= amounts.z;
    }
    return result;
}

// The white is the one that the tables give, so grey stays grey.
Matrix3 rec709ToXyz() {
    return fromPrimaries(xyzOfChromaticity(0.64, 0.33), xyzOfChromaticity(0.30, 0.60), xyzOfChromaticity(0.15, 0.06),
                         whiteD65());
}

// AP1 (SMPTE ST 2065-1's white, S-2014-004's primaries) gives XYZ under the ACES white; Bradford's matrix turns that
// to D65 by scaling cone-like responses by the ratio of the whites.
Matrix3 acescgToXyz() {
    const V3d acesWhite = xyzOfChromaticity(0.32168, 0.33767);
    const Matrix3 ap1 = fromPrimaries(xyzOfChromaticity(0.713, 0.293), xyzOfChromaticity(0.165, 0.830),
                                      xyzOfChromaticity(0.128, 0.044), acesWhite);
    const Matrix3 bradford = {{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
    const V3d from = bradford * acesWhite;
    const V3d to = bradford * whiteD65();
    const Matrix3 scale = {{{to.x / from.x, 0, 0}, {0, to.y / from.y, 0}, {0, 0, to.z / from.z}}};
    return inverse(bradford) * scale * bradford * ap1;
}

/// Both directions of one colour space.
struct SpaceMatrices {
    Matrix3 toXyz, fromXyz;
    explicit SpaceMatrices(const Matrix3& matrix) : toXyz(matrix), fromXyz(inverse(matrix)) {}
};

const SpaceMatrices& matrices(ColourSpace space) {
    static const SpaceMatrices rec709(rec709ToXyz());
    static const SpaceMatrices acescg(acescgToXyz());
    return space == ColourSpace::acescg ? acescg : rec709;
}

using FineWeights = std::array<V3d, fineCount>;

/// Per 5 nm sample: observer times D65, normalised to Y = 1 for the perfect diffuser.
FineWeights computeFineWeights() {
    const CieTables& cie = cieTables();
    double sum = 0.0;
    for (int i = 0; i < cieCount; ++i) {
        sum += cie.y[i] * cie.d65[i];
    }
    constexpr int offset = 4; // 380 nm among the CIE samples
    FineWeights weights;
    weights.fill(V3d(0.0));
    for (int i = 0; i < cieCount; ++i) {
        weights[std::clamp(i - offset, 0, fineCount - 1)] += V3d(cie.x[i], cie.y[i], cie.z[i]) * (cie.d65[i] / sum);
    }
    return weights;
}

const FineWeights& fineWeights() {
    static const FineWeights weights = computeFineWeights();
    return weights;
}

using BandWeights = std::array<V3d, bandCount>;

// A spectrum known at the bands is read at 5 nm through the cubic of the four nearest bands (Lagrange). The weight
// of a band is what its basis function collects. Four points always sum to 1, so constants are exact.
BandWeights computeBandWeights() {
    BandWeights weights;
    weights.fill(V3d(0.0));
    for (int i = 0; i < fineCount; ++i) {
        const double position =
            std::clamp((fineWavelengthNm(i) - firstBandNm) / bandStepNm, 0.0, static_cast<double>(bandCount - 1));
        const int first = std::clamp(static_cast<int>(position) - 1, 0, bandCount - 4);
        for (int a = 0; a < 4; ++a) {
            double basis = 1.0;
            for (int b = 0; b < 4; ++b) {
                if (b != a) {
                    basis *= (position - (first + b)) / (a - b);
                }
            }
            weights[first + a] += fineWeights()[i] * basis;
        }
    }
    return weights;
}

const BandWeights& xyzBandWeights() {
    static const BandWeights weights = computeBandWeights();
    return weights;
}

double labCurve(double t) {
    constexpr double knee = 6.0 / 29.0;
    return t > knee * knee * knee ? std::cbrt(t) : t / (3.0 * knee * knee) + 4.0 / 29.0;
}

} // namespace

V3d xyzFromReflectance(const FineSpectrum& reflectance) {
    V3d xyz(0.0);
    for (int i = 0; i < fineCount; ++i) {
        xyz += fineWeights()[i] * reflectance[i];
    }
    return xyz;
}

V3d xyzFromReflectance(const Spectrum& reflectance) {
    V3d xyz(0.0);
    for (int band = 0; band < bandCount; ++band) {
        xyz += xyzBandWeights()[band] * static_cast<double>(reflectance[band]);
    }
    return xyz;
}

V3d whiteD65() {
    FineSpectrum one;
    one.fill(1.0);
    return xyzFromReflectance(one);
}

std::array<Spectrum, 3> bandWeights(ColourSpace space) {
    std::array<Spectrum, 3> result;
    for (int band = 0; band < bandCount; ++band) {
        const V3d rgb = linearFromXyz(xyzBandWeights()[band], space);
        for (int channel = 0; channel < 3; ++channel) {
            result[channel][band] = static_cast<float>(rgb[channel]);
        }
    }
    return result;
}

const std::array<Spectrum, 3>& rec709BandWeights() {
    static const std::array<Spectrum, 3> weights = bandWeights(ColourSpace::rec709);
    return weights;
}

V3d linearRec709(const FineSpectrum& reflectance) {
    return linearRec709FromXyz(xyzFromReflectance(reflectance));
}
V3d linearRec709(const Spectrum& reflectance) {
    return linearRec709FromXyz(xyzFromReflectance(reflectance));
}

V3d linearFromXyz(const V3d& xyz, ColourSpace space) {
    return matrices(space).fromXyz * xyz;
}
V3d xyzFromLinear(const V3d& rgb, ColourSpace space) {
    return matrices(space).toXyz * rgb;
}
V3d linearRec709FromXyz(const V3d& xyz) {
    return linearFromXyz(xyz, ColourSpace::rec709);
}
V3d xyzFromLinearRec709(const V3d& rgb) {
    return xyzFromLinear(rgb, ColourSpace::rec709);
}
V3d acescgFromXyz(const V3d& xyz) {
    return linearFromXyz(xyz, ColourSpace::acescg);
}
V3d xyzFromAcescg(const V3d& rgb) {
    return xyzFromLinear(rgb, ColourSpace::acescg);
}

V3d labFromXyz(const V3d& xyz) {
    static const V3d white = whiteD65();
    const double fx = labCurve(xyz.x / white.x);
    const double fy = labCurve(xyz.y / white.y);
    const double fz = labCurve(xyz.z / white.z);
    return {116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)};
}

double deltaE2000(const V3d& labA, const V3d& labB) {
    constexpr double pi = 3.14159265358979323846;
    constexpr double degree = pi / 180.0;
    constexpr double power25to7 = 6103515625.0;
    const auto power7 = [](double v) { return v * v * v * v * v * v * v; };

    const double meanChroma = 0.5 * (std::hypot(labA.y, labA.z) + std::hypot(labB.y, labB.z));
    const double g = 0.5 * (1.0 - std::sqrt(power7(meanChroma) / (power7(meanChroma) + power25to7)));
    const double a1 = labA.y * (1.0 + g);
    const double a2 = labB.y * (1.0 + g);
    const double chroma1 = std::hypot(a1, labA.z);
    const double chroma2 = std::hypot(a2, labB.z);
    const auto hueOf = [](double a, double b) {
        if (a == 0.0 && b == 0.0) {
            return 0.0;
        }
        const double hue = std::atan2(b, a);
        return hue < 0.0 ? hue + 2.0 * pi : hue;
    };
    const double hue1 = hueOf(a1, labA.z);
    const double hue2 = hueOf(a2, labB.z);

    double hueDifference = hue2 - hue1;
    double hueMean = hue1 + hue2;
    if (chroma1 * chroma2 == 0.0) {
        hueDifference = 0.0;
    } else if (std::abs(hue2 - hue1) > pi) {
        hueDifference += hueDifference > 0.0 ? -2.0 * pi : 2.0 * pi;
        hueMean = 0.5 * (hueMean < 2.0 * pi ? hueMean + 2.0 * pi : hueMean - 2.0 * pi);
    } else {
        hueMean *= 0.5;
    }
    const double dL = labB.x - labA.x;
    const double dC = chroma2 - chroma1;
    const double dH = 2.0 * std::sqrt(chroma1 * chroma2) * std::sin(0.5 * hueDifference);

    const double lightness = 0.5 * (labA.x + labB.x) - 50.0;
    const double chroma = 0.5 * (chroma1 + chroma2);
    const double t = 1.0 - 0.17 * std::cos(hueMean - 30.0 * degree) + 0.24 * std::cos(2.0 * hueMean) +
                     0.32 * std::cos(3.0 * hueMean + 6.0 * degree) - 0.20 * std::cos(4.0 * hueMean - 63.0 * degree);
    const double sL = 1.0 + 0.015 * lightness * lightness / std::sqrt(20.0 + lightness * lightness);
    const double sC = 1.0 + 0.045 * chroma;
    const double sH = 1.0 + 0.015 * chroma * t;
    const double turn = (hueMean / degree - 275.0) / 25.0;
    const double rotation = -std::sin(60.0 * degree * std::exp(-turn * turn)) * 2.0 *
                            std::sqrt(power7(chroma) / (power7(chroma) + power25to7));
    const double l = dL / sL;
    const double c = dC / sC;
    const double h = dH / sH;
    return std::sqrt(std::max(0.0, l * l + c * c + h * h + rotation * c * h));
}

double encodeSrgb(double linear) {
    const double v = std::clamp(linear, 0.0, 1.0);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

double decodeSrgb(double encoded) {
    const double v = std::clamp(encoded, 0.0, 1.0);
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

std::string srgbHex(const V3d& linearRgb) {
    const auto byte = [](double v) { return static_cast<int>(std::lround(255.0 * encodeSrgb(v))); };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(linearRgb.x), byte(linearRgb.y), byte(linearRgb.z));
}

} // namespace patina
