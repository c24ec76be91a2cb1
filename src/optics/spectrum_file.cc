#include "optics/spectrum_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

SpectrumFault spectrumFault(const TabulatedSpectrum& spectrum, const SpectrumLimits& limits) {
    const auto& nm = spectrum.wavelengthsNm;
    for (std::size_t i = 0; i < nm.size(); ++i) {
        const double value = spectrum.values[i];
        if (!std::isfinite(nm[i]) || nm[i] <= 0.0) {
            return {"a wavelength must be a positive number of nanometres", i, true};
        }
        if (i > 0 && nm[i] <= nm[i - 1]) {
            return {fmt::format("wavelengths must rise, but {} nm follows {} nm", nm[i], nm[i - 1]), i, true};
        }
        if (!(value >= limits.least && value <= limits.most)) {
            return {fmt::format("{} {} is outside {}…{}", limits.quantity, value, limits.least, limits.most), i, false};
        }
    }
    for (std::size_t i = 1; i < nm.size(); ++i) {
        if (nm[i] - nm[i - 1] > longestStepNm && nm[i] > 400.0 && nm[i - 1] < 700.0) {
            return {fmt::format("a gap from {} to {} nm; at most {} nm may lie between samples", nm[i - 1], nm[i],
                                longestStepNm),
                    i, true};
        }
    }
    if (nm.empty() || nm.front() > 440.0 || nm.back() < 690.0) {
        const bool begins = !nm.empty() && nm.front() <= 440.0;
        return {"a spectrum must span at least 440…690 nm", begins ? nm.size() - 1 : 0, true};
    }
    return {};
}

TabulatedSpectrum readSpectrumFile(const std::filesystem::path& path, const std::string& column,
                                   const SpectrumLimits& limits) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) {
        fail(path, 0, 0, "no such spectrum file", "expected a table with the columns wavelength_nm and " + column, {});
    }
    const std::string text = readTextFile(path);
    TabulatedSpectrum spectrum;
    std::size_t wavelengthIndex = 0;
    std::size_t valueIndex = 0;
    bool headerSeen = false;
    int lineNumber = 0;
    std::vector<int> lines;
    std::vector<std::array<int, 2>> columns; // of value and wavelength
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
        columns.push_back({cells[valueIndex].column, cells[wavelengthIndex].column});
        sources.push_back(line);
    }
    if (lines.empty()) {
        fail(path, std::max(lineNumber, 1), 1, "the table has no samples",
             "expected a line of column names and one line for each wavelength", {});
    }
    const SpectrumFault fault = spectrumFault(spectrum, limits);
    if (!fault.message.empty()) {
        fail(path, lines[fault.sample], columns[fault.sample][fault.inWavelength], fault.message, {},
             sources[fault.sample]);
    }
    return spectrum;
}

} // namespace patina
