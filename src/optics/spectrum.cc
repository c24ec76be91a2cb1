#include "optics/spectrum.h"

#include <algorithm>

namespace patina {

Spectrum Spectrum::constant(float value) {
    Spectrum result;
    result.values.fill(value);
    return result;
}

Spectrum atBands(const FineSpectrum& fine) {
    Spectrum result;
    for (int band = 0; band < bandCount; ++band) {
        const double position = (bandWavelengthNm(band) - fineWavelengthNm(0)) / 5.0;
        const int below = std::clamp(static_cast<int>(position), 0, fineCount - 2);
        const double weight = position - below;
        result[band] = static_cast<float>((1.0 - weight) * fine[below] + weight * fine[below + 1]);
    }
    return result;
}

double TabulatedSpectrum::at(double wavelengthNm) const {
    const auto above = std::upper_bound(wavelengthsNm.begin(), wavelengthsNm.end(), wavelengthNm);
    if (above == wavelengthsNm.begin()) {
        return values.front();
    }
    if (above == wavelengthsNm.end()) {
        return values.back();
    }
    const auto index = static_cast<std::size_t>(above - wavelengthsNm.begin());
    const double below = wavelengthsNm[index - 1];
    const double weight = (wavelengthNm - below) / (wavelengthsNm[index] - below);
    return (1.0 - weight) * values[index - 1] + weight * values[index];
}

FineSpectrum TabulatedSpectrum::fine() const {
    FineSpectrum result{};
    for (int sample = 0; sample < fineCount; ++sample) {
        result[sample] = at(fineWavelengthNm(sample));
    }
    return result;
}

} // namespace patina
