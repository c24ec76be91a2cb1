#pragma once
// One statement of an operator: its materials, numbers, map and clauses.

#include "script/checker.h"
#include "script/expression_checker.h"
#include "script/findings.h"
#include "script/program.h"
#include "script/syntax.h"

#include <map>
#include <optional>
#include <set>
#include <string>

namespace patina {

/// Resolves operator statements one after the other and gives them their labels.
class StatementChecker {
  public:
    StatementChecker(const CheckContext& context, Findings& findings, Scope& scope)
        : context_(context), findings_(findings), expressions_(context, findings, scope) {}

    /// The statement, or nothing where it has an error.
    std::optional<Statement> resolve(const SyntaxStatement& syntax);

  private:
    enum class Expected { metal, layer, any };

    std::optional<Statement::Action> action(const SyntaxStatement& syntax);
    std::optional<Statement::Action> begin(const SyntaxStatement& syntax);
    std::optional<Statement::Action> coat(const SyntaxStatement& syntax);
    std::optional<Statement::Action> erode(const SyntaxStatement& syntax);
    std::optional<Statement::Action> grow(const SyntaxStatement& syntax);
    std::optional<Statement::Action> convert(const SyntaxStatement& syntax);
    std::optional<Statement::Action> fill(const SyntaxStatement& syntax);
    std::optional<Statement::Action> polish(const SyntaxStatement& syntax);
    std::optional<Statement::Action> offset(const SyntaxStatement& syntax);
    std::optional<Statement::Action> render(const SyntaxStatement& syntax);

    bool material(const SyntaxWord& word, Expected expected);
    bool mapInto(const SyntaxStatement& syntax, std::optional<Expression>& map);
    bool clausesFit(const SyntaxStatement& syntax);
    void warnWhereAbsent(const SyntaxWord& material);
    std::string label(const SyntaxStatement& syntax);

    const CheckContext& context_;
    Findings& findings_;
    ExpressionChecker expressions_;
    std::map<std::string, int> used_; ///< how often each unnamed label was given
    std::set<std::string> present_;   ///< layers laid so far
    bool presentKnown_ = true;        ///< false after `open`: the file's layers are not known here
};

} // namespace patina
