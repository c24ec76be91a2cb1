#pragma once
// Where statements begin and end: at `;`, at the end of a line (not inside brackets), at the braces of a block.

#include "script/source_text.h"

#include <cstddef>
#include <string>
#include <vector>

namespace patina {

struct StatementPiece {
    enum class Kind { statement, blockBegin, blockEnd };
    Kind kind = Kind::statement;
    std::size_t begin = 0;
    std::size_t end = 0;
    bool broken = false; ///< has an error already: not to be read further
};

struct StatementSplit {
    /// The text, byte for byte, with comments and line ends inside brackets turned into blanks.
    std::string masked;
    std::vector<StatementPiece> pieces;
    std::vector<Diagnostic> diagnostics;
};

/// Brackets may be nested this deep; deeper ones are an error, so that no text can exhaust the stack.
inline constexpr std::size_t deepestBrackets = 100;

/// An open bracket or quote is reported where it opened. Where the line behind it begins with a statement's word, the
/// next statement begins there: the errors after it are found as well.
StatementSplit splitStatements(const SourceText& source);

} // namespace patina
