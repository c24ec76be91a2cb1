// Constants with a meaning: lengths, fractions, whole numbers.

#include "base/units.h"
#include "script/expression_checker.h"

#include <fmt/format.h>

#include <cmath>

namespace patina {

std::optional<Expression> ExpressionChecker::constant(const SyntaxExpression& syntax, const std::string& what) {
    std::optional<Expression> out = resolveNode(syntax);
    if (out && out->kind != Expression::Kind::number) {
        findings_.error(syntax.offset, fmt::format("{} must be a number, this varies over the surface", what),
                        "a map stands behind the number, without an operator between them");
        return std::nullopt;
    }
    return out;
}

std::optional<double> ExpressionChecker::length(const SyntaxExpression& syntax, const std::string& what) {
    const std::optional<Expression> value = constant(syntax, what);
    return value ? std::optional<double>(value->number) : std::nullopt;
}

std::optional<double> ExpressionChecker::lengthNotNegative(const SyntaxExpression& syntax, const std::string& what) {
    const std::optional<double> value = length(syntax, what);
    if (value && *value < 0.0) {
        findings_.error(syntax.offset, fmt::format("{} is negative: {}", what, readableLength(*value)));
        return std::nullopt;
    }
    return value;
}

std::optional<double> ExpressionChecker::lengthPositive(const SyntaxExpression& syntax, const std::string& what) {
    const std::optional<double> value = lengthNotNegative(syntax, what);
    if (value && *value == 0.0) {
        findings_.error(syntax.offset, fmt::format("{} must be larger than 0", what));
        return std::nullopt;
    }
    return value;
}

std::optional<double> ExpressionChecker::plainNumber(const SyntaxExpression& syntax, const std::string& what) {
    const std::optional<Expression> value = constant(syntax, what);
    if (!value)
        return std::nullopt;
    if (value->isLength) {
        findings_.error(syntax.offset, fmt::format("{} is a number without a unit, this is a length", what));
        return std::nullopt;
    }
    return value->number;
}

std::optional<double> ExpressionChecker::fraction(const SyntaxExpression& syntax, const std::string& what) {
    const std::optional<double> value = plainNumber(syntax, what);
    if (value && (*value < 0.0 || *value > 1.0)) {
        findings_.error(syntax.offset, fmt::format("{} must be between 0 and 1, this is {:g}", what, *value));
        return std::nullopt;
    }
    return value;
}

std::optional<double> ExpressionChecker::wholeNumber(const SyntaxExpression& syntax, const std::string& what,
                                                     double fewest, double most) {
    const std::optional<double> value = plainNumber(syntax, what);
    if (!value)
        return std::nullopt;
    if (*value != std::floor(*value)) {
        findings_.error(syntax.offset, fmt::format("{} must be a whole number, this is {:g}", what, *value));
        return std::nullopt;
    }
    if (*value < fewest || *value > most) {
        findings_.error(syntax.offset,
                        fmt::format("{} must be {} to {:.0f}, this is {:.0f}", what, fewest, most, *value));
        return std::nullopt;
    }
    return value;
}

} // namespace patina
