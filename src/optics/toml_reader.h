#pragma once
// Values out of TOML tables, every fault noted with its place. Private to material_file.cc, which it keeps short.

#include "base/errors.h"
#include "base/names.h"
#include "optics/spectrum_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patina {

/// Reads values out of tables, and notes what is wrong with its place.
class TomlReader {
  public:
    TomlReader(std::filesystem::path path, std::filesystem::path dataFolder, std::vector<Diagnostic>& findings)
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
        std::vector<SourcePlace> wavelengthPlaces, valuePlaces;
        TabulatedSpectrum result;
        if (!numbers(table, "wavelengths_nm", result.wavelengthsNm, &wavelengthPlaces) ||
            !numbers(table, "values", result.values, &valuePlaces)) {
            return std::nullopt;
        }
        if (result.values.size() != result.wavelengthsNm.size()) {
            error(*table.get("values"),
                  fmt::format("{} values for {} wavelengths", result.values.size(), result.wavelengthsNm.size()));
            return std::nullopt;
        }
        const SpectrumFault fault = spectrumFault(result, limits);
        if (!fault.message.empty()) {
            error((fault.inWavelength ? wavelengthPlaces : valuePlaces)[fault.sample], fault.message);
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

    bool numbers(const toml::table& table, const char* key, std::vector<double>& out,
                 std::vector<SourcePlace>* places) {
        const toml::node* node = table.get(key);
        const toml::array* array = node ? node->as_array() : nullptr;
        if (!array || array->empty()) {
            error(node ? *node : static_cast<const toml::node&>(table),
                  fmt::format("'{}' must be a list of numbers", key));
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

} // namespace patina
