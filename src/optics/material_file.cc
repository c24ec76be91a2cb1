#include "optics/material_file.h"

#include "base/atomic_file.h"
#include "base/names.h"
#include "optics/fresnel.h"
#include "optics/kubelka_munk.h"
#include "optics/spectrum_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr double pi = 3.14159265358979323846;
/// Below this an opaque layer is black; K/S would grow without bound.
constexpr double blackest = 1e-3;

/// Reads values out of tables, and notes what is wrong with its place.
class Reader {
  public:
    Reader(std::filesystem::path path, std::filesystem::path dataFolder, std::vector<Diagnostic>& findings)
        : path_(std::move(path)), dataFolder_(std::move(dataFolder)), findings_(findings) {}

    const std::filesystem::path& path() const { return path_; }
    const std::filesystem::path& dataFolder() const { return dataFolder_; }
    void setText(const std::string& text) {
        std::size_t begin = 0;
        while (begin <= text.size()) {
            const std::size_t end = std::min(text.find('\n', begin), text.size());
            lines_.push_back(text.substr(begin, end - begin));
            begin = end + 1;
        }
    }

    SourcePlace placeOf(const toml::source_position& position) const {
        return {path_.string(), static_cast<int>(position.line), static_cast<int>(position.column)};
    }
    SourcePlace placeOf(const toml::node& node) const { return placeOf(node.source().begin); }

    void error(const SourcePlace& place, std::string message, std::string remedy = {}) {
        Diagnostic finding;
        finding.place = place;
        finding.message = std::move(message);
        finding.remedy = std::move(remedy);
        if (place.line > 0 && static_cast<std::size_t>(place.line) <= lines_.size()) {
            finding.sourceLine = lines_[place.line - 1];
        }
        findings_.push_back(finding);
    }
    void error(const toml::node& node, std::string message, std::string remedy = {}) {
        error(placeOf(node), std::move(message), std::move(remedy));
    }
    void append(const std::vector<Diagnostic>& findings) {
        findings_.insert(findings_.end(), findings.begin(), findings.end());
    }

    void allowOnly(const toml::table& table, const std::vector<std::string>& keys) {
        for (const auto& [key, value] : table) {
            const std::string name(key.str());
            if (std::find(keys.begin(), keys.end(), name) == keys.end()) {
                std::string remedy = didYouMean(name, keys);
                if (remedy.empty()) {
                    remedy = fmt::format("known keys: {}", fmt::join(keys, ", "));
                }
                error(placeOf(key.source().begin), fmt::format("unknown key '{}'", name), remedy);
            }
        }
    }

    std::optional<double> number(const toml::table& table, const char* key, double least, double most) {
        const toml::node* node = table.get(key);
        if (!node) {
            return std::nullopt;
        }
        const std::optional<double> value = node->value<double>();
        if (!node->is_number() || !value || !std::isfinite(*value)) {
            error(*node, fmt::format("'{}' must be a number", key));
            return std::nullopt;
        }
        if (*value < least || *value > most) {
            error(*node, fmt::format("'{}' is {}, outside {}…{}", key, *value, least, most));
            return std::nullopt;
        }
        return value;
    }

    std::string word(const toml::table& table, const char* key, std::string fallback = {}) {
        const toml::node* node = table.get(key);
        if (!node) {
            return fallback;
        }
        if (const auto* text = node->as_string()) {
            return text->get();
        }
        error(*node, fmt::format("'{}' must be text in quotes", key));
        return fallback;
    }

    bool truth(const toml::table& table, const char* key) {
        const toml::node* node = table.get(key);
        if (!node) {
            return false;
        }
        if (const auto* value = node->as_boolean()) {
            return value->get();
        }
        error(*node, fmt::format("'{}' must be true or false", key));
        return false;
    }

    const toml::table* subtable(const toml::table& table, const char* key) {
        const toml::node* node = table.get(key);
        if (!node) {
            return nullptr;
        }
        if (const toml::table* found = node->as_table()) {
            return found;
        }
        error(*node, fmt::format("'{}' must be a table", key));
        return nullptr;
    }

    /// Factor to 1/µm of the table's `unit`.
    double perMicrometre(const toml::table& table) {
        const toml::node* node = table.get("unit");
        const std::string unit = word(table, "unit");
        if (unit == "1/um" || unit == "1/µm") {
            return 1.0;
        }
        if (unit == "1/mm") {
            return 1e-3;
        }
        if (unit == "1/cm") {
            return 1e-4;
        }
        if (node && !node->is_string()) {
            return 1.0; // reported by word()
        }
        const SourcePlace place = node ? placeOf(*node) : placeOf(table);
        error(place, node ? fmt::format("unknown unit '{}'", unit) : std::string("a unit is missing"),
              "expected unit = \"1/um\", \"1/mm\" or \"1/cm\"");
        return 1.0;
    }

