#pragma once
// Spectra on two fixed sets of wavelengths: bands, which pictures and maps are computed with, and 5 nm, the reference
// that the bands were chosen against (docs/optics.md has the measurement).

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace patina {

/// Number of bands. Sixteen single-precision numbers fill one cache line and whole vector registers.
constexpr int bandCount = 16;
constexpr double firstBandNm = 410.0;
constexpr double bandStepNm = 18.0;
/// Wavelength of a band, nanometres: 410, 428 … 680.
constexpr double bandWavelengthNm(int band) {
    return firstBandNm + bandStepNm * band;
}

/// The 5 nm reference set: 380, 385 … 780 nm.
constexpr int fineCount = 81;
constexpr double fineWavelengthNm(int sample) {
    return 380.0 + 5.0 * sample;
}

/// A quantity per band (reflectance, or 1/µm).
struct alignas(64) Spectrum {
    std::array<float, bandCount> values{};

    float& operator[](std::size_t band) { return values[band]; }
    float operator[](std::size_t band) const { return values[band]; }
    static Spectrum constant(float value);
};

/// A quantity every 5 nm.
using FineSpectrum = std::array<double, fineCount>;

/// The fine spectrum at the wavelengths of the bands, interpolated linearly.
Spectrum atBands(const FineSpectrum& fine);

/// A spectrum as it was measured: wavelengths in nanometres, strictly increasing, and one value for each.
struct TabulatedSpectrum {
    std::vector<double> wavelengthsNm;
    std::vector<double> values;

    /// Linear between samples, constant beyond the first and the last. There must be at least one sample.
    double at(double wavelengthNm) const;
    FineSpectrum fine() const;
};

} // namespace patina
