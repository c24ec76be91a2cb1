#include "script/source_text.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {

namespace {

constexpr std::size_t longestShownLine = 240;

bool isContinuation(char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0u) == 0x80u;
}

bool isWordByte(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Bytes of a well-formed UTF-8 character at `offset`, or 0.
std::size_t characterLength(std::string_view text, std::size_t offset) {
    const auto lead = static_cast<unsigned char>(text[offset]);
    const std::size_t length = lead < 0x80u                    ? 1
                               : lead >= 0xC2u && lead < 0xE0u ? 2
                               : lead >= 0xE0u && lead < 0xF0u ? 3
                               : lead >= 0xF0u && lead < 0xF5u ? 4
                                                               : 0;
    if (length == 0 || offset + length > text.size())
        return 0;
    for (std::size_t i = 1; i < length; ++i)
        if (!isContinuation(text[offset + i]))
            return 0;
    return length;
}

} // namespace

SourceText::SourceText(std::string text, std::string file) : text_(std::move(text)), file_(std::move(file)) {
    lineStarts_.push_back(0);
    for (std::size_t i = 0; i < text_.size(); ++i) {
        if (text_[i] == '\n')
            lineStarts_.push_back(i + 1);
        else if (isContinuation(text_[i]))
            continuationBytes_.push_back(i);
    }
}

int SourceText::lineNumber(std::size_t offset) const {
    const auto after = std::upper_bound(lineStarts_.begin(), lineStarts_.end(), offset);
    return static_cast<int>(after - lineStarts_.begin());
}

SourcePlace SourceText::place(std::size_t offset) const {
    offset = std::min(offset, text_.size());
    const int line = lineNumber(offset);
    const std::size_t start = lineStarts_[static_cast<std::size_t>(line - 1)];
    const auto first = std::lower_bound(continuationBytes_.begin(), continuationBytes_.end(), start);
    const auto last = std::lower_bound(first, continuationBytes_.end(), offset);
    const std::size_t characters = offset - start - static_cast<std::size_t>(last - first);
    return {file_, line, static_cast<int>(characters) + 1};
}

Diagnostic SourceText::diagnostic(Diagnostic::Severity severity, std::size_t offset, std::string message,
                                  std::string remedy) const {
    Diagnostic finding{severity, place(offset), std::move(message), std::move(remedy), {}};
    const std::size_t start = lineStarts_[static_cast<std::size_t>(finding.place.line - 1)];
    std::size_t end = std::min(text_.find('\n', start), text_.size());
    if (end > start && text_[end - 1] == '\r')
        --end;
    if (end - start <= longestShownLine) {
        finding.sourceLine = text_.substr(start, end - start);
    } else if (offset < start + longestShownLine) {
        end = start + longestShownLine;
        while (end > start && isContinuation(text_[end]))
            --end;
        finding.sourceLine = text_.substr(start, end - start) + " …";
    }
    // Whatever the bytes are, the message stays one readable line of a terminal.
    for (std::size_t i = 0; i < finding.sourceLine.size();) {
        const std::size_t length = characterLength(finding.sourceLine, i);
        const auto byte = static_cast<unsigned char>(finding.sourceLine[i]);
        if (length == 0 || (length == 1 && byte != '\t' && (byte < 0x20u || byte == 0x7Fu)))
            finding.sourceLine[i] = '?';
        i += std::max<std::size_t>(length, 1);
    }
    return finding;
}

std::string SourceText::describeToken(std::string_view text, std::size_t offset) {
    while (offset < text.size() && (text[offset] == ' ' || text[offset] == '\t' || text[offset] == '\r'))
        ++offset;
    if (offset >= text.size() || text[offset] == ';' || text[offset] == '\n')
        return "the end of the statement";
    std::size_t end = offset;
    while (end < text.size() && end < offset + 40 && (isWordByte(text[end]) || text[end] == '.'))
        ++end;
    if (end == offset) {
        const std::size_t length = characterLength(text, offset);
        const auto byte = static_cast<unsigned char>(text[offset]);
        if (length == 0 || byte < 0x20u || byte == 0x7Fu)
            return fmt::format("a byte 0x{:02x}", byte);
        end = offset + length;
    }
    return fmt::format("'{}'", text.substr(offset, end - offset));
}

} // namespace patina