    /// `wavelengths_nm` and `values`, or `file` and `column`. Empty when there was an error.
    std::optional<TabulatedSpectrum> spectrum(const toml::table& table, const std::string& column,
                                              const SpectrumLimits& limits) {
        if (const toml::node* file = table.get("file")) {
            if (table.get("values") || table.get("wavelengths_nm")) {
                error(*file, "a spectrum comes either from a file or from values, not both");
                return std::nullopt;
            }
            return fileSpectrum(table, *file, column, limits);
        }
        std::vector<SourcePlace> places;
        TabulatedSpectrum result;
        if (!numbers(table, "wavelengths_nm", result.wavelengthsNm, nullptr) ||
            !numbers(table, "values", result.values, &places)) {
            return std::nullopt;
        }
        if (result.values.size() != result.wavelengthsNm.size()) {
            error(*table.get("values"), fmt::format("{} values for {} wavelengths", result.values.size(),
                                                    result.wavelengthsNm.size()));
            return std::nullopt;
        }
        std::size_t index = 0;
        const std::string fault = spectrumFault(result, limits, index);
        if (!fault.empty()) {
            error(index < places.size() ? places[index] : placeOf(table), fault);
            return std::nullopt;
        }
        return result;
    }

    std::optional<TabulatedSpectrum> fileSpectrum(const toml::table& table, const toml::node& file,
                                                  const std::string& column, const SpectrumLimits& limits) {
        const std::string name = word(table, "file");
        if (name.empty()) {
            return std::nullopt;
        }
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(dataFolder_ / name, ignored)) {
            error(file, fmt::format("no such spectrum file '{}'", name),
                  fmt::format("paths are relative to {}", dataFolder_.string()));
            return std::nullopt;
        }
        try {
            return readSpectrumFile(dataFolder_ / name, column, limits);
        } catch (const ScriptError& problem) {
            append(problem.diagnostics());
            return std::nullopt;
        }
    }

    bool numbers(const toml::table& table, const char* key, std::vector<double>& out, std::vector<SourcePlace>* places) {
        const toml::node* node = table.get(key);
        const toml::array* array = node ? node->as_array() : nullptr;
        if (!array || array->empty()) {
            error(node ? *node : static_cast<const toml::node&>(table), fmt::format("'{}' must be a list of numbers", key));
            return false;
        }
        for (const toml::node& element : *array) {
            const std::optional<double> value = element.value<double>();
            if (!element.is_number() || !value) {
                error(element, fmt::format("'{}' must be a list of numbers", key));
                return false;
            }
            out.push_back(*value);
            if (places) {
                places->push_back(placeOf(element));
            }
        }
        return true;
    }

  private:
    std::filesystem::path path_;
    std::filesystem::path dataFolder_;
    std::vector<Diagnostic>& findings_;
    std::vector<std::string> lines_;
};

/// R∞ as measured in air, freed of the first surface and of the light that it turns back (inverse Saunderson).
FineSpectrum withoutInterface(const FineSpectrum& measured, double index) {
    const double k1 = normalReflectance(index, 0.0);
    const double k2 = diffuseInterface(index).internal;
    FineSpectrum body{};
    for (int i = 0; i < fineCount; ++i) {
        body[i] = std::max(inverseSaunderson(measured[i], k1, k2), blackest);
    }
    return body;
}

void readReflectance(Reader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"file", "column", "wavelengths_nm", "values", "measured"});
    const std::optional<TabulatedSpectrum> spectrum =
        reader.spectrum(table, reader.word(table, "column", "reflectance"), {0.0, 1.0, "reflectance"});
    const std::string measured = reader.word(table, "measured", "in_air");
    if (measured != "in_air" && measured != "body") {
        reader.error(*table.get("measured"), fmt::format("'measured' is '{}'", measured),
                     "expected \"in_air\" (first surface included) or \"body\"");
        return;
    }
    if (spectrum) {
        FineSpectrum fine = spectrum->fine();
        if (!result.material.isMetal) {
            fine = withoutInterface(fine, measured == "in_air" ? result.material.refractiveIndex : 1.0);
        }
        result.reflectance = fine;
    }
}

