#pragma once
// What the checker has found so far.

#include "script/source_text.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace patina {

/// Collects errors and warnings; the same finding at the same place (a `repeat` is checked step by step) counts once.
class Findings {
  public:
    explicit Findings(const SourceText& source) : source_(source) {}

    void error(std::size_t offset, std::string message, std::string remedy = {});
    void warning(std::size_t offset, std::string message, std::string remedy = {});
    /// An error at a place that is not a byte of the text: the file as a whole, an option.
    void errorAt(SourcePlace place, std::string message, std::string remedy);
    void add(Diagnostic finding);

    int errorCount() const { return errors_; }
    /// In the order of the text; cut after mostFindings errors.
    std::vector<Diagnostic> sorted() const;

    const SourceText& source() const { return source_; }

  private:
    const SourceText& source_;
    std::set<std::pair<std::size_t, std::string>> known_;
    std::vector<Diagnostic> all_;
    int errors_ = 0;
};

} // namespace patina
