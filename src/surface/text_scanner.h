#pragma once
// Words and numbers of a text, whatever the locale.

#include <string_view>

namespace patina {

/// Takes a text apart by white space.
class TextScanner {
  public:
    explicit TextScanner(std::string_view text) : text_(text) {}

    /// The next word, across lines; empty at the end of the text.
    std::string_view word();
    /// The rest of the current line without its end and any white space around it.
    std::string_view line();
    bool atEnd() const { return at_ >= text_.size(); }
    /// Bytes consumed so far.
    std::size_t position() const { return at_; }

  private:
    std::string_view text_;
    std::size_t at_ = 0;
};

std::string_view trimmed(std::string_view text);

/// A word that is a number as a whole: "1e-3", "+2", also "nan" and "inf". False for anything else.
bool readNumber(std::string_view word, double& value);
/// A word that is an integer as a whole. False for anything else and beyond 63 bits.
bool readInteger(std::string_view word, long long& value);

} // namespace patina
