#pragma once
// Absorption and scattering of a layer from measured reflectances: the inverse of Kubelka–Munk.

#include "optics/spectrum.h"

#include <limits>
#include <string>

namespace patina {

/// One measured reflectance spectrum of the material, 0…1, the interface with the air removed (bodyReflectance()).
struct MeasuredLayer {
    TabulatedSpectrum reflectance;
    TabulatedSpectrum backing; ///< reflectance of what lies below, 0…1; without samples: black
    /// Micrometres of solid; infinite: opaque, whatever is below.
    double thicknessUm = std::numeric_limits<double>::infinity();
    std::string name; ///< of the file, for messages
};

/// K and S in 1/µm at the wavelengths of the measurement.
struct FittedCoefficients {
    TabulatedSpectrum absorption;
    TabulatedSpectrum scattering;
};

/// An opaque sample and a scattering that is assumed, 1/µm: K = S (1 - R)² / (2 R).
/// \throws Error (exit 3) where the sample is black at some wavelength: any K is enough then
FittedCoefficients fitOpaque(const MeasuredLayer& opaque, double scatteringPerUm);

/// An opaque sample and one of known thickness over a known backing.
/// With a = (R∞ + 1 / R∞) / 2 the thin one's R over a backing g gives c = b coth(b S d) = (1 + g R - a (R + g)) / (R -
/// g). \throws Error (exit 3), naming file and wavelength, where no layer has these reflectances: the thin sample is as
/// bright as the opaque one, or as its backing
FittedCoefficients fitOpaqueAndThin(const MeasuredLayer& opaque, const MeasuredLayer& thin);

/// One layer of known thickness over two backings g1, g2. Kubelka's R = (1 - g (a - c)) / (a - g + c) is linear in a
/// and c = b coth(b S d): (R + g) a + (R - g) c = 1 + g R, twice. Then b = sqrt(a² - 1), S d = ln((c + b) / (c - b)) /
/// (2 b), K d = (a - 1) S d. \throws Error (exit 3), naming file and wavelength, where no layer has these reflectances,
/// or the backings are too alike
FittedCoefficients fitTwoBackings(const MeasuredLayer& first, const MeasuredLayer& second);

/// A reflectance measured in air, its first surface included, as the body's below the surface: the inverse of
/// Saunderson's correction for an interface of `refractiveIndex`; not below 0.
TabulatedSpectrum bodyReflectance(const TabulatedSpectrum& inAir, double refractiveIndex);

/// A material file (data/materials) with the coefficients; `source` says where they are from.
std::string materialFileOf(const std::string& name, const FittedCoefficients& fitted, double refractiveIndex,
                           const std::string& source);

} // namespace patina
