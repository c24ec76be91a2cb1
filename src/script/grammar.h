#pragma once
// One statement's text becomes its syntax. The grammar itself (PEGTL) is in grammar_rules.h.

#include "script/syntax.h"

#include <string>
#include <string_view>

namespace patina {

/// An error of the syntax at a byte of the whole text.
struct SyntaxFailure {
    std::size_t offset = 0;
    std::string message;
    std::string remedy;
};

/// `masked[begin, end)` is one statement without comments and line ends; places count from the start of `masked`.
/// \throws SyntaxFailure at the first thing that cannot be read.
SyntaxStatement parseStatement(std::string_view masked, std::size_t begin, std::size_t end);

/// A number with or without a unit, nothing else around it: the VALUE of `--set NAME=VALUE`.
/// \throws SyntaxFailure (offsets count from the start of `text`).
SyntaxExpression parseQuantity(std::string_view text);

} // namespace patina
