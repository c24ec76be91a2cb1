#include "base/errors.h"
#include "surface/checked_file.h"
#include "surface/text_scanner.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace patina {

namespace {

constexpr std::size_t headerBytes = 84;   // 80 of anything, then the count
constexpr std::size_t triangleBytes = 50; // a normal, three corners, two bytes of anything

std::uint32_t littleEndian(const char* bytes) {
    const auto* b = reinterpret_cast<const unsigned char*>(bytes);
    return b[0] | b[1] << 8 | b[2] << 16 | static_cast<std::uint32_t>(b[3]) << 24;
}

void checkCoordinate(double value, std::size_t triangle, const std::string& place) {
    if (std::isnan(value))
        throw ModelError(place, fmt::format("a vertex of triangle {} is not a number (nan)", triangle),
                         "repair the model where it was made");
    if (!std::isfinite(value) || std::abs(value) > largestCoordinate)
        throw ModelError(place, fmt::format("a vertex of triangle {} is infinite or absurdly far away", triangle),
                         "repair the model where it was made");
}

bool looksBinary(std::string_view bytes) {
    if (bytes.size() < headerBytes)
        return false;
    const std::uint64_t count = littleEndian(bytes.data() + 80);
    // Binary files may begin with "solid" too; only one of the two has exactly the size that its count says.
    if (bytes.size() == headerBytes + count * triangleBytes)
        return true;
    return bytes.substr(0, 4096).find('\0') != std::string_view::npos;
}

CheckedFile checkedBinary(std::string_view bytes, const std::string& place) {
    const std::uint64_t count = littleEndian(bytes.data() + 80);
    if (bytes.size() < headerBytes + count * triangleBytes)
        throw ModelError(
            place,
            fmt::format("the file ends after {} of {} triangles", (bytes.size() - headerBytes) / triangleBytes, count),
            "it was cut short, or is not an STL file: copy or export it again");
    CheckedFile out;
    out.binary = true;
    out.bytes.assign(bytes.substr(0, headerBytes + count * triangleBytes));
    for (std::uint64_t i = 0; i < count; ++i)
        for (int j = 3; j < 12; ++j) {
            const std::uint32_t bits = littleEndian(bytes.data() + headerBytes + i * triangleBytes + 4 * j);
            float value;
            std::memcpy(&value, &bits, sizeof value);
            checkCoordinate(value, i + 1, place);
        }
    out.faceCount = static_cast<int>(count);
    return out;
}

CheckedFile checkedText(std::string_view bytes, const std::string& place) {
    TextScanner scanner(bytes);
    std::string_view first = scanner.line();
    while (first.empty() && !scanner.atEnd())
        first = scanner.line();
    if (first.substr(0, 5) != "solid" && first.substr(0, 5) != "SOLID")
        throw ModelError(place, "this is not an STL file: neither text that begins with 'solid' nor binary triangles",
                         "export the model again, as STL, OBJ, PLY or OFF");
    CheckedFile out;
    out.bytes = "solid\n";
    bool ended = false;
    int corners = -1; // -1: not between 'outer loop' and 'endloop'
    const auto broken = [&](const char* what) {
        throw ModelError(place, fmt::format("triangle {} {}", out.faceCount + 1, what), "export the model again");
    };
    for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
        if (word == "outer" || word == "OUTER") {
            corners = 0;
            out.bytes += "outer loop\n";
        } else if (word == "vertex" || word == "VERTEX") {
            if (corners < 0 || ++corners > 3)
                broken("does not have three corners");
            double values[3];
            for (double& value : values) {
                if (!readNumber(scanner.word(), value))
                    broken("has a corner that is not three numbers");
                checkCoordinate(value, static_cast<std::size_t>(out.faceCount) + 1, place);
            }
            out.bytes += fmt::format("vertex {} {} {}\n", static_cast<float>(values[0]), static_cast<float>(values[1]),
                                     static_cast<float>(values[2]));
        } else if (word == "endloop" || word == "ENDLOOP") {
            if (corners != 3)
                broken("does not have three corners");
            corners = -1;
            ++out.faceCount;
            out.bytes += "endloop\n";
        } else if (word == "endsolid" || word == "ENDSOLID" || word == "solid" || word == "SOLID") {
            scanner.line(); // a name, which may be any words
            ended = true;
        }
    }
    if (corners >= 0 || !ended)
        throw ModelError(place, fmt::format("the file ends after {} triangles without 'endsolid'", out.faceCount),
                         "it was cut short: copy or export it again");
    return out;
}

} // namespace

CheckedFile checkedStl(std::string_view bytes, const std::string& place) {
    return looksBinary(bytes) ? checkedBinary(bytes, place) : checkedText(bytes, place);
}

} // namespace patina
