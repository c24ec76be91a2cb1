#include "optics/spectrum_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/names.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

namespace patina {

namespace {

struct Cell {
    std::string_view text;
    int column = 1;
};

std::vector<Cell> splitLine(std::string_view line) {
    std::vector<Cell> cells;
    std::size_t begin = 0;
    while (true) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        std::size_t first = begin;
        std::size_t last = end;
        while (first < last && (line[first] == ' ' || line[first] == '\t')) {
            ++first;
        }
        while (last > first && (line[last - 1] == ' ' || line[last - 1] == '\t' || line[last - 1] == '\r')) {
            --last;
        }
        cells.push_back({line.substr(first, last - first), static_cast<int>(first) + 1});
        if (end == line.size()) {
            return cells;
        }
        begin = end + 1;
    }
}

[[noreturn]] void fail(const std::filesystem::path& path, int line, int column, std::string message, std::string remedy,
                       std::string_view sourceLine) {
    Diagnostic finding;
    finding.place = {path.string(), line, column};
    finding.message = std::move(message);
    finding.remedy = std::move(remedy);
    finding.sourceLine = std::string(sourceLine);
    throw ScriptError({finding});
}

} // namespace

std::string spectrumFault(const TabulatedSpectrum& spectrum, const SpectrumLimits& limits, std::size_t& index) {
    const auto& nm = spectrum.wavelengthsNm;
    for (index = 0; index < nm.size(); ++index) {
        const double value = spectrum.values[index];
        if (!std::isfinite(nm[index]) || nm[index] <= 0.0) {
            return "a wavelength must be a positive number of nanometres";
        }
        if (index > 0 && nm[index] <= nm[index - 1]) {
            return fmt::format("wavelengths must rise, but {} nm follows {} nm", nm[index], nm[index - 1]);
        }
        if (!(value >= limits.least && value <= limits.most)) {
            return fmt::format("{} {} is outside {}…{}", limits.quantity, value, limits.least, limits.most);
        }
    }
    for (index = 1; index < nm.size(); ++index) {
        if (nm[index] - nm[index - 1] > longestStepNm && nm[index] > 400.0 && nm[index - 1] < 700.0) {
            return fmt::format("a gap from {} to {} nm; at most {} nm may lie between samples", nm[index - 1],
                               nm[index], longestStepNm);
        }
    }
    index = nm.empty() ? 0 : nm.size() - 1;
    if (nm.empty() || nm.front() > 440.0 || nm.back() < 690.0) {
        return "a spectrum must span at least 440…690 nm";
    }
    return {};
}

TabulatedSpectrum readSpectrumFile(const std::filesystem::path& path, const std::string& column,
                                   const SpectrumLimits& limits) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) {
        fail(path, 0, 0, "no such spectrum file", "paths are relative to the data folder", {});
    }
    const std::string text = readTextFile(path);
    TabulatedSpectrum spectrum;
    std::size_t wavelengthIndex = 0;
    std::size_t valueIndex = 0;
    bool headerSeen = false;
    int lineNumber = 0;
    std::vector<int> lines;
    std::vector<int> columns;
    std::vector<std::string_view> sources;
    std::string_view rest = text;
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        const std::string_view line = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        ++lineNumber;
        if (line.empty() || line[0] == '#' || line == "\r") {
            continue;
        }
        const std::vector<Cell> cells = splitLine(line);
        if (!headerSeen) {
            std::vector<std::string> names;
            for (const Cell& cell : cells) {
                names.emplace_back(cell.text);
            }
            const auto positionOf = [&](const std::string& name) {
                for (std::size_t i = 0; i < names.size(); ++i) {
                    if (names[i] == name) {
                        return i;
                    }
                }
                fail(path, lineNumber, 1, fmt::format("no column '{}'", name), didYouMean(name, names), line);
            };
            wavelengthIndex = positionOf("wavelength_nm");
            valueIndex = positionOf(column);
            headerSeen = true;
            continue;
        }
        const auto numberAt = [&](std::size_t index) {
            if (index >= cells.size()) {
                fail(path, lineNumber, static_cast<int>(line.size()) + 1, "a number is missing at the end of the line",
                     {}, line);
            }
            const Cell& cell = cells[index];
            double value = 0.0;
            const auto [stop, error] = std::from_chars(cell.text.data(), cell.text.data() + cell.text.size(), value);
            if (error != std::errc() || stop != cell.text.data() + cell.text.size()) {
                fail(path, lineNumber, cell.column, fmt::format("expected a number, found '{}'", cell.text), {}, line);
            }
            return value;
        };
        spectrum.wavelengthsNm.push_back(numberAt(wavelengthIndex));
        spectrum.values.push_back(numberAt(valueIndex));
        lines.push_back(lineNumber);
        columns.push_back(cells[valueIndex].column);
        sources.push_back(line);
    }
    std::size_t index = 0;
    const std::string fault = spectrumFault(spectrum, limits, index);
    if (!fault.empty()) {
        const bool known = index < lines.size();
        fail(path, known ? lines[index] : 0, known ? columns[index] : 0, fault, {},
             known ? sources[index] : std::string_view{});
    }
    return spectrum;
}

} // namespace patina
