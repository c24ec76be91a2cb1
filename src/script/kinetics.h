#pragma once
// How fast metals corrode: ISO 9223's categories, ISO 9224's course over years, and how minerals swell.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patina {

struct Diagnostic;

/// Of one metal: D = r t^b, µm of metal after t years, along the tangent after 20 (ISO 9224:2012).
struct MetalKinetics {
    double exponent = 1.0; ///< b
    /// r by corrosivity category, "C1" … "CX", µm in the first year: least and most (ISO 9223:2012, table 2).
    std::map<std::string, std::pair<double, double>> firstYearUm;
};

struct Kinetics {
    std::map<std::string, MetalKinetics> metals;
    /// Thickness of dense mineral per thickness of the metal in it. Of materials that are mixtures 1 / sum (v / e) over
    /// their minerals' shares v of the volume; parts without metal, such as binder, count as room.
    std::map<std::string, double> expansion;
};

/// Reads data/weather/kinetics.toml, and what materials are mixed of from data/materials. What is wrong with the file is
/// added to `findings`. \throws RunError when it cannot be read
Kinetics readKinetics(const std::filesystem::path& dataFolder, std::vector<Diagnostic>& findings);
/// \throws ScriptError with every fault of the file, RunError when it cannot be read
Kinetics readKinetics(const std::filesystem::path& dataFolder);

/// Thickness of metal lost after some years, µm; 0 before the first. \param position  within the category's range:
/// 0 its least, 1 its most, between them geometrically (in C1, which begins at 0, along a line)
double metalLossUm(double exponent, const std::pair<double, double>& firstYearUm, double position, double years);

} // namespace patina