void readIndex(Reader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"file"});
    const toml::node* file = table.get("file");
    if (!file) {
        reader.error(table, "'index' needs a file with the columns wavelength_nm, n, k");
        return;
    }
    const std::optional<TabulatedSpectrum> n = reader.fileSpectrum(table, *file, "n", {0.0, 20.0, "n"});
    const std::optional<TabulatedSpectrum> k =
        n ? reader.fileSpectrum(table, *file, "k", {0.0, 50.0, "k"}) : std::nullopt;
    if (!n || !k) {
        return;
    }
    FineSpectrum spectrum{};
    for (int i = 0; i < fineCount; ++i) {
        const double nm = fineWavelengthNm(i);
        // Films: K = 2 · 4 pi k / lambda; the 2 because diffuse light travels twice as far as it sinks.
        spectrum[i] = result.material.isMetal ? normalReflectance(n->at(nm), k->at(nm))
                                              : 2.0 * 4.0 * pi * k->at(nm) / (nm * 1e-3);
    }
    (result.material.isMetal ? result.reflectance : result.absorption) = spectrum;
}

void readScattering(Reader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"value", "unit", "wavelength_exponent", "hides_at_um", "wavelengths_nm", "values", "file", "column"});
    if (table.get("hides_at_um")) {
        result.hidesAtUm = reader.number(table, "hides_at_um", 1e-3, 1e5).value_or(0.0);
        return;
    }
    const double scale = reader.perMicrometre(table);
    if (table.get("values") || table.get("file")) {
        const auto spectrum =
            reader.spectrum(table, reader.word(table, "column", "scattering"), {0.0, 1e7, "scattering"});
        if (spectrum) {
            result.scattering = spectrum->fine();
        }
    } else if (!table.get("value")) {
        reader.error(table, "'scattering' needs a value, a spectrum or hides_at_um");
        return;
    } else if (const auto value = reader.number(table, "value", 0.0, 1e7)) {
        // S ~ lambda^-p about 550 nm: 0 for grains larger than a wave, towards 4 for much smaller ones.
        const double exponent = reader.number(table, "wavelength_exponent", 0.0, 4.0).value_or(0.0);
        result.scattering.emplace();
        for (int i = 0; i < fineCount; ++i) {
            (*result.scattering)[i] = *value * std::pow(fineWavelengthNm(i) / 550.0, -exponent);
        }
    }
    if (result.scattering) {
        for (double& value : *result.scattering) {
            value *= scale;
        }
    }
}

void readMixture(Reader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"parts", "scattering_factor"});
    const toml::node* node = table.get("parts");
    const toml::array* parts = node ? node->as_array() : nullptr;
    if (!parts || parts->empty()) {
        reader.error(table, "'mixture' needs parts = [{ material = \"…\", volume = … }, …]");
        return;
    }
    double sum = 0.0;
    for (const toml::node& element : *parts) {
        const toml::table* part = element.as_table();
        if (!part) {
            reader.error(element, "a part of a mixture is { material = \"…\", volume = … }");
            continue;
        }
        reader.allowOnly(*part, {"material", "volume"});
        MixturePart entry;
        entry.material = reader.word(*part, "material");
        entry.volume = reader.number(*part, "volume", 0.0, 1.0).value_or(0.0);
        entry.place = reader.placeOf(part->get("material") ? *part->get("material") : element);
        if (entry.material.empty() || !part->get("volume")) {
            reader.error(element, "a part of a mixture needs a material and a volume");
            continue;
        }
        sum += entry.volume;
        result.parts.push_back(entry);
    }
    if (result.parts.size() == parts->size() && std::abs(sum - 1.0) > 1e-3) {
        reader.error(*node, fmt::format("volumes of a mixture must add up to 1, these give {:.4g}", sum));
    }
    result.scatteringFactor = reader.number(table, "scattering_factor", 0.01, 100.0).value_or(1.0);
}

void readRatio(Reader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"file", "column", "wavelengths_nm", "values"});
    const auto spectrum = reader.spectrum(table, reader.word(table, "column", "k_over_s"), {0.0, 1e6, "K/S"});
    if (spectrum) {
        result.ratio = spectrum->fine();
    }
}

void readAbsorption(Reader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"file", "column", "wavelengths_nm", "values", "unit"});
    const double scale = reader.perMicrometre(table);
    const auto spectrum =
        reader.spectrum(table, reader.word(table, "column", "absorption"), {0.0, 1e7, "absorption"});
    if (spectrum) {
        result.absorption = spectrum->fine();
        for (double& value : *result.absorption) {
            value *= scale;
        }
    }
}

} // namespace

