#include "script/grammar.h"
#include "script/statement_split.h"
#include "script/syntax.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

namespace patina {

namespace {

/// Blocks may be nested this deep.
constexpr std::size_t deepestBlocks = 16;
/// A person's script is some kilobytes; a file this large is another file.
constexpr std::size_t largestScript = std::size_t{4} << 20;
constexpr std::size_t longestStatement = std::size_t{1} << 16;

class Parser {
  public:
    explicit Parser(SyntaxTree& tree) : tree_(tree) {}

    void run() {
        const std::size_t size = tree_.source.text().size();
        if (size > largestScript) {
            Diagnostic finding;
            finding.place.file = tree_.source.file();
            finding.message = fmt::format("the script has {} bytes, more than the {} MiB a script can have", size,
                                          largestScript >> 20);
            finding.remedy = "is it a script?";
            tree_.diagnostics.push_back(std::move(finding));
            tree_.brokenBeginning = true;
            return;
        }
        split_ = splitStatements(tree_.source);
        tree_.diagnostics = std::move(split_.diagnostics);
        block(tree_.statements, 0);
    }

  private:
    /// Reads pieces up to the end of the block (or of the text) into `out`.
    void block(std::vector<SyntaxStatement>& out, std::size_t depth) {
        // Set while the last statement read is a `repeat` whose block has not begun.
        bool repeatWaits = false;
        const auto missingBlock = [&] {
            if (repeatWaits)
                error(out.back().offset, "'repeat' needs a block", "repeat N { … }");
            repeatWaits = false;
        };
        while (next_ < split_.pieces.size() && tree_.diagnostics.size() <= mostFindings) {
            const StatementPiece& piece = split_.pieces[next_++];
            if (piece.kind == StatementPiece::Kind::statement) {
                missingBlock();
                statement(piece, out, repeatWaits);
            } else if (piece.kind == StatementPiece::Kind::blockBegin) {
                if (!repeatWaits && !repeatWasBroken_)
                    error(piece.begin, "a block stands alone", "only 'repeat N' has a block");
                repeatWasBroken_ = false;
                if (depth + 1 > deepestBlocks) {
                    error(piece.begin, fmt::format("blocks are nested more than {} deep", deepestBlocks));
                    next_ = split_.pieces.size();
                    abandoned_ = true;
                    return;
                }
                std::vector<SyntaxStatement> body;
                const std::size_t opened = piece.begin;
                block(body, depth + 1);
                if (!closed_ && !abandoned_ && tree_.diagnostics.size() <= mostFindings)
                    error(opened, "'{' is not closed", "put a '}' at the end of the block");
                closed_ = false;
                if (repeatWaits)
                    out.back().body = std::move(body);
                else
                    std::move(body.begin(), body.end(), std::back_inserter(out));
                repeatWaits = false;
            } else {
                missingBlock();
                if (depth > 0) {
                    closed_ = true;
                    return;
                }
                error(piece.begin, "'}' closes no '{'");
            }
        }
        missingBlock();
        closed_ = false;
    }

    void statement(const StatementPiece& piece, std::vector<SyntaxStatement>& out, bool& repeatWaits) {
        if (piece.broken) {
            remember(piece);
            return;
        }
        if (piece.end - piece.begin > longestStatement) {
            error(piece.begin, "the statement is too long", "use 'let NAME = …' for parts of it");
            remember(piece);
            return;
        }
        try {
            out.push_back(parseStatement(split_.masked, piece.begin, piece.end));
            repeatWaits = out.back().word == "repeat";
        } catch (const SyntaxFailure& failure) {
            error(failure.offset, failure.message, failure.remedy);
            remember(piece);
        }
    }

    /// What a broken statement would have meant for those after it.
    void remember(const StatementPiece& piece) {
        const std::string_view text = std::string_view(split_.masked).substr(piece.begin, piece.end - piece.begin);
        const auto wordFrom = [text](std::size_t& at) {
            while (at < text.size() && (text[at] == ' ' || text[at] == '\t'))
                ++at;
            const std::size_t start = at;
            while (at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_'))
                ++at;
            return std::string(text.substr(start, at - start));
        };
        std::size_t at = 0;
        const std::string word = wordFrom(at);
        if (word == "let" || word == "param" || word == "curve")
            tree_.brokenNames.insert(wordFrom(at));
        else if (word == "repeat")
            repeatWasBroken_ = true;
        else if (word == "new" || word == "open" || !vocabulary::contains(vocabulary::statementWords(), word))
            tree_.brokenBeginning = true; // perhaps a misspelt `new`
    }

    void error(std::size_t offset, std::string message, std::string remedy = {}) {
        tree_.diagnostics.push_back(
            tree_.source.diagnostic(Diagnostic::Severity::error, offset, std::move(message), std::move(remedy)));
    }

    SyntaxTree& tree_;
    StatementSplit split_;
    std::size_t next_ = 0;
    bool closed_ = false;    ///< the block that was read last has its '}'
    bool abandoned_ = false; ///< the rest of the text is not read
    bool repeatWasBroken_ = false;
};

} // namespace

SyntaxTree parse(std::string text, std::string file) {
    SyntaxTree tree{SourceText(std::move(text), std::move(file)), {}, {}, {}, false};
    Parser(tree).run();
    return tree;
}

} // namespace patina
