#include "script/statement_split.h"

#include "script/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {

namespace {

class Splitter {
  public:
    explicit Splitter(const SourceText& source) : source_(source), text_(source.text()) { split_.masked = text_; }

    StatementSplit run() {
        if (text_.compare(0, 3, "\xEF\xBB\xBF") == 0) // a byte order mark
            blankOut(0, 3);
        for (at_ = 0; at_ < text_.size();)
            step();
        finish(text_.size());
        return std::move(split_);
    }

  private:
    void step() {
        const char c = text_[at_];
        if (c == '#' || (c == '/' && at_ + 1 < text_.size() && text_[at_ + 1] == '/')) {
            const std::size_t end = lineEnd(at_);
            blankOut(at_, end);
            at_ = end;
        } else if (c == '"') {
            quoted();
        } else if (c == '(') {
            open_.push_back(at_);
            if (open_.size() == deepestBrackets + 1)
                error(at_, fmt::format("brackets are nested more than {} deep", deepestBrackets),
                      "use 'let NAME = …' for parts of the expression");
            ++at_;
        } else if (c == ')') {
            if (open_.empty())
                error(at_, "')' closes no '('");
            else
                open_.pop_back();
            ++at_;
        } else if (c == ';') {
            finish(at_);
            begin_ = ++at_;
        } else if (c == '{' || c == '}') {
            finish(at_);
            split_.pieces.push_back(
                {c == '{' ? StatementPiece::Kind::blockBegin : StatementPiece::Kind::blockEnd, at_, at_ + 1, false});
            begin_ = ++at_;
        } else if (c == '\n') {
            if (open_.empty() || statementBegins(at_ + 1)) {
                finish(at_);
                begin_ = at_ + 1;
            } else {
                split_.masked[at_] = ' ';
            }
            ++at_;
        } else {
            ++at_;
        }
    }

    void quoted() {
        const std::size_t end = lineEnd(at_);
        const std::size_t close = std::string_view(text_).substr(at_ + 1, end - at_ - 1).find('"');
        if (close != std::string_view::npos) {
            at_ += close + 2;
            return;
        }
        error(at_, "the quoted text is not closed", "put a '\"' at its end, on the same line");
        open_.clear();
        at_ = end; // at the line's end: the statement ends there too
    }

    /// The statement ends before `end`. Inside brackets that is an error of the innermost open one.
    void finish(std::size_t end) {
        if (!open_.empty() && !broken_)
            error(open_.back(), "'(' is not closed",
                  fmt::format("the statement ends in line {} without its ')'", source_.lineNumber(end)));
        open_.clear();
        std::size_t first = begin_;
        while (first < end && isBlank(split_.masked[first]))
            ++first;
        std::size_t last = end;
        while (last > first && isBlank(split_.masked[last - 1]))
            --last;
        if (first < last)
            split_.pieces.push_back({StatementPiece::Kind::statement, first, last, broken_});
        begin_ = end;
        broken_ = false;
    }

    /// Whether the line that starts here begins with a word that begins a statement: no expression can.
    bool statementBegins(std::size_t start) const {
        while (start < text_.size() && (text_[start] == ' ' || text_[start] == '\t'))
            ++start;
        std::size_t end = start;
        while (end < text_.size() && end - start < 16 && text_[end] >= 'a' && text_[end] <= 'z')
            ++end;
        const bool wordEnds = end >= text_.size() || text_[end] == ' ' || text_[end] == '\t';
        return wordEnds &&
               vocabulary::contains(vocabulary::statementWords(), std::string_view(text_).substr(start, end - start));
    }

    /// Found once per line: a line can hold a million quotes.
    std::size_t lineEnd(std::size_t from) {
        if (from > lineEnd_ || lineEnd_ == 0)
            lineEnd_ = std::min(text_.find('\n', from), text_.size());
        return lineEnd_;
    }

    void blankOut(std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            split_.masked[i] = ' ';
    }

    static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

    void error(std::size_t offset, std::string message, std::string remedy = {}) {
        broken_ = true;
        if (split_.diagnostics.size() > mostFindings)
            return;
        split_.diagnostics.push_back(
            source_.diagnostic(Diagnostic::Severity::error, offset, std::move(message), std::move(remedy)));
    }

    const SourceText& source_;
    const std::string& text_;
    StatementSplit split_;
    std::size_t at_ = 0;
    std::size_t begin_ = 0;
    std::size_t lineEnd_ = 0;
    std::vector<std::size_t> open_;
    bool broken_ = false;
};

} // namespace

StatementSplit splitStatements(const SourceText& source) {
    return Splitter(source).run();
}

} // namespace patina
