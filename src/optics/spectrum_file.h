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

/// What is wrong with a spectrum, and where.
struct SpectrumFault {
    std::string message;       ///< "" where nothing is wrong
    std::size_t sample = 0;    ///< index of the sample at fault
    bool inWavelength = false; ///< its wavelength is at fault, not its value
};
/// The first fault: shared with spectra written into material files.
SpectrumFault spectrumFault(const TabulatedSpectrum& spectrum, const SpectrumLimits& limits);

} // namespace patina
