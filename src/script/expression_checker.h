#pragma once
// Expressions: names looked up, arguments and kinds of quantity checked, constants folded.

#include "operators/maps/image_channels.h"
#include "script/checker.h"
#include "script/findings.h"
#include "script/program.h"
#include "script/scope.h"
#include "script/syntax.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace patina {

/// Every function reports its errors to the findings and then returns nothing; nothing without a report means that
/// the error was reported before (where a name was declared).
class ExpressionChecker {
  public:
    ExpressionChecker(const CheckContext& context, Findings& findings, Scope& scope)
        : context_(context), findings_(findings), scope_(scope) {}

    /// Any expression.
    std::optional<Expression> resolve(const SyntaxExpression& syntax);
    /// A factor over the surface: no length; a constant beyond 0…1 is warned of.
    std::optional<Expression> map(const SyntaxExpression& syntax);

    /// A constant length in µm; a number without a unit is µm. `what` ("the thickness") begins the error's message.
    std::optional<double> length(const SyntaxExpression& syntax, const std::string& what);
    std::optional<double> lengthNotNegative(const SyntaxExpression& syntax, const std::string& what);
    std::optional<double> lengthPositive(const SyntaxExpression& syntax, const std::string& what);
    std::optional<double> plainNumber(const SyntaxExpression& syntax, const std::string& what);
    std::optional<double> fraction(const SyntaxExpression& syntax, const std::string& what);
    std::optional<double> wholeNumber(const SyntaxExpression& syntax, const std::string& what, double fewest,
                                      double most);

    /// A file's name joined to the script's folder; an error where it must exist and does not.
    std::optional<std::string> file(const std::string& name, std::size_t offset, const std::string& what);

    /// Number of nodes of a resolved expression.
    static int nodeCount(const Expression& expression);

  private:
    friend class GrowthChecker;
    friend class FieldChecker;
    friend class KineticsChecker;

    std::optional<Expression> resolveNode(const SyntaxExpression& syntax);
    std::optional<Expression> name(const SyntaxExpression& syntax);
    std::optional<Expression> call(const SyntaxExpression& syntax);
    std::optional<Expression> curveCall(const SyntaxExpression& syntax, const Declaration& declaration);
    std::optional<Expression> texture(const SyntaxExpression& syntax);
    std::optional<Expression> vertices(const SyntaxExpression& syntax);
    std::optional<Expression> geometric(const SyntaxExpression& syntax);
    std::optional<Expression> arithmetic(const SyntaxExpression& syntax);
    std::optional<Expression> unary(const SyntaxExpression& syntax);
    std::optional<Expression> binary(const SyntaxExpression& syntax);
    std::optional<Expression> folded(Expression expression);
    std::optional<Expression> constant(const SyntaxExpression& syntax, const std::string& what);

    Expression node(Expression::Kind kind, const SyntaxExpression& syntax) const;
    bool argumentCount(const SyntaxExpression& syntax);
    bool implemented(const std::string& function, std::size_t offset);
    bool noNamedArguments(const SyntaxExpression& syntax);

    const CheckContext& context_;
    Findings& findings_;
    Scope& scope_;
    int nodes_ = 0;                               ///< of the whole expression that is being resolved, `let`s put in
    int depth_ = 0;                               ///< of resolveNode's recursion
    std::map<std::string, ImageChannels> images_; ///< by path: a `repeat` asks for the same one at every step
};

/// The fields that take arguments.
class FieldChecker {
  public:
    explicit FieldChecker(ExpressionChecker& expressions) : expressions_(expressions) {}

    std::optional<Expression> exposure(const SyntaxExpression& syntax);
    std::optional<Expression> accessibility(const SyntaxExpression& syntax);

  private:
    bool argument(const std::string& name, const SyntaxExpression& value, ExposureRequest& out);
    bool sky(const SyntaxExpression& syntax, ExposureRequest& out);
    std::optional<bool> yesOrNo(const SyntaxExpression& syntax, const std::string& name);
    std::optional<std::vector<double>> numbers(const SyntaxExpression& syntax, std::size_t count,
                                               const std::string& what, const std::string& example);

    ExpressionChecker& expressions_;
};

/// What metals lose over the years, and how minerals swell: constants.
class KineticsChecker {
  public:
    explicit KineticsChecker(ExpressionChecker& expressions) : expressions_(expressions) {}

    std::optional<Expression> iso9224(const SyntaxExpression& syntax);
    std::optional<Expression> expansion(const SyntaxExpression& syntax);

  private:
    std::optional<std::string> word(const SyntaxExpression& syntax, const std::vector<std::string>& known,
                                    const std::string& what);

    ExpressionChecker& expressions_;
};

/// texture(BD.linear_1.20) and texture(BD(rate=linear, step=1, total=20, …)).
class GrowthChecker {
  public:
    explicit GrowthChecker(ExpressionChecker& expressions) : expressions_(expressions) {}

    /// Whether this is written like a growth pattern (perhaps of an unknown model).
    static bool looksLikeGrowth(const SyntaxExpression& syntax);
    std::optional<GrowthCall> resolve(const SyntaxExpression& syntax);

  private:
    bool argument(const SyntaxExpression& syntax, std::size_t index, GrowthCall& out);
    bool direction(const SyntaxExpression& syntax, GrowthCall& out);
    bool rate(const std::string& word, std::size_t offset, GrowthCall& out);
    bool moment(const GrowthCall& growth, std::size_t stepOffset, std::size_t totalOffset);

    ExpressionChecker& expressions_;
};

} // namespace patina
