#include "surface/text_scanner.h"

#include <charconv>
#include <cstdlib>
#include <string>

namespace patina {

namespace {

bool isSpace(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

std::string_view withoutPlus(std::string_view word) {
    return word.size() > 1 && word[0] == '+' && word[1] != '-' ? word.substr(1) : word;
}

} // namespace

std::string_view TextScanner::word() {
    while (at_ < text_.size() && isSpace(text_[at_]))
        ++at_;
    const std::size_t start = at_;
    while (at_ < text_.size() && !isSpace(text_[at_]))
        ++at_;
    return text_.substr(start, at_ - start);
}

std::string_view TextScanner::line() {
    const std::size_t start = at_;
    while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r')
        ++at_;
    const std::string_view found = text_.substr(start, at_ - start);
    // One end of line: \n, \r or \r\n.
    if (at_ < text_.size() && text_[at_++] == '\r' && at_ < text_.size() && text_[at_] == '\n')
        ++at_;
    return trimmed(found);
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && isSpace(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && isSpace(text.back()))
        text.remove_suffix(1);
    return text;
}

bool readNumber(std::string_view word, double& value) {
    word = withoutPlus(word);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || word.empty())
        return false;
    if (error == std::errc::result_out_of_range)
        value = std::strtod(std::string(word).c_str(), nullptr); // 0 or infinity, whichever it is near
    else if (error != std::errc())
        return false;
    return true;
}

bool readInteger(std::string_view word, long long& value) {
    word = withoutPlus(word);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

} // namespace patina
