#include "optics/material_file.h"

#include "base/atomic_file.h"
#include "optics/fresnel.h"
#include "optics/kubelka_munk.h"
#include "optics/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr double pi = 3.14159265358979323846;
/// Below this an opaque layer is black; K/S would grow without bound.
constexpr double blackest = 1e-3;

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

void readReflectance(TomlReader& reader, const toml::table& table, MaterialDescription& result) {
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

void readIndex(TomlReader& reader, const toml::table& table, MaterialDescription& result) {
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
    if (result.material.isMetal) {
        result.indexN = n->fine();
        result.indexK = k->fine();
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

void readRefraction(TomlReader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"file", "column", "wavelengths_nm", "values"});
    if (result.material.isMetal) {
        reader.error(table, "a metal has its refraction in [index]");
        return;
    }
    const auto spectrum = reader.spectrum(table, reader.word(table, "column", "n"), {1.0, 10.0, "n"});
    if (spectrum) {
        result.indexN = spectrum->fine();
    }
}

void readScattering(TomlReader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(
        table, {"value", "unit", "wavelength_exponent", "hides_at_um", "wavelengths_nm", "values", "file", "column"});
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

void readMixture(TomlReader& reader, const toml::table& table, MaterialDescription& result) {
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

void readRatio(TomlReader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"file", "column", "wavelengths_nm", "values"});
    const auto spectrum = reader.spectrum(table, reader.word(table, "column", "k_over_s"), {0.0, 1e6, "K/S"});
    if (spectrum) {
        result.ratio = spectrum->fine();
    }
}

void readAbsorption(TomlReader& reader, const toml::table& table, MaterialDescription& result) {
    reader.allowOnly(table, {"file", "column", "wavelengths_nm", "values", "unit"});
    const double scale = reader.perMicrometre(table);
    const auto spectrum = reader.spectrum(table, reader.word(table, "column", "absorption"), {0.0, 1e7, "absorption"});
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

    TomlReader reader(path, dataFolder, findings);
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
                            "absorption_over_scattering", "scattering", "mixture", "refraction"});
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
    if (const toml::table* table = reader.subtable(file, "refraction")) {
        readRefraction(reader, *table, result);
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
