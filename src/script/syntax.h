#pragma once
// A script as it was written: what the grammar finds, before names mean anything. Places are bytes of the text.

#include "script/source_text.h"

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace patina {

/// A word or quoted text and where it stands.
struct SyntaxWord {
    std::string text;
    std::size_t offset = 0;
};

struct SyntaxExpression {
    enum class Kind {
        number,      ///< number; µm where isLength
        string,      ///< text
        name,        ///< text
        call,        ///< text(children…), argumentNames parallel to children ("" where not named)
        unary,       ///< '-' child
        binary,      ///< text is the operator, two children
        tuple,       ///< (a, b, …)
        growthShort, ///< text is the model; rate, step, total
    };

    Kind kind = Kind::number;
    std::size_t offset = 0;
    double number = 0.0;
    bool isLength = false;
    std::string text;
    std::vector<SyntaxExpression> children;
    std::vector<SyntaxWord> argumentNames;
    SyntaxWord rate;
    int step = 0;
    int total = 0;
    std::size_t stepOffset = 0;
    std::size_t totalOffset = 0;
    bool ofFull = false;
    std::size_t ofOffset = 0;
};

/// `as NAME`, `by hardness`, `above smooth(2mm)`, …
struct SyntaxClause {
    std::string word; ///< "as", "by", "and", "above", "window", "of", "tangent-sphere", "global" or "everywhere"
    std::size_t offset = 0;
    std::vector<SyntaxWord> names;
    std::vector<SyntaxExpression> values;
};

struct SyntaxStatement {
    std::string word; ///< "coat", …
    std::size_t offset = 0;
    std::string text;
    std::vector<SyntaxWord> names;        ///< metals, materials, declared names, files, in order
    std::vector<SyntaxExpression> values; ///< thickness, height, value, count; curves: their points as tuples
    std::optional<SyntaxExpression> map;
    bool area = false;   ///< polish area
    bool smooth = false; ///< a curve's
    std::vector<SyntaxClause> clauses;
    std::vector<SyntaxStatement> body; ///< of repeat
};

struct SyntaxTree {
    SourceText source;
    std::vector<SyntaxStatement> statements;
    std::vector<Diagnostic> diagnostics;
    /// What statements with errors would have declared: not to be reported again as unknown.
    std::set<std::string> brokenNames;
    bool brokenBeginning = false; ///< a `new` or `open` has an error
};

/// Reads a script. Never throws for what is in the text: errors are in the tree's diagnostics.
SyntaxTree parse(std::string text, std::string file);

} // namespace patina