MaterialDescription readMaterialFile(const std::filesystem::path& path, const std::filesystem::path& dataFolder,
                                     std::vector<Diagnostic>& findings) {
    MaterialDescription result;
    result.path = path;
    result.place = {path.string(), 1, 1};
    Material& material = result.material;
    material.name = path.stem().string();

    Reader reader(path, dataFolder, findings);
    const std::string text = readTextFile(path);
    reader.setText(text);
    toml::table file;
    try {
        file = toml::parse(text, path.string());
    } catch (const toml::parse_error& problem) {
        reader.error(reader.placeOf(problem.source().begin), std::string(problem.description()));
        return result;
    }
    reader.allowOnly(file, {"title", "kind", "estimate", "source", "refractive_index", "roughness", "hardness",
                            "solid_fraction", "density_kg_m3", "reflectance", "index", "absorption",
                            "absorption_over_scattering", "scattering", "mixture"});
    material.title = reader.word(file, "title", material.name);
    material.source = reader.word(file, "source");
    if (material.source.empty()) {
        reader.error(result.place, "'source' is missing: say where the numbers come from");
    }
    material.isEstimate = reader.truth(file, "estimate");
    const std::string kind = reader.word(file, "kind", "film");
    if (kind != "film" && kind != "metal") {
        reader.error(*file.get("kind"), fmt::format("unknown kind '{}'", kind), "expected \"film\" or \"metal\"");
    }
    material.isMetal = kind == "metal";
    material.refractiveIndex = static_cast<float>(reader.number(file, "refractive_index", 1.0, 4.0).value_or(1.5));
    material.roughness = static_cast<float>(reader.number(file, "roughness", 1e-4, 1.0).value_or(0.3));
    material.hardness = static_cast<float>(reader.number(file, "hardness", 1e-3, 1e3).value_or(1.0));
    material.density = static_cast<float>(reader.number(file, "solid_fraction", 1e-3, 1.0).value_or(1.0));
    material.densityKgPerM3 = static_cast<float>(reader.number(file, "density_kg_m3", 1.0, 3e4).value_or(0.0));

    const std::size_t findingsBefore = findings.size();
    if (const toml::table* table = reader.subtable(file, "reflectance")) {
        readReflectance(reader, *table, result);
    }
    if (const toml::table* table = reader.subtable(file, "index")) {
        readIndex(reader, *table, result);
    }
    if (const toml::table* table = reader.subtable(file, "absorption")) {
        readAbsorption(reader, *table, result);
    }
    if (const toml::table* table = reader.subtable(file, "absorption_over_scattering")) {
        readRatio(reader, *table, result);
    }
    if (const toml::table* table = reader.subtable(file, "scattering")) {
        readScattering(reader, *table, result);
    }
    if (const toml::table* table = reader.subtable(file, "mixture")) {
        readMixture(reader, *table, result);
    }
    if (findings.size() != findingsBefore) {
        return result;
    }

    // Which combinations say enough, and no more than enough.
    const int sources = (file.get("reflectance") ? 1 : 0) + (file.get("index") ? 1 : 0) +
                        (file.get("absorption") ? 1 : 0) + (file.get("absorption_over_scattering") ? 1 : 0) +
                        (file.get("mixture") ? 1 : 0);
    if (sources != 1) {
        reader.error(result.place,
                     sources == 0 ? "no optics: the material has no spectrum" : "more than one source of the optics",
                     "give one of [reflectance], [index], [absorption], [absorption_over_scattering], [mixture]");
    } else if (material.isMetal && !result.reflectance) {
        reader.error(result.place, "a metal is described by [index] or [reflectance]");
    } else if (!material.isMetal && result.parts.empty() && !result.scattering && result.hidesAtUm <= 0.0) {
        reader.error(result.place, "a film needs [scattering]: a value in 1/um, or hides_at_um");
    } else if (file.get("scattering") && (!result.parts.empty() || material.isMetal)) {
        reader.error(*file.get("scattering"), "metals and mixtures have no [scattering] of their own",
                     "a mixture may have scattering_factor");
    } else if (result.hidesAtUm > 0.0 && result.absorption) {
        reader.error(*file.get("scattering"), "hides_at_um needs [reflectance] or [absorption_over_scattering]");
    }
    return result;
}

} // namespace patina
