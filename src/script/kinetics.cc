#include "script/kinetics.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "optics/toml_reader.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>

namespace patina {

namespace {

namespace fs = std::filesystem;

constexpr double isoYears = 20.0; // of the power law; then the rate stays

// Of a mixture that holds minerals of the table. The material's file is read by the library as well, which tells its
// faults.
std::optional<double> expansionOfMixture(const fs::path& file, const std::map<std::string, double>& minerals) {
    double metal = 0.0; // thickness of metal in one of the mixture
    try {
        const toml::table table = toml::parse(readTextFile(file.string()));
        if (const toml::array* parts = table["mixture"]["parts"].as_array())
            for (const toml::node& part : *parts)
                if (const toml::table* one = part.as_table()) {
                    const auto mineral = minerals.find((*one)["material"].value_or(std::string()));
                    if (mineral != minerals.end())
                        metal += (*one)["volume"].value_or(0.0) / mineral->second;
                }
    } catch (const toml::parse_error&) {
        return std::nullopt;
    }
    return metal > 0.0 ? std::optional<double>(1.0 / metal) : std::nullopt;
}

MetalKinetics readMetal(TomlReader& reader, const toml::table& table, std::map<std::string, double>& expansion) {
    MetalKinetics metal;
    reader.allowOnly(table, {"exponent", "first_year_um", "expansion"});
    if (!table.get("exponent"))
        reader.error(reader.placeOf(table), "'exponent' is missing");
    metal.exponent = reader.number(table, "exponent", 0.0, 2.0).value_or(0.0);
    if (const toml::table* years = reader.subtable(table, "first_year_um"))
        for (const auto& entry : *years) {
            const std::string category(entry.first.str());
            std::vector<double> range;
            if (!reader.numbers(*years, category.c_str(), range, nullptr))
                continue;
            if (range.size() != 2 || !(range[0] >= 0.0) || !(range[1] >= range[0]) || range[1] > 1e5)
                reader.error(entry.second,
                             fmt::format("'{}' must be two numbers, the smaller one first, 0 to 100000", category));
            else
                metal.firstYearUm[category] = {range[0], range[1]};
        }
    if (table.get("expansion"))
        if (const toml::table* minerals = reader.subtable(table, "expansion"))
            for (const auto& entry : *minerals) {
                const std::string mineral(entry.first.str());
                if (const auto value = reader.number(*minerals, mineral.c_str(), 0.1, 100.0))
                    expansion[mineral] = *value;
            }
    return metal;
}

} // namespace

Kinetics readKinetics(const fs::path& dataFolder, std::vector<Diagnostic>& findings) {
    const fs::path path = dataFolder / "weather" / "kinetics.toml";
    TomlReader reader(path, path.parent_path(), findings);
    const std::string text = readTextFile(path.string());
    reader.setText(text);
    toml::table table;
    try {
        table = toml::parse(text, path.string());
    } catch (const toml::parse_error& error) {
        reader.error(reader.placeOf(error.source().begin), std::string(error.description()));
        return {};
    }
    Kinetics out;
    for (const auto& entry : table) {
        const std::string name(entry.first.str());
        if (const toml::table* metal = entry.second.as_table())
            out.metals[name] = readMetal(reader, *metal, out.expansion);
        else
            reader.error(entry.second, fmt::format("'{}' must be the table of a metal", name));
    }
    const std::map<std::string, double> minerals = out.expansion;
    std::error_code none;
    for (const auto& file : fs::directory_iterator(dataFolder / "materials", none)) {
        const std::string name = file.path().stem().string();
        if (file.path().extension() != ".toml" || minerals.count(name) > 0)
            continue;
        if (const auto mixture = expansionOfMixture(file.path(), minerals))
            out.expansion[name] = *mixture;
    }
    return out;
}

Kinetics readKinetics(const fs::path& dataFolder) {
    std::vector<Diagnostic> findings;
    Kinetics out = readKinetics(dataFolder, findings);
    if (!findings.empty())
        throw ScriptError(findings);
    return out;
}

double metalLossUm(double exponent, const std::pair<double, double>& firstYearUm, double position, double years) {
    if (!(years > 0.0))
        return 0.0;
    const auto [least, most] = firstYearUm;
    // C1 begins at 0, between which and anything there is no geometric mean.
    const double first = least > 0.0 ? least * std::pow(most / least, position) : most * position;
    if (years <= isoYears)
        return first * std::pow(years, exponent);
    return first * (std::pow(isoYears, exponent) + exponent * std::pow(isoYears, exponent - 1.0) * (years - isoYears));
}

} // namespace patina
