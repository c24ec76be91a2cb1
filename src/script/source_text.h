#pragma once
// A text and the places in it.

#include "base/errors.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace patina {

/// No more findings than this are collected: a text with more is no script.
inline constexpr std::size_t mostFindings = 100;

/// A script's text with quick answers to "which line, which column is byte n?".
class SourceText {
  public:
    SourceText(std::string text, std::string file);

    const std::string& text() const { return text_; }
    const std::string& file() const { return file_; }

    /// Line and column, from 1; the column counts characters, not bytes, so that a caret stands right behind a "µ".
    SourcePlace place(std::size_t offset) const;
    int lineNumber(std::size_t offset) const;

    /// A finding at a byte of the text, with the line of the text (its beginning where the line is very long).
    Diagnostic diagnostic(Diagnostic::Severity severity, std::size_t offset, std::string message,
                          std::string remedy = {}) const;

    /// What stands at a byte, for messages: "'0.35'", "the end of the statement", "a byte 0x80".
    static std::string describeToken(std::string_view text, std::size_t offset);

  private:
    std::string text_;
    std::string file_;
    std::vector<std::size_t> lineStarts_;
    std::vector<std::size_t> continuationBytes_; ///< offsets of UTF-8 bytes that start no character
};

} // namespace patina
