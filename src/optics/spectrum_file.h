#pragma once
// Measured spectra as text: comment lines with '#', one line of column names, then numbers separated by commas.

#include "optics/spectrum.h"

#include <filesystem>
#include <string>

namespace patina {

/// What a column may hold.
struct SpectrumLimits {
    double least = 0.0;
    double most = 1.0;
    std::string quantity = "reflectance"; ///< for messages
};

/// Longest step between neighbouring wavelengths in the visible range; wider is a gap. Ellipsometry of metals comes in
/// steps of up to 89 nm (zinc).
constexpr double longestStepNm = 90.0;

/// Reads the column `wavelength_nm` and another one. Wavelengths must rise, leave no gap and span at least 440…690 nm.
/// \throws ScriptError with line and column of the first fault.
TabulatedSpectrum readSpectrumFile(const std::filesystem::path& path, const std::string& column,
                                   const SpectrumLimits& limits);

/// What is wrong with the samples from `first` on, or "": shared with spectra written into material files.
/// \param index  receives the sample at fault.
std::string spectrumFault(const TabulatedSpectrum& spectrum, const SpectrumLimits& limits, std::size_t& index);

} // namespace patina
