#pragma once
// From spectra to colours: CIE 1931 2° observer, illuminant D65, linear Rec.709 (the primaries of sRGB), ACEScg,
// CIELAB.

#include "optics/spectrum.h"

#include <Imath/ImathVec.h>

#include <array>
#include <string>

namespace patina {

/// Spaces of linear light that results may be in.
enum class ColourSpace {
    rec709, ///< primaries and white (D65) of sRGB and Rec.709
    acescg, ///< AP1 primaries, the ACES white; D65 is adapted to it by Bradford's matrix
};

/// Number of samples of the CIE tables: 360, 365 … 830 nm.
constexpr int cieCount = 95;

/// Colour matching functions and daylight every 5 nm, 360 … 830 nm.
/// CIE 015:2018 tables; data/cie holds the same numbers with their source.
struct CieTables {
    std::array<double, cieCount> x, y, z; ///< CIE 1931 2° observer
    std::array<double, cieCount> d65;     ///< relative spectral power
};
const CieTables& cieTables();

/// XYZ of a reflectance under D65 by summation over 5 nm; the perfect diffuser has Y = 1. Beyond 380 and 780 nm the
/// reflectance goes on as it ends.
Imath::V3d xyzFromReflectance(const FineSpectrum& reflectance);
/// The same from bands: the spectrum is taken as a cubic through neighbouring bands, constant beyond the ends,
/// and integrated against the 5 nm tables. A constant spectrum gives the same result as the sum over 5 nm.
Imath::V3d xyzFromReflectance(const Spectrum& reflectance);
/// XYZ of the perfect diffuser under D65, Y = 1.
Imath::V3d whiteD65();

/// Weight of each band in each channel of linear Rec.709; each channel's weights sum to 1.
const std::array<Spectrum, 3>& rec709BandWeights();
/// The same for a colour space.
std::array<Spectrum, 3> bandWeights(ColourSpace space);

/// Not clipped: colours outside the gamut have components below 0 or above 1.
Imath::V3d linearRec709(const FineSpectrum& reflectance);
Imath::V3d linearRec709(const Spectrum& reflectance);

Imath::V3d linearRec709FromXyz(const Imath::V3d& xyz);
Imath::V3d xyzFromLinearRec709(const Imath::V3d& rgb);
/// ACEScg, adapted from D65 to the ACES white by Bradford's matrix; white is (1, 1, 1).
Imath::V3d acescgFromXyz(const Imath::V3d& xyz);
/// Back to XYZ under D65.
Imath::V3d xyzFromAcescg(const Imath::V3d& rgb);
Imath::V3d linearFromXyz(const Imath::V3d& xyz, ColourSpace space);
Imath::V3d xyzFromLinear(const Imath::V3d& rgb, ColourSpace space);

/// CIELAB relative to D65.
Imath::V3d labFromXyz(const Imath::V3d& xyz);
/// Colour difference CIEDE2000 (Sharma, Wu, Dalal 2005; all weights 1).
double deltaE2000(const Imath::V3d& labA, const Imath::V3d& labB);

/// The sRGB transfer curve of one linear component; clipped to 0…1.
double encodeSrgb(double linear);
double decodeSrgb(double encoded);
/// "#rrggbb" of a linear Rec.709 colour, clipped.
std::string srgbHex(const Imath::V3d& linearRgb);

} // namespace patina
