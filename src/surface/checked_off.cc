#include "base/errors.h"
#include "surface/checked_file.h"
#include "surface/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace patina {

namespace {

/// The lines that say something.
class OffLines {
  public:
    OffLines(std::string_view bytes, const std::string& file) : scanner_(bytes), file_(file) {}

    /// \throws ModelError at the end of the file.
    std::string_view next(const std::string& expected) {
        while (!scanner_.atEnd()) {
            ++line_;
            std::string_view text = scanner_.line();
            text = trimmed(text.substr(0, text.find('#')));
            if (!text.empty())
                return text;
        }
        throw ModelError(file_, fmt::format("the file ends where {} should be", expected),
                         "it was cut short: copy or export it again");
    }
    [[noreturn]] void fail(const std::string& message) const {
        throw ModelError(SourcePlace{file_, line_, 0}.text(), message, "export the model again");
    }

  private:
    TextScanner scanner_;
    const std::string& file_;
    int line_ = 0;
};

} // namespace

CheckedFile checkedOff(std::string_view bytes, const std::string& place) {
    OffLines lines(bytes, place);
    std::string_view text = lines.next("'OFF'");
    TextScanner header(text);
    const std::string_view magic = header.word();
    const std::size_t off = magic.find("OFF");
    if (off == std::string_view::npos || off + 3 != magic.size() ||
        magic.substr(0, off).find_first_not_of("STCN") != std::string_view::npos)
        throw ModelError(place, "this is not an OFF file: it does not begin with OFF",
                         "export the model again, as OFF, OBJ, PLY or STL");
    const std::string_view rest = trimmed(text.substr(header.position()));
    if (rest.substr(0, 6) == "BINARY")
        throw ModelError(place, "binary OFF files cannot be read", "export it as text, or as binary PLY");
    TextScanner counts(rest.empty() ? lines.next("the numbers of vertices and faces") : rest);
    long long vertexCount, faceCount;
    if (!readInteger(counts.word(), vertexCount) || !readInteger(counts.word(), faceCount) || vertexCount < 0 ||
        faceCount < 0)
        lines.fail("the numbers of vertices and faces are missing");
    // Each vertex takes six bytes at least, each face too: counts that the file cannot hold cost no memory.
    if (static_cast<unsigned long long>(vertexCount) > bytes.size() ||
        static_cast<unsigned long long>(faceCount) > bytes.size())
        lines.fail(fmt::format("{} vertices and {} faces do not fit into the file", vertexCount, faceCount));

    CheckedFile out;
    out.vertexCount = static_cast<int>(vertexCount);
    out.faceCount = static_cast<int>(faceCount);
    out.bytes = fmt::format("OFF\n{} {} 0\n", vertexCount, faceCount);
    for (long long i = 0; i < vertexCount; ++i) {
        TextScanner words(lines.next(fmt::format("vertex {} of {}", i, vertexCount)));
        double values[3];
        for (double& value : values) {
            if (!readNumber(words.word(), value))
                lines.fail(fmt::format("vertex {} is not three numbers", i));
            if (std::isnan(value))
                lines.fail(fmt::format("vertex {} is not a number (nan)", i));
            if (!std::isfinite(value) || std::abs(value) > largestCoordinate)
                lines.fail(fmt::format("vertex {} is infinite or absurdly far away", i));
        }
        out.bytes += fmt::format("{} {} {}\n", static_cast<float>(values[0]), static_cast<float>(values[1]),
                                 static_cast<float>(values[2]));
    }
    std::vector<long long> corners;
    int written = 0;
    std::string faces;
    for (long long i = 0; i < faceCount; ++i) {
        const std::string_view line = lines.next(fmt::format("face {} of {}", i, faceCount));
        TextScanner words(line);
        long long size;
        if (!readInteger(words.word(), size) || size < 1 || static_cast<unsigned long long>(size) > line.size())
            lines.fail(fmt::format("face {} does not begin with its number of corners", i));
        if (size > mostCorners)
            lines.fail(fmt::format("face {} has {} corners", i, size));
        corners.resize(static_cast<std::size_t>(size));
        for (long long& corner : corners) {
            if (!readInteger(words.word(), corner))
                lines.fail(fmt::format("face {} has fewer corners than it says", i));
            if (corner < 0 || corner >= vertexCount)
                lines.fail(fmt::format("face {} names vertex {}, but there are {} (from 0)", i, corner, vertexCount));
        }
        if (size < 3)
            continue;
        ++written;
        faces += std::to_string(size);
        for (const long long corner : corners)
            faces.append(" ").append(std::to_string(corner));
        faces += '\n';
    }
    if (written != faceCount)
        out.bytes.replace(0, out.bytes.find('\n', 4) + 1, fmt::format("OFF\n{} {} 0\n", vertexCount, written));
    out.faceCount = written;
    out.bytes += faces;
    return out;
}

} // namespace patina
